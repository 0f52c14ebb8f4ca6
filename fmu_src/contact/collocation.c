#include "contact/collocation.h"

#include <float.h>
#include <string.h>

/* The iteration gains a factor of the angle turned in a step, some two radians, divided by the count of sweeps; where it needs
 * more than this, a shorter step is cheaper. */
enum { MAX_SWEEPS = 30 };

/* The coefficients of a row are sums with factors up to 611 (lobatto_monomial): so much of them is rounding, with some to spare. */
static const double ROW_ROUNDING = 1e-12;

static double larger(double a, double b)
{
    return a > b ? a : b;
}

/* s follows the load, y is the rest. */
static void follow(struct collocation *p, double softening)
{
    const int points = p->nodes->points;
    oscillator_follow(&p->oscillator, p->load, p->slow, points);
    row_at_nodes(p->nodes, p->slow, p->x);
    p->oscillator.square += softening;
    p->y = p->from.excess - p->x[0];
    p->y_rate = p->half * p->rate.x - row_slope(p->slow, points, 0.0);
    for (int i = 0; i < points && p->kind == COLLOCATION_RESOLVED; i += 2) {
        const number_pair y = p->y * pair_at(p->y_of_y, i) + p->y_rate * pair_at(p->y_of_rate, i);
        pair_put(p->x, i, pair_at(p->x, i) + y);
    }
}

/* (D + slower)(D + faster) x = load: u = (D + slower) x follows the load but for a fast decay, and X follows u. */
static void creep(struct collocation *p)
{
    const int points = p->nodes->points;
    const struct oscillator_rates rates = oscillator_rates_of(&p->oscillator);
    lobatto_row u;
    lobatto_row u_at_nodes;
    lobatto_row rate = {0.0};
    relaxation_follow(rates.faster, p->load, u, points);
    row_at_nodes(p->nodes, u, u_at_nodes);
    const double fast = p->half * p->rate.x + rates.slower * p->from.excess - u_at_nodes[0];
    p->y = -fast / (rates.faster - rates.slower);
    p->y_rate = -rates.faster * p->y;
    for (int i = 0; i < points; ++i) {
        rate[i] = u_at_nodes[i] - rates.slower * p->x[i];
    }
    (void)row_integrate(p->nodes, rate, p->x);
    for (int i = 0; i < points; ++i) {
        p->x[i] += p->from.excess - p->y;
    }
    row_coefficients(p->nodes, p->x, p->slow);
}

/* The largest that x comes to in the step, roughly [m]. */
static double size_of_excess(const struct collocation *p)
{
    double largest = fabs(p->y) + fabs(p->y_rate);
    for (int k = 0; k < p->nodes->points; ++k) {
        largest = larger(fabs(p->slow[k]), largest);
    }
    return largest;
}

/* The load into x; returns the largest change of a coefficient, scaled as if x were of the size of d: the force, which follows from x,
 * is to be as accurate as the position, however small x is. */
static double answer(struct collocation *p, const double *values, double softening)
{
    lobatto_row before;
    double change = 0.0;
    memcpy(before, p->slow, sizeof before);
    p->oscillator = (struct oscillator){p->from.square * p->half * p->half, p->from.damping * p->half};
    row_coefficients(p->nodes, values, p->load);
    if (p->kind == COLLOCATION_CREEPING) {
        creep(p);
    } else {
        follow(p, p->kind == COLLOCATION_SPANNING ? softening : 0.0);
    }
    for (int i = 0; i < p->nodes->points; ++i) {
        change = larger(fabs(p->slow[i] - before[i]), change);
    }
    const double size = size_of_excess(p);
    return change > ROW_ROUNDING * size ? change * fmax(1.0, p->distance / size) : 0.0;
}

/* f at the nodes, and x that answers. */
static double respond(struct collocation *p)
{
    const int points = p->nodes->points;
    const double half2 = p->half * p->half;
    const double *weight = p->nodes->integral + points - 1;
    const struct vec3 n = vec3_sub(vec3_make(1.0, 0.0, 0.0), p->turned);
    const struct vec3 h = vec3_sub(p->momentum, p->spun);
    lobatto_row values;
    lobatto_row softening;
    double mean = 0.0;
    for (int i = 0; i < points; i += 2) {
        const number_pair hz = h.z + pair_at(p->h.z, i);
        number_pair square = hz * hz;
        number_pair drive = (n.x + pair_at(p->n.x, i)) * pair_at(p->drive_at.x, i) +
                            (n.y + pair_at(p->n.y, i)) * pair_at(p->drive_at.y, i);
        if (!p->planar) {
            const number_pair hx = h.x + pair_at(p->h.x, i);
            const number_pair hy = h.y + pair_at(p->h.y, i);
            square += hx * hx + hy * hy;
            drive += (n.z + pair_at(p->n.z, i)) * pair_at(p->drive_at.z, i);
        }
        const number_pair inverse = 1.0 / (p->from.reach + pair_at(p->x, i));
        const number_pair spin = half2 * square * inverse * inverse * inverse;
        pair_put(values, i, spin + half2 * drive);
        pair_put(softening, i, 1.5 * spin * inverse);
    }
    /* -df/dx of the spin, averaged over the step: integral / 2 */
    for (int i = 0; i < points && p->kind == COLLOCATION_SPANNING; ++i) {
        mean += weight[i * points] * softening[i];
    }
    return answer(p, values, mean);
}

/* H' = d n x A */
static double spin_up(struct collocation *p)
{
    const struct vec3_row *a = &p->pull_at;
    const struct vec3 n = vec3_sub(vec3_make(1.0, 0.0, 0.0), p->turned);
    for (int i = 0; i < p->nodes->points; i += 2) {
        const number_pair arm = p->half * (p->from.reach + pair_at(p->x, i));
        const number_pair nx = n.x + pair_at(p->n.x, i);
        const number_pair ny = n.y + pair_at(p->n.y, i);
        pair_put(p->h_rate.z, i, arm * (nx * pair_at(a->y, i) - ny * pair_at(a->x, i)));
        if (!p->planar) {
            const number_pair nz = n.z + pair_at(p->n.z, i);
            pair_put(p->h_rate.x, i, arm * (ny * pair_at(a->z, i) - nz * pair_at(a->y, i)));
            pair_put(p->h_rate.y, i, arm * (nz * pair_at(a->x, i) - nx * pair_at(a->z, i)));
        }
    }
    double change = row_integrate(p->nodes, p->h_rate.z, p->h.z);
    if (!p->planar) {
        change = larger(row_integrate(p->nodes, p->h_rate.x, p->h.x), change);
        change = larger(row_integrate(p->nodes, p->h_rate.y, p->h.y), change);
    }
    return 2.0 * p->half / p->distance * change;
}

/* n' = H x n / d^2 */
static double turn(struct collocation *p)
{
    const struct vec3 n = vec3_sub(vec3_make(1.0, 0.0, 0.0), p->turned);
    const struct vec3 h = vec3_sub(p->momentum, p->spun);
    for (int i = 0; i < p->nodes->points; i += 2) {
        const number_pair d = p->from.reach + pair_at(p->x, i);
        const number_pair by = p->half / (d * d);
        const number_pair nx = n.x + pair_at(p->n.x, i);
        const number_pair ny = n.y + pair_at(p->n.y, i);
        const number_pair hz = h.z + pair_at(p->h.z, i);
        number_pair to_x = -hz * ny;
        number_pair to_y = hz * nx;
        if (!p->planar) {
            const number_pair nz = n.z + pair_at(p->n.z, i);
            const number_pair hx = h.x + pair_at(p->h.x, i);
            const number_pair hy = h.y + pair_at(p->h.y, i);
            to_x += hy * nz;
            to_y -= hx * nz;
            pair_put(p->n_rate.z, i, by * (hx * ny - hy * nx));
        }
        pair_put(p->n_rate.x, i, by * to_x);
        pair_put(p->n_rate.y, i, by * to_y);
    }
    double change =
        larger(row_integrate(p->nodes, p->n_rate.x, p->n.x), row_integrate(p->nodes, p->n_rate.y, p->n.y));
    if (!p->planar) {
        change = larger(row_integrate(p->nodes, p->n_rate.z, p->n.z), change);
    }
    return p->distance * change;
}

/* The load, x that answers, H, n. */
double collocation_sweep(struct collocation *p)
{
    const double by_load = respond(p);
    p->sweeps += 1;
    if (p->straight) {
        return p->kind == COLLOCATION_CREEPING ? by_load : 0.0; /* otherwise the load does not depend on x */
    }
    if (p->kind != COLLOCATION_RESOLVED) {
        const struct collocation_wave wave = collocation_wave_of(p, p->y, p->y_rate, vec3_make(1.0, 0.0, 0.0),
                                                                 p->momentum, p->pull[0], p->distance);
        p->turned = wave.turned;
        p->spun = wave.spun;
    }
    const double by_spin = spin_up(p);
    return larger(by_load, larger(by_spin, turn(p)));
}

static double tail_of(const struct collocation *p, const struct vec3_row *values, bool in_plane, bool across)
{
    double tail = 0.0;
    if (in_plane || !p->planar) {
        tail = larger(row_tail(p->nodes, values->x), row_tail(p->nodes, values->y));
    }
    return across || !p->planar ? larger(row_tail(p->nodes, values->z), tail) : tail;
}

/* Of the integrals: that of a Chebyshev polynomial is smaller by its degree. */
static double tail_of_all(const struct collocation *p)
{
    const int points = p->nodes->points;
    const double of_excess = larger(fabs(p->slow[points - 1]), fabs(p->slow[points - 2]));
    const double size = size_of_excess(p);
    /* The next coefficient is smaller by half a step's radians, two at most, over its number: less than a quarter. */
    const double left_out = 0.25 * ldexp(of_excess, 2 - points);
    const bool creeps = p->kind == COLLOCATION_CREEPING;
    const double by_excess = creeps && size > 0.0 ? left_out * larger(1.0, p->distance / size) : left_out;
    if (p->straight) {
        return by_excess;
    }
    const double by_turn = p->distance * tail_of(p, &p->n_rate, true, false);
    const double by_spin = 2.0 * p->half / p->distance * tail_of(p, &p->h_rate, false, true);
    return larger(by_excess, larger(by_turn, by_spin) / points);
}

static void keep_lead(struct collocation *p)
{
    const struct vec3 n = vec3_sub(vec3_make(1.0, 0.0, 0.0), p->turned);
    lobatto_row values;
    for (int i = 0; i < p->nodes->points; ++i) {
        values[i] = (n.x + p->n.x[i]) * p->lead_at.x[i] + (n.y + p->n.y[i]) * p->lead_at.y[i] +
                    (n.z + p->n.z[i]) * p->lead_at.z[i];
    }
    row_coefficients(p->nodes, values, p->led);
}

/* Numbers all of them, and the centre, where local coordinates end, not reached: d > 0. */
static bool is_sound(const struct collocation *p)
{
    for (int i = 0; i < p->nodes->points; ++i) {
        const double sum = p->n.x[i] + p->n.y[i] + p->n.z[i] + p->h.x[i] + p->h.y[i] + p->h.z[i];
        if (!(p->from.reach + p->x[i] > 0.0) || !isfinite(sum)) {
            return false;
        }
    }
    return true;
}

static void sum_up(struct collocation *p)
{
    const double largest = size_of_excess(p);
    p->terms = p->nodes->points;
    while (p->terms > 1 && fabs(p->slow[p->terms - 1]) <= DBL_EPSILON * DBL_EPSILON * largest) {
        p->terms -= 1;
    }
    p->interior_error = tail_of_all(p);
    if (p->from.leads) {
        keep_lead(p);
    }
}

bool collocation_finish(struct collocation *p, double before, double tolerance)
{
    double gain = 1.0;
    for (int i = p->sweeps; i < MAX_SWEEPS; ++i) {
        const double change = collocation_sweep(p);
        /* A sweep that moved things by so much less than the one before leaves less than that again; H and n take turns at it, so
         * the worse of two says how much. And X, which creeps through several of its decay times, comes in last. */
        const double gain_before = gain;
        gain = before > 0.0 && p->kind != COLLOCATION_CREEPING ? fmin(1.0, change / before) : 1.0;
        if (change * fmax(gain, gain_before) <= tolerance) {
            sum_up(p);
            return is_sound(p);
        }
        before = change;
    }
    return false;
}

bool collocation_make(struct collocation *p, const struct collocation_problem *from, double step,
                      enum collocation_kind kind, const struct lobatto *nodes, double tolerance)
{
    collocation_begin(p, from, step, kind, nodes);
    collocation_size(p, step);
    return collocation_finish(p, 0.0, tolerance);
}
