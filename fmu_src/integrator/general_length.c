/* How long a first step of the general segment may be. */
#include "integrator/general_memory.h"
#include "scene/free_bodies.h"
#include "scene/scene_jet.h"
#include "scene/turning.h"

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

#if SCENE_ANY_FRICTION

/* Regularized friction bends where the slip falls to some v_0: a polynomial ends before exp(-slip/v_0) is
 * more than rounding of a force, and beyond follows it over a few powers of e. Below the last it is as good
 * as linear. */
static const double SLIP_BEFORE = 20.0;
static const double SLIP_WITHIN = 8.0;
static const double SLIP_AFTER = 4.0;

/* No step is made shorter than this for it, in the clock or a second; nor by a slip that is rounding of
 * speeds. */
static const double SLIP_SHORTEST = 1e-13;
static const double SLIP_ROUNDING = 1e-12;

/* When the sum of[0] + of[1] t + of[2] t^2, positive at first, falls to zero; INFINITY: it does not. */
static double time_to_zero(const double of[3])
{
    const double square = of[1] * of[1] - 4.0 * of[0] * of[2];
    if (!(square >= 0.0) || !(of[1] < 0.0 || of[2] < 0.0)) {
        return (double)INFINITY;
    }
    const double q = -0.5 * (of[1] + copysign(sqrt(square), of[1]));
    const double near = of[1] < 0.0 ? of[0] / q : q / of[2]; /* a root that keeps its digits */
    return near > 0.0 ? near : (double)INFINITY;
}

double general_length_of_sliding(const struct scene_values *v, const struct scene_state *q)
{
    struct scene_instant at;
    struct scene_jet along;
    double least = (double)INFINITY;
    bool known = false;
    scene_evaluate(v, q, q->clock, free_bodies_now(q), &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct friction_law law = scene_friction_law(v, q, j);
        const double slip = vec3_norm(at.turning.slip[j]);
        if (q->contact[j].regime == REGIME_APART || law.kind != FRICTION_REGULARIZED ||
            !(slip > SLIP_AFTER * law.slip_velocity + SLIP_ROUNDING * vec3_norm(at.rate[j]))) {
            continue;
        }
        if (!known) {
            jet_of_motion(v, q, &at, &along);
            known = true;
        }
        const struct vec3 *terms = along.turning[j].slip;
        const double of[3] = {slip, vec3_dot(terms[1], terms[0]) / slip, vec3_dot(terms[2], terms[0]) / slip};
        const double zero = time_to_zero(of);
        const double v_0 = law.slip_velocity / fabs(of[1] + 2.0 * of[2] * zero); /* in time [s] */
        if (zero < (double)INFINITY && v_0 > 0.0) {
            least = fmin(least, fmax(zero - SLIP_BEFORE * v_0, SLIP_WITHIN * v_0));
        }
    }
    return fmax(least, SLIP_SHORTEST * fmax(q->clock, 1.0));
}

#endif
