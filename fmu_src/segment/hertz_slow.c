#include "segment/hertz_slow_rim.h"

#include <float.h>

enum { SLOW_SWEEPS = 30 };

/* Sweeps have converged where what is left changes delta and n by less than this part of them; their rounding
 * is less. */
static const double SLOW_SWEPT = 4.0 * DBL_EPSILON;

/* Newton's matrix is made once n changes by less than this, and anew while delta changes by more than this
 * part, on its way to its place. */
static const double NEW_MATRIX = 1e-3;

/* d g_i / d of the change of the bend: 1 + spring I I + dashpot I, factored. */
struct slow_newton {
    double a[SLOW_N][SLOW_N];
    int pivot[SLOW_N];
};

/* Gaussian elimination with pivots of columns. */
static void slow_factor(struct slow_newton *newton)
{
    for (int k = 0; k < SLOW_N; ++k) {
        int best = k;
        for (int i = k + 1; i < SLOW_N; ++i) {
            best = fabs(newton->a[i][k]) > fabs(newton->a[best][k]) ? i : best;
        }
        newton->pivot[k] = best;
        for (int j = 0; j < SLOW_N; ++j) {
            const double moved = newton->a[k][j];
            newton->a[k][j] = newton->a[best][j];
            newton->a[best][j] = moved;
        }
        const double inverse = 1.0 / newton->a[k][k];
        for (int i = k + 1; i < SLOW_N; ++i) {
            const double by = newton->a[i][k] * inverse;
            newton->a[i][k] = by;
            for (int j = k + 1; j < SLOW_N; ++j) {
                newton->a[i][j] -= by * newton->a[k][j];
            }
        }
    }
}

static void slow_solve(const struct slow_newton *newton, double *x)
{
    for (int k = 0; k < SLOW_N; ++k) {
        const int best = newton->pivot[k];
        const double moved = x[k];
        x[k] = x[best];
        x[best] = moved;
    }
    for (int i = 1; i < SLOW_N; ++i) {
        for (int j = 0; j < i; ++j) {
            x[i] -= newton->a[i][j] * x[j];
        }
    }
    for (int i = SLOW_N - 1; i >= 0; --i) {
        for (int j = i + 1; j < SLOW_N; ++j) {
            x[i] -= newton->a[i][j] * x[j];
        }
        x[i] /= newton->a[i][i];
    }
}

static void slow_matrix(const struct hertz_slow *p, struct slow_newton *newton)
{
    for (int i = 0; i < SLOW_N; ++i) {
        double law[3];
        slow_law(p, p->depth[i], p->rate[i], law);
        for (int j = 0; j < SLOW_N; ++j) {
            newton->a[i][j] = (i == j ? 1.0 : 0.0) + law[1] * radau_twice[j * SLOW_N + i] +
                              law[2] * radau.integral[j * SLOW_N + i];
        }
    }
    slow_factor(newton);
}

/* delta and its rate from the bend; false where the bodies would part. */
static bool take_bend(struct hertz_slow *p, double *change)
{
    nodal_values moved = {0.0};
    nodal_values deeper = {0.0};
    (void)nodal_integrate(&radau, p->bend, moved);
    for (int i = 0; i < SLOW_N; ++i) {
        p->rate[i] = p->rate_start + moved[i];
    }
    (void)nodal_integrate(&radau, p->rate, deeper);
    *change = 0.0;
    for (int i = 0; i < SLOW_N; ++i) {
        const double depth = p->depth_start + deeper[i];
        const double part = fabs(depth - p->depth[i]) / depth;
        *change = part > *change ? part : *change;
        if (!(depth > 0.0)) {
            return false;
        }
        p->depth[i] = depth;
    }
    return true;
}

/* A first guess of delta: at rest under the load at each node; as at the start beyond critical damping, for
 * there it creeps. The bend is left zero, leading elsewhere: for Newton's first step, `apart` is how far. */
static bool guess_depth(struct hertz_slow *p, const double *load, double apart[SLOW_N])
{
    double law[3];
    slow_law(p, p->depth_start, p->rate_start, law);
    const bool creeps = law[2] * law[2] > 4.0 * law[1];
    for (int i = 0; i < SLOW_N; ++i) {
        if (!creeps && !(load[i] > 0.0)) {
            return false;
        }
        const double rest = load[i] / (p->half * p->half * p->k);
        p->depth[i] = creeps ? p->depth_start : cbrt(rest * rest);
        p->rate[i] = p->rate_start;
        p->bend[i] = 0.0;
        apart[i] = p->depth_start + p->rate_start * (1.0 + radau.node[i]) - p->depth[i];
    }
    return true;
}

/* The polynomial through the nodes at the start, less the value there: what truncation leaves, and a part
 * that is too fast for the step. */
static double misses_start(const double *values, double start)
{
    nodal_values a;
    nodal_coefficients(&radau, values, a);
    return fabs(nodal_polynomial_at(a, SLOW_N, 0.0) - start);
}

/* After so many sweeps delta is near enough to its place to tell whether anything fast is left of it: a
 * step is given up where that is so many times too much. */
enum { LOOK_AFTER = 2 };
static const double TOO_FAST = 1e3;

/* Whether the changes of sweeps to come are below SLOW_SWEPT in all, as they fall by the ratio of the last
 * two. */
static bool sweeps_have_converged(double last, double before)
{
    return last <= SLOW_SWEPT || (last < before && last * last <= SLOW_SWEPT * (before - last));
}

static bool slow_iterate(struct hertz_slow *p, double depth_tolerance)
{
    struct slow_newton newton;
    nodal_values load;
    double apart[SLOW_N];
    for (int i = 0; i < SLOW_SWEEPS && slow_sweep_turning(p) > NEW_MATRIX; ++i) {
        /* until the load is near enough for Newton's matrix to last */
    }
    slow_load(p, load);
    if (!guess_depth(p, load, apart)) {
        return false;
    }
    double change = 1.0;
    double largest = 0.0; /* of the changes of delta and n; none yet */
    for (int i = 0; i < SLOW_SWEEPS; ++i) {
        double error[SLOW_N];
        const double before = largest;
        const double turned = slow_sweep_turning(p);
        slow_load(p, load);
        if (change > NEW_MATRIX) {
            slow_matrix(p, &newton);
        }
        for (int j = 0; j < SLOW_N; ++j) {
            double law[3];
            slow_law(p, p->depth[j], p->rate[j], law);
            error[j] = load[j] - law[0] - p->bend[j] - (i == 0 ? law[1] * apart[j] : 0.0);
        }
        slow_solve(&newton, error);
        for (int j = 0; j < SLOW_N; ++j) {
            p->bend[j] += error[j];
        }
        if (!take_bend(p, &change)) {
            return false;
        }
        largest = fmax(change, turned);
        if (sweeps_have_converged(largest, before)) {
            (void)slow_sweep_turning(p); /* with the last delta */
            return true;
        }
        if (i == LOOK_AFTER && misses_start(p->depth, p->depth_start) > TOO_FAST * depth_tolerance) {
            return false;
        }
    }
    return false;
}

static bool slow_is_accurate(const struct hertz_slow *p, double tolerance, double depth_tolerance)
{
    const double stiffness = 1.5 * p->k * sqrt(p->depth_start);
    const double damping = p->k * p->depth_start * sqrt(p->depth_start) * p->from->chi;
    /* Beyond critical damping the force is known by the rate, at which the contact settles. */
    const bool creeps = damping * damping > 4.0 * stiffness;
    const double fast = fmax(sqrt(stiffness), damping);
    const double by_rate = creeps ? stiffness / damping * p->half : fmax(1.0, fast * p->half);
    double error = misses_start(p->depth, p->depth_start);
    error = fmax(error, misses_start(p->rate, p->rate_start) / by_rate);
    if (!(error <= depth_tolerance)) {
        return false;
    }
    for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
        if (is_turning(p, j) && !(p->from->distance * misses_start(p->turned[j], 0.0) <= tolerance)) {
            return false;
        }
    }
    return true;
}

bool slow_hertz_make(struct hertz_slow *p, const struct contact_pair *from, double step, double tolerance,
                     double depth_tolerance)
{
    p->from = from;
    p->flight = hertz_flight_of(from);
    p->half = 0.5 * step;
    p->k = from->hertz_stiffness / from->reduced_mass;
    p->depth_start = -from->gap;
    p->rate_start = -p->half * pair_gap_derivative(from);
    const double normal[HERTZ_TURNING] = {
        1.0, 0.0, 0.0, 0.0, -from->distance * p->flight.w[0][2], from->distance * p->flight.w[0][1]};
    for (int j = 0; j < HERTZ_TURNING; ++j) {
        p->start[j] = normal[j];
        for (int i = 0; i < SLOW_N; ++i) {
            p->turned[j][i] = p->turning[j][i] = 0.0;
        }
    }
    for (int i = 0; i < SLOW_N; ++i) {
        p->depth[i] = p->depth_start;
    }
    if (slow_at_rim(p)) {
        slow_rim_begin(p);
    }
    slow_note_pull(p);
    if (!slow_iterate(p, depth_tolerance) || !slow_is_accurate(p, tolerance, depth_tolerance)) {
        return false;
    }
    nodal_coefficients(&radau, p->rate, p->rate_terms);
    return true;
}
