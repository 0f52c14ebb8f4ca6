/* How a collocated step begins: its frame, what acts at the nodes, the first guess. */
#include <float.h>
#include <string.h>

#include "segment/collocation.h"
#include "segment/collocation_rim.h"
#include "segment/collocation_turning.h"

/* Rounding of a product with the frame's vectors, relative to its factors. */
static const double FRAME_ROUNDING = 4.0 * DBL_EPSILON;

/* The direction of the part of `a` perpendicular to n, if there is one. Projected twice, because the first
 * projection of a long `a` leaves rounding. */
static bool direction_across(struct vec3 n, struct vec3 a, struct vec3 *direction)
{
    struct vec3 across = vec3_axpy(a, -vec3_dot(n, a), n);
    if (!(vec3_max_abs(across) > FRAME_ROUNDING * vec3_max_abs(a))) {
        return false;
    }
    across = vec3_scale(1.0 / vec3_norm(across), across);
    across = vec3_axpy(across, -vec3_dot(n, across), n);
    *direction = vec3_scale(1.0 / vec3_norm(across), across);
    return true;
}

static void set_frame(struct collocation *p)
{
    const struct collocation_problem *from = &p->from;
    const struct vec3 n = from->normal;
    struct vec3 along = {0.0, 0.0, 0.0};
    bool found = direction_across(n, from->rate, &along);
    for (int i = 0; i < COLLOCATION_ACCELERATION_TERMS && !found; ++i) {
        found = direction_across(n, from->acceleration[i], &along);
    }
    p->local.frame[0] = n;
    p->local.frame[1] = along;
    p->local.frame[2] = vec3_cross(n, along);
}

/* Whether a vector lies to rounding in the plane of the frame's first two; then a->z becomes zero. */
static bool flatten(struct vec3 *a)
{
    if (fabs(a->z) > FRAME_ROUNDING * (fabs(a->x) + fabs(a->y))) {
        return false;
    }
    a->z = 0.0;
    return true;
}

/* Whether n and H are constant: c' and A are along the normal. */
static bool is_head_on(const struct collocation_problem *from)
{
    double across = vec3_max_abs(vec3_cross(from->normal, from->rate));
    for (int i = 0; i < COLLOCATION_ACCELERATION_TERMS; ++i) {
        across = fmax(across, vec3_max_abs(vec3_cross(from->normal, from->acceleration[i])));
    }
    return !(across > 0.0);
}

static void put_problem_in_frame(struct collocation *p)
{
    p->local.rate = collocation_in_frame(p, p->from.rate);
    p->local.rate.x = p->from.radial;
    p->local.planar = flatten(&p->local.rate);
    for (int i = 0; i < COLLOCATION_ACCELERATION_TERMS; ++i) {
        p->local.acceleration[i] = collocation_in_frame(p, p->from.acceleration[i]);
        p->local.planar = flatten(&p->local.acceleration[i]) && p->local.planar;
    }
    for (int i = 0; i < COLLOCATION_MISMATCH_TERMS && p->from.has_mismatch; ++i) {
        p->local.mismatch[i] = collocation_in_frame(p, p->from.mismatch[i]);
    }
    p->local.momentum = vec3_scale(p->local.distance, vec3_make(0.0, -p->local.rate.z, p->local.rate.y));
}

static double load_at_start(const struct collocation *p)
{
    if (collocation_at_rim(p)) {
        return collocation_rim_load_at_start(p);
    }
    const double mismatch = p->from.has_mismatch ? p->from.damping_rate * p->local.mismatch[0].x : 0.0;
    return vec3_dot(p->local.momentum, p->local.momentum) /
               (p->local.distance * p->local.distance * p->local.distance) +
           p->local.acceleration[0].x - mismatch;
}

void collocation_begin(struct collocation *p, const struct collocation_problem *from, double step,
                       enum collocation_kind kind, const struct lobatto *nodes)
{
    p->from = *from;
    p->nodes = nodes;
    p->kind = kind;
    p->half = 0.5 * step;
    p->local.distance = from->reach + from->deviation;
    p->local.head_on = is_head_on(from);
    p->result.normal_correction = p->result.momentum_correction = vec3_make(0.0, 0.0, 0.0);
    p->work.sweeps = 0;
    if (collocation_at_rim(p)) {
        collocation_rim_begin(p);
    } else {
        set_frame(p);
        put_problem_in_frame(p);
    }
    p->result.oscillator =
        (struct oscillator){from->omega2 * p->half * p->half, from->damping_rate * p->half};
    memset(p->result.slow, 0, sizeof p->result.slow);
    memset(p->result.normal_mismatch, 0, sizeof p->result.normal_mismatch);
    p->result.terms = 1;
    p->result.slow[0] = kind == COLLOCATION_OVERDAMPED ? from->deviation : load_at_start(p) / from->omega2;
    p->result.y = from->deviation - p->result.slow[0];
    p->result.y_rate = p->half * p->local.rate.x;
}

static struct vec3 polynomial_of_time(const struct vec3 *a, int terms, double t)
{
    struct vec3 sum = a[terms - 1];
    for (int i = terms - 2; i >= 0; --i) {
        sum = vec3_axpy(a[i], t, sum);
    }
    return sum;
}

/* The first guess: x under the load as it begins, n and H to second and first order. */
static void guess(struct collocation *p, double half)
{
    const struct vec3 n = {1.0, 0.0, 0.0};
    const double per_distance_squared = 1.0 / (p->local.distance * p->local.distance);
    const struct vec3 momentum_rate = vec3_scale(p->local.distance, vec3_cross(n, p->local.acceleration[0]));
    const struct vec3 normal_rate = vec3_scale(per_distance_squared, vec3_cross(p->local.momentum, n));
    const struct vec3 bend =
        vec3_scale(0.5 * per_distance_squared,
                   vec3_add(vec3_cross(momentum_rate, n), vec3_cross(p->local.momentum, normal_rate)));
    for (int i = 0; i < p->nodes->points; ++i) {
        const double t = half * (1.0 + p->nodes->node[i]);
        nodal_put_vec3(&p->result.h, i, vec3_scale(t, momentum_rate));
        nodal_put_vec3(&p->result.n, i, vec3_scale(t, vec3_axpy(normal_rate, t, bend)));
        p->result.x[i] = p->result.slow[0];
    }
}

/* Adds y at the nodes to x (sign 1) or takes it out (sign -1). */
static void add_oscillation_at_nodes(struct collocation *p, double sign)
{
    for (int i = 0; i < p->nodes->points; ++i) {
        p->result.x[i] +=
            sign * (p->result.y * p->result.y_of_y[i] + p->result.y_rate * p->result.y_of_rate[i]);
    }
}

/* Extrapolates to the nodes of a step that is longer by `part`; takes y out of x. */
static void extrapolate(struct collocation *p, double part)
{
    add_oscillation_at_nodes(p, -1.0);
    for (int i = 0; i < p->nodes->points && !p->local.head_on; ++i) {
        const double later = part * (1.0 + p->nodes->node[i]);
        p->result.h.z[i] += later * p->result.h_rate.z[i];
        p->result.n.x[i] += later * p->result.n_rate.x[i];
        p->result.n.y[i] += later * p->result.n_rate.y[i];
        if (!p->local.planar) {
            p->result.h.x[i] += later * p->result.h_rate.x[i];
            p->result.h.y[i] += later * p->result.h_rate.y[i];
            p->result.n.z[i] += later * p->result.n_rate.z[i];
        }
    }
}

static void fill_nodes(struct collocation *p)
{
    const bool steady = !p->from.has_mismatch && vec3_is_zero(p->local.acceleration[1]) &&
                        vec3_is_zero(p->local.acceleration[2]);
    for (int i = 0; i < p->nodes->points && steady; ++i) {
        nodal_put_vec3(&p->work.acceleration_at, i, p->local.acceleration[0]);
        nodal_put_vec3(&p->work.drive_at, i, p->local.acceleration[0]);
    }
    for (int i = 0; i < p->nodes->points && !steady; ++i) {
        const double t = p->half * (1.0 + p->nodes->node[i]);
        const struct vec3 acceleration =
            polynomial_of_time(p->local.acceleration, COLLOCATION_ACCELERATION_TERMS, t);
        struct vec3 drive = acceleration;
        if (p->from.has_mismatch) {
            const struct vec3 mismatch = polynomial_of_time(p->local.mismatch, COLLOCATION_MISMATCH_TERMS, t);
            nodal_put_vec3(&p->work.mismatch_at, i, vec3_scale(p->half, mismatch));
            drive = vec3_axpy(acceleration, -p->from.damping_rate, mismatch);
        }
        nodal_put_vec3(&p->work.acceleration_at, i, acceleration);
        nodal_put_vec3(&p->work.drive_at, i, drive);
    }
}

void collocation_size(struct collocation *p, double step)
{
    const bool resolved = p->kind == COLLOCATION_RESOLVED;
    const double longer = 0.5 * step / p->half;
    if (p->work.sweeps == 0) {
        guess(p, 0.5 * step);
        if (collocation_at_rim(p)) {
            collocation_rim_guess(p, 0.5 * step);
        }
    } else if (resolved) {
        extrapolate(p, longer - 1.0);
    }
    p->result.y_rate *= longer;
    p->half = 0.5 * step;
    p->result.terms = p->nodes->points;
    p->result.oscillator =
        (struct oscillator){p->from.omega2 * p->half * p->half, p->from.damping_rate * p->half};
    fill_nodes(p);
    if (resolved) {
        oscillator_basis_about_one(&p->result.oscillator, p->nodes->node, p->nodes->points, p->result.y_of_y,
                                   p->result.y_of_rate);
        add_oscillation_at_nodes(p, 1.0);
    }
}
