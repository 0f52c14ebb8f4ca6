#include <string.h>

#include "contact/choices.h"
#include "math/compiler.h"
#include "math/lu.h"
#include "math/series.h"
#include "touch/collocation.h"

static struct vec3 at_row(const struct nodal_vec3 *row, int i)
{
    return vec3_make(row->x[i], row->y[i], row->z[i]);
}

/* Returns A in the frame at s [m/s^2]. */
static struct vec3 acceleration_then(const struct collocation *p, double s)
{
    return path_at(p->from.acceleration, COLLOCATION_ACCELERATION_TERMS, p->half * s);
}

/* Returns the integral of y over time, expressed by the present y and y' [m s]. */
static double collocation_oscillation_integral(const struct collocation *p, double y, double y_rate)
{
    /* y of an overdamped step decays by y' = -faster y, with or without a spring */
    const double integral =
        p->kind == COLLOCATION_OVERDAMPED
            ? -y / oscillator_rates_of(&p->result.oscillator).faster
            : -(y_rate + p->result.oscillator.damping_rate * y) / p->result.oscillator.omega2;
    return p->half * integral;
}

/* How n and H turn, in the coordinates of rim.h: n.x and n.y are the changes of azimuth and tilt, h.x and h.y
 * those of their momenta. */

/* Returns the state at a rim from the changes n of the angles and h of their momenta, and from x. */
static struct rim_state rim_state_by(const struct collocation *p, struct vec3 n, struct vec3 h, double x)
{
    const double change[4] = {n.x, n.y, h.x, h.y};
    return rim_state_of(&p->from.rim, change, x - p->from.deviation, rim_angles_of(&p->from.rim, n.x, n.y));
}

static struct rim_state rim_state_at_start(const struct collocation *p)
{
    const struct vec3 zero = {0.0, 0.0, 0.0};
    return rim_state_by(p, zero, zero, p->from.deviation);
}

static struct rim_state rim_state_at_node(const struct collocation *p, int i)
{
    const double change[4] = {p->result.n.x[i] - p->result.normal_correction.x,
                              p->result.n.y[i] - p->result.normal_correction.y,
                              p->result.h.x[i] - p->result.momentum_correction.x,
                              p->result.h.y[i] - p->result.momentum_correction.y};
    return rim_state_of(&p->from.rim, change, p->result.x[i] - p->from.deviation, p->angles[i]);
}

/* Notes the angles' cosines and sines at the nodes, which last until the next sweep. */
static void note_angles(struct collocation *p)
{
    for (int i = 0; i < p->nodes->points; ++i) {
        p->angles[i] = rim_angles_of(&p->from.rim, p->result.n.x[i] - p->result.normal_correction.x,
                                     p->result.n.y[i] - p->result.normal_correction.y);
    }
}

/* Returns the derivatives of the rates with respect to d times the integral of y. */
static struct collocation_correction correction_of(const struct collocation *p, const struct rim_state *at,
                                                   struct vec3 acceleration, double y, double y_rate)
{
    const double by = collocation_oscillation_integral(p, y, y_rate);
    double slopes[4];
    rim_slopes_by_distance(&p->from.rim, at, acceleration, slopes);
    return (struct collocation_correction){vec3_make(by * slopes[0], by * slopes[1], 0.0),
                                           vec3_make(by * slopes[2], by * slopes[3], 0.0)};
}

static double load_at_start(const struct collocation *p)
{
    const struct rim_state at = rim_state_at_start(p);
    return rim_slopes_at(&at, p->from.acceleration[0]).load;
}

/* Sets `values` to the load f times half^2 [m] at the nodes, and `softening` to half of -half^2 df/dx by the
 * centrifugal terms. */
static void put_load(const struct collocation *p, double *values, double *softening)
{
    const double half2 = p->half * p->half;
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct rim_state at = rim_state_at_node(p, i);
        const struct rim_slopes slopes = rim_slopes_at(&at, at_row(&p->acceleration_at, i));
        const double spin = slopes.azimuth * at.by.cosine;
        values[i] = half2 * slopes.load;
        softening[i] = 1.5 * half2 * (spin * spin + slopes.tilt * slopes.tilt);
    }
}

/* Integrates the nodal values of two coordinates from their rates; returns the largest change. In a plane
 * motion one of them rests. */
static double integrate_two(const struct collocation *p, const struct nodal_vec3 *rate,
                            struct nodal_vec3 *sum)
{
    const double *const rates[2] = {rate->x, rate->y};
    double *const sums[2] = {sum->x, sum->y};
    double change = 0.0;
    for (int k = 0; k < 2; ++k) {
        bool rests = true;
        for (int i = 0; i < p->nodes->points; ++i) {
            rests = rests && rates[k][i] == 0.0;
        }
        change = rests ? change : larger(nodal_integrate(p->nodes, rates[k], sums[k]), change);
    }
    return change;
}

/* Makes one sweep of n and H, at the x that the nodes have; returns the largest change [m]. */
CONTACT_FLATTEN static double turn(struct collocation *p)
{
    if (p->from.head_on) {
        return 0.0;
    }
    const double distance = p->from.rim.distance;
    const double scale = p->from.rim.rho / distance;
    const struct rim_state start = rim_state_at_start(p);
    const struct collocation_correction correction =
        correction_of(p, &start, p->from.acceleration[0], p->result.y, p->result.y_rate);
    p->result.normal_correction = correction.normal;
    p->result.momentum_correction = correction.momentum;
    nodal_values per_rho_squared;
    nodal_values per_d_squared;
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct rim_state at = rim_state_at_node(p, i);
        const struct rim_slopes slopes = rim_slopes_at(&at, at_row(&p->acceleration_at, i));
        p->result.h_rate.x[i] = p->half * slopes.azimuth_momentum / scale;
        p->result.h_rate.y[i] = p->half * slopes.tilt_momentum;
        per_rho_squared[i] = 1.0 / (at.rho * at.rho);
        per_d_squared[i] = 1.0 / (at.d * at.d);
    }
    const double by_momentum = 2.0 * p->half / distance * integrate_two(p, &p->result.h_rate, &p->result.h);
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct vec3 h = vec3_sub(at_row(&p->result.h, i), p->result.momentum_correction);
        p->result.n_rate.x[i] =
            p->half * scale * (p->from.rim.azimuth_momentum + scale * h.x) * per_rho_squared[i];
        p->result.n_rate.y[i] = p->half * (p->from.rim.tilt_momentum + h.y) * per_d_squared[i];
    }
    const double by_normal = distance * integrate_two(p, &p->result.n_rate, &p->result.n);
    note_angles(p);
    return fmax(by_momentum, by_normal);
}

/* A step turns by about two radians of tangential motion. Sweep k multiplies the error by about these radians
 * divided by k. A shorter step costs less than more sweeps. */
enum { MAX_SWEEPS = 30 };

/* Rounding of the coefficients relative to the nodal values: a coefficient is a sum of nodal values with
 * factors up to 611 (lobatto.monomial). */
static const double COEFFICIENT_ROUNDING = 1e-12;

/* Returns the part by Hertz's spring of d2x/ds2 at a node [m]: half^2 side (k_h / m_red) delta^(3/2). */
static double hertz_push(const struct collocation *p, int i)
{
    const double depth = -p->from.side * p->result.x[i];
    return p->half * p->half * p->from.side * p->from.hertz * depth * sqrt(depth);
}

/* Makes the oscillator and the load of an averaged step under Hertz's law: the oscillator has the mean slopes
 * of the force at the nodes, and the load gets what the force differs from that of the oscillator. */
static void linearize(struct collocation *p, double *load)
{
    const int points = p->nodes->points;
    const double chi = p->from.side * p->from.chi / p->half;
    struct oscillator mean = {0.0, 0.0};
    nodal_values rate;
    for (int i = 0; i < points; ++i) {
        const double push = hertz_push(p, i);
        rate[i] = nodal_slope(p->result.slow, points, 1.0 + p->nodes->node[i]);
        load[i] += push * (1.0 - chi * rate[i]);
        mean.omega2 -= 1.5 * push / p->result.x[i] * (1.0 - chi * rate[i]) / points;
        mean.damping_rate += push * chi / points;
    }
    for (int i = 0; i < points; ++i) {
        load[i] += mean.omega2 * p->result.x[i] + mean.damping_rate * rate[i];
    }
    p->result.oscillator = mean;
}

/* x = s + y: s is the particular solution for the load, y the free oscillation from the start values. */
static void oscillator_response(struct collocation *p, double softening)
{
    const int points = p->nodes->points;
    oscillator_particular(&p->result.oscillator, p->result.load, p->result.slow, points);
    nodal_values_of(p->nodes, p->result.slow, p->result.x);
    p->result.oscillator.omega2 += softening;
    p->result.y = p->from.deviation - p->result.x[0];
    p->result.y_rate = p->half * p->from.radial - nodal_slope(p->result.slow, points, 0.0);
}

/* (D + slower)(D + faster) x = load with D = d/ds. u = (D + slower) x is the particular solution of (D +
 * faster) u = load plus a fast decay, which is y. X is the integral of X' = u - slower X. */
static void overdamped_response(struct collocation *p)
{
    const int points = p->nodes->points;
    const struct oscillator_rates rates = oscillator_rates_of(&p->result.oscillator);
    nodal_values u;
    nodal_values u_at_nodes;
    nodal_values rate = {0.0};
    relaxation_particular(rates.faster, p->result.load, u, points);
    nodal_values_of(p->nodes, u, u_at_nodes);
    const double fast = p->half * p->from.radial + rates.slower * p->from.deviation - u_at_nodes[0];
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

/* Columns of the matrix below have room for the zeros behind them (lu.h). */
enum { CREEP_STRIDE = LOBATTO_MAX + LANES };

/* Solves x = x(0) + integral of x' for x at the nodes by a step of Newton's method, where x' is `rate` at the
 * present x and has the derivative -slope[j] with respect to it. */
static void follow_rate(struct collocation *p, const double *rate, const double *slope)
{
    const int points = p->nodes->points;
    double at[LOBATTO_MAX * CREEP_STRIDE] = {0.0};
    double missing[CREEP_STRIDE] = {0.0};
    int pivot[LOBATTO_MAX];
    const struct lu_matrix system = {points, CREEP_STRIDE, at, pivot};
    (void)nodal_integrate(p->nodes, rate, missing);
    for (int j = 0; j < points; ++j) {
        missing[j] += p->from.deviation - p->result.x[j];
        for (int i = 0; i < points; ++i) {
            at[j * CREEP_STRIDE + i] = p->nodes->integral[j * points + i] * slope[j] + (i == j ? 1.0 : 0.0);
        }
    }
    if (lu_factor(system)) {
        lu_solve(system, missing);
    }
    for (int i = 0; i < points; ++i) {
        p->result.x[i] += missing[i];
    }
}

/* An overdamped step under Hertz's law. The rate v = dx/ds follows from v + v'/decay = (load + push) / decay,
 * where `push` is the spring's part of the force and `decay` the fast decay's rate, both by the depth. The
 * left side is solved with the mean of 1/decay. The rest of v'/decay is taken from the last sweep. y is the
 * fast decay, by which v misses the rate of the start. */
static void creeping_response(struct collocation *p, const double *load)
{
    const int points = p->nodes->points;
    nodal_values right = {0.0};
    nodal_values bend;
    nodal_values slope;
    double inverse = 0.0; /* mean of 1/decay */
    for (int i = 0; i < points; ++i) {
        const double push = hertz_push(p, i);
        const double decay = p->from.chi / p->half * fabs(push);
        double x[4];
        nodal_derivatives(p->result.slow, points, 1.0 + p->nodes->node[i], x);
        bend[i] = x[2];
        right[i] = (load[i] + push - bend[i]) / decay;
        slope[i] = 1.5 * load[i] / (decay * p->result.x[i]);
        inverse += 1.0 / (decay * points);
    }
    for (int i = 0; i < points; ++i) {
        right[i] = right[i] / inverse + bend[i];
    }
    nodal_values rate;
    nodal_values a;
    nodal_coefficients(p->nodes, right, a);
    relaxation_particular(1.0 / inverse, a, a, points);
    nodal_values_of(p->nodes, a, rate);
    p->result.y_rate = p->half * p->from.radial - rate[0];
    p->result.y = -p->result.y_rate * inverse;
    follow_rate(p, rate, slope);
    nodal_coefficients(p->nodes, p->result.x, p->result.slow);
}

/* Returns a rough bound of |x| in the step [m]. */
static double size_of_deviation(const struct collocation *p)
{
    double largest = fabs(p->result.y) + fabs(p->result.y_rate);
    for (int k = 0; k < p->nodes->points; ++k) {
        largest = larger(fabs(p->result.slow[k]), largest);
    }
    return largest;
}

/* Solves for x under the load. Returns the largest change of a coefficient [m], scaled up as if x were as
 * large as d. The force, which follows from x, thereby gets the relative accuracy of the position. */
static double apply_load(struct collocation *p, const double *values, double softening)
{
    nodal_values before;
    double change = 0.0;
    memcpy(before, p->result.slow, sizeof before);
    nodal_coefficients(p->nodes, values, p->result.load);
    if (CONTACT_ANY_HERTZ && p->from.hertz > 0.0 && p->kind == COLLOCATION_OVERDAMPED) {
        creeping_response(p, values);
    } else if (p->kind == COLLOCATION_OVERDAMPED) {
        overdamped_response(p);
    } else {
        oscillator_response(p, softening);
    }
    for (int i = 0; i < p->nodes->points; ++i) {
        change = larger(fabs(p->result.slow[i] - before[i]), change);
    }
    const double size = size_of_deviation(p);
    return change > COEFFICIENT_ROUNDING * size ? change * fmax(1.0, p->from.rim.distance / size) : 0.0;
}

/* Updates the load f at the nodes, then x under this load. */
static double update_load(struct collocation *p)
{
    const int points = p->nodes->points;
    const double *weight = p->nodes->integral + points - 1;
    nodal_values values = {0.0};
    nodal_values softening;
    double mean = 0.0;
    put_load(p, values, softening);
    p->result.oscillator =
        (struct oscillator){p->from.omega2 * p->half * p->half, p->from.damping_rate * p->half};
    if (CONTACT_ANY_HERTZ && p->from.hertz > 0.0 && p->kind == COLLOCATION_AVERAGED) {
        linearize(p, values);
    }
    /* the mean of -half^2 df/dx over the step is half its integral over s, which is the integral of
     * `softening` */
    for (int i = 0; i < points && p->kind == COLLOCATION_AVERAGED; ++i) {
        mean += weight[i * points] * softening[i];
    }
    return apply_load(p, values, mean);
}

/* Makes one Gauss-Seidel sweep, which updates the load f, x, H and n in this order. */
static double sweep(struct collocation *p)
{
    const double by_load = update_load(p);
    /* a head-on load does not depend on x under the linear law, but an overdamped X is iterated */
    const bool is_solved = p->from.head_on && p->kind != COLLOCATION_OVERDAMPED && p->from.hertz == 0.0;
    return is_solved ? 0.0 : larger(by_load, turn(p));
}

static double tail_of(const struct collocation *p, const struct nodal_vec3 *values)
{
    return larger(nodal_tail(p->nodes, values->x), nodal_tail(p->nodes, values->y));
}

/* Estimates the error from the last coefficients of the integrands. The integral of a Chebyshev polynomial is
 * smaller than the polynomial by a factor of its degree. */
static double tail_of_all(struct collocation *p)
{
    const int points = p->nodes->points;
    const double of_deviation = larger(fabs(p->result.slow[points - 1]), fabs(p->result.slow[points - 2]));
    const double size = size_of_deviation(p);
    /* the first omitted coefficient is less than a quarter of the last one: their ratio is half the step's
     * radians, two at most, divided by the index */
    const double left_out = 0.25 * ldexp(of_deviation, 2 - points);
    const bool is_overdamped = p->kind == COLLOCATION_OVERDAMPED && p->from.hertz == 0.0;
    p->result.deviation_error = left_out;
    const double by_deviation =
        is_overdamped && size > 0.0 ? left_out * larger(1.0, p->from.rim.distance / size) : left_out;
    if (p->from.head_on) {
        return by_deviation;
    }
    const double by_normal = p->from.rim.distance * tail_of(p, &p->result.n_rate);
    const double by_momentum = 2.0 * p->half / p->from.rim.distance * tail_of(p, &p->result.h_rate);
    return larger(by_deviation, larger(by_normal, by_momentum) / points);
}

/* Returns whether all values are finite and d > 0, because local coordinates are singular at the centre. */
static bool finish(struct collocation *p)
{
    if (CONTACT_ANY_CIRCLE && p->from.at_rim) {
        nodal_coefficients(p->nodes, p->result.n_rate.y, p->result.tilt_rate);
    }
    for (int i = 0; i < p->nodes->points; ++i) {
        const double sum = p->result.n.x[i] + p->result.n.y[i] + p->result.h.x[i] + p->result.h.y[i];
        if (!(p->from.reach + p->result.x[i] > 0.0) || !isfinite(sum)) {
            return false;
        }
    }
    return true;
}

/* Iterates to convergence; returns whether the result is within `tolerance` and sound. */
static bool iterate(struct collocation *p, double tolerance)
{
    double before = 0.0;
    double gain = 1.0;
    for (int i = 0; i < MAX_SWEEPS; ++i) {
        const double change = sweep(p);
        /* The error left is about change * gain, where gain is the factor by which the last sweep converged.
         * H and n converge in turn, so the larger of the last two factors counts. X of an overdamped step
         * converges after H and n, so no factor is used there. */
        const double gain_before = gain;
        gain = before > 0.0 && p->kind != COLLOCATION_OVERDAMPED ? fmin(1.0, change / before) : 1.0;
        if (change * fmax(gain, gain_before) <= tolerance) {
            p->result.interior_error = tail_of_all(p);
            return finish(p);
        }
        before = change;
    }
    return false;
}

/* Returns the change of n or H since the start, from its nodal values and rates, without the part by y at the
 * start. */
static struct vec3 integral_then(const struct collocation *p, const struct nodal_vec3 *values,
                                 const struct nodal_vec3 *rate, struct vec3 correction, double s)
{
    const struct vec3 all = {nodal_integral_to(p->nodes, values->x, rate->x, s),
                             nodal_integral_to(p->nodes, values->y, rate->y, s), 0.0};
    return vec3_sub(all, correction);
}

/* Returns the state at s. The caller passes x of collocation_deviation, or the averaged x. */
static struct rim_state rim_state_then(const struct collocation *p, double s, const double x[4])
{
    const struct vec3 n = integral_then(p, &p->result.n, &p->result.n_rate, p->result.normal_correction, s);
    const struct vec3 h = integral_then(p, &p->result.h, &p->result.h_rate, p->result.momentum_correction, s);
    double slow[4];
    collocation_averaged_deviation(p, s, slow);
    const struct rim_state then = rim_state_by(p, n, h, x[0]);
    const struct collocation_correction correction =
        correction_of(p, &then, acceleration_then(p, s), x[0] - slow[0], x[1] - slow[1]);
    return rim_state_by(p, vec3_add(n, correction.normal), vec3_add(h, correction.momentum), x[0]);
}

struct collocation_change collocation_change_at(const struct collocation *p, double s)
{
    const struct vec3 none = {0.0, 0.0, 0.0};
    double x[4];
    collocation_deviation(p, s, x);
    const struct rim_state then =
        p->from.head_on ? rim_state_by(p, none, none, x[0]) : rim_state_then(p, s, x);
    return (struct collocation_change){rim_moved(&p->from.rim, &then),
                                       rim_gained(&p->from.rim, &then, p->from.radial, x[1] / p->half), x[0]};
}

void collocation_edges(const struct collocation *p, double s, const double x[4], double radial[3],
                       double axial[3])
{
    double tilt[3] = {p->from.rim.tilt, 0.0, 0.0};
    if (!p->from.head_on) {
        const int points = p->nodes->points;
        tilt[0] += nodal_integral(p->result.tilt_rate, points, s) - p->result.normal_correction.y;
        tilt[1] = taylor_at(p->result.tilt_rate, points, s - 1.0);
        tilt[2] = nodal_slope(p->result.tilt_rate, points, s);
        /* the oscillation y changes the tilt, too: see correction_of */
        double slow[4];
        collocation_averaged_deviation(p, s, slow);
        const double by = -2.0 * tilt[1] / (p->from.reach + x[0]);
        const double y = x[0] - slow[0];
        const double y_rate = x[1] - slow[1];
        tilt[0] += by * collocation_oscillation_integral(p, y, y_rate) / p->half;
        tilt[1] += by * y;
        tilt[2] += by * y_rate;
    }
    rim_edges(tilt, p->from.reach, radial, axial);
}

/* Dense output of a collocated step. */

void collocation_averaged_deviation(const struct collocation *p, double s, double x[4])
{
    nodal_derivatives(p->result.slow, p->nodes->points, s, x);
}

/* Adds y and its derivatives with respect to s to x and its derivatives. */
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
    collocation_averaged_deviation(p, s, x);
    const struct oscillator_basis by = oscillator_basis_at(&p->result.oscillator, s);
    add_oscillation(p, p->result.y * by.y_of_y + p->result.y_rate * by.y_of_rate,
                    p->result.y * by.rate_of_y + p->result.y_rate * by.rate_of_rate, x);
}

void collocation_overdamped_push(const struct collocation *p, double s, double push[3])
{
    const int points = p->nodes->points;
    nodal_values bend;
    double of_bend[4];
    double of_load[4];
    for (int k = 0; k < points; ++k) {
        bend[k] = k + 2 < points ? (k + 1) * (k + 2) * p->result.slow[k + 2] : 0.0;
    }
    nodal_derivatives(bend, points, s, of_bend);
    nodal_derivatives(p->result.load, points, s, of_load);
    const double faster = oscillator_rates_of(&p->result.oscillator).faster;
    double fast = p->result.y * exp(-faster * s) * faster * faster;
    for (int i = 0; i < 3; ++i) {
        push[i] = of_bend[i] + fast - of_load[i];
        fast *= -faster;
    }
}

/* Returns the integral from 0 to s of the polynomial `a` times (x - y)'. The nodes' quadrature is exact for
 * products of two polynomials. */
static double along_slow(const struct collocation *p, const double *a, double s)
{
    const int points = p->nodes->points;
    double sum = 0.0;
    for (int i = 0; i < points; ++i) {
        const double at = 0.5 * s * (1.0 + p->nodes->node[i]);
        const double part = taylor_at(a, points, at - 1.0) * nodal_slope(p->result.slow, points, at);
        sum += 0.5 * s * p->nodes->integral[i * points + points - 1] * part;
    }
    return sum;
}

/* Returns the integral of the polynomial `a` times y' from 0 to s, in closed form. With a spring (Q y + Q' y'
 * / omega2)' = a y' where Q + Q'' / omega2 - damping_rate Q' / omega2 = a. A single decay has (Q y)' = a y'
 * where Q - Q' / faster = a. */
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
        return taylor_at(q, points, s - 1.0) * y - taylor_at(q, points, -1.0) * p->result.y;
    }
    oscillator_particular(&mirrored, scaled, q, points);
    return taylor_at(q, points, s - 1.0) * y + nodal_slope(q, points, s) * y_rate / mirrored.omega2 -
           (taylor_at(q, points, -1.0) * p->result.y +
            nodal_slope(q, points, 0.0) * p->result.y_rate / mirrored.omega2);
}

/* The dissipated energy follows from the oscillator's balance of energy, which is exact at any frequency:
 * damping_rate x'^2 = -(x'^2 / 2 + omega2 x^2 / 2)' + f x'. */
double collocation_dissipated(const struct collocation *p, double s)
{
    const double omega2 = p->from.omega2 * p->half * p->half;
    const double softening = p->result.oscillator.omega2 - omega2;
    double x[4];
    double slow[4];
    collocation_deviation(p, s, x);
    collocation_averaged_deviation(p, s, slow);
    const double start_rate = p->half * p->from.radial;
    const double x0 = p->from.deviation;
    const double y = x[0] - slow[0];
    const double dissipated_energy =
        0.5 * ((start_rate - x[1]) * (start_rate + x[1]) + omega2 * (x0 - x[0]) * (x0 + x[0]) +
               softening * (p->result.y - y) * (p->result.y + y));
    const double sum = dissipated_energy + along_slow(p, p->result.load, s) +
                       along_oscillation(p, p->result.load, s, y, x[1] - slow[1]);
    return sum / (p->half * p->half);
}

/* The integral from 0 to s of b y with b given by `values` at the nodes, by parts: with B' = b, (B y)' - B y'
 * = b y. */
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
    return taylor_at(b, points, s - 1.0) * y - along_oscillation(p, b, s, y, x[1] - slow[1]);
}

struct vec3 collocation_moment(const struct collocation *p, int power, double s)
{
    struct nodal_vec3 of = {.x = {0.0}};
    struct nodal_vec3 along = {.x = {0.0}}; /* the factor of y */
    double *rows[3][2] = {{of.x, along.x}, {of.y, along.y}, {of.z, along.z}};
    double sum[3];
    for (int i = 0; i < p->nodes->points; ++i) {
        const double t = p->half * (1.0 + p->nodes->node[i]);
        const double weight = p->half * (power == 0 ? 1.0 : power == 1 ? t : t * t);
        const struct rim_state at = rim_state_at_node(p, i); /* without the oscillation */
        nodal_put_vec3(&of, i, vec3_scale(weight, rim_moved(&p->from.rim, &at)));
        nodal_put_vec3(&along, i, vec3_scale(weight, rim_normal(&at)));
    }
    for (int k = 0; k < 3; ++k) {
        nodal_values a;
        nodal_coefficients(p->nodes, rows[k][0], a);
        sum[k] = nodal_integral(a, p->nodes->points, s) + moment_of_oscillation(p, rows[k][1], s);
    }
    return vec3_from(sum);
}

/* Makes first guesses: n and H as at the start, and a constant x, which is its start, or its equilibrium in
 * an averaged step under the linear law. */
static void begin(struct collocation *p, const struct collocation_problem *from, double step,
                  enum collocation_kind kind)
{
    p->from = *from;
    p->nodes = &lobatto[LOBATTO_TWELVE];
    p->kind = kind;
    p->half = 0.5 * step;
    p->result.normal_correction = p->result.momentum_correction = vec3_make(0.0, 0.0, 0.0);
    memset(p->result.tilt_rate, 0, sizeof p->result.tilt_rate);
    memset(&p->result.n, 0, sizeof p->result.n);
    memset(&p->result.h, 0, sizeof p->result.h);
    memset(p->result.slow, 0, sizeof p->result.slow);
    p->result.slow[0] = kind == COLLOCATION_AVERAGED && from->hertz == 0.0 ? load_at_start(p) / from->omega2
                                                                           : from->deviation;
    p->result.y = from->deviation - p->result.slow[0];
    p->result.y_rate = p->half * p->from.radial;
    note_angles(p);
    for (int i = 0; i < p->nodes->points; ++i) {
        p->result.x[i] = p->result.slow[0];
        nodal_put_vec3(&p->acceleration_at, i, acceleration_then(p, 1.0 + p->nodes->node[i]));
    }
}

bool collocation_make(struct collocation *p, const struct collocation_problem *from, double step,
                      enum collocation_kind kind, double tolerance)
{
    begin(p, from, step, kind);
    return iterate(p, tolerance);
}
