#include "segment/collocation.h"
#include "segment/collocation_turning.h"

#include <float.h>
#include <string.h>

#include "math/compiler.h"

/* Sweep k multiplies the error by about 1/k of the radians of tangential motion in the step, some two. Where
 * more sweeps than this are needed, a shorter step costs less. */
enum { MAX_SWEEPS = 30 };

/* Rounding of coefficients relative to the values: sums with factors up to 611 (lobatto_monomial). */
static const double COEFFICIENT_ROUNDING = 1e-12;

static double larger(double a, double b)
{
    return a > b ? a : b;
}

/* x = s + y: s is the particular solution for the load, y the free oscillation from the start values. */
static void oscillator_response(struct collocation *p, double softening)
{
    const int points = p->nodes->points;
    oscillator_particular(&p->result.oscillator, p->result.load, p->result.slow, points);
    nodal_values_of(p->nodes, p->result.slow, p->result.x);
    p->result.oscillator.omega2 += softening;
    p->result.y = p->from.deviation - p->result.x[0];
    p->result.y_rate = p->half * p->local.rate.x - nodal_slope(p->result.slow, points, 0.0);
    for (int i = 0; i < points && p->kind == COLLOCATION_RESOLVED; i += LANES) {
        const double2 y = p->result.y * double2_at(p->result.y_of_y, i) +
                          p->result.y_rate * double2_at(p->result.y_of_rate, i);
        double2_put(p->result.x, i, double2_at(p->result.x, i) + y);
    }
}

/* (D + slower)(D + faster) x = load with D = d/ds. u = (D + slower) x is the particular solution of (D +
 * faster) u = load, plus a fast decay, which is y. X is then the integral of X' = u - slower X. */
static void overdamped_response(struct collocation *p)
{
    const int points = p->nodes->points;
    const struct oscillator_rates rates = oscillator_rates_of(&p->result.oscillator);
    nodal_values u;
    nodal_values u_at_nodes;
    nodal_values rate = {0.0};
    relaxation_particular(rates.faster, p->result.load, u, points);
    nodal_values_of(p->nodes, u, u_at_nodes);
    const double fast = p->half * p->local.rate.x + rates.slower * p->from.deviation - u_at_nodes[0];
    p->result.y = -fast / (rates.faster - rates.slower);
    p->result.y_rate = -rates.faster * p->result.y;
    for (int i = 0; i < points; ++i) {
        rate[i] = u_at_nodes[i] - rates.slower * p->result.x[i];
    }
    (void)nodal_integrate(p->nodes, rate, p->result.x);
    for (int i = 0; i < points; ++i) {
        p->result.x[i] += p->from.deviation - p->result.y;
    }
    nodal_coefficients(p->nodes, p->result.x, p->result.slow);
}

/* The largest that x comes to in the step, roughly [m]. */
static double size_of_deviation(const struct collocation *p)
{
    double largest = fabs(p->result.y) + fabs(p->result.y_rate);
    for (int k = 0; k < p->nodes->points; ++k) {
        largest = larger(fabs(p->result.slow[k]), largest);
    }
    return largest;
}

/* Solves for x under the load; returns the largest change of a coefficient [m], scaled as if x were as large
 * as d: the force follows from x and is to be as accurate relative to itself as the position is. */
static double apply_load(struct collocation *p, const double *values, double softening)
{
    nodal_values before;
    double change = 0.0;
    memcpy(before, p->result.slow, sizeof before);
    p->result.oscillator =
        (struct oscillator){p->from.omega2 * p->half * p->half, p->from.damping_rate * p->half};
    nodal_coefficients(p->nodes, values, p->result.load);
    if (p->kind == COLLOCATION_OVERDAMPED) {
        overdamped_response(p);
    } else {
        oscillator_response(p, p->kind == COLLOCATION_AVERAGED ? softening : 0.0);
    }
    for (int i = 0; i < p->nodes->points; ++i) {
        change = larger(fabs(p->result.slow[i] - before[i]), change);
    }
    const double size = size_of_deviation(p);
    return change > COEFFICIENT_ROUNDING * size ? change * fmax(1.0, p->local.distance / size) : 0.0;
}

/* The load f at the nodes, then x under it. */
static double update_load(struct collocation *p)
{
    const int points = p->nodes->points;
    const double *weight = p->nodes->integral + points - 1;
    nodal_values values;
    nodal_values softening;
    double mean = 0.0;
    collocation_load(p, values, softening);
    /* the softening averaged over the step: half its integral over s */
    for (int i = 0; i < points && p->kind == COLLOCATION_AVERAGED; ++i) {
        mean += weight[i * points] * softening[i];
    }
    return apply_load(p, values, mean);
}

/* One Gauss-Seidel sweep: the load f, x, H, n. */
double collocation_sweep(struct collocation *p)
{
    const double by_load = update_load(p);
    p->work.sweeps += 1;
    if (p->local.head_on) {
        /* otherwise the load does not depend on x */
        return p->kind == COLLOCATION_OVERDAMPED ? by_load : 0.0;
    }
    return larger(by_load, collocation_turn(p));
}

static double tail_of(const struct collocation *p, const struct nodal_vec3 *values, bool in_plane,
                      bool across)
{
    double tail = 0.0;
    if (in_plane || !p->local.planar) {
        tail = larger(nodal_tail(p->nodes, values->x), nodal_tail(p->nodes, values->y));
    }
    return across || !p->local.planar ? larger(nodal_tail(p->nodes, values->z), tail) : tail;
}

/* The last coefficients of what is integrated; integrals of Chebyshev polynomials are smaller by the
 * degree. */
static double tail_of_all(const struct collocation *p)
{
    const int points = p->nodes->points;
    const double of_deviation = larger(fabs(p->result.slow[points - 1]), fabs(p->result.slow[points - 2]));
    const double size = size_of_deviation(p);
    /* Ratio of the first omitted coefficient to the last: half the step's radians, two at most, over its
     * index, less than a quarter. */
    const double left_out = 0.25 * ldexp(of_deviation, 2 - points);
    const bool is_overdamped = p->kind == COLLOCATION_OVERDAMPED;
    const double by_deviation =
        is_overdamped && size > 0.0 ? left_out * larger(1.0, p->local.distance / size) : left_out;
    if (p->local.head_on) {
        return by_deviation;
    }
    const double by_normal = p->local.distance * tail_of(p, &p->result.n_rate, true, false);
    const double by_momentum = 2.0 * p->half / p->local.distance * tail_of(p, &p->result.h_rate, false, true);
    return larger(by_deviation, larger(by_normal, by_momentum) / points);
}

/* Whether all values are finite and d > 0: local coordinates end at the centre. */
static bool is_sound(const struct collocation *p)
{
    for (int i = 0; i < p->nodes->points; ++i) {
        const double sum = p->result.n.x[i] + p->result.n.y[i] + p->result.n.z[i] + p->result.h.x[i] +
                           p->result.h.y[i] + p->result.h.z[i];
        if (!(p->from.reach + p->result.x[i] > 0.0) || !isfinite(sum)) {
            return false;
        }
    }
    return true;
}

static void sum_up(struct collocation *p)
{
    /* without the rate: of a stiff contact it has many digits more than x */
    double largest = fabs(p->result.y);
    for (int k = 0; k < p->nodes->points; ++k) {
        largest = larger(fabs(p->result.slow[k]), largest);
    }
    p->result.terms = p->nodes->points;
    while (p->result.terms > 1 &&
           fabs(p->result.slow[p->result.terms - 1]) <= DBL_EPSILON * DBL_EPSILON * largest) {
        p->result.terms -= 1;
    }
    p->result.interior_error = tail_of_all(p);
    if (p->from.has_mismatch) {
        collocation_keep_mismatch(p);
    }
    collocation_keep_tilt(p);
}

bool collocation_finish(struct collocation *p, double before, double tolerance)
{
    double gain = 1.0;
    for (int i = p->work.sweeps; i < MAX_SWEEPS; ++i) {
        const double change = collocation_sweep(p);
        /* The error left is about change * gain, the factor by which the last sweep converged. H and n
         * converge in turn: the larger of two factors counts. None where overdamped: X converges last. */
        const double gain_before = gain;
        gain = before > 0.0 && p->kind != COLLOCATION_OVERDAMPED ? fmin(1.0, change / before) : 1.0;
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
