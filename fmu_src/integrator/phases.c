#include "integrator/phases.h"

#include <float.h>
#include <stdio.h>

#include "flight/flight.h"
#include "integrator/cvode.h"
#include "integrator/general.h"
#include "integrator/prediction.h"
#include "scene/evaluate.h"
#include "scene/present.h"

bool integrator_open(struct integrator *s, const struct scene_values *v,
                     const struct integrator_memory *memory)
{
    s->message[0] = '\0';
    if (!scene_uses_ode(v) || (scene_is_force_element(v) && !scene_turns(v))) {
        return true;
    }
    return solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN ? general_open(&s->general, v, memory, s->message)
                                                          : cvode_open(&s->cvode, v, memory, s->message);
}

void integrator_close(struct integrator *s)
{
    cvode_close(&s->cvode);
    general_close(&s->general);
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
        struct regime_change next;
        if (scene_turns(v)) {
            const struct outlook outlook = outlook_of(v, q, at, j, horizon, step->budget);
            next = outlook.next;
            horizon = outlook.searched;
            step->budget -= outlook.evaluations;
        } else {
            next = next_regime_change(v, q, at, q->clock, j, horizon);
        }
        q->contact[j].schedule.change_clock = q->clock + next.after;
        q->contact[j].schedule.change_regime = (int32_t)next.regime;
        q->contact[j].schedule.change_gap = next.gap;
        q->contact[j].schedule.passes_centre = next.passes_centre;
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

/* Whether the axis of the destination may turn. The paths of regime_change_note_depth have a fixed one. */
static bool tilts(const struct scene_values *v, int contact)
{
    const int destination = contact_destination(contact);
    return scene_turns(v) && body_turns(v, destination) && body_shape(destination) != SHAPE_SPHERE;
}

/* A separating contact opens, unless a prescribed displacement goes another way than its velocity says. */
static void note_depth_of_released(const struct scene_values *v, struct scene_state *q, struct advance *step)
{
    for (int j = 0; SCENE_ANY_PRESCRIBED && j < SCENE_CONTACTS; ++j) {
        const bool led =
            body_is_prescribed(v, contact_source(j)) || body_is_prescribed(v, contact_destination(j));
        if (led && q->contact[j].regime == REGIME_SEPARATING && !tilts(v, j)) {
            regime_change_note_depth(v, q, advance_now(step, v, q), j, step->clock_end);
        }
    }
}

/* Up to which clock a step need not end for what is foreseen: the next change of a regime, and the horizon
 * unless nothing is foreseen. Steps go on beyond the end of a communication step only where the phase has
 * lasted before, so that inputs which change with each of them cost no steps in vain. */
static double unforeseen_until(const struct scene_values *v, const struct scene_state *q)
{
    double until = q->clock + HORIZON_GROWTH * q->clock;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        until = fmin(until, q->contact[j].schedule.change_clock);
        until = contact_is_foreseen(v, q, j) ? fmin(until, q->horizon_clock) : until;
    }
    return until;
}

static enum advance_result advance_phase(struct integrator *s, const struct scene_values *v,
                                         struct scene_state *q, struct advance *step)
{
    if (!(step->clock_end > q->clock)) {
        return ADVANCE_REACHED;
    }
    if (scene_is_force_element(v) && !scene_turns(v)) {
        return prescribed_advance(v, q, step);
    }
    if (flight_is_free(q)) {
        note_depth_of_released(v, q, step);
        flight_advance(v, q, step->clock_end);
        return ADVANCE_REACHED;
    }
    if (solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN) {
        const enum advance_result result = scene_turns(v) ? ADVANCE_FAILED : event_driven_advance(v, q, step);
        if (result != ADVANCE_FAILED) {
            return result;
        }
        if (!scene_uses_ode(v)) {
            snprintf(s->message, sizeof s->message, "no segment of the motion can be made from here");
            return ADVANCE_FAILED;
        }
        counter_add(&q->counters.fallbacks, 1);
        step->clock_limit = fmax(step->clock_end, unforeseen_until(v, q));
        return general_advance(s->general, v, q, step);
    }
    return cvode_advance(s->cvode, v, q, step);
}

/* Puts a contact into its next regime; whether it begins or ends with that. */
static bool change_regime(const struct scene_values *v, struct scene_state *q, struct advance *step,
                          int contact, enum contact_regime regime)
{
    const bool touched = q->contact[contact].regime != (int32_t)REGIME_APART;
    transition_change_regime(v, q, contact, regime, &step->now);
    step->is_now = true;
    return touched != (q->contact[contact].regime != (int32_t)REGIME_APART);
}

/* The event that ended a phase; whether contact begins or ends with it. */
static bool take_event(const struct scene_values *v, struct scene_state *q, struct advance *step)
{
    if (SCENE_ANY_FRICTION && step->event > ODE_EVENT_LAW && step->event != ODE_EVENT_ZONE) {
        transition_change_friction(v, q, step->contact, (enum ode_event)step->event, &step->now);
        step->is_now = true;
        return false;
    }
    return change_regime(v, q, step, step->contact, step->regime);
}

/* When the step shall end, now that a contact has begun or ended: who asked for the step may look at the
 * outputs, and may want it to end earlier. Not asked where the step began, so that steps get on. */
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

/* Changes of regimes at one instant, beyond which they have no end: some hundredths of a second. */
enum { MOST_AT_ONCE = 10000 };

static enum integrator_status run_phases(struct integrator *s, const struct scene_values *v,
                                         struct scene_state *q, struct advance *step,
                                         const struct step_request *request)
{
    const double start = scene_time(q);
    double end_time = request->end_time;
    double latest = -(double)INFINITY; /* event */
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
            return step->budget > 0 ? INTEGRATOR_STALLED : INTEGRATOR_STEP_LIMIT;
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
        if (--step->budget <= 0) {
            return INTEGRATOR_STEP_LIMIT;
        }
    }
}

/* A step of the general segment takes some hundred evaluations of forces, each of which takes as long as some
 * steps in closed form. There may be as many evaluations as steps, so that the limit of steps bounds the
 * time of both; but no fewer than this, some ten seconds of them: a thousand impacts of bodies that turn take
 * half as many, and a small limit is to count steps alone. */
static const long LEAST_EVALUATIONS = 3000000;

enum integrator_status integrator_run(struct integrator *s, const struct scene_values *v,
                                      struct scene_state *q, const struct step_request *request)
{
    const double start = scene_time(q);
    struct advance step;
    step.budget = solver_max_internal_steps(v);
    step.evaluations = step.budget > LEAST_EVALUATIONS ? step.budget : LEAST_EVALUATIONS;
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
    q->deferrable_clock = 0.0; /* who asks again before a step has gone the long way is told so at once */
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
