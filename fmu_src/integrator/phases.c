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

/* Returns the present instant without accelerations and forces. It is computed once and then reused. */
static const struct scene_instant *advance_now(struct advance *step, const struct scene_values *v,
                                               const struct scene_state *q)
{
    if (!step->is_now) {
        scene_kinematics_now(v, q, &step->now);
        step->is_now = true;
    }
    return &step->now;
}

/* Horizon of a separating contact, divided by the time in which its gap opens at the present gap rate. */
static const double SEPARATION_TIMES = 4.0;

/* The horizon is at most the longer of LONGEST_HORIZON [s] and HORIZON_GROWTH times the time since the phase
 * began. Over so long a time a path of degree four becomes so long that bodies measure 1e-72 of it; the
 * fourth power of this size is still above underflow. */
static const double LONGEST_HORIZON = 1e18;
static const double HORIZON_GROWTH = 1e3;

static double horizon_of_flight(double clock, double remaining)
{
    const double horizon = fmax(remaining, clock);
    return horizon > LONGEST_HORIZON ? fmin(horizon, fmax(LONGEST_HORIZON, HORIZON_GROWTH * clock)) : horizon;
}

/* Returns the horizon of the search for regime changes [s]. It is the longer of the rest of the step and the
 * time since the phase began, so that a flight of many short steps is searched a few times only. While a
 * contact separates, the horizon is not much longer than the separation lasts. The conditions are then nearly
 * linear, and their roots are cheap. */
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

/* Notes for every contact when its regime changes next; does nothing before the horizon is reached. */
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

/* Returns the contact whose predicted change comes first. */
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

/* Notes the peak penetration of separating contacts with a prescribed body. Such a contact may close further,
 * where the prescribed displacement does not agree with the prescribed velocity. */
static void note_depth_of_released(const struct scene_values *v, struct scene_state *q, struct advance *step)
{
    for (int j = 0; SCENE_ANY_PRESCRIBED && j < SCENE_CONTACTS; ++j) {
        const bool led =
            body_is_prescribed(v, contact_source(j)) || body_is_prescribed(v, contact_destination(j));
        /* regime_change_note_depth needs an axis that keeps its direction */
        if (led && q->contact[j].regime == REGIME_SEPARATING && !contact_axis_turns(v, j)) {
            regime_change_note_depth(v, q, advance_now(step, v, q), j, step->clock_end);
        }
    }
}

/* Returns the error allowed in a segment [m]. It is a thousandth of the tolerances, because impacts amplify
 * errors. Near the centre it is reduced in proportion to the distance d, because an error e perpendicular to
 * the normal n turns n by the angle e / d. It is never below rounding. */
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

/* Whether segments can be made for the contact pairs: nothing turns or rubs, and no free body takes part in
 * two contacts that transmit forces. */
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

/* In a synchronized step all contact pairs advance by the same time. The step ends at the first terminal
 * event, the first end of a segment, or the first passage of a centre. */
struct synchronized_step {
    struct segment segment[SCENE_CONTACTS];
    double longest, time; /* limit and length of the step [s] */
    int terminal;         /* the contact with a terminal event at the step's end; -1: none */
    enum contact_regime next;
    bool changes; /* whether the regime or the zone of that contact changes at the end */
};

static bool has_segment(const struct scene_values *v, const struct scene_state *q, int contact)
{
    return contact_transmits(q, contact) && !contact_is_prescribed(v, contact);
}

/* A segment that lasts at least this part of the time asked for ends there within rounding. Such a segment
 * does not shorten the segments of the other pairs. */
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

/* Makes the segments of all pairs. Where one pair shortens the step, the segments made before are made again,
 * because a segment is most accurate at its own end. */
static bool synchronized_step_make(struct synchronized_step *all, const struct scene_values *v,
                                   const struct scene_state *q, const struct scene_instant *at,
                                   double longest)
{
    all->longest = all->time = longest;
    all->terminal = -1;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        all->segment[j].kind = SEGMENT_CLOSED_FORM; /* pairs without a segment need values, too */
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

/* Integrates the prescribed contacts to the clock `end`; returns the clock reached. The penetration is found
 * separately, because the quadrature of a force that is zero does not show it. */
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

/* Integrates the prescribed contacts over the synchronized step; false where the budget ends it early. */
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

/* Adds the external work on bodies on which no contact force acts. */
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

/* Moves the scene to the end of the step. A step of zero length moves nothing, because a segment starts at
 * the present state to its tolerance only, not exactly. */
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

/* Returns the energy stored by separating contacts [J]. Their force is zero, so that this energy is
 * dissipated as the gap opens. */
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

/* Advances the contact pairs segment by segment (touch/segment.h), together with the prescribed contacts. */
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
/* Returns the clock up to which an internal step of the general segment may reach [s]. No step crosses a
 * regime change that the closed forms foresee, nor the horizon up to which they have looked for one. A step
 * may reach beyond the end of the communication step, but only in proportion to the time since the phase
 * began. An input that changes at every communication point begins a new phase there, and the part of a step
 * beyond that point would be wasted. */
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

/* The phases of motion stand in order of preference. A phase that applies may give up where the motion is too
 * hard for it (ADVANCE_FAILED). The next phase that applies then goes on from there. */
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

/* Puts a contact into its next regime; returns whether the contact begins or ends by this change. */
static bool change_regime(const struct scene_values *v, struct scene_state *q, struct advance *step,
                          int contact, enum contact_regime regime)
{
    const bool touched = q->contact[contact].regime != (int32_t)REGIME_APART;
    transition_change_regime(v, q, contact, regime, &step->now);
    step->is_now = true;
    return touched != (q->contact[contact].regime != (int32_t)REGIME_APART);
}

/* Changes the regime by the event that ended a phase; returns whether a contact begins or ends by it. */
static bool take_event(const struct scene_values *v, struct scene_state *q, struct advance *step)
{
    if (SCENE_ANY_FRICTION && step->event > ODE_EVENT_LAW && step->event != ODE_EVENT_ZONE) {
        transition_change_friction(v, q, step->contact, (enum ode_event)step->event, &step->now);
        step->is_now = true;
        return false;
    }
    return change_regime(v, q, step, step->contact, step->regime);
}

/* Returns the end of the step [s] after a contact has begun or ended. The caller's at_event may read the
 * outputs and end the step earlier. It is not called at the start, so that every step advances. */
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

/* If more changes of regimes than this happen at one instant, they are taken to be endless. So many changes
 * take some hundredths of a second to compute. */
enum { MOST_AT_ONCE = 10000 };

static enum integrator_status run_phases(struct integrator *s, const struct scene_values *v,
                                         struct scene_state *q, struct advance *step,
                                         const struct step_request *request)
{
    const double start = scene_time(q);
    double end_time = request->end_time;
    double latest = -(double)INFINITY; /* time of the last event [s] */
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
        case ADVANCE_STEP_LIMIT: /* a quadrature (prescribed.c) may end by a limit of its own */
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
    /* An integrated step would go to the horizon, look ahead from there, and go on to its end. */
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
