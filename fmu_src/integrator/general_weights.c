/* Errors that a step of the general segment is allowed. */
#include <string.h>

#include "integrator/general_memory.h"

/* Of places by their own accelerations, the largest [1/s^2]. */
static double spring_of_places(const struct radau_step *p)
{
    double most = 0.0;
    for (int i = 0; i < p->problem.paired; ++i) {
        most = fmax(most, fabs(p->by_places[i * p->others + p->speed_among[i]]));
    }
    return most;
}

/* Rounding of places makes forces, which act for a radian of the oscillation at most, or until what they
 * change has died away: speeds and what else the forces change are no better. */
static void allow_rounding(struct general *g)
{
    struct radau_step *p = &g->step;
    const double spring = spring_of_places(p);
    const double fastest = fmax(sqrt(spring), 1.0 / p->length);
    double of_places[ODE_MOST_STATES] = {0.0}; /* of those left, by their places [1/s] */
    for (int i = 0; i < p->others; ++i) {
        double sum = 0.0;
        for (int j = 0; j < p->problem.paired; ++j) {
            sum += fabs(p->by_places[j * p->others + i]);
        }
        of_places[i] = sum / fmax(fastest, fabs(p->by_others[i * p->others + i]));
    }
    for (int j = 0; j < p->problem.paired; ++j) {
        of_places[p->speed_among[j]] = spring / fastest;
    }
    for (int i = 0; i < p->others; ++i) {
        double *weight = p->weight + p->other[i];
        *weight = 1.0 / (1.0 / *weight + of_places[i] * g->place_rounding);
    }
}

/* Weights of errors: by the sizes of the states at the start, or at the end of the guess if those are
 * larger; where bodies turn, by what rounding makes of them. */
void general_set_weights(struct general *g)
{
    struct radau_step *p = &g->step;
    memcpy(g->y, p->y, (size_t)g->size * sizeof *g->y);
    radau_step_stage(p, p->stages->stages - 1, g->y);
    ode_nominal(&g->ode, p->y, g->size_of);
    ode_nominal(&g->ode, g->y, g->end_size);
    for (int i = 0; i < g->size; ++i) {
        p->weight[i] = 1.0 / (g->relative * fmax(g->size_of[i], g->end_size[i]) + g->absolute);
    }
    if (SCENE_ANY_TURNING && p->problem.turns) {
        allow_rounding(g);
    }
}
