/* What a collocated step says: x between its ends, energies, moments. */
#include <string.h>

#include "contact/collocation.h"

/* Of the interior error, what is left at the end of a step of four radians with eight nodes, and what products of an oscillation as
 * large as d add to it: by measurement (tests/unit/collocation.c), with a factor of three or more to spare. */
static const double LEFT_AT_END = 1e-4;
static const double LEFT_OF_PRODUCTS = 2e-2;

double collocation_error_near_end(const struct collocation *p, double s)
{
    const int points = p->nodes->points;
    const double swing = (fabs(p->y) + fabs(p->y_rate)) / p->distance;
    /* A polynomial that is zero at the nodes grows from the last one by less than the square of their number. */
    const double way_back = points * points * fabs(2.0 - s);
    return p->interior_error * fmin(1.0, LEFT_AT_END + LEFT_OF_PRODUCTS * swing + way_back);
}

void collocation_slow_excess(const struct collocation *p, double s, double x[4])
{
    row_derivatives(p->slow, p->terms, s, x);
}

/* y and its derivatives, added to x. */
static void add_oscillation(const struct collocation *p, double y, double y_rate, double x[4])
{
    const double bend = -p->oscillator.damping * y_rate - p->oscillator.square * y;
    x[0] += y;
    x[1] += y_rate;
    x[2] += bend;
    x[3] += -p->oscillator.damping * bend - p->oscillator.square * y_rate;
}

void collocation_excess(const struct collocation *p, double s, double x[4])
{
    const struct oscillator_basis by = oscillator_basis_at(&p->oscillator, s);
    row_derivatives(p->slow, p->terms, s, x);
    add_oscillation(p, p->y * by.y_of_y + p->y_rate * by.y_of_rate,
                    p->y * by.rate_of_y + p->y_rate * by.rate_of_rate, x);
}

void collocation_excess_at_node(const struct collocation *p, int node, double x[4])
{
    const double s = 1.0 + p->nodes->node[node];
    if (p->kind != COLLOCATION_RESOLVED) {
        collocation_excess(p, s, x);
        return;
    }
    const double of_y = p->y_of_y[node];
    const double of_rate = p->y_of_rate[node];
    row_derivatives(p->slow, p->terms, s, x);
    add_oscillation(
        p, p->y * of_y + p->y_rate * of_rate,
        -p->oscillator.square * p->y * of_rate + p->y_rate * (of_y - p->oscillator.damping * of_rate), x);
}

void collocation_lead(const struct collocation *p, double s, double led[3])
{
    double all[4];
    row_derivatives(p->led, p->nodes->points, s, all);
    memcpy(led, all, 3 * sizeof *led);
}

void collocation_creeping_push(const struct collocation *p, double s, double push[3])
{
    const int points = p->nodes->points;
    lobatto_row bend;
    lobatto_row drive;
    double of_bend[4];
    double of_drive[4];
    for (int k = 0; k < points; ++k) {
        bend[k] = k + 2 < points ? (k + 1) * (k + 2) * p->slow[k + 2] : 0.0;
        drive[k] = p->load[k] + p->oscillator.damping * p->led[k];
    }
    row_derivatives(bend, points, s, of_bend);
    row_derivatives(drive, points, s, of_drive);
    const double faster = oscillator_rates_of(&p->oscillator).faster;
    double fast = p->y * exp(-faster * s) * faster * faster;
    for (int i = 0; i < 3; ++i) {
        push[i] = of_bend[i] + fast - of_drive[i];
        fast *= -faster;
    }
}

struct collocation_wave collocation_wave_of(const struct collocation *p, double y, double y_rate,
                                            struct vec3 n, struct vec3 h, struct vec3 pull, double d)
{
    /* A single decay has y' = -faster y: the same, but also good without a spring. */
    const double integral = p->kind == COLLOCATION_CREEPING
                                ? -y / oscillator_rates_of(&p->oscillator).faster
                                : -(y_rate + p->oscillator.damping * y) / p->oscillator.square;
    const double wave = p->half * integral;
    return (struct collocation_wave){vec3_scale(-2.0 * wave / (d * d * d), vec3_cross(h, n)),
                                     vec3_scale(wave, vec3_cross(n, pull))};
}

static struct vec3 pull_then(const struct collocation *p, double t)
{
    return vec3_axpy(vec3_axpy(p->pull[0], t, p->pull[1]), t * t, p->pull[2]);
}

static struct vec3 in_world(const struct collocation *p, struct vec3 a)
{
    return vec3_axpy(vec3_axpy(vec3_scale(a.x, p->frame[0]), a.y, p->frame[1]), a.z, p->frame[2]);
}

/* What has been added to n and H, y included. */
static void added_at(const struct collocation *p, double s, const double x[4], struct vec3 *turned,
                     struct vec3 *spun)
{
    const struct lobatto *nodes = p->nodes;
    turned->x = row_integral_to(nodes, p->n.x, p->n_rate.x, s);
    turned->y = row_integral_to(nodes, p->n.y, p->n_rate.y, s);
    spun->z = row_integral_to(nodes, p->h.z, p->h_rate.z, s);
    if (!p->planar) {
        turned->z = row_integral_to(nodes, p->n.z, p->n_rate.z, s);
        spun->x = row_integral_to(nodes, p->h.x, p->h_rate.x, s);
        spun->y = row_integral_to(nodes, p->h.y, p->h_rate.y, s);
    }
    if (p->kind != COLLOCATION_RESOLVED) {
        double slow[4];
        collocation_slow_excess(p, s, slow);
        *turned = vec3_sub(*turned, p->turned);
        *spun = vec3_sub(*spun, p->spun);
        const struct collocation_wave wave = collocation_wave_of(
            p, x[0] - slow[0], x[1] - slow[1], vec3_add(vec3_make(1.0, 0.0, 0.0), *turned),
            vec3_add(p->momentum, *spun), pull_then(p, p->half * s), p->from.reach + x[0]);
        *turned = vec3_add(*turned, wave.turned);
        *spun = vec3_add(*spun, wave.spun);
    }
}

struct collocation_change collocation_change_at(const struct collocation *p, double s)
{
    const struct vec3 normal = {1.0, 0.0, 0.0};
    double x[4];
    collocation_excess(p, s, x);
    struct vec3 turned = {0.0, 0.0, 0.0};
    struct vec3 spun = {0.0, 0.0, 0.0};
    if (!p->straight) {
        added_at(p, s, x, &turned, &spun);
    }
    const double d = p->from.reach + x[0];
    /* n keeps its length: |normal + turned|^2 = 1 + longer */
    const double longer = vec3_dot(vec3_axpy(turned, 2.0, normal), turned);
    const double root = sqrt(1.0 + longer);
    turned = vec3_axpy(turned, -longer / (root * (1.0 + root)), vec3_add(normal, turned));
    /* Differences of c = d n and c' = x' n + H x n / d, so that a short step keeps its digits. */
    const double grown = x[0] - p->from.excess;
    const double radial = x[1] / p->half;
    struct vec3 gained = vec3_axpy(vec3_scale(radial, turned), radial - p->rate.x, normal);
    if (!p->straight) { /* which may be at the centre, where d = 0 */
        const struct vec3 swing =
            vec3_add(vec3_cross(spun, vec3_add(normal, turned)), vec3_cross(p->momentum, turned));
        gained = vec3_axpy(gained, 1.0 / d, swing);
        gained = vec3_axpy(gained, -grown / (d * p->distance), vec3_cross(p->momentum, normal));
    }
    return (struct collocation_change){in_world(p, vec3_axpy(vec3_scale(d, turned), grown, normal)),
                                       in_world(p, gained), x[0]};
}

/* The integral from 0 to s of (polynomial) X' or s' ds. */
static double along_slow(const struct collocation *p, const double *a, double s)
{
    const int points = p->nodes->points;
    lobatto_row product;
    lobatto_row slope = {0.0};
    lobatto_row values;
    lobatto_row values_of_slope;
    for (int k = 0; k < points; ++k) {
        slope[k] = k + 1 < points ? (k + 1) * p->slow[k + 1] : 0.0;
    }
    row_at_nodes(p->nodes, a, values);
    row_at_nodes(p->nodes, slope, values_of_slope);
    for (int i = 0; i < points; ++i) {
        values[i] *= values_of_slope[i];
    }
    row_coefficients(p->nodes, values, product);
    return row_integral(product, points, s);
}

/* The integral of (polynomial a) y' in closed form. With a spring: (Q y + Q' y' / square)' = a y' where
 * Q + Q'' / square - damping Q' / square = a. A single decay: (Q y)' = a y' where Q - Q' / faster = a. */
static double along_rest(const struct collocation *p, const double *a, double s, double y, double y_rate)
{
    const int points = p->nodes->points;
    lobatto_row scaled = {0.0};
    lobatto_row q;
    const bool decays = p->kind == COLLOCATION_CREEPING;
    const struct oscillator mirrored = {p->oscillator.square, -p->oscillator.damping};
    const double factor = decays ? -oscillator_rates_of(&p->oscillator).faster : mirrored.square;
    for (int k = 0; k < points; ++k) {
        scaled[k] = factor * a[k];
    }
    if (decays) {
        relaxation_follow(factor, scaled, q, points);
        return row_at(q, points, s) * y - row_at(q, points, 0.0) * p->y;
    }
    oscillator_follow(&mirrored, scaled, q, points);
    return row_at(q, points, s) * y + row_slope(q, points, s) * y_rate / mirrored.square -
           (row_at(q, points, 0.0) * p->y + row_slope(q, points, 0.0) * p->y_rate / mirrored.square);
}

/* From the oscillator's own balance of energy, exact however fast it turns:
 * damping x'^2 = -(x'^2 / 2 + square x^2 / 2)' + f x', and (x' + e)^2 = x'^2 + 2 e x' + e^2. */
double collocation_dissipated(const struct collocation *p, double s)
{
    const double damping = p->from.damping * p->half;
    const double square = p->from.square * p->half * p->half;
    const double softening = p->oscillator.square - square;
    double x[4];
    double slow[4];
    lobatto_row a;
    collocation_excess(p, s, x);
    collocation_slow_excess(p, s, slow);
    for (int k = 0; k < p->nodes->points; ++k) {
        a[k] = p->load[k] + (p->from.leads ? 2.0 * damping * p->led[k] : 0.0);
    }
    const double start_rate = p->half * p->rate.x;
    const double x0 = p->from.excess;
    const double y = x[0] - slow[0];
    const double released = 0.5 * ((start_rate - x[1]) * (start_rate + x[1]) +
                                   square * (x0 - x[0]) * (x0 + x[0]) + softening * (p->y - y) * (p->y + y));
    double sum = released + along_slow(p, a, s) + along_rest(p, a, s, y, x[1] - slow[1]);
    if (p->from.leads) {
        lobatto_row values;
        row_at_nodes(p->nodes, p->led, values);
        for (int i = 0; i < p->nodes->points; ++i) {
            values[i] *= values[i];
        }
        row_coefficients(p->nodes, values, a);
        sum += damping * row_integral(a, p->nodes->points, s);
    }
    return sum / (p->half * p->half);
}

/* The integral from 0 to s of (values at the nodes) y ds, by parts: with B' = b, (B y)' - B y' = b y. */
static double moment_of_rest(const struct collocation *p, const double *values, double s)
{
    const int points = p->nodes->points;
    lobatto_row sum = {0.0};
    lobatto_row b;
    double x[4];
    double slow[4];
    collocation_excess(p, s, x);
    collocation_slow_excess(p, s, slow);
    (void)row_integrate(p->nodes, values, sum);
    row_coefficients(p->nodes, sum, b);
    const double y = x[0] - slow[0];
    return row_at(b, points, s) * y - along_rest(p, b, s, y, x[1] - slow[1]);
}

double collocation_moment(const struct collocation *p, const struct vec3 weight[2], double s)
{
    const struct vec3 normal = {1.0, 0.0, 0.0};
    lobatto_row values = {0.0};
    lobatto_row along = {0.0};
    lobatto_row a;
    for (int i = 0; i < p->nodes->points; ++i) {
        const double at = 1.0 + p->nodes->node[i];
        const struct vec3 turned = vec3_sub(vec3_make(p->n.x[i], p->n.y[i], p->n.z[i]), p->turned);
        const double d = p->from.reach + p->x[i];
        const struct vec3 moved = vec3_axpy(vec3_scale(d, turned), p->x[i] - p->from.excess, normal);
        const struct vec3 weight_then = vec3_axpy(weight[0], p->half * at, weight[1]);
        values[i] = vec3_dot(weight_then, in_world(p, moved));
        along[i] = vec3_dot(weight_then, in_world(p, vec3_add(normal, turned)));
    }
    row_coefficients(p->nodes, values, a);
    const double slow = row_integral(a, p->nodes->points, s);
    const double rest = p->kind == COLLOCATION_RESOLVED ? 0.0 : moment_of_rest(p, along, s);
    return p->half * (slow + rest);
}
