#include "segment/pair_collocation.h"

#include <float.h>
#include <string.h>

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
    const double load = vec3_dot(along, along) / d + vec3_dot(p->normal, problem->acceleration[0]) -
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

static void add_force(const struct contact_pair *from, struct pair_sample *sample)
{
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_FORCE][i] =
            contact_linear_force(from->coefficients, sample->of[PAIR_GAP][i], sample->of[PAIR_GAP_RATE][i]);
    }
}

/* Spring and dashpot forces nearly cancel: the force from the acceleration that it causes. */
static void add_overdamped_force(const struct pair_collocation *p, double s, struct pair_sample *sample)
{
    const double factor = p->from->shape.side * p->from->reduced_mass / (p->step.half * p->step.half);
    double push[3];
    collocation_overdamped_push(&p->step, s, push);
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_FORCE][i] = factor * push[i];
    }
}

static void fill_sample(const struct pair_collocation *p, const double x[4], double s,
                        struct pair_sample *sample)
{
    const double side = p->from->shape.side;
    const double per_time = side / p->step.half;
    double normal_mismatch[3] = {0.0, 0.0, 0.0};
    if (p->step.from.has_mismatch) {
        collocation_mismatch(&p->step, s, normal_mismatch);
    }
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_GAP][i] = side * x[i];
        sample->of[PAIR_GAP_RATE][i] = per_time * (x[i + 1] + normal_mismatch[i]);
    }
    if (p->step.kind == COLLOCATION_OVERDAMPED) {
        add_overdamped_force(p, s, sample);
    } else {
        add_force(p->from, sample);
    }
}

void pair_collocation_sample(const void *pair_collocation, double s, struct pair_sample *sample)
{
    const struct pair_collocation *p = pair_collocation;
    double x[4];
    collocation_deviation(&p->step, s, x);
    fill_sample(p, x, s, sample);
}

void pair_collocation_sample_node(const struct pair_collocation *p, int node, struct pair_sample *sample)
{
    double x[4];
    collocation_deviation_at_node(&p->step, node, x);
    fill_sample(p, x, 1.0 + p->step.nodes->node[node], sample);
}

/* y, its rate and its force all solve the oscillator's equation. */
void pair_free_oscillation(const struct pair_collocation *p, enum pair_quantity quantity, double *start,
                           double *rate)
{
    const struct oscillator *o = &p->step.result.oscillator;
    const double half = p->step.half;
    const double y = p->step.result.y;
    const double y_rate = p->step.result.y_rate;
    const double bend = -o->damping_rate * y_rate - o->omega2 * y;
    const double k = p->from->coefficients.k;
    const double c = p->from->coefficients.c / half;
    *start = quantity == PAIR_GAP ? y : quantity == PAIR_GAP_RATE ? y_rate / half : k * y + c * y_rate;
    *rate = quantity == PAIR_GAP ? y_rate : quantity == PAIR_GAP_RATE ? bend / half : k * y_rate + c * bend;
}

struct oscillator_envelope pair_envelope_of(const struct pair_collocation *p, enum pair_quantity quantity)
{
    double start;
    double rate;
    pair_free_oscillation(p, quantity, &start, &rate);
    return oscillator_envelope_of(&p->step.result.oscillator, start, rate);
}

void pair_collocation_sample_averaged(const void *pair_collocation, double s, struct pair_sample *sample)
{
    const struct pair_collocation *p = pair_collocation;
    double x[4];
    collocation_averaged_deviation(&p->step, s, x);
    fill_sample(p, x, s, sample);
}

void pair_lower_bound_from(const struct pair_lower_bound *bound, const struct oscillator_envelope *envelope,
                           double s, const struct pair_sample *slow, double *value, double *slope)
{
    const double still = envelope->decay_rate > 0.0 ? envelope->amplitude * exp(-envelope->decay_rate * s)
                                                    : envelope->amplitude;
    *value = bound->factor * slow->of[bound->quantity][0] + bound->offset - still;
    *slope = bound->factor * slow->of[bound->quantity][1] + envelope->decay_rate * still;
}

void pair_lower_bound_at(const void *pair_lower_bound, double s, double *value, double *slope)
{
    const struct pair_lower_bound *bound = pair_lower_bound;
    const struct oscillator_envelope envelope = pair_envelope_of(bound->of, bound->quantity);
    struct pair_sample slow;
    pair_collocation_sample_averaged(bound->of, s, &slow);
    pair_lower_bound_from(bound, &envelope, s, &slow, value, slope);
}

/* Integrated by parts, so that the oscillation of r' and r'' need not be resolved: (path r)' = path' r + path
 * r', and once more. The remaining integrand is path' or path'', linear in time, times r = c - c(0) - (C -
 * C(0)). */
static double work_by_parts(const struct pair_collocation *p, const struct pair_work *work,
                            const struct pair_change *change, double s)
{
    const double t = change->time;
    const struct vec3 path = path_at(work->path, 3, t);
    const struct vec3 slope = vec3_axpy(work->path[1], 2.0 * t, work->path[2]);
    struct vec3 weight[2] = {work->path[1], vec3_scale(2.0, work->path[2])};
    if (work->order == 0) {
        return 0.0;
    }
    double boundary = vec3_dot(path, change->r);
    double sign = -1.0;
    if (work->order == 2) {
        boundary = vec3_dot(path, change->r_rate) - vec3_dot(slope, change->r);
        sign = 1.0;
        weight[0] = weight[1];
        weight[1] = vec3_make(0.0, 0.0, 0.0);
    }
    if (!(vec3_max_abs(weight[0]) + vec3_max_abs(weight[1]) > 0.0)) {
        return boundary;
    }
    /* C - C(0) has degree four, the weight one: five Gauss-Legendre nodes would be more than enough; term by
     * term it is exact. */
    double flown = 0.0;
    double power = t;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const struct vec3 c = p->felt[i - 1];
        power *= t;
        flown += power * (vec3_dot(weight[0], c) / (i + 1) + t * vec3_dot(weight[1], c) / (i + 2));
    }
    return boundary + sign * (collocation_moment(&p->step, weight, s) - flown);
}

struct pair_change pair_collocation_change(const void *pair_collocation, double s)
{
    const struct pair_collocation *p = pair_collocation;
    const struct contact_pair *from = p->from;
    const struct collocation_change step = collocation_change_at(&p->step, s);
    struct pair_change change = {.time = p->step.half * s, .r = step.moved, .r_rate = step.gained};
    double power = 1.0;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const struct vec3 c = p->felt[i - 1];
        if (i > 1) {
            change.r_rate = vec3_axpy(change.r_rate, -i * power, c);
        }
        power *= change.time;
        change.r = vec3_axpy(change.r, -power, c);
    }
    change.gap = from->shape.side * step.deviation;
    if (from->coefficients.c > 0.0) {
        change.dissipated = from->reduced_mass * collocation_dissipated(&p->step, s);
    }
    for (int end = 0; end < PAIR_BODIES; ++end) {
        change.work[end] = work_by_parts(p, &from->work[end], &change, s);
    }
    return change;
}
