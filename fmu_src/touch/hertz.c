#include <float.h>

#include "math/polynomial.h"
#include "touch/hertz.h"
#include "touch/pair.h"
#include "touch/segment.h"
#include "touch/terminal_event.h"

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
    double time2, square, fourth, drag, speed;
    double n[HERTZ_DIMENSIONS], push[HERTZ_DIMENSIONS], r[HERTZ_DIMENSIONS];
};

/* Where a row backwards has the factors of the coefficients 1, 2, ... of another in their product's
 * coefficient i. */
static inline const double *back_from(const double *back, int i)
{
    return back + (TAYLOR_ORDER - i);
}

/* Of scalars, all in one loop, so that none waits for another. Its last pair may hold the first coefficient
 * that is not known: zero so far, as is what it is multiplied with. */
static inline void hertz_lower_scalars(const struct pair_hertz *p, const struct hertz_recurrence *z, int i,
                                       struct hertz_sums *sum)
{
    const double *times = back_from(z->time_back, i);
    const double *roots = back_from(z->root_back, i);
    const double *squares = back_from(z->square_back, i);
    const double *rates = back_from(z->rate_back, i);
    double2 time2 = {0.0};
    double2 square = {0.0};
    double2 fourth = {0.0};
    double2 drag = {0.0};
    for (int k = 1; k < i; k += LANES) {
        time2 += double2_at(p->time, k) * double2_at(times, k);
        square += double2_at(p->root, k) * double2_at(roots, k);
        fourth += double2_at(z->square, k) * double2_at(squares, k);
        drag += double2_at(z->fourth, k) * double2_at(rates, k);
    }
    sum->time2 = lanes_together(time2);
    sum->square = lanes_together(square);
    sum->fourth = lanes_together(fourth);
    sum->drag = lanes_together(drag);
}

/* Of vectors, all components in one loop: they share factors. */
static inline void hertz_lower_vectors(const struct pair_hertz *p, const struct hertz_recurrence *z, int i,
                                       int dimensions, struct hertz_sums *sum)
{
    double2 r[HERTZ_DIMENSIONS];
    double2 n[HERTZ_DIMENSIONS];
    double2 push[HERTZ_DIMENSIONS];
    double2 speed = {0.0};
    for (int j = 0; j < dimensions; ++j) {
        r[j] = n[j] = push[j] = speed;
    }
    for (int k = 1; k < i; k += LANES) {
        const double2 root = double2_at(p->root, k);
        const double2 d = double2_at(z->d, k);
        const double2 impulse = double2_at(z->impulse, k);
        for (int j = 0; j < dimensions; ++j) {
            r[j] += root * double2_at(back_from(z->r_rate_back[j], i), k);
            if (dimensions > 1) {
                const double2 normal = double2_at(back_from(z->n_back[j], i), k);
                n[j] += d * normal;
                push[j] += impulse * normal;
                speed += double2_at(z->w[j], k) * normal;
            }
        }
    }
    for (int j = 0; j < dimensions; ++j) {
        sum->r[j] = lanes_together(r[j]);
        sum->n[j] = lanes_together(n[j]);
        sum->push[j] = lanes_together(push[j]);
    }
    sum->speed = lanes_together(speed);
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

/* What is known while the code is made: fewer dimensions, a lower degree and no mismatch cost less. */
struct hertz_kind {
    int dimensions, degree;
    bool has_mismatch;
    bool first; /* order zero, of which the first and the last term of a product are one */
};

/* Coefficient i of d, n, w and of both rates of the gap, from those of t, u, r and r'. */
static inline void hertz_geometry(struct pair_hertz *p, struct hertz_recurrence *z, int i,
                                  const struct hertz_sums *sum, struct hertz_kind kind)
{
    const struct contact_pair *from = p->from;
    const double side = from->shape.side;
    double speed = kind.dimensions > 1 ? sum->speed : 0.0;
    for (int k = 2; k <= kind.degree; ++k) {
        z->power[k][i] = k == 2 ? sum->time2 : series_product(z->power[k - 1], p->time, i);
    }
    z->square[i] = sum->square + (kind.first ? 1.0 : 2.0) * p->root[0] * p->root[i];
    z->d[i] = kind.first ? from->distance : -side * z->square[i];
    for (int j = 0; j == 0 || j < kind.dimensions; ++j) {
        z->w[j][i] = hertz_along_time(p, z, p->flight.w, kind.degree, j, i) + p->r_rate[j][i];
        z->n[j][i] = kind.first && j == 0 ? 1.0 : 0.0;
        if (kind.dimensions > 1 && !kind.first) {
            const double c = hertz_along_time(p, z, p->flight.c, kind.degree + 1, j, i) + p->r[j][i];
            z->n[j][i] = (c - sum->n[j] - z->d[i] * z->n[j][0]) * z->inverse_distance;
            speed += z->n[j][i] * z->w[j][0];
        }
    }
    speed += z->w[0][i]; /* n[0] is the first direction of the frame */
    p->rate[i] = kind.first && !isnan(from->carried_rate) ? from->carried_rate : side * speed;
    z->opening[i] = !kind.has_mismatch ? p->rate[i]

                    : kind.first ? pair_gap_derivative(from)
                                 : side * hertz_closing(p, z, i, kind.dimensions);
    if (kind.has_mismatch && kind.first) {
        (void)hertz_closing(p, z, 0, kind.dimensions);
    }
}

/* 1 / i: a division would keep the next order waiting. */
#define RECIPROCALS(i) 1.0 / (i), 1.0 / ((i) + 1), 1.0 / ((i) + 2), 1.0 / ((i) + 3)
static const double reciprocal[TAYLOR_TERMS] = {
    0.0, RECIPROCALS(1), RECIPROCALS(5), RECIPROCALS(9), RECIPROCALS(13), RECIPROCALS(17), RECIPROCALS(21)};

/* Coefficient i of u^4, of the dashpot's part of u F_n, and of u F_n. */
static inline void hertz_impulse(struct pair_hertz *p, struct hertz_recurrence *z, int i,
                                 const struct hertz_sums *sum, struct hertz_kind kind)
{
    const struct contact_pair *from = p->from;
    const double both = kind.first ? 0.0 : 1.0;
    z->fourth[i] = sum->fourth + (1.0 + both) * z->square[0] * z->square[i];
    const double drag = sum->drag + z->fourth[i] * p->rate[0] + both * z->fourth[0] * p->rate[i];
    p->drag[i] = from->hertz_stiffness * from->chi * drag;
    z->impulse[i] = from->hertz_stiffness * z->fourth[i] - p->drag[i];
}

/* Coefficient i + 1 of t, u, r and r'. */
static inline void hertz_next(struct pair_hertz *p, struct hertz_recurrence *z, int i,
                              const struct hertz_sums *sum, struct hertz_kind kind)
{
    const double both = kind.first ? 0.0 : 1.0;
    const double unit = p->unit * reciprocal[i + 1];
    p->time[i + 1] = unit * p->root[i];
    p->root[i + 1] = -0.5 * unit * z->opening[i];
    for (int j = 0; j < kind.dimensions; ++j) {
        const double push = kind.dimensions == 1 ? z->impulse[i]
                                                 : sum->push[j] + z->impulse[i] * z->n[j][0] +
                                                       both * z->impulse[0] * z->n[j][i];
        p->r[j][i + 1] = unit * (sum->r[j] + p->root[0] * p->r_rate[j][i]);
        p->r_rate[j][i + 1] = unit * (z->side_by_mass * push);
    }
}

/* What the sums of the next order read: rows backwards, but for their first coefficients, and zeros where the
 * sums reach beyond what is known. */
static inline void hertz_note(struct pair_hertz *p, struct hertz_recurrence *z, int i, struct hertz_kind kind)
{
    const int back = TAYLOR_ORDER - i;
    z->time_back[back] = kind.first ? 0.0 : p->time[i];
    z->root_back[back] = kind.first ? 0.0 : p->root[i];
    z->square_back[back] = kind.first ? 0.0 : z->square[i];
    z->rate_back[back] = kind.first ? 0.0 : p->rate[i];
    z->square[i + 1] = z->fourth[i + 1] = z->d[i + 1] = z->impulse[i + 1] = 0.0;
    for (int j = 0; j < kind.dimensions; ++j) {
        z->n_back[j][back] = kind.first ? 0.0 : z->n[j][i];
        z->r_rate_back[j][back] = kind.first ? 0.0 : p->r_rate[j][i];
        z->w[j][i + 1] = 0.0;
    }
}

static inline void hertz_order(struct pair_hertz *p, struct hertz_recurrence *z, int i,
                               struct hertz_kind kind)
{
    struct hertz_sums sum;
    hertz_lower_scalars(p, z, i, &sum);
    hertz_lower_vectors(p, z, i, kind.dimensions, &sum);
    hertz_geometry(p, z, i, &sum, kind);
    hertz_impulse(p, z, i, &sum, kind);
    if (i < TAYLOR_ORDER) {
        hertz_next(p, z, i, &sum, kind);
        hertz_note(p, z, i, kind);
    }
}

/* Orders that the recurrence takes in one go: from `begin` up to but without `end`. */
struct hertz_orders {
    int begin, end;
};

static inline void hertz_run(struct pair_hertz *p, struct hertz_recurrence *z, struct hertz_orders orders,
                             struct hertz_kind kind)
{
    if (orders.begin == 0) {
        hertz_order(p, z, 0, (struct hertz_kind){kind.dimensions, kind.degree, kind.has_mismatch, true});
    }
    for (int i = orders.begin > 0 ? orders.begin : 1; i < orders.end; ++i) {
        hertz_order(p, z, i, kind);
    }
}

/* Under constant forces the degree is two at most. */
CONTACT_FLATTEN void hertz_recurrence_run(struct pair_hertz *p, struct hertz_recurrence *z, int begin,
                                          int end)
{
    const struct hertz_flight *flight = &p->flight;
    const struct hertz_orders orders = {begin, end};
    if (flight->degree > 2 || p->from->has_mismatch) {
        const struct hertz_kind any = {flight->dimensions, flight->degree, p->from->has_mismatch, false};
        hertz_run(p, z, orders, any);
    } else if (flight->dimensions == 1) {
        hertz_run(p, z, orders, (struct hertz_kind){1, 2, false, false});
    } else if (flight->dimensions == 2) {
        hertz_run(p, z, orders, (struct hertz_kind){2, 2, false, false});
    } else {
        hertz_run(p, z, orders, (struct hertz_kind){HERTZ_DIMENSIONS, 2, false, false});
    }
}

/* Components across the plane of motion by less than this part are rounding. */
static const double OUT_OF_PLANE = 8.0 * DBL_EPSILON;

/* What rounding leaves of a vector along the normal points anywhere. Of its direction that part is tangential
 * which a second projection leaves; less than this is none. */
static const double MOSTLY_NORMAL = 0.5;

/* The first tangential direction that the motion of flight has; none: head-on. */
static struct vec3 hertz_tangent(const struct contact_pair *from)
{
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const struct vec3 rows[2] = {from->flight.c[i], from->flight.w[i - 1]};
        for (int k = 0; k < 2; ++k) {
            const struct vec3 across = pair_across(from, rows[k]);
            const struct vec3 along = pair_tangential(from, across);
            if (!vec3_is_zero(along) && !vec3_is_zero(vec3_cross(from->normal, across))) {
                const struct vec3 direction = vec3_scale(1.0 / vec3_norm(along), along);
                const struct vec3 tangent = pair_tangential(from, direction);
                const double left = vec3_norm(tangent);
                if (left > MOSTLY_NORMAL) {
                    return vec3_scale(1.0 / left, tangent);
                }
            }
        }
    }
    return vec3_make(0.0, 0.0, 0.0);
}

/* One coefficient in the frame; whether it is out of the plane. */
static bool hertz_to_frame(const struct contact_pair *from, struct hertz_flight *flight, struct vec3 a,
                           double out[HERTZ_DIMENSIONS])
{
    out[0] = out[1] = out[2] = 0.0;
    if (vec3_is_zero(a)) {
        return false;
    }
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
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        leaves_plane = hertz_to_frame(from, &flight, from->flight.c[i], flight.c[i]) || leaves_plane;
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
    const double ratio = acceleration * from->reduced_mass / from->hertz_stiffness;
    return cbrt(ratio * ratio);
}

double pair_hertz_depth_to_come(const struct contact_pair *from, double opening)
{
    const double k = from->hertz_stiffness / from->reduced_mass;
    const double load = pair_load(from) / from->reduced_mass;
    const double speed = fabs(opening);
    const double stops = fmin(0.5 * speed, 1.0 / from->chi); /* chi = 0: the former */
    const double by_speed = pow(2.5 * speed * stops / k, 0.4);
    const double creeps = sqrt(sqrt(0.5 * load) / (k * from->chi)); /* chi = 0: INFINITY, or NaN */
    const double by_load = fmin(pair_hertz_depth_under(from, load), creeps);
    return fmax(fmax(by_speed, by_load), -from->gap);
}

/*
 * The unit of s: at the deepest that present speed, load and penetration lead to, one radian of the contact's
 * oscillation, one decay time of its damping, or the time of passage, whichever is shortest. The order of
 * magnitude is enough: it keeps the coefficients within the range of numbers.
 */
static double hertz_unit(const struct contact_pair *from, double opening)
{
    const double k = from->hertz_stiffness / from->reduced_mass;
    const double depth = pair_hertz_depth_to_come(from, opening);
    const double root = sqrt(depth);
    const double spring = sqrt(1.5 * k * root);
    const double dashpot = k * from->chi * depth * root;
    const double passage = vec3_norm(from->flight.w[0]) / from->distance;
    const double unit = 1.0 / (fmax(spring, fmax(dashpot, passage)) * root);
    return isfinite(unit) && unit > 0.0 ? unit : 1.0;
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
    const double root = larger(fabs(p->root[2]), larger(fabs(p->root[1]), fabs(p->root[0])));
    double speed = fabs(p->rate[0]);
    double growth = -(double)INFINITY; /* binary logarithm of 1 / the radius of convergence */
    for (int i = 1; i < TAYLOR_TERMS; ++i) {
        for (int j = 0; j < p->flight.dimensions; ++j) {
            speed = larger(fabs(p->r_rate[j][i]), speed);
        }
    }
    for (int i = TAYLOR_TERMS - HERTZ_LAST; i < TAYLOR_TERMS; ++i) {
        double part = larger(fabs(p->rate[i]) / speed, fabs(p->root[i]) / root);
        for (int j = 0; j < p->flight.dimensions; ++j) {
            part = larger(fabs(z->n[j][i]), larger(fabs(p->r_rate[j][i]) / speed, part));
        }
        growth = larger(log2(part) / i, growth);
    }
    return fmin(LONGEST_HERTZ, exp2(log2(accuracy) / TAYLOR_TERMS - growth));
}

void pair_hertz_begin(struct pair_hertz *p, struct hertz_recurrence *z, const struct contact_pair *from)
{
    p->from = from;
    p->flight = hertz_flight_of(from);
    p->unit = hertz_unit(from, pair_gap_derivative(from));
    p->time[0] = 0.0;
    p->root[0] = sqrt(fmax(-from->gap, 0.0));
    for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
        p->r[j][0] = p->r_rate[j][0] = 0.0;
    }
    z->inverse_distance = 1.0 / from->distance;
    z->side_by_mass = from->shape.side / from->reduced_mass;
    hertz_recurrence_run(p, z, 0, HERTZ_FIRST);
}

void pair_hertz_complete(struct pair_hertz *p, struct hertz_recurrence *z, double accuracy)
{
    hertz_recurrence_run(p, z, HERTZ_FIRST, TAYLOR_TERMS);
    p->step = hertz_reliable_step(p, z, accuracy);
}

void pair_hertz_make(struct pair_hertz *p, const struct contact_pair *from, double accuracy)
{
    struct hertz_recurrence z;
    pair_hertz_begin(p, &z, from);
    pair_hertz_complete(p, &z, accuracy);
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

/* Gauss-Legendre rule on [-1, 1], 26 points, the positive half. The nearest singularities of dt/dw are the
 * roots of P: of an impact without load at w = +-0.966 +- 0.492 i, on the ellipse about -1 and 1 whose half
 * axes add up to 2.03. Over a whole impact the rule is off by 2.03^-52 = 1e-16; with the largest load allowed
 * the ellipse is of 1.93, and that is 1e-15. */
static const struct {
    double node, weight;
} gauss[] = {
    {0.05923009342931321, 0.11832141527926228}, {0.17685882035689018, 0.11666044348529658},
    {0.2920048394859569, 0.11336181654631966},  {0.4030517551234863, 0.10847184052857659},
    {0.5084407148245057, 0.10205916109442542},  {0.6066922930176181, 0.09421380035591415},
    {0.6964272604199573, 0.08504589431348523},  {0.7763859488206789, 0.07468414976565975},
    {0.845445942788498, 0.06327404632957484},   {0.9026378619843071, 0.05097582529714781},
    {0.9471590666617142, 0.037962383294362766}, {0.978385445956471, 0.02441785109263191},
    {0.9958857011456169, 0.010551372617343006},
};

enum { GAUSS_HALF = sizeof gauss / sizeof gauss[0] };

/* Newton's method for delta_max from a place near it. */
enum { DEEPEST_STEPS = 50 };

/* P and its first two derivatives: e (1 + u + u^2 + u^3 + u^4) + 2 L delta_max u^2 (1 + u + u^2). */
static inline double elastic_polynomial(const struct hertz_elastic *p, double u)
{
    const double high = p->touch + p->pressed;
    return p->touch + u * (p->touch + u * high * (1.0 + u * (1.0 + u)));
}

static void elastic_polynomial_slopes(const struct hertz_elastic *p, double u, double out[2])
{
    const double high = p->touch + p->pressed;
    out[0] = p->touch + u * high * (2.0 + u * (3.0 + u * 4.0));
    out[1] = high * (2.0 + u * (6.0 + u * 12.0));
}

static inline double elastic_root(double w)
{
    return (1.0 - w) * (1.0 + w);
}

/* dt/dw over 4 delta_max [s/m] */
static inline double elastic_pace(const struct hertz_elastic *p, double w)
{
    const double u = elastic_root(w);
    return u / sqrt(elastic_polynomial(p, u));
}

/* The time from w to w + s [s]. */
static double elastic_time_between(const struct hertz_elastic *p, double w, double s)
{
    const double half = 0.5 * s;
    const double middle = w + half;
    double sum = 0.0;
    for (int i = 0; i < GAUSS_HALF; ++i) {
        const double off = half * gauss[i].node;
        sum += gauss[i].weight * (elastic_pace(p, middle - off) + elastic_pace(p, middle + off));
    }
    return 4.0 * p->deepest * half * sum;
}

/* (4/5) k delta^(5/2) */
static double elastic_stored(double k, double depth)
{
    return 0.8 * k * depth * depth * sqrt(depth);
}

/* The root of (4/5) k delta^(5/2) = e + 2 L delta, convex: from the first step on Newton's method comes down
 * to it. */
static double elastic_deepest(double k, double load, double touch)
{
    double depth = pow(1.25 * touch / k, 0.4);
    for (int i = 0; i < DEEPEST_STEPS; ++i) {
        const double stored = elastic_stored(k, depth);
        const double missing = touch + 2.0 * load * depth - stored;
        const double step = missing / (2.5 * stored / depth - 2.0 * load);
        depth += step;
        if (!(fabs(step) > 2.0 * DBL_EPSILON * depth)) {
            break;
        }
    }
    return depth;
}

bool hertz_elastic_make(struct hertz_elastic *p, const struct contact_pair *from)
{
    const double k = from->hertz_stiffness / from->reduced_mass;
    const double depth = fmax(-from->gap, 0.0);
    if (from->chi > 0.0 || from->has_mismatch || !from->is_head_on) {
        return false;
    }
    const double rate = pair_gap_derivative(from);
    p->from = from;
    p->load = -2.0 * from->shape.side * vec3_dot(from->normal, pair_across(from, from->flight.c[2]));
    p->touch = rate * rate + elastic_stored(k, depth) - 2.0 * p->load * depth;
    p->deepest = elastic_deepest(k, p->load, p->touch);
    p->pressed = 2.0 * p->load * p->deepest;
    const bool free =
        !contact_may_reach_centre(&from->shape) || p->deepest < 0.5 * contact_reach(&from->shape);
    if (!(p->touch > 0.0 && p->touch >= 2.0 * p->pressed && p->deepest > DBL_MIN && free)) {
        return false;
    }
    p->start = rate / sqrt(elastic_polynomial(p, sqrt(depth / p->deepest)));
    p->start = fmin(fmax(p->start, -1.0), 1.0);
    p->end = 1.0 - p->start;
    p->end_time = elastic_time_between(p, p->start, p->end);
    return p->end > 0.0 && isfinite(p->end_time);
}

double hertz_elastic_time(const struct hertz_elastic *p, double s)
{
    return s == p->end ? p->end_time : s == 0.0 ? 0.0 : elastic_time_between(p, p->start, s);
}

struct elastic_time_left {
    const struct hertz_elastic *of;
    double time;
};

static void elastic_time_left_at(const void *elastic_time_left, double s, double *value, double *slope)
{
    const struct elastic_time_left *left = elastic_time_left;
    *value = hertz_elastic_time(left->of, s) - left->time;
    *slope = 4.0 * left->of->deepest * elastic_pace(left->of, left->of->start + s);
}

double hertz_elastic_place(const struct hertz_elastic *p, double time)
{
    const struct elastic_time_left left = {p, time};
    return time < p->end_time ? root_in_bracket(elastic_time_left_at, &left, 0.0, p->end) : p->end;
}

void hertz_elastic_sample(const void *hertz_elastic, double s, struct pair_sample *sample)
{
    const struct hertz_elastic *p = hertz_elastic;
    const double w = s == p->end ? 1.0 : p->start + s;
    const double u = elastic_root(w);
    double slopes[2];
    elastic_polynomial_slopes(p, u, slopes);
    const double q = sqrt(elastic_polynomial(p, u));
    const double turn = -slopes[0] / q; /* dq/dw = w turn */
    const double q_bend = turn + w * w * (2.0 * slopes[1] - turn * turn) / q;
    const double by_root = p->from->hertz_stiffness * p->deepest * sqrt(p->deepest);
    sample->of[PAIR_GAP][0] = -p->deepest * u * u;
    sample->of[PAIR_GAP][1] = 4.0 * p->deepest * u * w;
    sample->of[PAIR_GAP][2] = 4.0 * p->deepest * (u - 2.0 * w * w);
    sample->of[PAIR_GAP_RATE][0] = w * q;
    sample->of[PAIR_GAP_RATE][1] = q + w * w * turn;
    sample->of[PAIR_GAP_RATE][2] = w * (2.0 * turn + q_bend);
    sample->of[PAIR_FORCE][0] = by_root * u * u * u;
    sample->of[PAIR_FORCE][1] = -6.0 * by_root * u * u * w;
    sample->of[PAIR_FORCE][2] = by_root * u * (24.0 * w * w - 6.0 * u);
}

/* The work of paths that are constant, as in pair.c. */
struct pair_change hertz_elastic_change(const void *hertz_elastic, double s)
{
    const struct hertz_elastic *p = hertz_elastic;
    const struct contact_pair *from = p->from;
    struct pair_sample at;
    hertz_elastic_sample(p, s, &at);
    const double time = hertz_elastic_time(p, s);
    const double rate = pair_gap_derivative(from);
    const double r = at.of[PAIR_GAP][0] - from->gap - (rate - 0.5 * p->load * time) * time;
    const double r_rate = at.of[PAIR_GAP_RATE][0] - rate + p->load * time;
    struct pair_change change = {.time = time,
                                 .r = vec3_scale(from->shape.side * r, from->normal),
                                 .r_rate = vec3_scale(from->shape.side * r_rate, from->normal),
                                 .gap = at.of[PAIR_GAP][0],
                                 .dissipated = 0.0};
    for (int end = 0; end < PAIR_BODIES; ++end) {
        const struct pair_work *work = &from->work[end];
        const struct vec3 by = work->order == 1 ? change.r : change.r_rate;
        change.work[end] = work->order == 0 ? 0.0 : vec3_dot(work->path[0], by);
    }
    return change;
}

/* Under Hertz's law: how long bodies at the touch hardly feel each other, and how contact ends. */

/* A contact force of this part of the load is none. */
static const double NO_FORCE = 0.5 * DBL_EPSILON;

/* Halvings of a step at most: from the longest to the shortest that double precision tells apart. */
enum { HALVINGS = 1100 };

/* Bounds of penetration [m] and relative acceleration [m/s^2] after a time without contact force. */
struct coasting {
    double depth, acceleration;
};

static struct coasting coasting_to(const struct contact_pair *from, double time)
{
    const struct vec3 *c = from->flight.c;
    const double load = pair_load(from) / from->reduced_mass;
    const double cubic = vec3_norm(c[3]) * time;
    const double quartic = vec3_norm(c[4]) * time * time;
    const double speed = fabs(pair_gap_derivative(from));
    return (struct coasting){fmax(-from->gap, 0.0) + time * (speed + time * (0.5 * load + cubic + quartic)),
                             load + 6.0 * cubic + 12.0 * quartic};
}

double hertz_pressing_load(const struct contact_pair *from)
{
    return -from->shape.side *
           (pair_turning(from, from->distance) + 2.0 * vec3_dot(from->normal, from->flight.c[2]));
}

/* Whether bodies that part at this speed come back before it has brought them apart by the depth at which the
 * force is nothing beside the load. An oscillation that touches zero is to have no events on rounding. */
static bool hardly_parts(const struct contact_pair *from, double speed)
{
    const double load = hertz_pressing_load(from);
    return load > 0.0 && speed * speed <= 2.0 * load * pair_hertz_depth_under(from, NO_FORCE * load);
}

/*
 * At rest at the touch, or nearly so, u = sqrt(delta) is no variable to begin with. For how long the
 * contact's force stays nothing beside the load [s]; 0 where it is not, or where the bodies move on their
 * own.
 */
double hertz_coasting_time(const struct segment *p)
{
    const struct contact_pair *from = &p->pair;
    const double load = pair_load(from) / from->reduced_mass;
    const double depth = pair_hertz_depth_under(from, NO_FORCE * load);
    const double speed = pair_gap_derivative(from);
    if (!(-from->gap <= depth && speed * speed <= 2.0 * load * depth)) {
        return 0.0;
    }
    double time = p->longest;
    for (int i = 0; i < HALVINGS && time > 0.0; ++i) {
        const struct coasting then = coasting_to(from, time);
        /* four: penetration, speed and load bring one depth each, and the force is a little more than
         * proportional */
        if (then.depth <= 4.0 * pair_hertz_depth_under(from, NO_FORCE * then.acceleration)) {
            return time;
        }
        time *= 0.5;
    }
    return time;
}

void hertz_find_terminal_event(struct segment *p, double parting)
{
    const int last = p->output.count - 1;
    if (parting > 0.0 && parting <= p->end &&
        hardly_parts(&p->pair, p->output.at[last].of[PAIR_GAP_RATE][0])) {
        parting = (double)INFINITY;
    }
    const struct terminal_event parts = {parting, {PAIR_GAP, -1.0, 0.0}, REGIME_APART};
    p->terminal = parts;
    if (terminal_event_by_law(p)) {
        const struct event_function margin = terminal_event_margin(p);
        const double s = dense_output_first_event(&p->output, &margin);
        if (s < parting) {
            p->terminal = (struct terminal_event){s, margin, contact_regime_after(&p->pair.law, p->regime)};
        }
    }
}
