#include "solver/solver.h"

#if SCENE_ANY_FREE

#include <float.h>
#include <stdio.h>

#include "dynamics/encounter.h"
#include "dynamics/flight.h"
#include "dynamics/resolution.h"
#include "solver/cvode.h"
#include "solver/event_driven.h"
#include "solver/sampled.h"

/* event_driven leaves only bodies in several contacts to CVODE. */
static bool uses_cvode(const struct scene_values *v)
{
    return solver_method(v) != SOLVER_METHOD_EVENT_DRIVEN || system_shares_free_body(v);
}

bool solver_open(struct solver *s, const struct scene_values *v, const struct solver_memory *memory)
{
    s->message[0] = '\0';
    return system_is_force_element(v) || !uses_cvode(v) || cvode_open(&s->cvode, v, memory, s->message);
}

void solver_close(struct solver *s)
{
    cvode_close(&s->cvode);
}

const struct system_instant *advance_now(struct advance *step, const struct scene_values *v,
                                         const struct motion *q)
{
    if (!step->is_now) {
        system_place(v, q, &step->now);
        step->is_now = true;
    }
    return &step->now;
}

/* Multiple of the time in which a released contact opens at its present rate: it is over by then, unless something pulls. */
static const double RELEASE_TIMES = 4.0;

/* To the end of the step, and as far again as the phase has already lasted: a flight of many communication steps is searched
 * a few times, a short one not far beyond its end. At first not further than a released contact lasts: over so short a time its
 * conditions are almost linear, and their roots cheap. */
static double horizon_from(const struct scene_values *v, const struct motion *q,
                           const struct system_instant *at, double remaining)
{
    double horizon = fmax(remaining, q->clock);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime == REGIME_RELEASED) {
            const struct contact_geometry *now = &at->geometry[j];
            const double opens = (resolution_of_gap(v, at, j) - now->gap) / now->gap_rate;
            horizon = opens > 0.0 ? fmin(horizon, fmax(RELEASE_TIMES * opens, q->clock)) : horizon;
        }
    }
    return horizon;
}

/* Says of every contact when its regime changes next. */
static void look_ahead(const struct scene_values *v, struct motion *q, double remaining, struct advance *step)
{
    if (q->horizon_clock > q->clock) {
        return;
    }
    const struct system_instant *at = advance_now(step, v, q);
    const double horizon = horizon_from(v, q, at, remaining);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct encounter next = encounter_next(v, q, at, q->clock, j, horizon);
        q->contact[j].change_clock = q->clock + next.after;
        q->contact[j].change_regime = (int32_t)next.regime;
        q->contact[j].change_gap = next.gap;
        q->contact[j].passes_centre = next.passes_centre;
    }
    q->horizon_clock = q->clock + horizon;
}

/* The contact whose closed-form change comes first. */
static int contact_changing_first(const struct motion *q)
{
    int first = 0;
    for (int j = 1; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].change_clock < q->contact[first].change_clock) {
            first = j;
        }
    }
    return first;
}

/* A released contact opens, unless a prescribed displacement goes another way than its velocity says. */
static void note_depth_of_released(const struct scene_values *v, struct motion *q, struct advance *step)
{
    for (int j = 0; SCENE_ANY_PRESCRIBED && j < SCENE_CONTACTS; ++j) {
        const bool led =
            body_is_prescribed(v, contact_source(j)) || body_is_prescribed(v, contact_destination(j));
        if (led && q->contact[j].regime == REGIME_RELEASED) {
            const struct system_instant *at = advance_now(step, v, q);
            const double gap = encounter_least_gap(v, q, at, q->clock, j, step->clock_end);
            q->contact[j].peak_penetration = fmax(q->contact[j].peak_penetration, -gap);
        }
    }
}

static enum advance_result advance_phase(struct solver *s, const struct scene_values *v, struct motion *q,
                                         struct advance *step)
{
    if (!(step->clock_end > q->clock)) {
        return ADVANCE_REACHED;
    }
    if (system_is_force_element(v)) {
        return sampled_advance(v, q, step);
    }
    if (flight_is_free(q)) {
        note_depth_of_released(v, q, step);
        flight_advance(v, q, step->clock_end);
        return ADVANCE_REACHED;
    }
    if (solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN) {
        const enum advance_result result = event_driven_advance(v, q, step);
        if (result != ADVANCE_FAILED) {
            return result;
        }
        if (!uses_cvode(v)) {
            snprintf(s->message, sizeof s->message, "no segment of the motion can be made from here");
            return ADVANCE_FAILED;
        }
        counter_add(&q->counters.fallbacks, 1);
        q->integrator_fresh = 1;
    }
    return cvode_advance(s->cvode, v, q, step);
}

static enum solver_status run_phases(struct solver *s, const struct scene_values *v, struct motion *q,
                                     struct advance *step, double end_time)
{
    for (;;) {
        const double remaining = motion_remaining(q, end_time);
        if (!(remaining > 0.0)) {
            return SOLVER_DONE;
        }
        look_ahead(v, q, remaining, step);
        const int next = contact_changing_first(q);
        const double change = q->contact[next].change_clock;
        const double end = q->clock + remaining;
        step->clock_end = fmin(end, fmin(change, q->horizon_clock));
        const enum advance_result result = advance_phase(s, v, q, step);
        step->is_now = false;
        switch (result) {
        case ADVANCE_REACHED:
            if (step->clock_end >= change) {
                event_change_regime(v, q, next, (enum contact_regime)q->contact[next].change_regime,
                                    &step->now);
                step->is_now = true;
                break;
            }
            if (step->clock_end >= end) {
                return SOLVER_DONE;
            }
            break;
        case ADVANCE_EVENT:
            event_change_regime(v, q, step->contact, step->regime, &step->now);
            step->is_now = true;
            break;
        case ADVANCE_STEP_LIMIT:
            return SOLVER_STEP_LIMIT;
        case ADVANCE_FAILED:
        default:
            return SOLVER_FAILED;
        }
        /* An event costs a step of the budget, so that a storm of events ends too. */
        if (--step->budget <= 0) {
            return SOLVER_STEP_LIMIT;
        }
    }
}

enum solver_status solver_run(struct solver *s, const struct scene_values *v, struct motion *q,
                              double end_time)
{
    const double start = motion_time(q);
    struct advance step;
    step.budget = solver_max_internal_steps(v);
    event_begin_window(v, q, &step.now);
    step.is_now = true;
    const enum solver_status status = run_phases(s, v, q, &step, end_time);
    q->window = motion_time(q) - start;
    event_end_window(v, q);
    q->quiet_clock = status == SOLVER_DONE && !system_is_force_element(v) ? flight_quiet_until(v, q) : 0.0;
    return status;
}

#endif
