#include "integrator/general.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

#include "integrator/general_memory.h"

/* What a step may take of the tolerances: as much as the other segments (integrator/event_driven.c), because
 * impacts multiply errors; not less than what rounding leaves of a step and its events. */
static const double TOLERANCE_SHARE = 1e-3;
static const double LEAST_TOLERANCE = 1024.0 * DBL_EPSILON;

/* Where outputs are read within a step the error there is this part of the tolerance at most. */
static const double READ_PART = 0.1;

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

static void split_jacobian_of(const void *context, double clock, const double *y, double *columns,
                              double *by_forces, double *of_forces)
{
    ode_split_jacobian(context, clock, y, columns, by_forces, of_forces);
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
                                    .whole_jacobian = whole_jacobian_of,
                                    .forces = ode_forces(v),
                                    .tipping = ode_tipping(v),
                                    .split_jacobian = split_jacobian_of};
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
           a->paired == b->paired && a->turns == b->turns && a->forces == b->forces &&
           a->tipping == b->tipping;
}

bool general_open(struct general **slot, const struct scene_values *v, const struct integrator_memory *memory,
                  char *message)
{
    struct general trial;
    const struct radau_problem wanted = problem_of(&trial, v);
    const int size = wanted.size;
    if (*slot == NULL || !same_layout(&(*slot)->step.problem, &wanted)) {
        const size_t own = (sizeof(struct general) + 15) / 16 * 16;
        const size_t rows = 4 * (size_t)size * sizeof(double);
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
        g->end.y = g->end_size + size;
    }
    const struct radau_problem problem = problem_of(*slot, v);
    radau_step_place(&(*slot)->step, &problem, (*slot)->end.y + size);
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

void general_attach(struct general *g, const struct scene_values *v, struct scene_state *q)
{
    g->ode.values = v;
    g->ode.state = g->state = q;
    g->relative = fmax(TOLERANCE_SHARE * solver_relative_tolerance(v), LEAST_TOLERANCE);
    g->absolute = TOLERANCE_SHARE * solver_absolute_tolerance(v);
    g->read_share = g->relative / (READ_PART * solver_relative_tolerance(v));
    g->longest = q->general_length; /* of the state, so that a restored one goes on as the saved one */
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        g->output[j] =
            (struct scene_output){.contact = j, .move = move_along_step, .mover = g, .output.latest_s = -1.0};
    }
}

void general_set_events(struct general *g, struct scene_instant *at)
{
    ode_leave_centres(g->ode.values, g->state);
    scene_now(g->ode.values, g->state, at);
    ode_begin(&g->ode, at, g->relative, g->absolute);
}

void general_start(struct general *g, const struct scene_values *v, struct scene_state *q)
{
    struct scene_instant at;
    general_attach(g, v, q);
    g->solvable = g->simple = (double)INFINITY;
    g->step.known_length = 0.0;
    general_set_events(g, &at);
    ode_pack(&g->ode, g->y);
    general_begin(g, q->clock, g->y);
#if SCENE_ANY_HERTZ
    g->longest = fmin(g->longest, general_length_of_impacts(v, q, &at));
#endif
}
