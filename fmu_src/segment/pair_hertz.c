#include "segment/pair_hertz.h"

#include "math/root.h"
#include "segment/hertz_recurrence.h"

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

/* Values and two derivatives of u and rate, side by side. */
static void hertz_sample_series(const struct pair_hertz *p, double s, double out[2][3])
{
#if CONTACT_GNU_C
    double2 value = {0.0};
    double2 slope = {0.0};
    double2 bend = {0.0}; /* half of it */
    for (int i = TAYLOR_TERMS - 1; i >= 0; --i) {
        const double2 next = {p->root[i], p->rate[i]};
        bend = bend * s + slope;
        slope = slope * s + value;
        value = value * s + next;
    }
    for (int j = 0; j < 2; ++j) {
        out[j][0] = value[j];
        out[j][1] = slope[j];
        out[j][2] = 2.0 * bend[j];
    }
#else
    hertz_series_at(p->root, s, out[0]);
    hertz_series_at(p->rate, s, out[1]);
#endif
}

static void hertz_sample_start(const struct pair_hertz *p, double out[2][3])
{
    for (int i = 0; i < 3; ++i) {
        const double factor = i < 2 ? 1.0 : 2.0;
        out[0][i] = factor * p->root[i];
        out[1][i] = factor * p->rate[i];
    }
}

/* F_n = k_h u^3 q with q = 1 - chi g', and its derivatives by s, from those of u and of g'. */
static void hertz_sample_force(const struct contact_pair *from, const double *u, const double *rate,
                               double out[3])
{
    const double k = from->hertz_stiffness;
    const double q[3] = {1.0 - from->chi * rate[0], -from->chi * rate[1], -from->chi * rate[2]};
    const double square = u[0] * u[0];
    const double cube = square * u[0];
    out[0] = k * cube * q[0];
    out[1] = k * (3.0 * square * u[1] * q[0] + cube * q[1]);
    out[2] = k * ((6.0 * u[0] * u[1] * u[1] + 3.0 * square * u[2]) * q[0] + 6.0 * square * u[1] * q[1] +
                  cube * q[2]);
}

void pair_hertz_sample(const void *pair_hertz, double s, struct pair_sample *sample)
{
    const struct pair_hertz *p = pair_hertz;
    double rows[2][3];
    if (s == 0.0) {
        hertz_sample_start(p, rows);
    } else {
        hertz_sample_series(p, s, rows);
    }
    const double *u = rows[0];
    sample->of[PAIR_GAP][0] = -u[0] * u[0];
    sample->of[PAIR_GAP][1] = -2.0 * u[0] * u[1];
    sample->of[PAIR_GAP][2] = -2.0 * (u[1] * u[1] + u[0] * u[2]);
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_GAP_RATE][i] = rows[1][i];
    }
    hertz_sample_force(p->from, u, rows[1], sample->of[PAIR_FORCE]);
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

/* Powers of s: sums of many rows at one place then need no more than a multiplication a term. */
struct hertz_powers {
    double of[TAYLOR_TERMS];
};

static struct hertz_powers hertz_powers_of(double s)
{
    struct hertz_powers at;
    double power = 1.0;
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        at.of[i] = power;
        power *= s;
    }
    return at;
}

/* The sum of a row, the smallest terms first. */
static double hertz_sum(const double row[TAYLOR_TERMS], const struct hertz_powers *at)
{
    _Static_assert(TAYLOR_ORDER % LANES == 0, "the terms but the first are in pairs");
    double2 sum = {0.0};
    for (int i = TAYLOR_TERMS - LANES; i > 0; i -= LANES) {
        sum += double2_at(row, i) * double2_at(at->of, i);
    }
    return row[0] + lanes_together(sum);
}

/* The integral of -(F_n - k_h u^3) g' dt, dt = unit u ds. */
static double hertz_dissipated(const struct pair_hertz *p, const struct hertz_powers *at, double s)
{
    double rates[TAYLOR_TERMS + 1]; /* backwards; zero where a pair reaches beyond the first */
    double power[TAYLOR_TERMS];
    if (!(p->from->chi > 0.0)) {
        return 0.0;
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        rates[TAYLOR_ORDER - i] = p->rate[i];
    }
    rates[TAYLOR_TERMS] = 0.0;
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        const double *back = rates + (TAYLOR_ORDER - i);
        double2 sum = {0.0};
        for (int k = 1; k <= i; k += LANES) {
            sum += double2_at(p->drag, k) * double2_at(back, k);
        }
        power[i] = (p->drag[0] * p->rate[i] + lanes_together(sum)) / (i + 1);
    }
    return p->unit * s * hertz_sum(power, at);
}

/* A row of vectors, in the world. */
static struct vec3 hertz_vector_at(const struct pair_hertz *p, const double rows[][TAYLOR_TERMS],
                                   const struct hertz_powers *at)
{
    struct vec3 out = vec3_make(0.0, 0.0, 0.0);
    for (int j = 0; j < p->flight.dimensions && j < HERTZ_DIMENSIONS; ++j) {
        out = vec3_axpy(out, hertz_sum(rows[j], at), p->flight.frame[j]);
    }
    return out;
}

struct pair_change pair_hertz_change(const void *pair_hertz, double s)
{
    const struct pair_hertz *p = pair_hertz;
    const struct hertz_powers at = hertz_powers_of(s);
    const double u = hertz_sum(p->root, &at);
    return (struct pair_change){
        .time = pair_hertz_time(p, s),
        .r = hertz_vector_at(p, p->r, &at),
        .r_rate = hertz_vector_at(p, p->r_rate, &at),
        .gap = -u * u,
        .dissipated = hertz_dissipated(p, &at, s),
        .work = {hertz_work(p, &p->from->work[0], s), hertz_work(p, &p->from->work[1], s)}};
}
