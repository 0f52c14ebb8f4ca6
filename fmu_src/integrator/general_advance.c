/* The general segment from one clock to another: step by step, up to an event or within a step. */
#include <float.h>
#include <math.h>

#include "integrator/general_memory.h"
#include "math/compiler.h"
#include "scene/projection.h"

/* Whether a contact ends as the gap opens, not as the source passes an end of its cylinder. */
static bool parts_at_gap(const struct general *g, const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
    const double beyond = scene_beyond_ends(&shape, &at->geometry[contact]);
    const double gap = fabs(at->geometry[contact].gap);
    return gap <= 4.0 * g->ode.gap_offset[contact] || (scene_turns(v) && gap <= fabs(beyond));
}

/* Moves free bodies as far as the gap is from zero, along their velocities: a shift along the normal
 * would change the angular momentum by as much at every impact. Only over what is rounding of the clock, or
 * of a second where a phase has just begun. */
static void go_back_to_gap(const struct scene_values *v, struct scene_state *q,
                           const struct scene_instant *at, int contact)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const double since = g->gap / g->gap_rate;
    if (!(g->gap_rate > 0.0) || !(fabs(since) <= 64.0 * DBL_EPSILON * fmax(fabs(q->clock), 1.0))) {
        return;
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            q->body[i].moved = vec3_axpy(q->body[i].moved, -since, q->body[i].velocity);
        }
    }
}

/* The error allowed in a step is that of a speed, too. */
static void tidy_end(struct general *g, const struct scene_values *v, struct scene_state *q,
                     const struct advance *step)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    if (step->regime == REGIME_APART && parts_at_gap(g, v, q, &at, step->contact)) {
        const double speed = vec3_norm(at.rate[step->contact]);
        if (scene_turns(v)) {
            go_back_to_gap(v, q, &at, step->contact);
        }
        projection_close_gap(v, q, step->contact);
        projection_restore_energy(v, q, step->contact, g->relative * speed + g->absolute);
    }
    q->contact[step->contact].schedule.settled_clock = q->clock * (1.0 + 16.0 * DBL_EPSILON);
}

/* Contacts that end, or begin, at almost the same time: when the first has ended the phase, the second may
 * already be past its root by more than the offset. So may the end of a contact whose friction has just
 * changed. */
static bool has_passed_event(struct general *g, const struct scene_values *v, struct scene_state *q,
                             struct advance *step)
{
    double events[ODE_EVENTS];
    struct scene_instant at;
    scene_now(v, q, &at);
    ode_events(&g->ode, q->clock, g->step.y, events);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const bool leaves = (q->contact[j].regime == REGIME_APART) == (at.geometry[j].gap_rate < 0.0);
        if (events[ODE_EVENTS_EACH * j] < 0.0 && leaves) {
            step->contact = j;
            step->event = ODE_EVENT_GAP;
            step->regime = ode_regime_after(v, q, j, 0);
            return true;
        }
    }
    return false;
}

/* A step up to its end or its first event. Where no step can be made to end at an event, one of half the way
 * to it comes first, and so on until the event is within the rounding of the clock. */
static enum advance_result make_step(struct general *g, const struct scene_state *q, struct advance *step)
{
    struct general_end *end = &g->end;
    const double left = step->clock_end - q->clock;
    /* what does not turn stops at the end, as no state keeps its steps; so does what rounding decides */
    const double most =
        g->step.problem.turns && g->read_share <= 1.0 ? fmax(step->clock_limit - q->clock, left) : left;
    double longest = (double)INFINITY;
#if SCENE_ANY_FRICTION
    if (g->step.problem.turns) {
        g->longest = fmin(g->longest, general_length_of_sliding(g->ode.values, q));
    }
#endif
    for (;;) {
        if (!general_step_make(g, fmin(most, longest), left, &step->budget)) {
            return step->budget > 0 ? ADVANCE_FAILED : ADVANCE_STEP_LIMIT;
        }
        const struct general_event first = general_first_event(g);
        const double until = first.part * g->step.length;
        end->event = first;
        end->clock = g->step.length == left ? step->clock_end : q->clock + g->step.length;
        if (first.event < 0) {
            radau_step_at(&g->step, 1.0, end->y);
            return ADVANCE_REACHED;
        }
        if (general_end_at(g, &end->event, &end->clock, end->y)) {
            return ADVANCE_REACHED;
        }
        ode_pack(&g->ode, end->y);
        general_begin(g, q->clock, end->y);
        if (!(q->clock + 0.5 * until > q->clock)) {
            end->event = first;
            end->clock = q->clock;
            return ADVANCE_REACHED;
        }
        longest = 0.5 * until;
        step->budget += 1; /* the way is halved fifty times at most */
    }
}

/* To the end of the step, and what ends it. */
static enum advance_result end_step(struct general *g, const struct scene_values *v, struct scene_state *q,
                                    struct advance *step)
{
    const struct general_end *end = &g->end;
    general_move_scene(g, q, end->clock, end->y);
    if (end->event.event >= 0) {
        step->contact = end->event.event / ODE_EVENTS_EACH;
        step->event = end->event.event % ODE_EVENTS_EACH;
        step->regime = step->event > ODE_EVENT_LAW ? (enum contact_regime)q->contact[step->contact].regime
                                                   : ode_regime_after(v, q, step->contact, step->event);
        tidy_end(g, v, q, step);
        return ADVANCE_EVENT;
    }
    if (q->clock < step->clock_end) {
        general_begin(g, q->clock, end->y);
    }
    return ADVANCE_REACHED;
}

/* The step that the last call has left unfinished, up to its end. */
static enum advance_result finish_step(struct general *g, const struct scene_values *v, struct scene_state *q,
                                       struct advance *step)
{
    struct scene_instant at;
    general_set_events(g, &at);
    return end_step(g, v, q, step);
}

static enum advance_result make_steps(struct general *g, const struct scene_values *v, struct scene_state *q,
                                      struct advance *step)
{
    enum advance_result result = ADVANCE_REACHED;
    while (result == ADVANCE_REACHED && q->clock < step->clock_end) {
        result = make_step(g, q, step);
        if (result != ADVANCE_REACHED) {
            return result;
        }
        counter_add(&q->counters.steps, 1);
        general_set_peaks(g);
        if (g->end.clock > step->clock_end) {
            general_keep_step(g, q);
            general_follow(g, q, step->clock_end);
            return ADVANCE_REACHED;
        }
        result = end_step(g, v, q, step);
    }
    if (result == ADVANCE_REACHED && g->step.problem.turns) {
        general_keep_step(g, q); /* the next one goes on from its polynomial */
    }
    return result;
}

/* Not inline: what does not turn or rub passes by its caller, and is faster where that stays small. */
CONTACT_NOINLINE enum advance_result general_advance(struct general *g, const struct scene_values *v,
                                                     struct scene_state *q, struct advance *step)
{
    enum advance_result result = ADVANCE_REACHED;
    g->step.evaluations = 0;
    g->rejected = 0;
    if (general_take_up(g, v, q)) {
        if (g->end.clock > step->clock_end) {
            general_follow(g, q, step->clock_end);
            return ADVANCE_REACHED;
        }
        result = finish_step(g, v, q, step);
    } else {
        general_start(g, v, q);
        if ((SCENE_CONTACTS > 1 || scene_turns(v)) && has_passed_event(g, v, q, step)) {
            result = ADVANCE_EVENT;
        }
    }
    q->integrator_fresh = 1;
    if (result == ADVANCE_REACHED) {
        result = make_steps(g, v, q, step);
    }
    q->general_length = isfinite(g->longest) ? g->longest : 0.0;
    counter_add(&q->counters.force_evaluations, g->step.evaluations);
    counter_add(&q->counters.rejected_steps, g->rejected);
    return result;
}
