#include "solver/event_driven.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "dynamics/flight.h"
#include "solver/peaks.h"
#include "solver/sampled.h"

/* The error allowed in a piece: of what the user asks for a thousandth, for impacts multiply errors, in proportion to d where the centre
 * is near, for it turns n by its part of d, and no less than what rounding leaves. */
static double tolerance_of(const struct scene_values *v, const struct motion *q,
                           const struct system_instant *at, int contact)
{
    const struct contact_shape shape = system_shape(v, q, contact);
    const double distance = at->geometry[contact].distance;
    const double size = fmax(distance, contact_reach(&shape));
    const double asked = solver_relative_tolerance(v) * size + solver_absolute_tolerance(v);
    return fmax(1e-3 * asked * (distance / size), 8.0 * DBL_EPSILON * size);
}

/* Islands: the free bodies that pressing contacts join. A pair alone, one of it free, is what pieces are made for. */
static bool pairs_are_alone(const struct scene_values *v, const struct motion *q)
{
    for (int j = 0; SCENE_CONTACTS > 1 && j < SCENE_CONTACTS; ++j) {
        if (contact_is_coupled(v, q, j)) {
            return false;
        }
    }
    return true;
}

/* What all pairs that press do until the first of them comes to the end of a piece or of its regime, or to the centre. */
struct stretch {
    struct piece piece[SCENE_CONTACTS];
    double longest, time; /* at most, and as it is [s] */
    int ending;           /* the contact whose regime ends then or begins anew; -1: none */
    enum contact_regime next;
};

static bool is_piecewise(const struct scene_values *v, const struct motion *q, int contact)
{
    return contact_transmits(q, contact) && !contact_is_held(v, contact);
}

/* A piece that covers so much of what it was asked for covers it, but for rounding: nobody else need be cut short. */
static const double ALL_OF_IT = 1.0 - 4.0 * DBL_EPSILON;

static bool add_pair(struct stretch *all, const struct scene_values *v, const struct motion *q,
                     const struct system_instant *at, int contact)
{
    struct piece *p = &all->piece[contact];
    const double longest =
        all->time > 0.0 ? all->time : all->longest; /* if another ends at once, so does this one */
    if (!piece_make(p, v, q, at, contact, longest, tolerance_of(v, q, at, contact))) {
        return false;
    }
    const double end = p->end * p->unit;
    const double ending = p->ending.s * p->unit;
    const double latest = all->ending < 0 ? all->time / ALL_OF_IT : all->time;
    if (p->ending.s <= p->end && ending < latest) {
        all->time = ending;
        all->ending = contact;
        all->next = p->ending.regime;
    } else if (end < all->time && end < longest * ALL_OF_IT) {
        all->time = end;
        all->ending = -1;
    }
    return true;
}

/* Pairs made before a shorter one came are made again: a piece is at its best at its end. */
static bool stretch_make(struct stretch *all, const struct scene_values *v, const struct motion *q,
                         const struct system_instant *at, double longest)
{
    all->longest = all->time = longest;
    all->ending = -1;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        all->piece[j].unit = all->piece[j].end = 0.0;
    }
    for (double before = (double)INFINITY; all->time < before;) {
        before = SCENE_CONTACTS > 1 ? all->time : 0.0;
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            if (is_piecewise(v, q, j) && j != all->ending && !add_pair(all, v, q, at, j)) {
                return false;
            }
        }
    }
    return true;
}

/* Contacts whose motion is given come along; false where the budget ends the stretch before its time. */
static bool stretch_integrate_held(struct stretch *all, const struct scene_values *v, struct motion *q,
                                   long *budget)
{
    const double to = q->clock + all->time;
    const double reached = SCENE_CONTACTS > 1 ? sampled_integrate(v, q, to, budget) : to;
    if (reached < to) {
        all->time = reached - q->clock;
        all->ending = -1;
    }
    return !(reached < to);
}

/* Bodies outside islands fly. */
static void book_flights(const struct scene_values *v, struct motion *q, double time)
{
    for (int i = 0; SCENE_CONTACTS > 1 && i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i) && !body_is_pressed(q, i, -1)) {
            struct vec3 force[3];
            flight_force(q, i, q->clock, force);
            q->external_work += flight_work(v, i, q->body[i], force, time);
        }
    }
}

static void carry_rate(struct piece *p, double s, const struct press_change *change,
                       const struct scene_values *v, struct motion *q, int contact)
{
    struct contact_state *state = &q->contact[contact];
    state->rate_rounding = press_rate_rounding(&p->press, change, v, q, contact);
    if (state->rate_rounding > 0.0) {
        state->carried_rate = watch_see(&p->watch, s)->of[PRESS_RATE][0];
    }
}

static void stretch_apply(struct stretch *all, const struct scene_values *v, struct motion *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (is_piecewise(v, q, j)) {
            struct piece *p = &all->piece[j];
            const double s = j == all->ending || all->time < p->end * p->unit ? all->time / p->unit : p->end;
            const struct press_change change = piece_change(p, s);
            peaks_note(p, &q->contact[j], s);
            press_apply(&p->press, &change, v, q, j);
            carry_rate(p, s, &change, v, q, j);
            counter_add(&q->counters.steps, 1);
            counter_add(&q->counters.force_evaluations, 1);
        }
    }
    book_flights(v, q, all->time);
    q->clock += all->time;
    flight_restore(v, q);
}

/* What released contacts still store: it is lost as they open, while other pairs press. */
static double stored_in_released(const struct scene_values *v, const struct motion *q, struct advance *step)
{
    double sum = 0.0;
    for (int j = 0; SCENE_CONTACTS > 1 && j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime == REGIME_RELEASED && !contact_is_held(v, j)) {
            const struct contact_law law = system_law(v, q, j);
            const double gap = advance_now(step, v, q)->geometry[j].gap;
            sum += contact_stored_energy(&law, REGIME_RELEASED, gap);
        }
    }
    return sum;
}

enum advance_result event_driven_advance(const struct scene_values *v, struct motion *q, struct advance *step)
{
    if (!pairs_are_alone(v, q)) {
        return ADVANCE_FAILED;
    }
    while (q->clock < step->clock_end) {
        struct stretch all;
        const double left = step->clock_end - q->clock;
        if (step->budget <= 0) {
            return ADVANCE_STEP_LIMIT;
        }
        if (!stretch_make(&all, v, q, advance_now(step, v, q), left)) {
            return ADVANCE_FAILED; /* with the budget it came with: CVODE takes a budget of 0 as its default */
        }
        step->budget -= 1;
        const bool whole = stretch_integrate_held(&all, v, q, &step->budget);
        const double stored = stored_in_released(v, q, step);
        step->is_now = false;
        stretch_apply(&all, v, q);
        q->dissipated += stored - stored_in_released(v, q, step);
        if (!whole) {
            return ADVANCE_STEP_LIMIT;
        }
        if (all.ending >= 0 && all.next != (enum contact_regime)q->contact[all.ending].regime) {
            step->contact = all.ending;
            step->regime = all.next;
            return ADVANCE_EVENT;
        }
        if (all.time >= left) {
            q->clock = step->clock_end;
        }
    }
    return ADVANCE_REACHED;
}

#endif
