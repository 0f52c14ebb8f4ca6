/* Rates and sizes of the motion at the start of a collocated step. */
#include <float.h>
#include <string.h>

#include "segment/pair_collocation.h"

/* The part of a vector that the contact's motion feels: across a cylinder's axis; along a plane's normal, so
 * that nothing turns (H = 0) and a polynomial load is followed exactly. */
static struct vec3 coupled(const struct contact_pair *p, struct vec3 c)
{
    return contact_is_plane(&p->shape) ? vec3_scale(vec3_dot(p->normal, c), p->normal) : pair_across(p, c);
}

/* A: second derivative of C. E = W - C'. Both across a cylinder's axis. */
static void set_paths(const struct contact_pair *p, const struct vec3 felt[SEPARATION_DEGREE],
                      struct collocation_problem *problem)
{
    for (int i = 0; i < COLLOCATION_ACCELERATION_TERMS; ++i) {
        problem->acceleration[i] = vec3_scale((i + 1) * (i + 2), felt[i + 1]);
    }
    for (int i = 0; i < COLLOCATION_MISMATCH_TERMS; ++i) {
        const struct vec3 mismatch = vec3_axpy(p->flight.w[i], -(i + 1), p->flight.c[i + 1]);
        const bool is_none = !(vec3_max_abs(mismatch) > 0.0);
        problem->mismatch[i] = is_none ? mismatch : coupled(p, mismatch);
        problem->has_mismatch = problem->has_mismatch || !is_none;
    }
}

/* Where W and C' are the same but for rounding, the dashpot makes a load of the difference, and the spring an
 * oscillation. Below this part of the load it is left as it is: peaks are right to it. */
static const double NEGLIGIBLE_LOAD = 1e-6;

/* A difference by rounding alone, seen over a radian of the tangential motion, is none if it makes a force
 * to be seen beside the load. */
static void drop_rounded_mismatch(const struct contact_pair *p, double tangential_rate,
                                  struct collocation_problem *problem)
{
    double size = 0.0;
    double power = 1.0;
    for (int i = 0; i < COLLOCATION_MISMATCH_TERMS; ++i) {
        const double rate = vec3_norm(p->flight.w[i]);
        size += rate > 0.0 ? rate * power : 0.0;
        power /= tangential_rate;
    }
    const double load = vec3_norm(problem->acceleration[0]);
    const double per_rate = problem->damping_rate + sqrt(problem->omega2);
    if (per_rate * 16.0 * DBL_EPSILON * size > NEGLIGIBLE_LOAD * load) {
        memset(problem->mismatch, 0, sizeof problem->mismatch);
        problem->has_mismatch = false;
    }
}

void pair_timescales_make(struct pair_timescales *out, const struct contact_pair *p)
{
    struct collocation_problem *problem = &out->problem;
    problem->has_mismatch = false;
    problem->normal = p->normal;
    for (int i = 0; i < SEPARATION_DEGREE; ++i) {
        out->felt[i] = coupled(p, p->flight.c[i + 1]);
    }
    problem->rate = out->felt[0];
    problem->reach = contact_reach(&p->shape);
    problem->deviation = p->shape.side * p->gap;
    problem->omega2 = p->coefficients.k / p->reduced_mass;
    problem->damping_rate = p->coefficients.c / p->reduced_mass;
    set_paths(p, out->felt, problem);
    const double d = contact_is_plane(&p->shape) ? (double)INFINITY : problem->reach + problem->deviation;
    const struct vec3 along = pair_tangential(p, problem->rate);
    const double radial = p->shape.side * pair_gap_derivative(p);
    problem->radial = radial;
    out->distance = d;
    out->rate_along = vec3_norm(along) / d;
    out->tangential_rate = out->rate_along + sqrt(vec3_norm(problem->acceleration[0]) / d);
    if (problem->has_mismatch && !p->has_mismatch) {
        drop_rounded_mismatch(p, out->tangential_rate, problem);
    }
    double turning = vec3_dot(along, along) / d;
#if SCENE_ANY_CAPS
    problem->at_rim = contact_is_rim(&p->shape);
    if (problem->at_rim) {
        problem->rim = pair_rim_start(p);
        turning = pair_turning(p, d);
    }
#endif
    const double load = turning + vec3_dot(p->normal, problem->acceleration[0]) -
                        problem->damping_rate * vec3_dot(p->normal, problem->mismatch[0]);
    const struct oscillator oscillator = {problem->omega2, problem->damping_rate};
    out->rates = oscillator_rates_of(&oscillator);
    out->equilibrium_depth = -p->shape.side * load / problem->omega2;
    out->underdamped = 4.0 * problem->omega2 > problem->damping_rate * problem->damping_rate;
    out->oscillation =
        oscillator_envelope_of(&oscillator, problem->deviation - load / problem->omega2, radial).amplitude;
}

/* |A| at its largest, seen at the start, the middle and the end of the step [m/s^2]. */
static double largest_acceleration(const struct vec3 acceleration[COLLOCATION_ACCELERATION_TERMS],
                                   double step)
{
    double largest = vec3_norm(acceleration[0]);
    for (int i = 1; i <= 2; ++i) {
        largest =
            fmax(largest, vec3_norm(path_at(acceleration, COLLOCATION_ACCELERATION_TERMS, 0.5 * i * step)));
    }
    return largest;
}

double pair_tangential_rate_within(const struct pair_timescales *scales, double step)
{
    const struct vec3 *acceleration = scales->problem.acceleration;
    if (vec3_is_zero(acceleration[1]) && vec3_is_zero(acceleration[2])) {
        return scales->tangential_rate;
    }
    return scales->rate_along + sqrt(largest_acceleration(acceleration, step) / scales->distance);
}

/* A step may cover this many times the radians asked for: they are an estimate. */
static const double RADIANS_MORE = 1.1;

/* Each trial at least halves the logarithm of the excess length: a step 1e6 times too long needs eight. */
enum { STEP_TRIALS = 12 };

double pair_step_within(const struct pair_timescales *scales, double longest, double radians)
{
    double step = fmin(longest, radians / scales->tangential_rate);
    for (int i = 0; i < STEP_TRIALS; ++i) {
        const double tangential_rate = pair_tangential_rate_within(scales, step);
        if (step * tangential_rate <= RADIANS_MORE * radians) {
            break;
        }
        /* The step sought lies between this one and radians / tangential_rate. The rate grows with a power
         * of the step between 0 and 1, so the geometric mean of the two is nearer to it than either. */
        step = sqrt(step * (radians / tangential_rate));
    }
    return step;
}
