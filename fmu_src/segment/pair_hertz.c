#include "segment/pair_hertz.h"

#include <float.h>

#include "math/compiler.h"
#include "math/nodal_values.h"
#include "math/root.h"

typedef double series[TAYLOR_TERMS];
typedef double series3[HERTZ_DIMENSIONS][TAYLOR_TERMS];

/* Everything that the recurrence needs besides the results. */
struct hertz_recurrence {
    series power[SEPARATION_DEGREE + 1]; /* t^k, k from 2 on */
    series3 w;                           /* rate of the separation as the law sees it [m/s] */
    series3 c_rate;                      /* its derivative, where that is another [m/s] */
    series3 n;
    series d;                              /* [m] */
    series opening;                        /* dg/dt [m/s] */
    series square;                         /* u^2 */
    series damping;                        /* 1 + chi delta' */
    series impulse;                        /* u F_n */
    double inverse_distance, side_by_mass; /* 1/d at the start [1/m], side/m_red [1/kg] */
};

/* Coefficient `order` of a product. */
static double series_product(const double *a, const double *b, int order)
{
    double sum[2] = {0.0, 0.0}; /* two, because one would wait for each of its additions */
    int i = 0;
    for (; i < order; i += 2) {
        sum[0] += a[i] * b[order - i];
        sum[1] += a[i + 1] * b[order - i - 1];
    }
    return sum[0] + sum[1] + (i == order ? a[i] * b[0] : 0.0);
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

/* The parts of products at one order that come from lower ones. */
struct hertz_sums {
    double time2, square, cube, force, impulse, speed;
    double n[HERTZ_DIMENSIONS], push[HERTZ_DIMENSIONS], r[HERTZ_DIMENSIONS];
};

/* row[i], row[i - 1], ...: as many as one instruction takes. */
static inline double2 backwards(const double *row, int i)
{
#if CONTACT_GNU_C
    return (double2){row[i], row[i - 1]};
#else
    return row[i];
#endif
}

static inline double lanes_together(double2 a)
{
#if CONTACT_GNU_C
    return a[0] + a[1];
#else
    return a;
#endif
}

/* Of scalars, all in one loop, so that none waits for another. */
static inline void hertz_lower_scalars(const struct pair_hertz *p, const struct hertz_recurrence *z, int i,
                                       struct hertz_sums *sum)
{
    double2 time2 = {0.0};
    double2 square = {0.0};
    double2 cube = {0.0};
    double2 force = {0.0};
    double2 impulse = {0.0};
    int k = 1;
    for (; k + LANES <= i; k += LANES) {
        const double2 root = double2_at(p->root, k);
        const double2 roots = backwards(p->root, i - k);
        time2 += double2_at(p->time, k) * backwards(p->time, i - k);
        square += root * roots;
        cube += double2_at(z->square, k) * roots;
        force += double2_at(p->cube, k) * backwards(z->damping, i - k);
        impulse += root * backwards(p->force, i - k);
    }
    const bool is_left = k < i;
    sum->time2 = lanes_together(time2) + (is_left ? p->time[k] * p->time[i - k] : 0.0);
    sum->square = lanes_together(square) + (is_left ? p->root[k] * p->root[i - k] : 0.0);
    sum->cube = lanes_together(cube) + (is_left ? z->square[k] * p->root[i - k] : 0.0);
    sum->force = lanes_together(force) + (is_left ? p->cube[k] * z->damping[i - k] : 0.0);
    sum->impulse = lanes_together(impulse) + (is_left ? p->root[k] * p->force[i - k] : 0.0);
}

/* Of one component. */
static inline void hertz_lower_component(const struct pair_hertz *p, const struct hertz_recurrence *z, int i,
                                         int j, bool turns, struct hertz_sums *sum)
{
    double2 r = {0.0};
    double2 n = {0.0};
    double2 push = {0.0};
    double2 speed = {0.0};
    int k = 1;
    for (; k + LANES <= i; k += LANES) {
        r += double2_at(p->root, k) * backwards(p->r_rate[j], i - k);
        if (turns) {
            const double2 normal = backwards(z->n[j], i - k);
            n += double2_at(z->d, k) * normal;
            push += double2_at(z->impulse, k) * normal;
            speed += double2_at(z->w[j], k) * normal;
        }
    }
    const bool is_left = k < i;
    sum->r[j] = lanes_together(r) + (is_left ? p->root[k] * p->r_rate[j][i - k] : 0.0);
    if (turns) {
        const double normal = is_left ? z->n[j][i - k] : 0.0;
        sum->n[j] = lanes_together(n) + (is_left ? z->d[k] * normal : 0.0);
        sum->push[j] = lanes_together(push) + (is_left ? z->impulse[k] * normal : 0.0);
        sum->speed += lanes_together(speed) + (is_left ? z->w[j][k] * normal : 0.0);
    }
}

/* Coefficient i of the derivative of c along n, where W is another. */
static double hertz_closing(const struct pair_hertz *p, struct hertz_recurrence *z, int i, int dimensions)
{
    double closing = 0.0;
    for (int j = 0; j < dimensions; ++j) {
        double rate = p->r_rate[j][i];
        for (int k = 1; k <= p->flight.degree; ++k) {
            const double power = k == 1 ? (i == 0) : k == 2 ? p->time[i] : z->power[k - 1][i];
            rate += k * p->flight.c[k][j] * power;
        }
        z->c_rate[j][i] = rate;
        for (int k = 0; k <= i; ++k) {
            closing += z->n[j][k] * z->c_rate[j][i - k];
        }
    }
    return closing;
}

/* Coefficient i of d, n, w and of both rates of the gap, from those of t, u, r and r'. */
static inline void hertz_geometry(struct pair_hertz *p, struct hertz_recurrence *z, int i,
                                  const struct hertz_sums *sum, int dimensions)
{
    const struct contact_pair *from = p->from;
    const double side = from->shape.side;
    double speed = dimensions > 1 ? sum->speed : 0.0;
    for (int k = 2; k <= p->flight.degree; ++k) {
        z->power[k][i] = k == 2 ? sum->time2 : series_product(z->power[k - 1], p->time, i);
    }
    z->square[i] = sum->square + (i == 0 ? 1.0 : 2.0) * p->root[0] * p->root[i];
    z->d[i] = i == 0 ? from->distance : -side * z->square[i];
    for (int j = 0; j < dimensions; ++j) {
        z->w[j][i] = hertz_along_time(p, z, p->flight.w, p->flight.degree, j, i) + p->r_rate[j][i];
        z->n[j][i] = i == 0 && j == 0 ? 1.0 : 0.0;
        if (dimensions > 1 && i > 0) {
            const double c = hertz_along_time(p, z, p->flight.c, p->flight.degree + 1, j, i) + p->r[j][i];
            z->n[j][i] = (c - sum->n[j] - z->d[i] * z->n[j][0]) * z->inverse_distance;
            speed += z->n[j][i] * z->w[j][0];
        }
    }
    speed += z->w[0][i]; /* n[0] is the first direction of the frame */
    p->rate[i] = i == 0 && !isnan(from->carried_rate) ? from->carried_rate : side * speed;
    z->opening[i] = !from->has_mismatch ? p->rate[i]
                    : i == 0            ? pair_gap_derivative(from)
                                        : side * hertz_closing(p, z, i, dimensions);
    if (from->has_mismatch && i == 0) {
        (void)hertz_closing(p, z, 0, dimensions);
    }
}

/* 1 / i: a division would keep the next order waiting. */
#define RECIPROCALS(i) 1.0 / (i), 1.0 / ((i) + 1), 1.0 / ((i) + 2), 1.0 / ((i) + 3)
static const double reciprocal[TAYLOR_TERMS] = {
    0.0, RECIPROCALS(1), RECIPROCALS(5), RECIPROCALS(9), RECIPROCALS(13), RECIPROCALS(17), RECIPROCALS(21)};

/* Coefficient i of everything, from those below and of t, u, r, r'; then i + 1 of these. */
static inline void hertz_coefficient(struct pair_hertz *p, struct hertz_recurrence *z, int i, int dimensions)
{
    const struct contact_pair *from = p->from;
    const double both = i == 0 ? 0.0 : 1.0; /* the first and the last term of a product are two */
    struct hertz_sums sum;
    hertz_lower_scalars(p, z, i, &sum);
    sum.speed = 0.0;
    for (int j = 0; j < dimensions; ++j) {
        hertz_lower_component(p, z, i, j, dimensions > 1, &sum);
    }
    hertz_geometry(p, z, i, &sum, dimensions);
    p->cube[i] = sum.cube + z->square[i] * p->root[0] + both * z->square[0] * p->root[i];
    z->damping[i] = (i == 0 ? 1.0 : 0.0) - from->chi * p->rate[i];
    p->force[i] =
        from->law.stiffness * (sum.force + p->cube[i] * z->damping[0] + both * p->cube[0] * z->damping[i]);
    z->impulse[i] = sum.impulse + p->root[0] * p->force[i] + both * p->root[i] * p->force[0];
    if (i + 1 == TAYLOR_TERMS) {
        return;
    }
    const double unit = p->unit * reciprocal[i + 1];
    p->time[i + 1] = unit * p->root[i];
    p->root[i + 1] = -0.5 * unit * z->opening[i];
    for (int j = 0; j < dimensions; ++j) {
        const double push =
            dimensions == 1 ? z->impulse[i]
                            : sum.push[j] + z->impulse[i] * z->n[j][0] + both * z->impulse[0] * z->n[j][i];
        p->r[j][i + 1] = unit * (sum.r[j] + p->root[0] * p->r_rate[j][i]);
        p->r_rate[j][i + 1] = unit * (z->side_by_mass * push);
    }
}

/* From the touch on every fifth coefficient of a free impact is other than zero, so that the last five are
 * looked at. */
enum { HERTZ_LAST = 5 };

/* Longest step [units]: without force, as a damped contact parts, the series are finite sums, and terms that
 * are left out may have vanished below the range of numbers. */
static const double LONGEST_HERTZ = 16.0;

/* Jorba and Zou: the step at which the first term left out is this part of the whole, by the least radius of
 * convergence that the last coefficients tell. */
static double hertz_reliable_step(const struct pair_hertz *p, const struct hertz_recurrence *z,
                                  double accuracy)
{
    /* u is as large as its first coefficients, for s is of order one */
    const double root = fmax(fabs(p->root[0]), fmax(fabs(p->root[1]), fabs(p->root[2])));
    double speed = fabs(p->rate[0]);
    double radius = (double)INFINITY;
    for (int i = 1; i < TAYLOR_TERMS; ++i) {
        for (int j = 0; j < p->flight.dimensions; ++j) {
            speed = fmax(speed, fabs(p->r_rate[j][i]));
        }
    }
    for (int i = TAYLOR_TERMS - HERTZ_LAST; i < TAYLOR_TERMS; ++i) {
        double part = fmax(fabs(p->root[i]) / root, fabs(p->rate[i]) / speed);
        for (int j = 0; j < p->flight.dimensions; ++j) {
            part = fmax(part, fmax(fabs(p->r_rate[j][i]) / speed, fabs(z->n[j][i])));
        }
        radius = fmin(radius, pow(part, -1.0 / i));
    }
    return fmin(LONGEST_HERTZ, radius * pow(accuracy, 1.0 / TAYLOR_TERMS));
}

/* A number of dimensions at a time, each a constant. */
static CONTACT_FLATTEN void hertz_coefficients(struct pair_hertz *p, struct hertz_recurrence *z)
{
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        if (p->flight.dimensions == 1) {
            hertz_coefficient(p, z, i, 1);
        } else if (p->flight.dimensions == 2) {
            hertz_coefficient(p, z, i, 2);
        } else {
            hertz_coefficient(p, z, i, HERTZ_DIMENSIONS);
        }
    }
}

void pair_hertz_make(struct pair_hertz *p, const struct contact_pair *from, double accuracy)
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
    z.inverse_distance = 1.0 / from->distance;
    z.side_by_mass = from->shape.side / from->reduced_mass;
    hertz_coefficients(p, &z);
    p->step = hertz_reliable_step(p, &z, accuracy);
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

/* A step is a third of the radius of convergence at most, so that u has one extremum in it. */
double pair_hertz_parting(const struct pair_hertz *p, double end)
{
    const struct root_bracket_end low = {0.0, p->root[0], p->root[1]};
    struct root_bracket_end high = {.s = end};
    if (low.value == 0.0 && !(low.slope > 0.0)) {
        return 0.0;
    }
    hertz_root_at(p, end, &high.value, &high.slope);
    if (high.value > 0.0 && low.value > 0.0 && low.slope < 0.0 && high.slope > 0.0) {
        struct root_bracket_end dip = {.s = root_in_bracket(hertz_root_slope_at, p, low.s, high.s)};
        hertz_root_at(p, dip.s, &dip.value, &dip.slope);
        high = dip.value <= 0.0 ? dip : high;
    }
    if (high.value > 0.0) {
        return (double)INFINITY;
    }
    if (low.value > 0.0) {
        return root_between(hertz_root_at, p, low, high);
    }
    /* it rises from zero: its root is beyond its top */
    return root_in_bracket(hertz_root_at, p, root_in_bracket(hertz_root_slope_at, p, 0.0, end), end);
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
    series slope[HERTZ_DIMENSIONS];
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
        series along = {0.0};
        series power;
        for (int i = 0; i + 1 < TAYLOR_TERMS; ++i) {
            along[i] = path[0] * (i == 0) + path[1] * p->time[i];
            along[i] += path[2] == 0.0 ? 0.0 : path[2] * series_product(p->time, p->time, i);
            power[i] = is_steady ? path[0] * slope[j][i] : series_product(along, slope[j], i);
        }
        sum += taylor_integral(power, TAYLOR_ORDER, s);
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

/* A row of vectors at s, in the world. */
static struct vec3 hertz_vector_at(const struct pair_hertz *p, double rows[][TAYLOR_TERMS], double s)
{
    double sum[HERTZ_DIMENSIONS] = {0.0, 0.0, 0.0};
    struct vec3 out = vec3_make(0.0, 0.0, 0.0);
    for (int i = TAYLOR_TERMS - 1; i >= 0; --i) {
        for (int j = 0; j < p->flight.dimensions; ++j) {
            sum[j] = sum[j] * s + rows[j][i];
        }
    }
    for (int j = 0; j < p->flight.dimensions; ++j) {
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
