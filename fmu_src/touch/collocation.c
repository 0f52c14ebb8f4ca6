#include <string.h>

#include "contact/choices.h"
#include "math/compiler.h"
#include "math/lu.h"
#include "math/series.h"
#include "touch/collocation.h"

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

/* How n and H turn, in the coordinates of rim.h. */

/* Returns the state at a rim from the changes of n and H, and from x. */
static struct rim_state rim_state_by(const struct collocation *p, const double change[COLLOCATION_CHANGES],
                                     double x)
{
    return rim_state_of(&p->from.rim, change, x - p->from.deviation,
                        rim_angles_of(&p->from.rim, change[0], change[1]));
}

static struct rim_state rim_state_at_node(const struct collocation *p, int i)
{
    double change[COLLOCATION_CHANGES];
    for (int k = 0; k < COLLOCATION_CHANGES; ++k) {
        change[k] = p->result.change[k][i] - p->result.correction[k];
    }
    return rim_state_of(&p->from.rim, change, p->result.x[i] - p->from.deviation, p->angles[i]);
}

/* Notes the angles' cosines and sines at the nodes, which last until the next sweep. */
static void note_angles(struct collocation *p)
{
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        p->angles[i] = rim_angles_of(&p->from.rim, p->result.change[0][i] - p->result.correction[0],
                                     p->result.change[1][i] - p->result.correction[1]);
    }
}

/* Adds what an oscillation y adds to the changes of n and H at constant load, acceleration and d. y changes
 * their rates by P y, where P varies slowly. The integral of P y is -P (y' + damping_rate y) / omega2, up to
 * terms smaller by the ratio of the slow rate to the oscillation's. */
static void add_correction(const struct collocation *p, const struct rim_state *at, struct vec3 acceleration,
                           double y, double y_rate, double change[COLLOCATION_CHANGES])
{
    const double by = collocation_oscillation_integral(p, y, y_rate);
    double slopes[COLLOCATION_CHANGES];
    rim_slopes_by_distance(at, acceleration, slopes);
    for (int k = 0; k < COLLOCATION_CHANGES; ++k) {
        change[k] += by * slopes[k];
    }
}

/* Returns how far a unit of one change moves the centre in the step: rho or d for an angle [m], and the step
 * divided by these lengths for a momentum [s/m]. */
static double length_of(const struct collocation *p, int k)
{
    const double length = k % COLLOCATION_ANGLES == 0 ? p->from.rim.rho : p->from.rim.distance;
    return k < COLLOCATION_ANGLES ? length : 2.0 * p->half / length;
}

/* Integrates a change at the nodes from its rate; returns the largest difference to the last sweep [m]. */
static double integrate_change(struct collocation *p, int k)
{
    return length_of(p, k) * nodal_integrate(p->result.rate[k], p->result.change[k]);
}

/* A step turns by about two radians of tangential motion. Sweep k multiplies the error by about these radians
 * divided by k. A shorter step costs less than more sweeps. */
enum { MAX_SWEEPS = 30 };

/* This is the rounding of the coefficients relative to the nodal values: a coefficient is a sum of nodal
 * values with factors up to 611 (lobatto.monomial). */
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
    const double chi = p->from.side * p->from.chi / p->half;
    struct oscillator mean = {0.0, 0.0};
    nodal_values rate;
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        const double push = hertz_push(p, i);
        rate[i] = nodal_slope(p->result.slow, nodal_place(i));
        load[i] += push * (1.0 - chi * rate[i]);
        mean.omega2 -= 1.5 * push / p->result.x[i] * (1.0 - chi * rate[i]) / LOBATTO_MAX;
        mean.damping_rate += push * chi / LOBATTO_MAX;
    }
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        load[i] += mean.omega2 * p->result.x[i] + mean.damping_rate * rate[i];
    }
    p->result.oscillator = mean;
}

/* x = s + y: s is the particular solution for the load, y the free oscillation from the start values. */
static void oscillator_response(struct collocation *p, double softening)
{
    oscillator_particular(&p->result.oscillator, 1.0, p->result.load, p->result.slow, LOBATTO_MAX);
    nodal_values_of(p->result.slow, p->result.x);
    p->result.oscillator.omega2 += softening;
    p->result.y = p->from.deviation - p->result.x[0];
    p->result.y_rate = p->half * p->from.radial - nodal_slope(p->result.slow, 0.0);
}

/* (D + slower)(D + faster) x = load with D = d/ds. u = (D + slower) x is the particular solution of (D +
 * faster) u = load plus a fast decay, which is y. X is the integral of X' = u - slower X. */
static void overdamped_response(struct collocation *p)
{
    const struct oscillator_rates rates = oscillator_rates_of(&p->result.oscillator);
    nodal_values u;
    nodal_values u_at_nodes;
    nodal_values rate = {0.0};
    oscillator_particular(&(struct oscillator){rates.faster, 1.0}, 0.0, p->result.load, u, LOBATTO_MAX);
    nodal_values_of(u, u_at_nodes);
    const double fast = p->half * p->from.radial + rates.slower * p->from.deviation - u_at_nodes[0];
    p->result.y = -fast / (rates.faster - rates.slower);
    p->result.y_rate = -rates.faster * p->result.y;
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        rate[i] = u_at_nodes[i] - rates.slower * p->result.x[i];
    }
    (void)nodal_integrate(rate, p->result.x);
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        p->result.x[i] += p->from.deviation - p->result.y;
    }
    nodal_coefficients(p->result.x, p->result.slow);
}

/* Columns of the matrix below have room for the zeros behind them (lu.h). */
enum { CREEP_STRIDE = LOBATTO_MAX + LANES };

/* Solves x = x(0) + integral of x' for x at the nodes by a step of Newton's method, where x' is `rate` at the
 * present x and has the derivative -slope[j] with respect to it. */
static void follow_rate(struct collocation *p, const double *rate, const double *slope)
{
    double at[LOBATTO_MAX * CREEP_STRIDE] = {0.0};
    double missing[CREEP_STRIDE] = {0.0};
    int pivot[LOBATTO_MAX];
    const struct lu_matrix system = {LOBATTO_MAX, CREEP_STRIDE, at, pivot};
    (void)nodal_integrate(rate, missing);
    for (int j = 0; j < LOBATTO_MAX; ++j) {
        missing[j] += p->from.deviation - p->result.x[j];
        for (int i = 0; i < LOBATTO_MAX; ++i) {
            at[j * CREEP_STRIDE + i] =
                NODAL_RULE->integral[j * LOBATTO_MAX + i] * slope[j] + (i == j ? 1.0 : 0.0);
        }
    }
    if (lu_factor(system)) {
        lu_solve(system, missing);
    }
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        p->result.x[i] += missing[i];
    }
}

/* This function takes an overdamped step under Hertz's law. The rate v = dx/ds follows from v + v'/decay =
 * (load + push) / decay, where `push` is the spring's part of the force and `decay` the fast decay's rate,
 * both by the depth. The left side is solved with the mean of 1/decay. The rest of v'/decay is taken from the
 * last sweep. y is the fast decay, by which v misses the rate of the start. */
static void creeping_response(struct collocation *p, const double *load)
{
    nodal_values right = {0.0};
    nodal_values bend;
    nodal_values slope;
    double inverse = 0.0; /* mean of 1/decay */
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        const double push = hertz_push(p, i);
        const double decay = p->from.chi / p->half * fabs(push);
        double x[4];
        nodal_derivatives(p->result.slow, nodal_place(i), x);
        bend[i] = x[2];
        right[i] = (load[i] + push - bend[i]) / decay;
        slope[i] = 1.5 * load[i] / (decay * p->result.x[i]);
        inverse += 1.0 / (decay * LOBATTO_MAX);
    }
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        right[i] = right[i] / inverse + bend[i];
    }
    nodal_values rate = {0.0};
    nodal_values a;
    nodal_coefficients(right, a);
    oscillator_particular(&(struct oscillator){1.0 / inverse, 1.0}, 0.0, a, a, LOBATTO_MAX);
    nodal_values_of(a, rate);
    p->result.y_rate = p->half * p->from.radial - rate[0];
    p->result.y = -p->result.y_rate * inverse;
    follow_rate(p, rate, slope);
    nodal_coefficients(p->result.x, p->result.slow);
}

/* Returns a rough bound of |x| in the step [m]. */
static double size_of_deviation(const struct collocation *p)
{
    double largest = fabs(p->result.y) + fabs(p->result.y_rate);
    for (int k = 0; k < LOBATTO_MAX; ++k) {
        largest = larger(fabs(p->result.slow[k]), largest);
    }
    return largest;
}

/* Solves for x under the load, given by its values at the nodes; `softening` is the mean of -half^2 df/dx by
 * the centrifugal terms. Returns the largest change of a coefficient [m], scaled up as if x were as large as
 * d. The force, which follows from x, thereby gets the relative accuracy of the position. */
static double respond(struct collocation *p, double *load, double softening)
{
    const bool is_hertz = CONTACT_ANY_HERTZ && p->from.hertz > 0.0;
    nodal_values before;
    double change = 0.0;
    memcpy(before, p->result.slow, sizeof before);
    p->result.oscillator =
        (struct oscillator){p->from.omega2 * p->half * p->half, p->from.damping_rate * p->half};
    if (is_hertz && p->kind == COLLOCATION_AVERAGED) {
        linearize(p, load);
    }
    nodal_coefficients(load, p->result.load);
    if (p->kind == COLLOCATION_AVERAGED) {
        oscillator_response(p, softening);
    } else if (is_hertz) {
        creeping_response(p, load);
    } else {
        overdamped_response(p);
    }
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        change = larger(fabs(p->result.slow[i] - before[i]), change);
    }
    const double size = size_of_deviation(p);
    return change > COEFFICIENT_ROUNDING * size ? change * fmax(1.0, p->from.rim.distance / size) : 0.0;
}

/* Makes one sweep: evaluates the load and the rates of H at the nodes, updates x under this load, then H,
 * then n. Returns the largest change [m]. */
CONTACT_FLATTEN static double sweep(struct collocation *p)
{
    struct collocation_result *made = &p->result;
    const double half2 = p->half * p->half;
    nodal_values load = {0.0};
    nodal_values per_rho_squared;
    nodal_values per_d_squared;
    double softening = 0.0; /* a mean over the step is half the integral over s */
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        const struct rim_state at = rim_state_at_node(p, i);
        const struct rim_slopes slopes = rim_slopes_at(&at, p->acceleration_at[i]);
        const double spin = slopes.azimuth * at.by.cosine;
        const double weight = 0.5 * nodal_weight(i);
        load[i] = half2 * slopes.load;
        softening += weight * 3.0 * half2 * (spin * spin + slopes.tilt * slopes.tilt);
        made->rate[2][i] = p->half * slopes.azimuth_momentum;
        made->rate[3][i] = p->half * slopes.tilt_momentum;
        per_rho_squared[i] = 1.0 / (at.rho * at.rho);
        per_d_squared[i] = 1.0 / (at.d * at.d);
    }
    const double by_load = respond(p, load, softening);
    if (p->from.head_on) {
        /* under the linear law one sweep is exact, unless x is overdamped and found by iteration */
        return p->kind != COLLOCATION_OVERDAMPED && p->from.hertz == 0.0 ? 0.0 : by_load;
    }
    memset(made->correction, 0, sizeof made->correction);
    const struct rim_state start = rim_state_by(p, made->correction, p->from.deviation);
    add_correction(p, &start, p->from.acceleration[0], made->y, made->y_rate, made->correction);
    const double by_momentum = larger(integrate_change(p, 2), integrate_change(p, 3));
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        const double spun = made->change[2][i] - made->correction[2];
        const double tilting = made->change[3][i] - made->correction[3];
        made->rate[0][i] = p->half * (p->from.rim.azimuth_momentum + spun) * per_rho_squared[i];
        made->rate[1][i] = p->half * (p->from.rim.tilt_momentum + tilting) * per_d_squared[i];
    }
    const double by_normal = larger(integrate_change(p, 0), integrate_change(p, 1));
    note_angles(p);
    return larger(by_load, larger(by_momentum, by_normal));
}

/* Estimates the error from the last coefficients of the integrands. The integral of a Chebyshev polynomial is
 * smaller than the polynomial by a factor of its degree. */
static double tail_of_all(struct collocation *p)
{
    const double of_deviation =
        larger(fabs(p->result.slow[LOBATTO_MAX - 1]), fabs(p->result.slow[LOBATTO_MAX - 2]));
    const double size = size_of_deviation(p);
    /* the first omitted coefficient is less than a quarter of the last one: their ratio is half the step's
     * radians, two at most, divided by the index */
    const double left_out = 0.25 * ldexp(of_deviation, 2 - LOBATTO_MAX);
    const bool is_overdamped = p->kind == COLLOCATION_OVERDAMPED && p->from.hertz == 0.0;
    p->result.deviation_error = left_out;
    const double by_deviation =
        is_overdamped && size > 0.0 ? left_out * larger(1.0, p->from.rim.distance / size) : left_out;
    if (p->from.head_on) {
        return by_deviation;
    }
    double by_changes = 0.0;
    for (int k = 0; k < COLLOCATION_CHANGES; ++k) {
        by_changes = larger(length_of(p, k) * nodal_tail(p->result.rate[k]), by_changes);
    }
    return larger(by_deviation, by_changes / LOBATTO_MAX);
}

/* Returns whether all values are finite and d > 0, because local coordinates are singular at the centre. */
static bool finish(struct collocation *p)
{
    if (CONTACT_ANY_CIRCLE && p->from.rim.radius > 0.0) {
        nodal_coefficients(p->result.rate[1], p->result.tilt_rate);
    }
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        double sum = 0.0;
        for (int k = 0; k < COLLOCATION_CHANGES; ++k) {
            sum += p->result.change[k][i];
        }
        if (!(p->from.reach + p->result.x[i] > 0.0) || !isfinite(sum)) {
            return false;
        }
    }
    return true;
}

void collocation_deviation(const struct collocation *p, double s, double averaged[4], double y[4])
{
    const struct oscillator *o = &p->result.oscillator;
    const struct oscillator_basis by = oscillator_basis_at(o, s);
    nodal_derivatives(p->result.slow, s, averaged);
    y[0] = p->result.y * by.y_of_y + p->result.y_rate * by.y_of_rate;
    y[1] = p->result.y * by.rate_of_y + p->result.y_rate * by.rate_of_rate;
    y[2] = -o->damping_rate * y[1] - o->omega2 * y[0];
    y[3] = -o->damping_rate * y[2] - o->omega2 * y[1];
}

struct collocation_change collocation_change_at(const struct collocation *p, double s)
{
    double change[COLLOCATION_CHANGES] = {0.0};
    double slow[4];
    double y[4];
    collocation_deviation(p, s, slow, y);
    const double x = slow[0] + y[0];
    const double rate = slow[1] + y[1];
    for (int k = 0; k < COLLOCATION_CHANGES && !p->from.head_on; ++k) {
        change[k] = nodal_integral_to(p->result.change[k], p->result.rate[k], s) - p->result.correction[k];
    }
    if (!p->from.head_on) {
        const struct rim_state without_y = rim_state_by(p, change, x);
        add_correction(p, &without_y, acceleration_then(p, s), y[0], y[1], change);
    }
    const struct rim_state then = rim_state_by(p, change, x);
    return (struct collocation_change){rim_moved(&p->from.rim, &then),
                                       rim_gained(&p->from.rim, &then, p->from.radial, rate / p->half), x,
                                       rate};
}

void collocation_edges(const struct collocation *p, double s, const double averaged[4], const double y[4],
                       double radial[3], double axial[3])
{
    const double slow = taylor_at(p->result.tilt_rate, LOBATTO_MAX, s - 1.0);
    /* the oscillation y changes the tilt, too: see add_correction */
    const double by = -2.0 * slow / (p->from.reach + averaged[0] + y[0]);
    const double tilt = p->from.rim.tilt + nodal_integral(p->result.tilt_rate, s) - p->result.correction[1] +
                        by * collocation_oscillation_integral(p, y[0], y[1]) / p->half;
    const double rate = slow + by * y[0];
    const double bend = nodal_slope(p->result.tilt_rate, s) + by * y[1];
    radial[0] = p->from.reach * cos(tilt);
    axial[0] = p->from.reach * sin(tilt);
    radial[1] = -axial[0] * rate;
    axial[1] = radial[0] * rate;
    radial[2] = -radial[0] * rate * rate - axial[0] * bend;
    axial[2] = radial[0] * bend - axial[0] * rate * rate;
}

void collocation_overdamped_push(const struct collocation *p, double s, double push[3])
{
    nodal_values slow_push;
    double of[4];
    for (int k = 0; k < LOBATTO_MAX; ++k) {
        const double bend = k + 2 < LOBATTO_MAX ? (k + 1) * (k + 2) * p->result.slow[k + 2] : 0.0;
        slow_push[k] = bend - p->result.load[k];
    }
    nodal_derivatives(slow_push, s, of);
    const double faster = oscillator_rates_of(&p->result.oscillator).faster;
    double fast = p->result.y * exp(-faster * s) * faster * faster;
    for (int i = 0; i < 3; ++i) {
        push[i] = of[i] + fast;
        fast *= -faster;
    }
}

/* Returns the integral of the polynomial `a` times y' from 0 to s, in closed form. With a spring (Q y + Q' y'
 * / omega2)' = a y' where Q + Q'' / omega2 - damping_rate Q' / omega2 = a. A single decay has (Q y)' = a y'
 * where Q - Q' / faster = a. */
static double along_oscillation(const struct collocation *p, const double *a, double s, const double y[4])
{
    const struct oscillator *o = &p->result.oscillator;
    const bool decays = p->kind == COLLOCATION_OVERDAMPED;
    const struct oscillator mirrored = {decays ? -oscillator_rates_of(o).faster : o->omega2,
                                        decays ? 1.0 : -o->damping_rate};
    const double by_rate = decays ? 0.0 : 1.0 / mirrored.omega2;
    nodal_values scaled = {0.0};
    nodal_values q = {0.0};
    for (int k = 0; k < LOBATTO_MAX; ++k) {
        scaled[k] = mirrored.omega2 * a[k];
    }
    oscillator_particular(&mirrored, decays ? 0.0 : 1.0, scaled, q, LOBATTO_MAX);
    return taylor_at(q, LOBATTO_MAX, s - 1.0) * y[0] - taylor_at(q, LOBATTO_MAX, -1.0) * p->result.y +
           by_rate * (nodal_slope(q, s) * y[1] - nodal_slope(q, 0.0) * p->result.y_rate);
}

/* The dissipated energy follows from the oscillator's balance of energy, which is exact at any frequency.
 * With the deviation x, its oscillation y and the load f this balance is damping_rate x'^2 = -(x'^2 / 2 +
 * omega2 x^2 / 2)' + f x'. Quadrature by the nodes is exact for the product of the polynomials f and (x -
 * y)'. */
double collocation_dissipated(const struct collocation *p, double s)
{
    const double omega2 = p->from.omega2 * p->half * p->half;
    const double softening = p->result.oscillator.omega2 - omega2;
    double slow[4];
    double y[4];
    collocation_deviation(p, s, slow, y);
    const double start_rate = p->half * p->from.radial;
    const double x0 = p->from.deviation;
    const double x = slow[0] + y[0];
    const double rate = slow[1] + y[1];
    const double lost = 0.5 * ((start_rate - rate) * (start_rate + rate) + omega2 * (x0 - x) * (x0 + x) +
                               softening * (p->result.y - y[0]) * (p->result.y + y[0]));
    double along_slow = 0.0;
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        const double at = 0.5 * s * nodal_place(i);
        const double part =
            taylor_at(p->result.load, LOBATTO_MAX, at - 1.0) * nodal_slope(p->result.slow, at);
        along_slow += 0.5 * s * nodal_weight(i) * part;
    }
    const double sum = lost + along_slow + along_oscillation(p, p->result.load, s, y);
    return sum / (p->half * p->half);
}

struct vec3 collocation_moment(const struct collocation *p, int power, double s)
{
    nodal_values moved[3];
    nodal_values along[3]; /* the factor of y */
    double slow[4];
    double y[4];
    double sum[3];
    collocation_deviation(p, s, slow, y);
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        const double t = p->half * nodal_place(i);
        const double weight = p->half * (power == 0 ? 1.0 : power == 1 ? t : t * t);
        const struct rim_state at = rim_state_at_node(p, i); /* without the oscillation */
        const struct vec3 way = vec3_scale(weight, rim_moved(&p->from.rim, &at));
        const struct vec3 normal = vec3_scale(weight, rim_normal(&at));
        for (int k = 0; k < 3; ++k) {
            moved[k][i] = vec3_get(way, k);
            along[k][i] = vec3_get(normal, k);
        }
    }
    for (int k = 0; k < 3; ++k) {
        nodal_values grown = {0.0};
        nodal_values a;
        nodal_values b;
        nodal_coefficients(moved[k], a);
        (void)nodal_integrate(along[k], grown);
        nodal_coefficients(grown, b);
        /* by parts: with B' = b, the integral of b y is B y less that of B y' */
        sum[k] =
            nodal_integral(a, s) + taylor_at(b, LOBATTO_MAX, s - 1.0) * y[0] - along_oscillation(p, b, s, y);
    }
    return vec3_from(sum);
}

bool collocation_make(struct collocation *p, const struct collocation_problem *from, double step,
                      enum collocation_kind kind, double tolerance)
{
    p->from = *from;
    p->kind = kind;
    p->half = 0.5 * step;
    memset(&p->result, 0, sizeof p->result); /* the first guess: n, H and x as at the start */
    p->result.slow[0] = from->deviation;
    note_angles(p);
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        p->result.x[i] = p->result.slow[0];
        p->acceleration_at[i] = acceleration_then(p, nodal_place(i));
    }
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
