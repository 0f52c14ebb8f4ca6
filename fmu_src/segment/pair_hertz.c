#include "segment/pair_hertz.h"

#include "math/root.h"

/* Value and two derivatives. */
static void hertz_series_at(const double *a, double s, double out[3])
{
    out[0] = out[1] = out[2] = 0.0;
    for (int i = TAYLOR_TERMS - 1; i >= 0; --i) {
        out[2] = out[2] * s + 2.0 * out[1];
        out[1] = out[1] * s + out[0];
        out[0] = out[0] * s + a[i];
    }
}

double pair_hertz_time(const struct pair_hertz *p, double s)
{
    return taylor_at(p->time, TAYLOR_TERMS, s);
}

struct hertz_time_left {
    const struct pair_hertz *of;
    double time;
};

static void hertz_time_left_at(const void *hertz_time_left, double s, double *value, double *slope)
{
    const struct hertz_time_left *left = hertz_time_left;
    double time[3];
    hertz_series_at(left->of->time, s, time);
    *value = time[0] - left->time;
    *slope = time[1];
}

double pair_hertz_place(const struct pair_hertz *p, double time, double end)
{
    const struct hertz_time_left left = {p, time};
    struct root_bracket_end low = {0.0, -time, p->time[1]};
    struct root_bracket_end high = {.s = end};
    hertz_time_left_at(&left, end, &high.value, &high.slope);
    return high.value > 0.0 ? root_between(hertz_time_left_at, &left, low, high) : end;
}

static void hertz_root_at(const void *root, double s, double *value, double *slope)
{
    double u[3];
    hertz_series_at(root, s, u);
    *value = u[0];
    *slope = u[1];
}

static void hertz_root_slope_at(const void *root, double s, double *value, double *slope)
{
    double u[3];
    hertz_series_at(root, s, u);
    *value = u[1];
    *slope = u[2];
}

/* A step is a third of the radius of convergence at most, so that u has one extremum in it. */
double pair_hertz_parting(const double root[TAYLOR_TERMS], double end)
{
    const struct root_bracket_end low = {0.0, root[0], root[1]};
    struct root_bracket_end high = {.s = end};
    if (low.value == 0.0 && !(low.slope > 0.0)) {
        return 0.0;
    }
    hertz_root_at(root, end, &high.value, &high.slope);
    if (high.value > 0.0 && low.value > 0.0 && low.slope < 0.0 && high.slope > 0.0) {
        struct root_bracket_end dip = {.s = root_in_bracket(hertz_root_slope_at, root, low.s, high.s)};
        hertz_root_at(root, dip.s, &dip.value, &dip.slope);
        high = dip.value <= 0.0 ? dip : high;
    }
    if (high.value > 0.0) {
        return (double)INFINITY;
    }
    if (low.value > 0.0) {
        return root_between(hertz_root_at, root, low, high);
    }
    /* it rises from zero: its root is beyond its top */
    return root_in_bracket(hertz_root_at, root, root_in_bracket(hertz_root_slope_at, root, 0.0, end), end);
}

/* Value, slope and half the bend of a series: one step of Horner's scheme. */
struct hertz_point {
    double value, slope, bend;
};

static inline struct hertz_point hertz_horner(struct hertz_point a, double s, double next)
{
    return (struct hertz_point){a.value * s + next, a.slope * s + a.value, a.bend * s + a.slope};
}

/* Values and two derivatives of u, rate and force, in one loop, so that none waits for another. */
static void hertz_sample_series(const struct pair_hertz *p, double s, double out[3][3])
{
    struct hertz_point root = {0.0, 0.0, 0.0};
    struct hertz_point rate = {0.0, 0.0, 0.0};
    struct hertz_point force = {0.0, 0.0, 0.0};
    for (int i = TAYLOR_TERMS - 1; i >= 0; --i) {
        root = hertz_horner(root, s, p->root[i]);
        rate = hertz_horner(rate, s, p->rate[i]);
        force = hertz_horner(force, s, p->force[i]);
    }
    const struct hertz_point rows[3] = {root, rate, force};
    for (int j = 0; j < 3; ++j) {
        out[j][0] = rows[j].value;
        out[j][1] = rows[j].slope;
        out[j][2] = 2.0 * rows[j].bend;
    }
}

static void hertz_sample_start(const struct pair_hertz *p, double out[3][3])
{
    for (int i = 0; i < 3; ++i) {
        const double factor = i < 2 ? 1.0 : 2.0;
        out[0][i] = factor * p->root[i];
        out[1][i] = factor * p->rate[i];
        out[2][i] = factor * p->force[i];
    }
}

void pair_hertz_sample(const void *pair_hertz, double s, struct pair_sample *sample)
{
    double rows[3][3];
    if (s == 0.0) {
        hertz_sample_start(pair_hertz, rows);
    } else {
        hertz_sample_series(pair_hertz, s, rows);
    }
    const double *u = rows[0];
    sample->of[PAIR_GAP][0] = -u[0] * u[0];
    sample->of[PAIR_GAP][1] = -2.0 * u[0] * u[1];
    sample->of[PAIR_GAP][2] = -2.0 * (u[1] * u[1] + u[0] * u[2]);
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_GAP_RATE][i] = rows[1][i];
        sample->of[PAIR_FORCE][i] = rows[2][i];
    }
}

/* The integral of pair_work over [0, s]: of path(t) r'_s ds, order 2, or path(t) r_s ds, order 1. */
static double hertz_work(const struct pair_hertz *p, const struct pair_work *work, double s)
{
    double slope[HERTZ_DIMENSIONS][TAYLOR_TERMS];
    double sum = 0.0;
    const bool is_idle =
        vec3_is_zero(work->path[0]) && vec3_is_zero(work->path[1]) && vec3_is_zero(work->path[2]);
    if (work->order == 0 || is_idle) {
        return 0.0;
    }
    for (int i = 0; i + 1 < TAYLOR_TERMS; ++i) {
        for (int j = 0; j < p->flight.dimensions; ++j) {
            slope[j][i] = (i + 1) * (work->order == 1 ? p->r[j][i + 1] : p->r_rate[j][i + 1]);
        }
    }
    for (int j = 0; j < p->flight.dimensions; ++j) {
        const double path[3] = {vec3_dot(work->path[0], p->flight.frame[j]),
                                vec3_dot(work->path[1], p->flight.frame[j]),
                                vec3_dot(work->path[2], p->flight.frame[j])};
        const bool is_steady = path[1] == 0.0 && path[2] == 0.0;
        double along[TAYLOR_TERMS] = {0.0};
        double power[TAYLOR_TERMS];
        for (int i = 0; i + 1 < TAYLOR_TERMS; ++i) {
            along[i] = path[0] * (i == 0) + path[1] * p->time[i];
            along[i] += path[2] == 0.0 ? 0.0 : path[2] * taylor_multiply(p->time, p->time, i);
            power[i] = is_steady ? path[0] * slope[j][i] : taylor_multiply(along, slope[j], i);
        }
        sum += taylor_integral(power, TAYLOR_ORDER, s);
    }
    return sum;
}

/* The integral of -(F_n - k_h u^3) g' dt, dt = unit u ds. */
static double hertz_dissipated(const struct pair_hertz *p, double s)
{
    double damped[TAYLOR_TERMS];
    double power[TAYLOR_TERMS];
    if (!(p->from->chi > 0.0)) {
        return 0.0;
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        damped[i] = p->from->hertz_stiffness * p->cube[i] - p->force[i];
        power[i] = taylor_multiply(damped, p->rate, i);
    }
    double by_s[TAYLOR_TERMS];
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        by_s[i] = taylor_multiply(power, p->root, i);
    }
    return p->unit * taylor_integral(by_s, TAYLOR_TERMS, s);
}

/* A row of vectors at s, in the world. */
static struct vec3 hertz_vector_at(const struct pair_hertz *p, double rows[][TAYLOR_TERMS], double s)
{
    double sum[HERTZ_DIMENSIONS] = {0.0, 0.0, 0.0};
    struct vec3 out = vec3_make(0.0, 0.0, 0.0);
    for (int i = TAYLOR_TERMS - 1; i >= 0; --i) {
        for (int j = 0; j < p->flight.dimensions && j < HERTZ_DIMENSIONS; ++j) {
            sum[j] = sum[j] * s + rows[j][i];
        }
    }
    for (int j = 0; j < p->flight.dimensions && j < HERTZ_DIMENSIONS; ++j) {
        out = vec3_axpy(out, sum[j], p->flight.frame[j]);
    }
    return out;
}

struct pair_change pair_hertz_change(const void *pair_hertz, double s)
{
    struct pair_hertz *p = (struct pair_hertz *)pair_hertz;
    const double u = taylor_at(p->root, TAYLOR_TERMS, s);
    return (struct pair_change){
        .time = pair_hertz_time(p, s),
        .r = hertz_vector_at(p, p->r, s),
        .r_rate = hertz_vector_at(p, p->r_rate, s),
        .gap = -u * u,
        .dissipated = hertz_dissipated(p, s),
        .work = {hertz_work(p, &p->from->work[0], s), hertz_work(p, &p->from->work[1], s)}};
}
