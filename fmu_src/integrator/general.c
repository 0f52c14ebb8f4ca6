#include "integrator/general.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

#include "integrator/general_memory.h"
#include "scene/projection.h"
#include "segment/flight.h"

/* What a step may take of the tolerances: as much as the other segments (integrator/event_driven.c), because
 * impacts multiply errors; not less than what rounding leaves of a step and its events. */
static const double TOLERANCE_SHARE = 1e-3;
static const double LEAST_TOLERANCE = 1024.0 * DBL_EPSILON;

static void rates_at_stage(const void *context, double clock, const double *y, double *rates)
{
    ode_rates(context, clock, y, rates);
}

static void jacobian_of(const void *context, double clock, const double *y, double *columns)
{
    ode_coupled_jacobian(context, clock, y, columns);
}

static void whole_jacobian_of(const void *context, double clock, const double *y, double *columns)
{
    ode_jacobian(context, clock, y, columns);
}

static struct radau_problem problem_of(struct general *g, const struct scene_values *v)
{
    struct radau_problem problem = {.context = &g->ode,
                                    .size = ode_size(v),
                                    .coupled = ode_coupled(v),
                                    .integrals = ode_integrals(v),
                                    .turns = scene_turns(v),
                                    .place = g->place,
                                    .speed = g->speed,
                                    .rates = rates_at_stage,
                                    .jacobian = jacobian_of,
                                    .whole_jacobian = whole_jacobian_of};
    for (int i = 0; i < SCENE_BODIES; ++i) {
        for (int k = 0; k < 3 && body_is_free(v, i); ++k) {
            g->place[problem.paired] = ode_body(v, i) + k;
            g->speed[problem.paired] = ode_body(v, i) + 3 + k;
            problem.paired += 1;
        }
    }
    return problem;
}

static bool same_layout(const struct radau_problem *a, const struct radau_problem *b)
{
    return a->size == b->size && a->coupled == b->coupled && a->integrals == b->integrals &&
           a->paired == b->paired && a->turns == b->turns;
}

bool general_open(struct general **slot, const struct scene_values *v, const struct integrator_memory *memory,
                  char *message)
{
    struct general trial;
    const struct radau_problem wanted = problem_of(&trial, v);
    const int size = wanted.size;
    if (*slot == NULL || !same_layout(&(*slot)->step.problem, &wanted)) {
        const size_t own = (sizeof(struct general) + 15) / 16 * 16;
        const size_t rows = 3 * (size_t)size * sizeof(double);
        struct general *g = memory->allocate(1, own + rows + radau_step_memory(&wanted));
        if (g == NULL) {
            snprintf(message, INTEGRATOR_MESSAGE_SIZE, "the integrator's memory could not be had");
            return false;
        }
        general_close(slot);
        *slot = g;
        g->size = size;
        g->release = memory->release;
        g->y = (double *)(void *)((char *)g + own);
        g->size_of = g->y + size;
        g->end_size = g->size_of + size;
    }
    const struct radau_problem problem = problem_of(*slot, v);
    radau_step_place(&(*slot)->step, &problem, (*slot)->end_size + size);
    (*slot)->message = message;
    return true;
}

void general_close(struct general **slot)
{
    if (*slot) {
        (*slot)->release(*slot);
        *slot = NULL;
    }
}

/* The motion at a clock within the last step; a scene_output's `move`. */
static void move_along_step(void *memory, double clock, struct scene_state *q)
{
    struct general *g = memory;
    const struct radau_step *p = &g->step;
    radau_step_at(p, fmin((clock - p->start) / p->length, 1.0), g->y);
    ode_unpack(g->ode.values, q, g->y);
}

/* Starts from the motion. */
static void start_general(struct general *g, const struct scene_values *v, struct scene_state *q)
{
    struct scene_instant at;
    g->ode.values = v;
    g->ode.state = g->state = q;
    g->fully = false;
    g->solvable = g->simple = (double)INFINITY;
    g->step.known_length = 0.0;
    ode_leave_centres(v, q);
    scene_now(v, q, &at);
    g->relative = fmax(TOLERANCE_SHARE * solver_relative_tolerance(v), LEAST_TOLERANCE);
    g->absolute = TOLERANCE_SHARE * solver_absolute_tolerance(v);
    ode_begin(&g->ode, &at, g->relative, g->absolute);
    ode_pack(&g->ode, g->y);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        g->output[j] = (struct scene_output){.contact = j, .move = move_along_step, .mover = g};
    }
    g->step.evaluations = 0;
    g->rejected = 0;
    g->longest = q->general_length; /* of the state, so that a restored one goes on as the saved one */
    general_begin(g, q->clock, g->y);
#if SCENE_ANY_HERTZ
    g->longest = fmin(g->longest, general_length_of_impacts(v, q, &at));
#endif
}

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

/* A step of twelve stages is five radians of an oscillation at most: parts of less than half a turn. */
static void note_peaks_of_step(struct general *g, struct scene_state *q, double to)
{
    const int parts = g->step.stages->stages / 3;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime != REGIME_APART && to > q->clock) {
            struct scene_output *output = &g->output[j];
            output->values = g->ode.values;
            output->state = q;
            scene_output_note_peaks(output, q->clock, to, parts, &q->contact[j].peaks);
            scene_output_add_torque(output, q->clock, to, parts, q);
        }
    }
}

/* The scene at the end of a step. */
static void move_scene(struct general *g, struct scene_state *q, double clock, const double *y)
{
    ode_unpack(g->ode.values, q, y);
    q->clock = clock;
    flight_restore(g->ode.values, q);
}

/* Where no step can be made to end at an event, one of half the way to it comes first, and so on until the
 * event is within the rounding of the clock. */
enum advance_result general_advance(struct general *g, const struct scene_values *v, struct scene_state *q,
                                    struct advance *step)
{
    enum advance_result result = ADVANCE_REACHED;
    double *y = g->size_of; /* free between steps */
    double longest = (double)INFINITY;
    start_general(g, v, q);
    if ((SCENE_CONTACTS > 1 || scene_turns(v)) && has_passed_event(g, v, q, step)) {
        return ADVANCE_EVENT;
    }
    while (result == ADVANCE_REACHED && q->clock < step->clock_end) {
        const double left = step->clock_end - q->clock;
        if (!general_step_make(g, fmin(left, longest), &step->budget)) {
            result = step->budget > 0 ? ADVANCE_FAILED : ADVANCE_STEP_LIMIT;
            break;
        }
        struct general_event found = general_first_event(g);
        const struct general_event first = found;
        const double until = found.part * g->step.length;
        double clock = g->step.length < left ? q->clock + g->step.length : step->clock_end;
        longest = (double)INFINITY;
        if (found.event < 0) {
            radau_step_at(&g->step, 1.0, y);
        } else if (!general_end_at(g, &found, &clock, y)) {
            ode_pack(&g->ode, y);
            general_begin(g, q->clock, y);
            if (q->clock + 0.5 * until > q->clock) {
                longest = 0.5 * until;
                step->budget += 1; /* the way is halved fifty times at most */
                continue;
            }
            found = first;
            clock = q->clock;
        }
        note_peaks_of_step(g, q, clock);
        move_scene(g, q, clock, y);
        counter_add(&q->counters.steps, 1);
        if (found.event >= 0) {
            step->contact = found.event / ODE_EVENTS_EACH;
            step->event = found.event % ODE_EVENTS_EACH;
            step->regime = step->event > ODE_EVENT_LAW ? (enum contact_regime)q->contact[step->contact].regime
                                                       : ode_regime_after(v, q, step->contact, step->event);
            tidy_end(g, v, q, step);
            result = ADVANCE_EVENT;
        } else if (q->clock < step->clock_end) {
            general_begin(g, q->clock, y);
        }
    }
    q->general_length = isfinite(g->longest) ? g->longest : 0.0;
    counter_add(&q->counters.force_evaluations, g->step.evaluations);
    counter_add(&q->counters.rejected_steps, g->rejected);
    return result;
}
