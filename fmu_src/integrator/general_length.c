/* How long a first step of the general segment may be. */
#include "integrator/general_memory.h"

/* Radians of the fastest oscillation. An impact takes pi, four under Hertz's law. */
static const double FIRST_STEP = 4.0;

double general_length_of_springs(const struct general *g)
{
    const struct radau_step *p = &g->step;
    double square = 0.0;
    for (int i = 0; i < p->problem.paired; ++i) {
        const double *row = p->by_places + p->speed_among[i] * p->problem.paired;
        double sum = 0.0;
        for (int j = 0; j < p->problem.paired; ++j) {
            sum += fabs(row[j]);
        }
        square = fmax(square, sum);
    }
    return square > 0.0 ? FIRST_STEP / sqrt(square) : (double)INFINITY;
}

#if SCENE_ANY_HERTZ

/* Hertz's spring at so much of its largest depth, or more, is known by its slope: general_length_of_springs
 * and the error of a step see it. The slope goes with the root of the depth. */
static const double DEEP = 0.25;

/* Depth to which speed and load bring a contact from the touch, its order of magnitude [m]: of an impact
 * without damping delta^(5/2) = 5/4 v^2 / k; with much, 5/2 v / (k chi); at rest under a load a,
 * delta^(3/2) = a / k. `k` is by mass. */
static double depth_to_come(double k, double chi, double speed, double load)
{
    const double stops = fmin(0.5 * speed, 1.0 / chi); /* chi = 0: the former */
    const double static_depth = cbrt(load / k);
    return fmax(pow(2.5 * speed * stops / k, 0.4), static_depth * static_depth);
}

static double length_of_impact(const struct scene_values *v, const struct scene_state *q,
                               const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    const double per_mass = scene_inverse_mass(v, contact);
    if (!contact_is_hertz(&law) || !contact_transmits(q, contact) || !(per_mass > 0.0)) {
        return (double)INFINITY;
    }
    const struct contact_coefficients factors = contact_factors_of(&law);
    const double k = factors.k * per_mass;
    const double chi = regime == REGIME_COMPRESSION ? factors.c : 0.0;
    const struct contact_geometry *g = &at->geometry[contact];
    const double load = scene_pressing_acceleration(v, q, at, contact);
    const double depth = depth_to_come(k, chi, fabs(g->gap_rate), load);
    if (!(-g->gap < DEEP * depth)) {
        return (double)INFINITY;
    }
    const double spring = sqrt(1.5 * k * sqrt(depth));
    const double dashpot = k * chi * depth * sqrt(depth);
    return FIRST_STEP / fmax(spring, dashpot);
}

double general_length_of_impacts(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_instant *at)
{
    double least = (double)INFINITY;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        least = fmin(least, length_of_impact(v, q, at, j));
    }
    return least;
}

#endif
