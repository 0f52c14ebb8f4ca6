/* What a collocated step says: x between its ends, energies, moments. */
#include <string.h>

#include "contact/collocation.h"

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
    const double s = 1.0 + lobatto_node[node];
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
    double all[4] = {0.0, 0.0, 0.0, 0.0};
    if (p->from.leads) {
        row_derivatives(p->led, LOBATTO_POINTS, s, all);
    }
    memcpy(led, all, 3 * sizeof *led);
}

void collocation_creeping_push(const struct collocation *p, double s, double push[3])
{
    lobatto_row bend;
    lobatto_row drive;
    double of_bend[4];
    double of_drive[4];
    for (int k = 0; k < LOBATTO_POINTS; ++k) {
        bend[k] = k + 2 < LOBATTO_POINTS ? (k + 1) * (k + 2) * p->slow[k + 2] : 0.0;
        drive[k] = p->load[k] + p->oscillator.damping * p->led[k];
    }
    row_derivatives(bend, LOBATTO_POINTS, s, of_bend);
    row_derivatives(drive, LOBATTO_POINTS, s, of_drive);
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

static struct vec3 pull_at(const struct collocation *p, double t)
{
    return vec3_axpy(vec3_axpy(p->from.pull[0], t, p->from.pull[1]), t * t, p->from.pull[2]);
}

struct collocation_change collocation_change_at(const struct collocation *p, double s)
{
    struct collocation_change change;
    double x[4];
    collocation_excess(p, s, x);
    struct vec3 turned = {0.0, 0.0, 0.0};
    struct vec3 spun = {0.0, 0.0, 0.0};
    if (!p->straight) {
        turned = vec3_sub(row_integral3(&p->n, &p->n_rate, s), p->turned);
        spun = vec3_sub(row_integral3(&p->h, &p->h_rate, s), p->spun);
    }
    const double d = p->from.reach + x[0];
    if (p->kind != COLLOCATION_RESOLVED) {
        double slow[4];
        collocation_slow_excess(p, s, slow);
        const struct vec3 pull = pull_at(p, p->half * s);
        const struct collocation_wave wave =
            collocation_wave_of(p, x[0] - slow[0], x[1] - slow[1], vec3_add(p->from.normal, turned),
                                vec3_add(p->momentum, spun), pull, d);
        turned = vec3_add(turned, wave.turned);
        spun = vec3_add(spun, wave.spun);
    }
    /* n keeps its length: |normal + turned|^2 = 1 + longer */
    const double longer = vec3_dot(vec3_axpy(turned, 2.0, p->from.normal), turned);
    const double root = sqrt(1.0 + longer);
    turned = vec3_axpy(turned, -longer / (root * (1.0 + root)), vec3_add(p->from.normal, turned));
    /* Differences of c = d n and c' = x' n + H x n / d, so that a short step keeps its digits. */
    const double grown = x[0] - p->from.excess;
    change.moved = vec3_axpy(vec3_scale(d, turned), grown, p->from.normal);
    const double radial = x[1] / p->half;
    const double faster = radial - vec3_dot(p->from.normal, p->from.rate);
    const struct vec3 n = vec3_add(p->from.normal, turned);
    const struct vec3 swing = vec3_add(vec3_cross(spun, n), vec3_cross(p->momentum, turned));
    change.gained = vec3_axpy(vec3_scale(radial, turned), faster, p->from.normal);
    change.gained = vec3_axpy(change.gained, 1.0 / d, swing);
    change.gained =
        vec3_axpy(change.gained, -grown / (d * p->distance), vec3_cross(p->momentum, p->from.normal));
    return change;
}

/* The integral from 0 to s of (polynomial) X' or s' ds. */
static double along_slow(const struct collocation *p, const double *a, double s)
{
    lobatto_row product;
    lobatto_row slope;
    lobatto_row values;
    lobatto_row values_of_slope;
    for (int k = 0; k < LOBATTO_POINTS; ++k) {
        slope[k] = k + 1 < LOBATTO_POINTS ? (k + 1) * p->slow[k + 1] : 0.0;
    }
    row_at_nodes(a, values);
    row_at_nodes(slope, values_of_slope);
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        values[i] *= values_of_slope[i];
    }
    row_coefficients(values, product);
    return row_integral(product, s);
}

/* The integral of (polynomial a) y' in closed form. With a spring: (Q y + Q' y' / square)' = a y' where
 * Q + Q'' / square - damping Q' / square = a. A single decay: (Q y)' = a y' where Q - Q' / faster = a. */
static double along_rest(const struct collocation *p, const double *a, double s, double y, double y_rate)
{
    lobatto_row scaled;
    lobatto_row q;
    const bool decays = p->kind == COLLOCATION_CREEPING;
    const struct oscillator mirrored = {p->oscillator.square, -p->oscillator.damping};
    const double factor = decays ? -oscillator_rates_of(&p->oscillator).faster : mirrored.square;
    for (int k = 0; k < LOBATTO_POINTS; ++k) {
        scaled[k] = factor * a[k];
    }
    if (decays) {
        relaxation_follow(factor, scaled, q, LOBATTO_POINTS);
        return row_at(q, s) * y - row_at(q, 0.0) * p->y;
    }
    oscillator_follow(&mirrored, scaled, q, LOBATTO_POINTS);
    return row_at(q, s) * y + row_slope(q, s) * y_rate / mirrored.square -
           (row_at(q, 0.0) * p->y + row_slope(q, 0.0) * p->y_rate / mirrored.square);
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
    for (int k = 0; k < LOBATTO_POINTS; ++k) {
        a[k] = p->load[k] + (p->from.leads ? 2.0 * damping * p->led[k] : 0.0);
    }
    const double start_rate = p->half * vec3_dot(p->from.normal, p->from.rate);
    const double x0 = p->from.excess;
    const double y = x[0] - slow[0];
    const double released = 0.5 * ((start_rate - x[1]) * (start_rate + x[1]) +
                                   square * (x0 - x[0]) * (x0 + x[0]) + softening * (p->y - y) * (p->y + y));
    double sum = released + along_slow(p, a, s) + along_rest(p, a, s, y, x[1] - slow[1]);
    if (p->from.leads) {
        lobatto_row values;
        row_at_nodes(p->led, values);
        for (int i = 0; i < LOBATTO_POINTS; ++i) {
            values[i] *= values[i];
        }
        row_coefficients(values, a);
        sum += damping * row_integral(a, s);
    }
    return sum / (p->half * p->half);
}

double collocation_moment(const struct collocation *p, const struct vec3 weight[2], double s)
{
    lobatto_row values;
    lobatto_row a;
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        const double at = 1.0 + lobatto_node[i];
        const struct vec3 turned = vec3_sub(vec3_make(p->n.x[i], p->n.y[i], p->n.z[i]), p->turned);
        const double d = p->from.reach + p->x[i];
        const struct vec3 moved = vec3_axpy(vec3_scale(d, turned), p->x[i] - p->from.excess, p->from.normal);
        values[i] = vec3_dot(vec3_axpy(weight[0], p->half * at, weight[1]), moved);
    }
    row_coefficients(values, a);
    return p->half * row_integral(a, s);
}
