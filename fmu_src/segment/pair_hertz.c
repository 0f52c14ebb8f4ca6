#include "segment/pair_hertz.h"

#include <float.h>

#include "math/root.h"

typedef double series[TAYLOR_TERMS];

/* Everything that the recurrence needs besides the results. */
struct hertz_recurrence {
    series power[SEPARATION_DEGREE + 1]; /* t^k, k from 2 on */
    series c[HERTZ_DIMENSIONS];          /* separation [m] */
    series w[HERTZ_DIMENSIONS];          /* its rate as the law sees it [m/s] */
    series c_rate[HERTZ_DIMENSIONS];     /* its derivative, where that is another [m/s] */
    series n[HERTZ_DIMENSIONS];
    series d;       /* [m] */
    series opening; /* dg/dt [m/s] */
    series square;  /* u^2 */
    series damping; /* 1 + chi delta' */
    series impulse; /* u F_n */
};

/* Coefficient `order` of a product. Four sums, because one would wait for each of its additions. */
static double series_product(const double *a, const double *b, int order)
{
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    int i = 0;
    for (; i + 3 <= order; i += 4) {
        sum[0] += a[i] * b[order - i];
        sum[1] += a[i + 1] * b[order - i - 1];
        sum[2] += a[i + 2] * b[order - i - 2];
        sum[3] += a[i + 3] * b[order - i - 3];
    }
    for (; i <= order; ++i) {
        sum[0] += a[i] * b[order - i];
    }
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Components across the plane of motion by less than this part are rounding. */
static const double OUT_OF_PLANE = 8.0 * DBL_EPSILON;

/* The first tangential direction that the motion of flight has; none: head-on. */
static struct vec3 hertz_tangent(const struct contact_pair *from)
{
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const struct vec3 rows[2] = {from->flight.c[i], from->flight.w[i - 1]};
        for (int k = 0; k < 2; ++k) {
            const struct vec3 across = pair_across(from, rows[k]);
            const struct vec3 along = pair_tangential(from, across);
            if (!vec3_is_zero(along) && !vec3_is_zero(vec3_cross(from->normal, across))) {
                return vec3_scale(1.0 / vec3_norm(along), along);
            }
        }
    }
    return vec3_make(0.0, 0.0, 0.0);
}

/* One coefficient in the frame; whether it is out of the plane. */
static bool hertz_to_frame(const struct contact_pair *from, struct hertz_flight *flight, struct vec3 a,
                           double out[HERTZ_DIMENSIONS])
{
    const struct vec3 across = pair_across(from, a);
    for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
        out[j] = vec3_dot(flight->frame[j], across);
    }
    return fabs(out[2]) > OUT_OF_PLANE * vec3_norm(a);
}

struct hertz_flight hertz_flight_of(const struct contact_pair *from)
{
    struct hertz_flight flight = {.frame = {from->normal, hertz_tangent(from)}, .degree = 1};
    flight.frame[2] = vec3_cross(flight.frame[0], flight.frame[1]);
    bool leaves_plane = false;
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) {
        const bool leaves = hertz_to_frame(from, &flight, from->flight.c[i], flight.c[i]);
        leaves_plane = leaves_plane || (leaves && i > 0);
        flight.degree = i > 1 && !vec3_is_zero(from->flight.c[i]) ? i : flight.degree;
    }
    for (int i = 0; i < SEPARATION_DEGREE; ++i) {
        leaves_plane = hertz_to_frame(from, &flight, from->flight.w[i], flight.w[i]) || leaves_plane;
        const bool counts = i >= flight.degree && !vec3_is_zero(from->flight.w[i]);
        flight.degree = counts ? i + 1 : flight.degree;
    }
    flight.dimensions = vec3_is_zero(flight.frame[1]) ? 1 : leaves_plane ? 3 : 2;
    return flight;
}

double pair_hertz_depth_under(const struct contact_pair *from, double acceleration)
{
    const double ratio = acceleration * from->reduced_mass / from->law.stiffness;
    return cbrt(ratio * ratio);
}

/*
 * The unit of s: at the deepest that present speed, load and penetration lead to, one radian of the contact's
 * oscillation, one decay time of its damping, or the time of passage, whichever is shortest. The order of
 * magnitude is enough: it keeps the coefficients within the range of numbers.
 */
static double hertz_unit(const struct contact_pair *from, double opening)
{
    const double k = from->law.stiffness / from->reduced_mass;
    /* of an impact without damping: delta_max^(5/2) = 5/4 v^2 / k */
    const double by_speed = pow(1.25 * opening * opening / k, 0.4);
    const double by_load = pair_hertz_depth_under(from, pair_load(from) / from->reduced_mass);
    const double depth = fmax(fmax(by_speed, by_load), -from->gap);
    const double root = sqrt(depth);
    const double spring = sqrt(1.5 * k * root);
    const double dashpot = k * from->chi * depth * root;
    const double passage = vec3_norm(from->flight.w[0]) / from->distance;
    const double unit = 1.0 / (fmax(spring, fmax(dashpot, passage)) * root);
    return isfinite(unit) && unit > 0.0 ? unit : 1.0;
}

/* Coefficient i of a polynomial of time, C or W, of which `terms` count. */
static double hertz_along_time(const struct pair_hertz *p, const struct hertz_recurrence *z,
                               double a[][HERTZ_DIMENSIONS], int terms, int j, int i)
{
    double sum = (i == 0 ? a[0][j] : 0.0) + (terms > 1 ? a[1][j] * p->time[i] : 0.0);
    for (int k = 2; k < terms; ++k) {
        sum += a[k][j] * z->power[k][i];
    }
    return sum;
}

/* Coefficient i of c, its rates, d, n and of both rates of the gap, from those of t, u, r and r'. */
static void hertz_geometry(struct pair_hertz *p, struct hertz_recurrence *z, int i)
{
    const struct contact_pair *from = p->from;
    const double side = from->shape.side;
    double speed = 0.0;
    double closing = 0.0;
    for (int k = 2; k <= p->flight.degree; ++k) {
        z->power[k][i] = series_product(k == 2 ? p->time : z->power[k - 1], p->time, i);
    }
    z->square[i] = series_product(p->root, p->root, i);
    z->d[i] = i == 0 ? from->distance : -side * z->square[i];
    for (int j = 0; j < p->flight.dimensions; ++j) {
        z->w[j][i] = hertz_along_time(p, z, p->flight.w, p->flight.degree, j, i) + p->r_rate[j][i];
        if (p->flight.dimensions == 1) {
            z->n[0][i] = i == 0 ? 1.0 : 0.0;
            speed = z->w[0][i];
        } else {
            z->c[j][i] = hertz_along_time(p, z, p->flight.c, p->flight.degree + 1, j, i) + p->r[j][i];
            z->n[j][i] = 0.0;
            z->n[j][i] = (z->c[j][i] - series_product(z->d, z->n[j], i)) / z->d[0];
            speed += series_product(z->n[j], z->w[j], i);
        }
        if (from->has_mismatch) {
            double derivative = p->r_rate[j][i];
            for (int k = 1; k <= p->flight.degree; ++k) {
                const double power = k == 1 ? (i == 0) : k == 2 ? p->time[i] : z->power[k - 1][i];
                derivative += k * p->flight.c[k][j] * power;
            }
            z->c_rate[j][i] = derivative;
            closing += series_product(z->n[j], z->c_rate[j], i);
        }
    }
    const bool is_carried = i == 0 && !isnan(from->carried_rate);
    p->rate[i] = is_carried ? from->carried_rate : side * speed;
    z->opening[i] = !from->has_mismatch ? p->rate[i] : i == 0 ? pair_gap_derivative(from) : side * closing;
}

/* Coefficient i of everything, from those below and of t, u, r, r'; then i + 1 of these. */
static void hertz_coefficient(struct pair_hertz *p, struct hertz_recurrence *z, int i)
{
    const struct contact_pair *from = p->from;
    hertz_geometry(p, z, i);
    p->cube[i] = series_product(z->square, p->root, i);
    p->force[i] = from->law.stiffness * p->cube[i];
    if (from->chi > 0.0) {
        z->damping[i] = (i == 0 ? 1.0 : 0.0) - from->chi * p->rate[i];
        p->force[i] = from->law.stiffness * series_product(p->cube, z->damping, i);
    }
    z->impulse[i] = series_product(p->root, p->force, i);
    if (i + 1 == TAYLOR_TERMS) {
        return;
    }
    const double unit = p->unit / (i + 1);
    p->time[i + 1] = unit * p->root[i];
    p->root[i + 1] = -0.5 * unit * z->opening[i];
    for (int j = 0; j < p->flight.dimensions; ++j) {
        const double push =
            p->flight.dimensions == 1 ? z->impulse[i] : series_product(z->impulse, z->n[j], i);
        p->r[j][i + 1] = unit * series_product(p->root, p->r_rate[j], i);
        p->r_rate[j][i + 1] = from->shape.side * unit / from->reduced_mass * push;
    }
}

/* The last terms of a step may be this part of the whole: what follows them is less, for a step is a quarter
 * of the radius of convergence. */
static const double LAST_TERM = 2.0 * DBL_EPSILON;

static double largest_coefficient(const double *a, int first)
{
    double largest = 0.0;
    for (int i = first; i < TAYLOR_TERMS; ++i) {
        largest = fmax(largest, fabs(a[i]));
    }
    return largest;
}

/* From the touch on every fifth coefficient of a free impact is other than zero, so that the last five are
 * looked at. */
enum { HERTZ_LAST = 5 };

/* Longest step [units]: without force, as a damped contact parts, the series are finite sums, and terms that
 * are left out may have vanished below the range of numbers. */
static const double LONGEST_HERTZ = 16.0;

/* Jorba and Zou: the step at which the last coefficients are a rounding of the whole. */
static double hertz_reliable_step(const struct pair_hertz *p, const struct hertz_recurrence *z)
{
    /* u is as large as its first coefficients, for s is of order one */
    const double root = fmax(fabs(p->root[0]), fmax(fabs(p->root[1]), fabs(p->root[2])));
    double speed = fabs(p->rate[0]);
    double step = LONGEST_HERTZ;
    for (int j = 0; j < p->flight.dimensions; ++j) {
        speed = fmax(speed, largest_coefficient(p->r_rate[j], 1));
    }
    for (int i = TAYLOR_TERMS - HERTZ_LAST; i < TAYLOR_TERMS; ++i) {
        double part = fmax(fabs(p->root[i]) / root, fabs(p->rate[i]) / speed);
        for (int j = 0; j < p->flight.dimensions; ++j) {
            part = fmax(part, fmax(fabs(p->r_rate[j][i]) / speed, fabs(z->n[j][i])));
        }
        step = fmin(step, pow(LAST_TERM / part, 1.0 / i));
    }
    return step;
}

void pair_hertz_make(struct pair_hertz *p, const struct contact_pair *from)
{
    struct hertz_recurrence z;
    p->from = from;
    p->flight = hertz_flight_of(from);
    p->unit = hertz_unit(from, pair_gap_derivative(from));
    p->time[0] = 0.0;
    p->root[0] = sqrt(fmax(-from->gap, 0.0));
    for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
        p->r[j][0] = p->r_rate[j][0] = 0.0;
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        hertz_coefficient(p, &z, i);
    }
    p->step = hertz_reliable_step(p, &z);
}

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

static void hertz_root_at(const void *pair_hertz, double s, double *value, double *slope)
{
    const struct pair_hertz *p = pair_hertz;
    double u[3];
    hertz_series_at(p->root, s, u);
    *value = u[0];
    *slope = u[1];
}

static void hertz_root_slope_at(const void *pair_hertz, double s, double *value, double *slope)
{
    const struct pair_hertz *p = pair_hertz;
    double u[3];
    hertz_series_at(p->root, s, u);
    *value = u[1];
    *slope = u[2];
}

/* Places between which u has one extremum at most: a step is a quarter of the radius of convergence. */
enum { PARTING_PLACES = 4 };

double pair_hertz_parting(const struct pair_hertz *p, double end)
{
    struct root_bracket_end low = {0.0, p->root[0], p->root[1]};
    if (low.value == 0.0 && !(low.slope > 0.0)) {
        return 0.0;
    }
    for (int i = 1; i <= PARTING_PLACES; ++i) {
        struct root_bracket_end high = {.s = end * i / PARTING_PLACES};
        hertz_root_at(p, high.s, &high.value, &high.slope);
        if (high.value > 0.0 && low.value > 0.0 && low.slope < 0.0 && high.slope > 0.0) {
            struct root_bracket_end dip = {.s = root_in_bracket(hertz_root_slope_at, p, low.s, high.s)};
            hertz_root_at(p, dip.s, &dip.value, &dip.slope);
            high = dip.value <= 0.0 ? dip : high;
        }
        if (high.value <= 0.0) {
            return low.value > 0.0 ? root_between(hertz_root_at, p, low, high)
                                   : root_in_bracket(hertz_root_at, p, 0.25 * high.s, high.s);
        }
        low = high;
    }
    return (double)INFINITY;
}

void pair_hertz_sample(const void *pair_hertz, double s, struct pair_sample *sample)
{
    const struct pair_hertz *p = pair_hertz;
    double u[3];
    hertz_series_at(p->root, s, u);
    sample->of[PAIR_GAP][0] = -u[0] * u[0];
    sample->of[PAIR_GAP][1] = -2.0 * u[0] * u[1];
    sample->of[PAIR_GAP][2] = -2.0 * (u[1] * u[1] + u[0] * u[2]);
    hertz_series_at(p->rate, s, sample->of[PAIR_GAP_RATE]);
    hertz_series_at(p->force, s, sample->of[PAIR_FORCE]);
}

/* The integral of pair_work over [0, s]: of path(t) r'_s ds, order 2, or path(t) r_s ds, order 1. */
static double hertz_work(const struct pair_hertz *p, const struct pair_work *work, double s)
{
    series slope;
    series path;
    double sum = 0.0;
    if (work->order == 0) {
        return 0.0;
    }
    for (int j = 0; j < p->flight.dimensions; ++j) {
        const double *row = work->order == 1 ? p->r[j] : p->r_rate[j];
        const double a[3] = {vec3_dot(work->path[0], p->flight.frame[j]),
                             vec3_dot(work->path[1], p->flight.frame[j]),
                             vec3_dot(work->path[2], p->flight.frame[j])};
        sum += a[0] * (taylor_at(row, TAYLOR_TERMS, s) - row[0]);
        if (a[1] == 0.0 && a[2] == 0.0) {
            continue;
        }
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            path[i] = a[1] * p->time[i] + a[2] * series_product(p->time, p->time, i);
            slope[i] = i + 1 < TAYLOR_TERMS ? (i + 1) * row[i + 1] : 0.0;
        }
        series whole;
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            whole[i] = series_product(path, slope, i);
        }
        sum += taylor_integral(whole, TAYLOR_TERMS, s);
    }
    return sum;
}

/* The integral of -(F_n - k_h u^3) g' dt, dt = unit u ds. */
static double hertz_dissipated(const struct pair_hertz *p, double s)
{
    series damped;
    series power;
    if (!(p->from->chi > 0.0)) {
        return 0.0;
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        damped[i] = p->from->law.stiffness * p->cube[i] - p->force[i];
        power[i] = series_product(damped, p->rate, i);
    }
    series by_s;
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        by_s[i] = series_product(power, p->root, i);
    }
    return p->unit * taylor_integral(by_s, TAYLOR_TERMS, s);
}

struct pair_change pair_hertz_change(const void *pair_hertz, double s)
{
    const struct pair_hertz *p = pair_hertz;
    const double u = taylor_at(p->root, TAYLOR_TERMS, s);
    struct vec3 r = vec3_make(0.0, 0.0, 0.0);
    struct vec3 r_rate = r;
    for (int j = 0; j < p->flight.dimensions; ++j) {
        r = vec3_axpy(r, taylor_at(p->r[j], TAYLOR_TERMS, s), p->flight.frame[j]);
        r_rate = vec3_axpy(r_rate, taylor_at(p->r_rate[j], TAYLOR_TERMS, s), p->flight.frame[j]);
    }
    return (struct pair_change){
        .time = pair_hertz_time(p, s),
        .r = r,
        .r_rate = r_rate,
        .gap = -u * u,
        .dissipated = hertz_dissipated(p, s),
        .work = {hertz_work(p, &p->from->work[0], s), hertz_work(p, &p->from->work[1], s)}};
}
