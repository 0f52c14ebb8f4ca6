/* Dense output of a collocated step: dissipated energy and moments at any s. */
#include "segment/collocation.h"
#include "segment/collocation_rim.h"
#include "segment/collocation_turning.h"

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

/* c - c(0) and n at a node, in the world, the oscillation left out. */
static void at_node(const struct collocation *p, int i, struct vec3 *moved, struct vec3 *normal)
{
    const struct vec3 start = {1.0, 0.0, 0.0};
    const struct vec3 normal_change = vec3_sub(
        vec3_make(p->result.n.x[i], p->result.n.y[i], p->result.n.z[i]), p->result.normal_correction);
    const double d = p->from.reach + p->result.x[i];
    *moved = collocation_in_world(
        p, vec3_axpy(vec3_scale(d, normal_change), p->result.x[i] - p->from.deviation, start));
    *normal = collocation_in_world(p, vec3_add(start, normal_change));
}

double collocation_moment(const struct collocation *p, const struct vec3 weight[2], double s)
{
    nodal_values values = {0.0};
    nodal_values along = {0.0};
    nodal_values a;
    for (int i = 0; i < p->nodes->points; ++i) {
        const double at = 1.0 + p->nodes->node[i];
        const struct vec3 weight_then = vec3_axpy(weight[0], p->half * at, weight[1]);
        struct vec3 moved;
        struct vec3 normal;
        if (collocation_at_rim(p)) {
            collocation_rim_at_node(p, i, &moved, &normal);
        } else {
            at_node(p, i, &moved, &normal);
        }
        values[i] = vec3_dot(weight_then, moved);
        along[i] = vec3_dot(weight_then, normal);
    }
    nodal_coefficients(p->nodes, values, a);
    const double slow = nodal_integral(a, p->nodes->points, s);
    const double rest = p->kind == COLLOCATION_RESOLVED ? 0.0 : moment_of_oscillation(p, along, s);
    return p->half * (slow + rest);
}
