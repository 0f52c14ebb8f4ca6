#include "integrator/phases.h"

#include <float.h>
#include <stdio.h>

#include "flight/flight.h"
#include "integrator/cvode.h"
#include "integrator/general.h"
#include "integrator/prediction.h"
#include "prescribed/prescribed.h"
#include "scene/evaluate.h"
#include "touch/segment.h"

bool integrator_open(struct integrator *s, const struct scene_values *v,
                     const struct integrator_memory *memory)
{
    s->message[0] = '\0';
    if (!scene_uses_ode(v) || (scene_is_force_element(v) && !scene_turns(v))) {
        return true;
    }
#if SCENE_HAS_GENERAL
    if (solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN) {
        return general_open(&s->general, v, memory, s->message);
    }
#endif
#ifdef CONTACT_WITH_CVODE
    return cvode_open(&s->cvode, v, memory, s->message);
#else
    (void)memory;
    snprintf(s->message, sizeof s->message, "this FMU has no CVODE");
    return solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN;
#endif
}

void integrator_close(struct integrator *s)
{
#if SCENE_HAS_GENERAL
    general_close(&s->general);
#endif
#ifdef CONTACT_WITH_CVODE
    cvode_close(&s->cvode);
#endif
    (void)s;
}

/* The present instant, without accelerations and forces: computed once, however many ask for it. */
static const struct scene_instant *advance_now(struct advance *step, const struct scene_values *v,
                                               const struct scene_state *q)
{
    if (!step->is_now) {
        scene_kinematics_now(v, q, &step->now);
        step->is_now = true;
    }
    return &step->now;
}

/* Horizon of a separating contact, as a multiple of the time in which it opens at its present rate. */
static const double SEPARATION_TIMES = 4.0;

/* The horizon is at most this [s], or this many times as long as the phase has lasted; so are steps. In units
 * of a path of degree four and so long bodies measure 1e-72, whose fourth power is a number still. */
static const double LONGEST_HORIZON = 1e18;
static const double HORIZON_GROWTH = 1e3;

static double horizon_of_flight(double clock, double remaining)
{
    const double horizon = fmax(remaining, clock);
    return horizon > LONGEST_HORIZON ? fmin(horizon, fmax(LONGEST_HORIZON, HORIZON_GROWTH * clock)) : horizon;
}

/* The horizon of the search for regime changes [s]: the rest of the step, or the time since the phase began
 * if that is longer, so that a flight of many short steps is searched a few times only. While a contact
 * separates it is not much longer than that lasts: the conditions are then nearly linear and their roots
 * cheap. */
static double horizon_from(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at, double remaining)
{
    double horizon = horizon_of_flight(q->clock, remaining);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime == REGIME_SEPARATING) {
            const struct contact_geometry *now = &at->geometry[j];
            const double opens = (rounding_of_gap(v, at, j) - now->gap) / now->gap_rate;
            horizon = opens > 0.0 ? fmin(horizon, fmax(SEPARATION_TIMES * opens, q->clock)) : horizon;
        }
    }
    return horizon;
}

/* Says of every contact when its regime changes next. */
static inline void look_ahead(const struct scene_values *v, struct scene_state *q, double remaining,
                              struct advance *step)
{
    if (q->horizon_clock > q->clock) {
        return;
    }
    const struct scene_instant *at = advance_now(step, v, q);
    double horizon = horizon_from(v, q, at, remaining);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct prediction found = prediction_of(v, q, at, j, horizon, step->budget);
        horizon = found.searched;
        advance_spend(step, found.evaluations, found.evaluations);
        q->contact[j].schedule.change_clock = q->clock + found.next.after;
        q->contact[j].schedule.change_regime = (int32_t)found.next.regime;
        q->contact[j].schedule.change_gap = found.next.gap;
        q->contact[j].schedule.passes_centre = found.next.passes_centre;
    }
    q->horizon_clock = q->clock + horizon;
}

/* The contact whose closed-form change comes first. */
static int contact_changing_first(const struct scene_state *q)
{
    int first = 0;
    for (int j = 1; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].schedule.change_clock < q->contact[first].schedule.change_clock) {
            first = j;
        }
    }
    return first;
}

/* A separating contact opens, unless a prescribed displacement goes another way than its velocity says. */
static void note_depth_of_released(const struct scene_values *v, struct scene_state *q, struct advance *step)
{
    for (int j = 0; SCENE_ANY_PRESCRIBED && j < SCENE_CONTACTS; ++j) {
        const bool led =
            body_is_prescribed(v, contact_source(j)) || body_is_prescribed(v, contact_destination(j));
        /* the paths of regime_change_note_depth have a fixed axis */
        if (led && q->contact[j].regime == REGIME_SEPARATING && !contact_axis_turns(v, j)) {
            regime_change_note_depth(v, q, advance_now(step, v, q), j, step->clock_end);
        }
    }
}

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

/* Segments are made for contact pairs where nothing turns or rubs and no free body takes part in two contacts
 * that transmit forces. */
static bool pairs_are_alone(const struct scene_values *v, const struct scene_state *q)
{
    if (solver_method(v) != SOLVER_METHOD_EVENT_DRIVEN || scene_turns(v)) {
        return false;
    }
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
    double longest, time; /* limit and length of the step [s] */
    int terminal;         /* the contact whose regime ends, or begins anew, at its end; -1: none */
    enum contact_regime next;
    bool changes; /* whether the regime or the zone of that contact changes at the end */
};

static bool has_segment(const struct scene_values *v, const struct scene_state *q, int contact)
{
    return contact_transmits(q, contact) && !contact_is_prescribed(v, contact);
}

/* A segment that reaches this part of the time asked for reaches it within rounding, and does not shorten the
 * other pairs. */
static const double ALL_OF_IT = 1.0 - 4.0 * DBL_EPSILON;

static bool add_pair(struct synchronized_step *all, const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at, int contact)
{
    struct segment *p = &all->segment[contact];
    const double longest =
        all->time > 0.0 ? all->time : all->longest; /* the segment of another pair may end earlier */
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
        all->segment[j].work = 0;
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

/* Integrates the prescribed contacts to a clock; returns the clock reached. The depth is found separately,
 * because a quadrature of a force that is zero does not show it. */
static double integrate_prescribed(const struct scene_values *v, struct scene_state *q, double end,
                                   struct advance *step)
{
    const long before = step->budget;
    const double reached = prescribed_integrate(v, q, end, &step->budget);
    advance_spend(step, 0, PANEL_WORK * (before - step->budget));
    for (int j = 0; reached > q->clock && j < SCENE_CONTACTS; ++j) {
        if (contact_is_prescribed(v, j) && q->contact[j].regime != (int32_t)REGIME_APART) {
            regime_change_note_depth(v, q, advance_now(step, v, q), j, reached);
        }
    }
    return reached;
}

/* Integrates the prescribed contacts over the same time; false where the budget ends the synchronized step
 * early. */
static bool synchronized_step_integrate(struct synchronized_step *all, const struct scene_values *v,
                                        struct scene_state *q, struct advance *step)
{
    if (!SCENE_ANY_PRESCRIBED_CONTACT || SCENE_CONTACTS == 1) {
        return true;
    }
    const double to = q->clock + all->time;
    const double reached = integrate_prescribed(v, q, to, step);
    if (reached < to) {
        all->time = reached - q->clock;
        all->terminal = -1;
        return false;
    }
    return true;
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
        if (q->contact[j].regime == REGIME_SEPARATING && !contact_is_prescribed(v, j)) {
            const struct contact_law law = scene_contact_law(v, q, j);
            const double gap = advance_now(step, v, q)->geometry[j].gap;
            sum += contact_stored_energy(&law, REGIME_SEPARATING, gap);
        }
    }
    return sum;
}

static long work_of_pairs(const struct synchronized_step *all)
{
    long sum = 0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += all->segment[j].work;
    }
    return sum;
}

/* Advances the contact pairs segment by segment (touch/segment.h), and the prescribed contacts with them. */
static enum advance_result advance_pairs(struct integrator *s, const struct scene_values *v,
                                         struct scene_state *q, struct advance *step)
{
    (void)s;
    while (q->clock < step->clock_end) {
        struct synchronized_step all;
        const double left = step->clock_end - q->clock;
        if (advance_is_spent(step)) {
            return ADVANCE_STEP_LIMIT;
        }
        if (!synchronized_step_make(&all, v, q, advance_now(step, v, q), left)) {
            /* with the budget it came with: CVODE takes a budget of 0 as its default */
            return ADVANCE_FAILED;
        }
        advance_spend(step, 1, work_of_pairs(&all));
        const bool whole = synchronized_step_integrate(&all, v, q, step);
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

#if SCENE_ANY_PRESCRIBED_CONTACT
static bool is_prescribed(const struct scene_values *v, const struct scene_state *q)
{
    (void)q;
    return scene_is_force_element(v) && !scene_turns(v);
}

static enum advance_result advance_prescribed(struct integrator *s, const struct scene_values *v,
                                              struct scene_state *q, struct advance *step)
{
    (void)s;
    q->clock = integrate_prescribed(v, q, step->clock_end, step);
    return q->clock < step->clock_end ? ADVANCE_STEP_LIMIT : ADVANCE_REACHED;
}
#endif

static bool is_flight(const struct scene_values *v, const struct scene_state *q)
{
    (void)v;
    return flight_is_free(q);
}

static enum advance_result advance_flight(struct integrator *s, const struct scene_values *v,
                                          struct scene_state *q, struct advance *step)
{
    (void)s;
    note_depth_of_released(v, q, step);
    flight_advance(v, q, step->clock_end);
    return ADVANCE_REACHED;
}

#if SCENE_HAS_GENERAL
/* The clock up to which nothing foreseen ends a step: the next change of a regime, and the horizon unless
 * nothing is foreseen. Steps go on beyond the end of a communication step only where the phase has lasted
 * before, so that inputs that change at every communication point waste no steps. */
static double unforeseen_until(const struct scene_values *v, const struct scene_state *q)
{
    double until = q->clock + HORIZON_GROWTH * q->clock;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        until = fmin(until, q->contact[j].schedule.change_clock);
        until = contact_is_foreseen(v, q, j) ? fmin(until, q->horizon_clock) : until;
    }
    return until;
}

static bool is_general(const struct scene_values *v, const struct scene_state *q)
{
    (void)q;
    return solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN && scene_uses_ode(v);
}

static enum advance_result advance_general(struct integrator *s, const struct scene_values *v,
                                           struct scene_state *q, struct advance *step)
{
    counter_add(&q->counters.fallbacks, 1);
    step->clock_limit = fmax(step->clock_end, unforeseen_until(v, q));
    return general_advance(s->general, v, q, step);
}
#endif

#ifdef CONTACT_WITH_CVODE
static bool is_cvode(const struct scene_values *v, const struct scene_state *q)
{
    (void)q;
    return solver_method(v) != SOLVER_METHOD_EVENT_DRIVEN;
}

static enum advance_result advance_cvode(struct integrator *s, const struct scene_values *v,
                                         struct scene_state *q, struct advance *step)
{
    return cvode_advance(s->cvode, v, q, step);
}
#endif

/* The phases of motion in order of preference. One that applies may give up where the motion is too hard for
 * it (ADVANCE_FAILED); the next one that applies goes on from there. */
static const struct motion_phase {
    bool (*applies)(const struct scene_values *v, const struct scene_state *q);
    enum advance_result (*advance)(struct integrator *s, const struct scene_values *v, struct scene_state *q,
                                   struct advance *step);
} PHASES[] = {
#if SCENE_ANY_PRESCRIBED_CONTACT
    {is_prescribed, advance_prescribed},
#endif
    {is_flight, advance_flight},         {pairs_are_alone, advance_pairs},
#if SCENE_HAS_GENERAL
    {is_general, advance_general},
#endif
#ifdef CONTACT_WITH_CVODE
    {is_cvode, advance_cvode},
#endif
};

static enum advance_result advance_phase(struct integrator *s, const struct scene_values *v,
                                         struct scene_state *q, struct advance *step)
{
    if (!(step->clock_end > q->clock)) {
        return ADVANCE_REACHED;
    }
    s->message[0] = '\0';
    for (size_t i = 0; i < sizeof PHASES / sizeof *PHASES; ++i) {
        if (PHASES[i].applies(v, q)) {
            const enum advance_result result = PHASES[i].advance(s, v, q, step);
            if (result != ADVANCE_FAILED) {
                return result;
            }
        }
    }
    if (s->message[0] == '\0') {
        snprintf(s->message, sizeof s->message, "no segment of the motion can be made from here");
    }
    return ADVANCE_FAILED;
}

/* Puts a contact into its next regime; returns whether contact begins or ends with it. */
static bool change_regime(const struct scene_values *v, struct scene_state *q, struct advance *step,
                          int contact, enum contact_regime regime)
{
    const bool touched = q->contact[contact].regime != (int32_t)REGIME_APART;
    transition_change_regime(v, q, contact, regime, &step->now);
    step->is_now = true;
    return touched != (q->contact[contact].regime != (int32_t)REGIME_APART);
}

/* Takes the event that ended a phase; returns whether contact begins or ends with it. */
static bool take_event(const struct scene_values *v, struct scene_state *q, struct advance *step)
{
    if (SCENE_ANY_FRICTION && step->event > ODE_EVENT_LAW && step->event != ODE_EVENT_ZONE) {
        transition_change_friction(v, q, step->contact, (enum ode_event)step->event, &step->now);
        step->is_now = true;
        return false;
    }
    return change_regime(v, q, step, step->contact, step->regime);
}

/* The end of the step after a contact has begun or ended: the caller may read the outputs and end the step
 * earlier. It is not asked at the start of the step, so that steps advance. */
static double end_after_event(const struct step_request *request, struct scene_state *q, double start,
                              double end_time)
{
    const double time = scene_time(q);
    if (request->at_event == NULL || !(time > start)) {
        return end_time;
    }
    q->step_length = time - start;
    return fmin(end_time, request->at_event(request->context, end_time));
}

/* More changes of regimes than this at one instant never end; so many take some hundredths of a second. */
enum { MOST_AT_ONCE = 10000 };

static enum integrator_status run_phases(struct integrator *s, const struct scene_values *v,
                                         struct scene_state *q, struct advance *step,
                                         const struct step_request *request)
{
    const double start = scene_time(q);
    double end_time = request->end_time;
    double latest = -(double)INFINITY; /* clock of the last event */
    int at_once = 0;
    for (;;) {
        bool begins_or_ends = false;
        const double remaining = scene_remaining(q, end_time);
        if (!(remaining > 0.0)) {
            return INTEGRATOR_DONE;
        }
        look_ahead(v, q, remaining, step);
        const int next = contact_changing_first(q);
        const double change = q->contact[next].schedule.change_clock;
        const double end = q->clock + remaining;
        step->clock_end = fmin(end, fmin(change, q->horizon_clock));
        step->event = ODE_EVENT_GAP;
        const enum advance_result result = advance_phase(s, v, q, step);
        step->is_now = false;
        switch (result) {
        case ADVANCE_REACHED:
            if (step->clock_end >= change) {
                begins_or_ends = change_regime(v, q, step, next,
                                               (enum contact_regime)q->contact[next].schedule.change_regime);
                break;
            }
            if (step->clock_end >= end) {
                return INTEGRATOR_DONE;
            }
            break;
        case ADVANCE_EVENT:
            begins_or_ends = take_event(v, q, step);
            break;
        case ADVANCE_STEP_LIMIT: /* a quadrature (prescribed.c) has a limit of its own */
            return advance_is_spent(step) ? INTEGRATOR_STEP_LIMIT : INTEGRATOR_STALLED;
        case ADVANCE_FAILED:
        default:
            return INTEGRATOR_FAILED;
        }
        if (begins_or_ends) {
            end_time = end_after_event(request, q, start, end_time);
        }
        at_once = scene_time(q) > latest ? 0 : at_once + 1;
        if (at_once == MOST_AT_ONCE) {
            return INTEGRATOR_STALLED;
        }
        latest = scene_time(q);
        /* An event counts as a step, so that the limit of steps ends any number of events. */
        advance_spend(step, 1, 1);
        if (advance_is_spent(step)) {
            return INTEGRATOR_STEP_LIMIT;
        }
    }
}

/* The limit of internal steps limits their work as well: each unit of work counts as a step in closed form.
 * The limit of work is at least this, the start value of the limit of steps, which takes about a second. */
static const long LEAST_WORK = 2000000;

enum integrator_status integrator_run(struct integrator *s, const struct scene_values *v,
                                      struct scene_state *q, const struct step_request *request)
{
    const double start = scene_time(q);
    struct advance step;
    step.budget = solver_max_internal_steps(v);
    step.work = step.budget > LEAST_WORK ? step.budget : LEAST_WORK;
    transition_begin_step(v, q, &step.now);
    step.is_now = true;
    if (solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN && !scene_turns(v)) {
        q->integrator_fresh = 1; /* CVODE's history is in no saved state: each step does without it */
    }
    const enum integrator_status status = run_phases(s, v, q, &step, request);
    q->step_length = scene_time(q) - start;
    transition_end_step(v, q);
    q->deferrable_clock =
        status == INTEGRATOR_DONE && !scene_is_force_element(v) ? flight_deferrable_until(v, q) : 0.0;
    return status;
}

bool integrator_defer_further(const struct scene_values *v, struct scene_state *q, double end_time)
{
    const double deferrable = q->deferrable_clock;
    q->deferrable_clock = 0.0; /* no further search until a step has been integrated */
    if (!(deferrable > 0.0 && deferrable == q->horizon_clock)) {
        return false;
    }
    flight_catch_up(v, q);
    const double before = q->clock;
    const double apart = flight_apart_until(v, q);
    /* As the step would go: to the horizon, from where it looks ahead, and to its end. */
    q->clock = deferrable;
    const double remaining = scene_remaining(q, end_time);
    const double further = remaining > 0.0 ? horizon_of_flight(q->clock, remaining) : 0.0;
    const double horizon = q->clock + further;
    if (remaining >= 0.0 && horizon < apart && q->clock + remaining <= horizon) {
        q->horizon_clock = horizon;
        if (flight_deferrable_until(v, q) == horizon) {
            q->deferrable_clock = horizon;
            q->clock += remaining;
            q->deferred = 1;
            return true;
        }
        q->horizon_clock = deferrable;
    }
    q->clock = before;
    return false;
}
