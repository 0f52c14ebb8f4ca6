/* Dense output of a collocated step: x, motion, dissipated energy and moments at any s. */
#include <string.h>

#include "segment/collocation.h"

/* Parts of the interior error that remain at the end of a step of four radians with eight nodes: of the
 * quadrature, and of products of an oscillation as large as d. Measured in tests/unit/collocation.c, with a
 * margin of three or more. */
static const double LEFT_AT_END = 1e-4;
static const double LEFT_OF_PRODUCTS = 2e-2;

double collocation_error_near_end(const struct collocation *p, double s)
{
    const int points = p->nodes->points;
    const double swing = (fabs(p->result.y) + fabs(p->result.y_rate)) / p->local.distance;
    /* A polynomial that is zero at the nodes has a slope at the last one below the square of their number,
     * relative to its size. */
    const double off_node = points * points * fabs(2.0 - s);
    return p->result.interior_error * fmin(1.0, LEFT_AT_END + LEFT_OF_PRODUCTS * swing + off_node);
}

void collocation_averaged_deviation(const struct collocation *p, double s, double x[4])
{
    nodal_derivatives(p->result.slow, p->result.terms, s, x);
}

/* y and its derivatives, added to x. */
static void add_oscillation(const struct collocation *p, double y, double y_rate, double x[4])
{
    const double bend = -p->result.oscillator.damping_rate * y_rate - p->result.oscillator.omega2 * y;
    x[0] += y;
    x[1] += y_rate;
    x[2] += bend;
    x[3] += -p->result.oscillator.damping_rate * bend - p->result.oscillator.omega2 * y_rate;
}

void collocation_deviation(const struct collocation *p, double s, double x[4])
{
    const struct oscillator_basis by = oscillator_basis_at(&p->result.oscillator, s);
    nodal_derivatives(p->result.slow, p->result.terms, s, x);
    add_oscillation(p, p->result.y * by.y_of_y + p->result.y_rate * by.y_of_rate,
                    p->result.y * by.rate_of_y + p->result.y_rate * by.rate_of_rate, x);
}

void collocation_deviation_at_node(const struct collocation *p, int node, double x[4])
{
    const double s = 1.0 + p->nodes->node[node];
    if (p->kind != COLLOCATION_RESOLVED) {
        collocation_deviation(p, s, x);
        return;
    }
    const double of_y = p->result.y_of_y[node];
    const double of_rate = p->result.y_of_rate[node];
    nodal_derivatives(p->result.slow, p->result.terms, s, x);
    add_oscillation(p, p->result.y * of_y + p->result.y_rate * of_rate,
                    -p->result.oscillator.omega2 * p->result.y * of_rate +
                        p->result.y_rate * (of_y - p->result.oscillator.damping_rate * of_rate),
                    x);
}

void collocation_mismatch(const struct collocation *p, double s, double normal_mismatch[3])
{
    double all[4];
    nodal_derivatives(p->result.normal_mismatch, p->nodes->points, s, all);
    memcpy(normal_mismatch, all, 3 * sizeof *normal_mismatch);
}

void collocation_overdamped_push(const struct collocation *p, double s, double push[3])
{
    const int points = p->nodes->points;
    nodal_values bend;
    nodal_values drive;
    double of_bend[4];
    double of_drive[4];
    for (int k = 0; k < points; ++k) {
        bend[k] = k + 2 < points ? (k + 1) * (k + 2) * p->result.slow[k + 2] : 0.0;
        drive[k] = p->result.load[k] + p->result.oscillator.damping_rate * p->result.normal_mismatch[k];
    }
    nodal_derivatives(bend, points, s, of_bend);
    nodal_derivatives(drive, points, s, of_drive);
    const double faster = oscillator_rates_of(&p->result.oscillator).faster;
    double fast = p->result.y * exp(-faster * s) * faster * faster;
    for (int i = 0; i < 3; ++i) {
        push[i] = of_bend[i] + fast - of_drive[i];
        fast *= -faster;
    }
}

struct collocation_correction collocation_correction_of(const struct collocation *p, double y, double y_rate,
                                                        struct vec3 n, struct vec3 h,
                                                        struct vec3 acceleration, double d)
{
    /* A single decay has y' = -faster y: the same, but also good without a spring. */
    const double integral =
        p->kind == COLLOCATION_OVERDAMPED
            ? -y / oscillator_rates_of(&p->result.oscillator).faster
            : -(y_rate + p->result.oscillator.damping_rate * y) / p->result.oscillator.omega2;
    const double correction = p->half * integral;
    return (struct collocation_correction){vec3_scale(-2.0 * correction / (d * d * d), vec3_cross(h, n)),
                                           vec3_scale(correction, vec3_cross(n, acceleration))};
}

static struct vec3 acceleration_then(const struct collocation *p, double t)
{
    return vec3_axpy(vec3_axpy(p->local.acceleration[0], t, p->local.acceleration[1]), t * t,
                     p->local.acceleration[2]);
}

static struct vec3 in_world(const struct collocation *p, struct vec3 a)
{
    return vec3_axpy(vec3_axpy(vec3_scale(a.x, p->local.frame[0]), a.y, p->local.frame[1]), a.z,
                     p->local.frame[2]);
}

/* Change of n and H since the start, y included. */
static void frame_change_at(const struct collocation *p, double s, const double x[4],
                            struct vec3 *normal_change, struct vec3 *momentum_change)
{
    const struct lobatto *nodes = p->nodes;
    normal_change->x = nodal_integral_to(nodes, p->result.n.x, p->result.n_rate.x, s);
    normal_change->y = nodal_integral_to(nodes, p->result.n.y, p->result.n_rate.y, s);
    momentum_change->z = nodal_integral_to(nodes, p->result.h.z, p->result.h_rate.z, s);
    if (!p->local.planar) {
        normal_change->z = nodal_integral_to(nodes, p->result.n.z, p->result.n_rate.z, s);
        momentum_change->x = nodal_integral_to(nodes, p->result.h.x, p->result.h_rate.x, s);
        momentum_change->y = nodal_integral_to(nodes, p->result.h.y, p->result.h_rate.y, s);
    }
    if (p->kind != COLLOCATION_RESOLVED) {
        double slow[4];
        collocation_averaged_deviation(p, s, slow);
        *normal_change = vec3_sub(*normal_change, p->result.normal_correction);
        *momentum_change = vec3_sub(*momentum_change, p->result.momentum_correction);
        const struct collocation_correction correction = collocation_correction_of(
            p, x[0] - slow[0], x[1] - slow[1], vec3_add(vec3_make(1.0, 0.0, 0.0), *normal_change),
            vec3_add(p->local.momentum, *momentum_change), acceleration_then(p, p->half * s),
            p->from.reach + x[0]);
        *normal_change = vec3_add(*normal_change, correction.normal);
        *momentum_change = vec3_add(*momentum_change, correction.momentum);
    }
}

struct collocation_change collocation_change_at(const struct collocation *p, double s)
{
    const struct vec3 normal = {1.0, 0.0, 0.0};
    double x[4];
    collocation_deviation(p, s, x);
    struct vec3 normal_change = {0.0, 0.0, 0.0};
    struct vec3 momentum_change = {0.0, 0.0, 0.0};
    if (!p->local.head_on) {
        frame_change_at(p, s, x, &normal_change, &momentum_change);
    }
    const double d = p->from.reach + x[0];
    /* n keeps its length: |normal + normal_change|^2 = 1 + longer */
    const double longer = vec3_dot(vec3_axpy(normal_change, 2.0, normal), normal_change);
    const double root = sqrt(1.0 + longer);
    normal_change =
        vec3_axpy(normal_change, -longer / (root * (1.0 + root)), vec3_add(normal, normal_change));
    /* Differences of c = d n and c' = x' n + H x n / d, so that a short step keeps its digits. */
    const double grown = x[0] - p->from.deviation;
    const double radial = x[1] / p->half;
    struct vec3 gained = vec3_axpy(vec3_scale(radial, normal_change), radial - p->local.rate.x, normal);
    if (!p->local.head_on) { /* which may be at the centre, where d = 0 */
        const struct vec3 swing = vec3_add(vec3_cross(momentum_change, vec3_add(normal, normal_change)),
                                           vec3_cross(p->local.momentum, normal_change));
        gained = vec3_axpy(gained, 1.0 / d, swing);
        gained = vec3_axpy(gained, -grown / (d * p->local.distance), vec3_cross(p->local.momentum, normal));
    }
    return (struct collocation_change){in_world(p, vec3_axpy(vec3_scale(d, normal_change), grown, normal)),
                                       in_world(p, gained), x[0]};
}

/* The integral from 0 to s of the polynomial `a` times the rate of x without y. */
static double along_slow(const struct collocation *p, const double *a, double s)
{
    const int points = p->nodes->points;
    nodal_values product;
    nodal_values slope = {0.0};
    nodal_values values;
    nodal_values values_of_slope;
    for (int k = 0; k < points; ++k) {
        slope[k] = k + 1 < points ? (k + 1) * p->result.slow[k + 1] : 0.0;
    }
    nodal_values_of(p->nodes, a, values);
    nodal_values_of(p->nodes, slope, values_of_slope);
    for (int i = 0; i < points; ++i) {
        values[i] *= values_of_slope[i];
    }
    nodal_coefficients(p->nodes, values, product);
    return nodal_integral(product, points, s);
}

/* The integral from 0 to s of the polynomial `a` times y', in closed form. With a spring: (Q y + Q' y' /
 * omega2)' = a y' where Q + Q'' / omega2 - damping_rate Q' / omega2 = a. A single decay: (Q y)' = a y' where
 * Q - Q' / faster = a. */
static double along_oscillation(const struct collocation *p, const double *a, double s, double y,
                                double y_rate)
{
    const int points = p->nodes->points;
    nodal_values scaled = {0.0};
    nodal_values q;
    const bool decays = p->kind == COLLOCATION_OVERDAMPED;
    const struct oscillator mirrored = {p->result.oscillator.omega2, -p->result.oscillator.damping_rate};
    const double factor = decays ? -oscillator_rates_of(&p->result.oscillator).faster : mirrored.omega2;
    for (int k = 0; k < points; ++k) {
        scaled[k] = factor * a[k];
    }
    if (decays) {
        relaxation_particular(factor, scaled, q, points);
        return nodal_polynomial_at(q, points, s) * y - nodal_polynomial_at(q, points, 0.0) * p->result.y;
    }
    oscillator_particular(&mirrored, scaled, q, points);
    return nodal_polynomial_at(q, points, s) * y + nodal_slope(q, points, s) * y_rate / mirrored.omega2 -
           (nodal_polynomial_at(q, points, 0.0) * p->result.y +
            nodal_slope(q, points, 0.0) * p->result.y_rate / mirrored.omega2);
}

/* From the oscillator's own balance of energy, exact at any frequency:
 * damping_rate x'^2 = -(x'^2 / 2 + omega2 x^2 / 2)' + f x', and (x' + e)^2 = x'^2 + 2 e x' + e^2. */
double collocation_dissipated(const struct collocation *p, double s)
{
    const double damping_rate = p->from.damping_rate * p->half;
    const double omega2 = p->from.omega2 * p->half * p->half;
    const double softening = p->result.oscillator.omega2 - omega2;
    double x[4];
    double slow[4];
    nodal_values a;
    collocation_deviation(p, s, x);
    collocation_averaged_deviation(p, s, slow);
    for (int k = 0; k < p->nodes->points; ++k) {
        a[k] = p->result.load[k] +
               (p->from.has_mismatch ? 2.0 * damping_rate * p->result.normal_mismatch[k] : 0.0);
    }
    const double start_rate = p->half * p->local.rate.x;
    const double x0 = p->from.deviation;
    const double y = x[0] - slow[0];
    const double dissipated_energy =
        0.5 * ((start_rate - x[1]) * (start_rate + x[1]) + omega2 * (x0 - x[0]) * (x0 + x[0]) +
               softening * (p->result.y - y) * (p->result.y + y));
    double sum = dissipated_energy + along_slow(p, a, s) + along_oscillation(p, a, s, y, x[1] - slow[1]);
    if (p->from.has_mismatch) {
        nodal_values values;
        nodal_values_of(p->nodes, p->result.normal_mismatch, values);
        for (int i = 0; i < p->nodes->points; ++i) {
            values[i] *= values[i];
        }
        nodal_coefficients(p->nodes, values, a);
        sum += damping_rate * nodal_integral(a, p->nodes->points, s);
    }
    return sum / (p->half * p->half);
}

/* The integral from 0 to s of b y, b given by `values` at the nodes, by parts: with B' = b, (B y)' - B y' = b
 * y. */
static double moment_of_oscillation(const struct collocation *p, const double *values, double s)
{
    const int points = p->nodes->points;
    nodal_values sum = {0.0};
    nodal_values b;
    double x[4];
    double slow[4];
    collocation_deviation(p, s, x);
    collocation_averaged_deviation(p, s, slow);
    (void)nodal_integrate(p->nodes, values, sum);
    nodal_coefficients(p->nodes, sum, b);
    const double y = x[0] - slow[0];
    return nodal_polynomial_at(b, points, s) * y - along_oscillation(p, b, s, y, x[1] - slow[1]);
}

double collocation_moment(const struct collocation *p, const struct vec3 weight[2], double s)
{
    const struct vec3 normal = {1.0, 0.0, 0.0};
    nodal_values values = {0.0};
    nodal_values along = {0.0};
    nodal_values a;
    for (int i = 0; i < p->nodes->points; ++i) {
        const double at = 1.0 + p->nodes->node[i];
        const struct vec3 normal_change = vec3_sub(
            vec3_make(p->result.n.x[i], p->result.n.y[i], p->result.n.z[i]), p->result.normal_correction);
        const double d = p->from.reach + p->result.x[i];
        const struct vec3 moved =
            vec3_axpy(vec3_scale(d, normal_change), p->result.x[i] - p->from.deviation, normal);
        const struct vec3 weight_then = vec3_axpy(weight[0], p->half * at, weight[1]);
        values[i] = vec3_dot(weight_then, in_world(p, moved));
        along[i] = vec3_dot(weight_then, in_world(p, vec3_add(normal, normal_change)));
    }
    nodal_coefficients(p->nodes, values, a);
    const double slow = nodal_integral(a, p->nodes->points, s);
    const double rest = p->kind == COLLOCATION_RESOLVED ? 0.0 : moment_of_oscillation(p, along, s);
    return p->half * (slow + rest);
}
