#include "integrator/advance.h"

#include <float.h>

#include "flight/flight.h"
#include "touch/segment.h"

/* The error allowed in a segment [m]: a thousandth of the tolerances, because impacts amplify errors. Near
 * the centre it is cut in proportion to d, because an error e across n turns n by e / d. It is never below
 * what rounding leaves. */
static double tolerance_of(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const double reach = contact_reach(&shape);
    const double distance = contact_is_plane(&shape) ? reach : at->geometry[contact].distance;
    const double size = fmax(distance, reach);
    const double asked = solver_relative_tolerance(v) * size + solver_absolute_tolerance(v);
    return fmax(1e-3 * asked * (distance / size), 8.0 * DBL_EPSILON * size);
}

/* Whether no free body takes part in two contacts that transmit forces. Segments are made for such pairs
 * only. */
static bool pairs_are_alone(const struct scene_values *v, const struct scene_state *q)
{
    for (int j = 0; SCENE_CONTACTS > 1 && j < SCENE_CONTACTS; ++j) {
        if (contact_is_coupled(v, q, j)) {
            return false;
        }
    }
    return true;
}

/* One synchronized step: all contact pairs advance by the same time, up to the first terminal event, the
 * first end of a segment, or the first passage of a centre. */
struct synchronized_step {
    struct segment segment[SCENE_CONTACTS];
    double longest, time; /* at most, and as it is [s] */
    int terminal;         /* the contact whose regime ends then or begins anew; -1: none */
    enum contact_regime next;
    bool changes; /* whether the regime or the zone of that contact is another then */
};

static bool has_segment(const struct scene_values *v, const struct scene_state *q, int contact)
{
    return contact_transmits(q, contact) && !contact_is_driven(v, contact);
}

/* A segment that reaches this part of the time asked for reaches all of it but for rounding: the other pairs
 * are not shortened. */
static const double ALL_OF_IT = 1.0 - 4.0 * DBL_EPSILON;

static bool add_pair(struct synchronized_step *all, const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at, int contact)
{
    struct segment *p = &all->segment[contact];
    const double longest =
        all->time > 0.0 ? all->time : all->longest; /* if another ends, up to the same time */
    if (!segment_make(p, v, q, at, contact, longest, tolerance_of(v, q, at, contact))) {
        return false;
    }
    const double end = segment_time(p, p->end);
    const double terminal = p->terminal.s <= p->end ? segment_time(p, p->terminal.s) : (double)INFINITY;
    const double latest = all->terminal < 0 ? all->time / ALL_OF_IT : all->time;
    if (p->terminal.s <= p->end && terminal < latest) {
        all->time = terminal;
        all->terminal = contact;
        all->next = p->terminal.regime;
        all->changes =
            all->next != (enum contact_regime)q->contact[contact].regime || zone_end_is_terminal(p);
    } else if (end < all->time && end < longest * ALL_OF_IT) {
        all->time = end;
        all->terminal = -1;
    }
    return true;
}

/* Where one pair shortens the step, the pairs made before it are made again: a segment is most accurate at
 * its own end. */
static bool synchronized_step_make(struct synchronized_step *all, const struct scene_values *v,
                                   const struct scene_state *q, const struct scene_instant *at,
                                   double longest)
{
    all->longest = all->time = longest;
    all->terminal = -1;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        all->segment[j].kind = SEGMENT_CLOSED_FORM; /* defined where there is none, too */
        all->segment[j].unit = all->segment[j].end = 0.0;
    }
    for (double before = (double)INFINITY; all->time < before;) {
        before = SCENE_CONTACTS > 1 ? all->time : 0.0;
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            if (has_segment(v, q, j) && j != all->terminal && !add_pair(all, v, q, at, j)) {
                return false;
            }
        }
    }
    return true;
}

/* Integrates the kinematically driven contacts over the same time; false where the budget ends the
 * synchronized step early. */
static bool synchronized_step_integrate_driven(struct synchronized_step *all, const struct scene_values *v,
                                               struct scene_state *q, long *budget)
{
    const double to = q->clock + all->time;
    const double reached = SCENE_CONTACTS > 1 ? prescribed_integrate(v, q, to, budget) : to;
    if (reached < to) {
        all->time = reached - q->clock;
        all->terminal = -1;
    }
    return !(reached < to);
}

/* External work on bodies without a contact force. */
static void book_flights(const struct scene_values *v, struct scene_state *q, double time)
{
    for (int i = 0; SCENE_CONTACTS > 1 && i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i) && !body_is_loaded(q, i, -1)) {
            struct vec3 force[3];
            flight_force(q, i, q->clock, force);
            q->external_work += flight_work(v, i, q->body[i], force, time);
        }
    }
}

/* A step that ends where it begins moves nothing: a segment is right to its tolerance there, not exact. */
static void synchronized_step_apply(struct synchronized_step *all, const struct scene_values *v,
                                    struct scene_state *q)
{
    if (!(all->time > 0.0)) {
        return;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (has_segment(v, q, j)) {
            struct segment *p = &all->segment[j];
            const bool is_shortened = j == all->terminal || all->time < segment_time(p, p->end);
            const double s = is_shortened ? segment_place(p, all->time) : p->end;
            segment_advance(p, s, v, q, j);
            counter_add(&q->counters.steps, 1);
            counter_add(&q->counters.force_evaluations, 1);
        }
    }
    book_flights(v, q, all->time);
    q->clock += all->time;
    flight_restore(v, q);
}

/* Energy stored by separating contacts [J]. Their force is zero, so that it is lost as the gap opens. */
static double stored_in_separating(const struct scene_values *v, const struct scene_state *q,
                                   struct advance *step)
{
    double sum = 0.0;
    for (int j = 0; SCENE_CONTACTS > 1 && j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime == REGIME_SEPARATING && !contact_is_driven(v, j)) {
            const struct contact_law law = scene_contact_law(v, q, j);
            const double gap = advance_now(step, v, q)->geometry[j].gap;
            sum += contact_stored_energy(&law, REGIME_SEPARATING, gap);
        }
    }
    return sum;
}

enum advance_result event_driven_advance(const struct scene_values *v, struct scene_state *q,
                                         struct advance *step)
{
    if (!pairs_are_alone(v, q)) {
        return ADVANCE_FAILED;
    }
    while (q->clock < step->clock_end) {
        struct synchronized_step all;
        const double left = step->clock_end - q->clock;
        if (step->budget <= 0) {
            return ADVANCE_STEP_LIMIT;
        }
        if (!synchronized_step_make(&all, v, q, advance_now(step, v, q), left)) {
            /* with the budget it came with: CVODE takes a budget of 0 as its default */
            return ADVANCE_FAILED;
        }
        step->budget -= 1;
        const bool whole = synchronized_step_integrate_driven(&all, v, q, &step->budget);
        const double stored = stored_in_separating(v, q, step);
        step->is_now = false;
        synchronized_step_apply(&all, v, q);
        q->dissipated += stored - stored_in_separating(v, q, step);
        if (!whole) {
            return ADVANCE_STEP_LIMIT;
        }
        if (all.terminal >= 0 && all.changes) {
            step->contact = all.terminal;
            step->regime = all.next;
            return ADVANCE_EVENT;
        }
        if (all.time >= left) {
            q->clock = step->clock_end;
        }
    }
    return ADVANCE_REACHED;
}
