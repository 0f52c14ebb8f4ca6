/* Dense output of a collocated step: x at any s, and what y adds to n and H. */
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

double collocation_oscillation_integral(const struct collocation *p, double y, double y_rate)
{
    /* A single decay has y' = -faster y: the same, but also good without a spring. */
    const double integral =
        p->kind == COLLOCATION_OVERDAMPED
            ? -y / oscillator_rates_of(&p->result.oscillator).faster
            : -(y_rate + p->result.oscillator.damping_rate * y) / p->result.oscillator.omega2;
    return p->half * integral;
}

struct collocation_correction collocation_correction_of(const struct collocation *p, double y, double y_rate,
                                                        struct vec3 n, struct vec3 h,
                                                        struct vec3 acceleration, double d)
{
    const double correction = collocation_oscillation_integral(p, y, y_rate);
    return (struct collocation_correction){vec3_scale(-2.0 * correction / (d * d * d), vec3_cross(h, n)),
                                           vec3_scale(correction, vec3_cross(n, acceleration))};
}
