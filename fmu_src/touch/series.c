#include <float.h>
#include <string.h>

#include "math/compiler.h"
#include "math/nodes.h"
#include "math/polynomial.h"
#include "touch/segment.h"

/*
 * A contact pair by power series, under either law and at any place (Jorba and Zou, Experimental Mathematics
 * 14 (2005) 99). The force follows from c and c' by products and quotients, so the coefficients are found
 * order by order. A series is exact to its accuracy over a few radians of the contact's oscillation.
 *
 *   g_t = side n.c',   c_t = c',   c'_t = A + side F_n n / m_red,   d = reach + side g,   n = f / d
 *
 * f points from the source's centre to the axis or the centre of the destination, so f = c. At a rim f points
 * to the nearest point of the circle of radius R at the height h. There e is the axis, and rho and a are the
 * length and the direction of the part of c across e:
 *
 *   f = c - R a + h e;   the centre is rho - R beyond the side and -(c.e + h) beyond the cap.
 *
 * Linear law: the variable is s = t / unit, and g is integrated.
 *
 * Hertz's law, F_n = k_h delta^(3/2) (1 + chi delta') (Hunt and Crossley): as a function of time the force is
 * singular where the bodies touch and where they part. A series in time cannot begin at the touch, and it
 * converges ever more slowly towards the release. So u = sqrt(delta) is integrated, and dt/ds = unit u:
 *
 *   u_s = -unit g_t / 2,   c_s = unit u c',   u F_n = k_h u^4 (1 + chi delta'),   g = -u^2
 *
 * These equations are analytic throughout. At the touch and at the release u passes through zero with a
 * slope. A series may begin at u = 0, and the release is an ordinary root of u.
 */

/* The coefficients of a series in reversed order, without coefficient 0: coefficient j at [TAYLOR_ORDER - j],
 * and place TAYLOR_ORDER holds zero. Products then read both of their factors forwards, several terms in one
 * instruction. */
typedef double series_back[TAYLOR_TERMS];

/* Everything that the recurrence needs besides the results. */
struct series_work {
    series_row power[SEPARATION_DEGREE + 1];  /* coefficients of t^k for k from 2 on, in a series by u */
    double unit_power[SEPARATION_DEGREE + 1]; /* unit^k, the only coefficient of t^k in a series by time */
    series_row w[FRAME];                      /* velocity of separation that the law uses [m/s] */
    series_row c_rate[FRAME];                 /* c', where it differs from w [m/s] */
    series_row n[FRAME];
    series_row d;              /* [m] */
    series_row opening;        /* dg/dt [m/s] */
    series_row square, fourth; /* u^2, u^4 */
    series_row impulse;        /* F_n dt/ds / unit */
    series_back time_back, opened_back, square_back, rate_back;
    series_back n_back[FRAME], r_rate_back[FRAME];
    /* the part of c across the axis, its square and length, and the acceleration */
    series_row across[2], rho_squared, rho, a[2];
    double normal[FRAME];                  /* n at the start */
    double inverse_distance, side_by_mass; /* 1/d at the start [1/m], side/m_red [1/kg] */
};

/* Number of coefficients that are made before the rest, to recognize quasi-static motion by them. */
enum { SERIES_FIRST = 7 };

/* Properties of a series as constants of its code: fewer dimensions, a lower degree and no mismatch cost
 * less. */
struct series_kind {
    int dimensions, degree;
    bool by_root, at_rim, has_mismatch;
    bool first; /* order zero, at which a product has only one term */
};

/* The three functions below are constants where the scene decides them, even in a build without inlining. */
static inline bool kind_by_root(struct series_kind kind)
{
    return SCENE_ANY_HERTZ && kind.by_root;
}

static inline bool kind_at_rim(struct series_kind kind)
{
    return CONTACT_ANY_CIRCLE && kind.at_rim;
}

static inline bool kind_has_mismatch(struct series_kind kind)
{
    return SCENE_ANY_PRESCRIBED && kind.has_mismatch;
}

/* Returns coefficient i of component j of a polynomial in time with `terms` coefficients. Where t = unit s,
 * only the power t^i contributes. */
static inline double along_time(const struct pair_series *p, const struct series_work *z,
                                const double a[][FRAME], int terms, int j, int i, struct series_kind kind)
{
    if (!kind_by_root(kind)) {
        return i < terms ? a[i][j] * z->unit_power[i] : 0.0;
    }
    double sum = (i == 0 ? a[0][j] : 0.0) + (terms > 1 ? a[1][j] * p->time[i] : 0.0);
    for (int k = 2; k < terms; ++k) {
        sum += a[k][j] * z->power[k][i];
    }
    return sum;
}

/* The parts of the products' coefficients at one order that come from coefficients of lower orders. */
struct series_sums {
    double time2, square, fourth, drag, speed;
    double n[FRAME], push[FRAME], r[FRAME];
};

/* Returns the place in a reversed series from which its terms multiply coefficients 1, 2, ... of another
 * series in coefficient i of the product. */
static inline const double *back_from(const double *back, int i)
{
    return back + (TAYLOR_ORDER - i);
}

/* Sums the products of scalars in a series by u. All sums are in one loop, so that none waits for another.
 * The last pair may hold the first unknown coefficient, which is zero so far, as is its factor. */
static inline void sum_lower_scalars(const struct pair_series *p, const struct series_work *z, int i,
                                     struct series_sums *sum)
{
    const double *times = back_from(z->time_back, i);
    const double *roots = back_from(z->opened_back, i);
    const double *squares = back_from(z->square_back, i);
    const double *rates = back_from(z->rate_back, i);
    double2 time2[PARTS];
    double2 square[PARTS];
    double2 fourth[PARTS];
    double2 drag[PARTS];
    memset(time2, 0, sizeof time2);
    memset(square, 0, sizeof square);
    memset(fourth, 0, sizeof fourth);
    memset(drag, 0, sizeof drag);
    for (int k = 1; k < i; k += LANES) {
        time2[part(k - 1)] += double2_at(p->time, k) * double2_at(times, k);
        square[part(k - 1)] += double2_at(p->opened, k) * double2_at(roots, k);
        fourth[part(k - 1)] += double2_at(z->square, k) * double2_at(squares, k);
        drag[part(k - 1)] += double2_at(z->fourth, k) * double2_at(rates, k);
    }
    sum->time2 = parts_together(time2);
    sum->square = parts_together(square);
    sum->fourth = parts_together(fourth);
    sum->drag = parts_together(drag);
}

/* Sums the products of vectors. All components are in one loop because they share factors. */
static inline void sum_lower_vectors(const struct pair_series *p, const struct series_work *z, int i,
                                     struct series_kind kind, struct series_sums *sum)
{
    double2 r[FRAME][PARTS];
    double2 n[FRAME][PARTS];
    double2 push[FRAME][PARTS];
    double2 speed[PARTS];
    memset(speed, 0, sizeof speed);
    for (int j = 0; j < kind.dimensions; ++j) {
        memset(r[j], 0, sizeof r[j]);
        memset(n[j], 0, sizeof n[j]);
        memset(push[j], 0, sizeof push[j]);
    }
    for (int k = 1; k < i && (kind_by_root(kind) || kind.dimensions > 1); k += LANES) {
        const double2 root = double2_at(p->opened, k);
        const double2 d = double2_at(z->d, k);
        const double2 impulse = double2_at(z->impulse, k);
        for (int j = 0; j < kind.dimensions; ++j) {
            if (kind_by_root(kind)) {
                r[j][part(k - 1)] += root * double2_at(back_from(z->r_rate_back[j], i), k);
            }
            if (kind.dimensions > 1) {
                const double2 normal = double2_at(back_from(z->n_back[j], i), k);
                n[j][part(k - 1)] += d * normal;
                push[j][part(k - 1)] += impulse * normal;
                speed[part(k - 1)] += double2_at(z->w[j], k) * normal;
            }
        }
    }
    for (int j = 0; j < kind.dimensions; ++j) {
        sum->r[j] = parts_together(r[j]);
        sum->n[j] = parts_together(n[j]);
        sum->push[j] = parts_together(push[j]);
    }
    sum->speed = parts_together(speed);
}

/* Changes f from coefficient i of c to coefficient i of f. At a rim the nearest point of the circle moves. */
static inline void put_nearest(struct pair_series *p, struct series_work *z, int i, struct series_kind kind,
                               double f[FRAME])
{
    if (kind_at_rim(kind)) {
        const struct contact_solid *solid = &p->from->shape.solid;
        f[1] += kind.first ? solid->half_height : 0.0;
        p->axial[i] = -f[1];
        if (kind.dimensions == 2) { /* in a plane through the axis the point stays where it is */
            f[0] -= kind.first ? solid->radius : 0.0;
            p->radial[i] = f[0];
            return;
        }
        z->across[0][i] = f[0];
        z->across[1][i] = f[2];
        z->rho_squared[i] =
            taylor_multiply(z->across[0], z->across[0], i) + taylor_multiply(z->across[1], z->across[1], i);
        z->rho[i] = taylor_root(z->rho_squared, z->rho, i);
        for (int j = 0; j < 2; ++j) {
            z->a[j][i] = taylor_divide(z->across[j], z->rho, z->a[j], i);
            f[2 * j] -= solid->radius * z->a[j][i];
        }
        p->radial[i] = z->rho[i] - (kind.first ? solid->radius : 0.0);
    }
}

/* Sets coefficient i of d and n from the coefficients of c and of the gap. */
static inline void put_normal_term(struct pair_series *p, struct series_work *z, int i,
                                   const struct series_sums *sum, struct series_kind kind)
{
    const struct frame_flight *flight = &p->flight;
    const double side = p->from->shape.side;
    double f[FRAME] = {0.0};
    if (kind_by_root(kind)) {
        z->square[i] = sum->square + (kind.first ? 1.0 : 2.0) * p->opened[0] * p->opened[i];
    }
    z->d[i] = kind.first ? p->from->distance : side * (kind_by_root(kind) ? -z->square[i] : p->opened[i]);
    if (kind.dimensions > 1 && (!kind.first || kind_at_rim(kind))) {
        for (int j = 0; j < kind.dimensions; ++j) {
            f[j] = along_time(p, z, flight->c, kind.degree + 1, j, i, kind) + p->r[j][i];
        }
        put_nearest(p, z, i, kind, f);
    }
    for (int j = 0; j == 0 || j < kind.dimensions; ++j) {
        z->n[j][i] = kind.first            ? z->normal[j]
                     : kind.dimensions > 1 ? (f[j] - sum->n[j] - z->d[i] * z->n[j][0]) * z->inverse_distance
                                           : 0.0;
    }
}

/* Returns coefficient i of n.c', for a pair with a velocity mismatch, whose w is not c'. */
static double closing_of(const struct pair_series *p, struct series_work *z, int i, struct series_kind kind)
{
    double closing = 0.0;
    for (int j = 0; j < kind.dimensions; ++j) {
        z->c_rate[j][i] = along_time(p, z, p->flight.c_rate, kind.degree, j, i, kind) + p->r_rate[j][i];
        closing += taylor_multiply(z->n[j], z->c_rate[j], i);
    }
    return closing;
}

/* Sets coefficient i of w and of both gap rates: p->rate is the law's, z->opening is dg/dt. */
static inline void put_rates(struct pair_series *p, struct series_work *z, int i,
                             const struct series_sums *sum, struct series_kind kind)
{
    const struct contact_pair *from = p->from;
    const struct frame_flight *flight = &p->flight;
    const double side = from->shape.side;
    const bool is_carried = kind.first && !isnan(from->carried_rate);
    double speed = kind.dimensions > 1 ? sum->speed : 0.0;
    for (int j = 0; j == 0 || j < kind.dimensions; ++j) {
        z->w[j][i] = along_time(p, z, flight->w, kind.degree, j, i, kind) + p->r_rate[j][i];
        speed += kind.first || kind.dimensions == 1 ? 0.0 : z->n[j][i] * z->w[j][0];
        /* away from a rim n is the first direction of the frame */
        speed += kind_at_rim(kind) ? z->n[j][0] * z->w[j][i] : j == 0 ? z->w[0][i] : 0.0;
    }
    p->rate[i] = is_carried ? from->carried_rate : side * speed;
    z->opening[i] = p->rate[i];
    if (kind_has_mismatch(kind)) {
        const double closing = closing_of(p, z, i, kind);
        z->opening[i] = is_carried ? pair_gap_derivative(from) : side * closing;
    }
}

/* Sets coefficient i of the normal force F_n times dt/ds divided by unit, and of the dashpot's part with the
 * opposite sign (drag). */
static inline void put_impulse(struct pair_series *p, struct series_work *z, int i,
                               const struct series_sums *sum, struct series_kind kind)
{
    const struct contact_pair *from = p->from;
    const double both = kind.first ? 0.0 : 1.0;
    if (!kind_by_root(kind)) {
        p->drag[i] = from->coefficients.c * p->rate[i];
        z->impulse[i] = contact_linear_force(from->coefficients, p->opened[i], p->rate[i]);
        return;
    }
    z->fourth[i] = sum->fourth + (1.0 + both) * z->square[0] * z->square[i];
    const double drag = sum->drag + z->fourth[i] * p->rate[0] + both * z->fourth[0] * p->rate[i];
    p->drag[i] = from->hertz_stiffness * from->chi * drag;
    z->impulse[i] = from->hertz_stiffness * z->fourth[i] - p->drag[i];
}

/* The reciprocals of i are tabulated because a division would delay the next order. */
#define RECIPROCALS(i) 1.0 / (i), 1.0 / ((i) + 1), 1.0 / ((i) + 2), 1.0 / ((i) + 3)
static const double reciprocal[TAYLOR_TERMS] = {
    0.0, RECIPROCALS(1), RECIPROCALS(5), RECIPROCALS(9), RECIPROCALS(13), RECIPROCALS(17), RECIPROCALS(21)};

/* Sets coefficient i + 1 of t, of g or u, and of r and r'. */
static inline void put_next(struct pair_series *p, struct series_work *z, int i,
                            const struct series_sums *sum, struct series_kind kind)
{
    const double both = kind.first ? 0.0 : 1.0;
    const double unit = p->unit * reciprocal[i + 1];
    p->time[i + 1] = kind_by_root(kind) ? unit * p->opened[i] : kind.first ? unit : 0.0;
    p->opened[i + 1] = (kind_by_root(kind) ? -0.5 : 1.0) * unit * z->opening[i];
    for (int j = 0; j < kind.dimensions; ++j) {
        const double push = kind.dimensions == 1 ? z->impulse[i]
                                                 : sum->push[j] + z->impulse[i] * z->n[j][0] +
                                                       both * z->impulse[0] * z->n[j][i];
        const double moved =
            kind_by_root(kind) ? sum->r[j] + p->opened[0] * p->r_rate[j][i] : p->r_rate[j][i];
        p->r[j][i + 1] = unit * moved;
        p->r_rate[j][i + 1] = unit * (z->side_by_mass * push);
    }
}

/* Stores the data of the next order's sums: the reversed series without coefficient 0, and a zero behind the
 * known coefficients of the others. */
static inline void note_order(struct pair_series *p, struct series_work *z, int i, struct series_kind kind)
{
    const int back = TAYLOR_ORDER - i;
    if (kind_by_root(kind)) {
        z->time_back[back] = kind.first ? 0.0 : p->time[i];
        z->opened_back[back] = kind.first ? 0.0 : p->opened[i];
        z->square_back[back] = kind.first ? 0.0 : z->square[i];
        z->rate_back[back] = kind.first ? 0.0 : p->rate[i];
        z->square[i + 1] = z->fourth[i + 1] = 0.0;
    }
    z->d[i + 1] = z->impulse[i + 1] = 0.0;
    for (int j = 0; j < kind.dimensions; ++j) {
        z->n_back[j][back] = kind.first ? 0.0 : z->n[j][i];
        z->r_rate_back[j][back] = kind.first ? 0.0 : p->r_rate[j][i];
        z->w[j][i + 1] = 0.0;
    }
}

static inline void make_order(struct pair_series *p, struct series_work *z, int i, struct series_kind kind)
{
    struct series_sums sum = {.speed = 0.0};
    if (kind_by_root(kind)) {
        sum_lower_scalars(p, z, i, &sum);
        for (int k = 2; k <= kind.degree; ++k) {
            z->power[k][i] = k == 2 ? sum.time2 : taylor_multiply(z->power[k - 1], p->time, i);
        }
    }
    sum_lower_vectors(p, z, i, kind, &sum);
    put_normal_term(p, z, i, &sum, kind);
    put_rates(p, z, i, &sum, kind);
    put_impulse(p, z, i, &sum, kind);
    if (i < TAYLOR_ORDER) {
        put_next(p, z, i, &sum, kind);
        note_order(p, z, i, kind);
    }
}

/* Orders that the recurrence takes in one go: from `begin` up to but without `end`. */
struct series_orders {
    int begin, end;
};

static inline void make_orders(struct pair_series *p, struct series_work *z, struct series_orders orders,
                               struct series_kind kind)
{
    if (orders.begin == 0) {
        struct series_kind first = kind;
        first.first = true;
        make_order(p, z, 0, first);
    }
    for (int i = orders.begin > 0 ? orders.begin : 1; i < orders.end; ++i) {
        make_order(p, z, i, kind);
    }
}

/* Under constant forces the flight is a polynomial in time of degree two at most. */
static inline void make_steady_orders(struct pair_series *p, struct series_work *z,
                                      struct series_orders orders, bool by_root)
{
    if (p->flight.dimensions == 1) {
        make_orders(p, z, orders, (struct series_kind){.dimensions = 1, .degree = 2, .by_root = by_root});
    } else if (p->flight.dimensions == 2) {
        make_orders(p, z, orders, (struct series_kind){.dimensions = 2, .degree = 2, .by_root = by_root});
    } else {
        make_orders(p, z, orders, (struct series_kind){.dimensions = FRAME, .degree = 2, .by_root = by_root});
    }
}

/* Makes the orders from `begin` up to but without `end`; the orders before `begin` are known. Order zero
 * needs t, g or u, r and r' at the start. */
CONTACT_FLATTEN static void make_coefficients(struct pair_series *p, struct series_work *z, int begin,
                                              int end)
{
    const struct contact_pair *from = p->from;
    const struct series_orders orders = {begin, end};
    const bool at_rim = contact_is_circle(&from->shape);
    const bool is_plain_rim = at_rim && p->flight.dimensions == 2 && !(SCENE_ANY_HERTZ && p->by_root);
    if (p->flight.degree > 2 || from->has_mismatch || (at_rim && !is_plain_rim)) {
        const struct series_kind any = {.dimensions = p->flight.dimensions,
                                        .degree = p->flight.degree,
                                        .by_root = SCENE_ANY_HERTZ && p->by_root,
                                        .at_rim = at_rim,
                                        .has_mismatch = from->has_mismatch};
        make_orders(p, z, orders, any);
    } else if (at_rim) { /* an impact along the normal of a rim */
        make_orders(p, z, orders, (struct series_kind){.dimensions = 2, .degree = 2, .at_rim = true});
    } else if (SCENE_ANY_HERTZ && p->by_root) {
        make_steady_orders(p, z, orders, true);
    } else {
        make_steady_orders(p, z, orders, false);
    }
}

/* Returns the rate at which d changes by its own size, at the present speed or from rest under load and
 * contact force [1/s]. */
static double passage_rate_of(const struct contact_pair *from)
{
    const double force = fabs(from->coefficients.k * from->gap) / from->reduced_mass;
    const double acceleration = force + 2.0 * vec3_norm(from->flight.c[2]);
    return fmax(vec3_norm(from->flight.w[0]) / from->distance, sqrt(acceleration / from->distance));
}

/* The unit of s: one radian of the contact's oscillation, one decay time of its damping, or the time of
 * passage, whichever is shortest. Under Hertz's law the rates are taken at the penetration to come. The
 * unit's order of magnitude suffices to keep the coefficients within the range of numbers. */
static double unit_of(const struct pair_series *p)
{
    const struct contact_pair *from = p->from;
    const double passage = p->flight.dimensions > 1 ? passage_rate_of(from) : 0.0;
    double spring = sqrt(from->coefficients.k / from->reduced_mass);
    double dashpot = from->coefficients.c / from->reduced_mass;
    double root = 1.0;
    if (SCENE_ANY_HERTZ && p->by_root) {
        const double k = from->hertz_stiffness / from->reduced_mass;
        const double depth = hertz_depth_to_come(from, pair_gap_derivative(from));
        root = sqrt(depth);
        spring = sqrt(1.5 * k * root);
        dashpot = k * from->chi * depth * root;
    }
    const double unit = 1.0 / (fmax(spring, fmax(dashpot, passage)) * root);
    return isfinite(unit) && unit > 0.0 ? unit : 1.0;
}

/* Number of last coefficients that give the error: in a free impact from the touch only every fifth
 * coefficient of a series by u is not zero. By time every other one may be zero. */
enum { LAST_BY_ROOT = 5, LAST_BY_TIME = 2 };

/* Longest step [units]. Without a force the series are finite sums, and if the unit is the time of passage
 * the last terms may underflow. */
static const double LONGEST_SERIES = 16.0;

/* Returns the step at which the first omitted term divided by the whole is `accuracy` (Jorba and Zou). The
 * step follows from the least radius of convergence of the last coefficients. A quotient of zeros is
 * ignored. */
static double reliable_step(const struct pair_series *p, const struct series_work *z, double accuracy)
{
    /* u is as large as its first coefficients, for s is of order one */
    const double opened = SCENE_ANY_HERTZ && p->by_root
                              ? larger(fabs(p->opened[2]), larger(fabs(p->opened[1]), fabs(p->opened[0])))
                              : larger(p->from->distance, contact_reach(&p->from->shape));
    double speed = 0.0;
    double growth = -(double)INFINITY; /* minus the binary logarithm of the radius of convergence */
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        for (int j = 0; j < p->flight.dimensions; ++j) {
            speed = larger(fabs(p->r_rate[j][i]), speed);
        }
        speed = i <= SEPARATION_DEGREE ? larger(fabs(p->rate[i]), speed)
                                       : speed; /* without a force r' is zero and the rate is the flight's */
    }
    const int last = SCENE_ANY_HERTZ && p->by_root ? LAST_BY_ROOT : LAST_BY_TIME;
    for (int i = TAYLOR_TERMS - last; i < TAYLOR_TERMS; ++i) {
        double part = larger(fabs(p->opened[i]) / opened, 0.0);
        part = larger(fabs(p->rate[i]) / speed, part);
        for (int j = 0; j < p->flight.dimensions; ++j) {
            part = larger(fabs(z->n[j][i]), larger(fabs(p->r_rate[j][i]) / speed, part));
        }
        growth = larger(log2(part) / i, growth);
    }
    return fmin(LONGEST_SERIES, exp2(log2(accuracy) / TAYLOR_TERMS - growth));
}

/* Makes the first SERIES_FIRST coefficients. `by_root` is allowed only under Hertz's law with g <= 0, and not
 * from rest at g = 0, where time does not advance with s. */
static void begin_series(struct pair_series *p, struct series_work *z, const struct contact_pair *from,
                         bool by_root)
{
    p->from = from;
    p->by_root = by_root;
    p->flight = contact_is_circle(&from->shape) ? frame_flight_at_rim(from) : frame_flight_of(from);
    p->unit = unit_of(p);
    p->time[0] = 0.0;
    p->opened[0] = by_root ? sqrt(fmax(-from->gap, 0.0)) : from->gap;
    double power = 1.0;
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) {
        z->unit_power[i] = power;
        power *= p->unit;
    }
    for (int j = 0; j < FRAME; ++j) {
        z->normal[j] = vec3_dot(p->flight.frame[j], from->normal);
        p->r[j][0] = p->r_rate[j][0] = 0.0;
    }
    z->inverse_distance = 1.0 / from->distance;
    z->side_by_mass = from->shape.side / from->reduced_mass;
    make_coefficients(p, z, 0, SERIES_FIRST);
}

/* Makes the other coefficients and sets the step. The sums are exact to `accuracy` relative to their largest
 * terms. */
static void complete_series(struct pair_series *p, struct series_work *z, double accuracy)
{
    make_coefficients(p, z, SERIES_FIRST, TAYLOR_TERMS);
    p->step = reliable_step(p, z, accuracy);
}

void series_time(const void *pair_series, double s, double time[3])
{
    const struct pair_series *p = pair_series;
    if (SCENE_ANY_HERTZ && p->by_root) {
        taylor_derivatives(p->time, TAYLOR_TERMS, s, time);
        return;
    }
    time[0] = p->unit * s;
    time[1] = p->unit;
}

static double series_time_at(const struct pair_series *p, double s)
{
    return SCENE_ANY_HERTZ && p->by_root ? taylor_at(p->time, TAYLOR_TERMS, s) : p->unit * s;
}

void series_sample(const void *pair_series, double s, struct pair_sample *sample)
{
    const struct pair_series *p = pair_series;
    double opened[3];
    double *gap = sample->of[PAIR_GAP];
    double *rate = sample->of[PAIR_GAP_RATE];
    taylor_derivatives(p->opened, TAYLOR_TERMS, s, opened);
    taylor_derivatives(p->rate, TAYLOR_TERMS, s, rate);
    if (SCENE_ANY_HERTZ && p->by_root) {
        gap[0] = -opened[0] * opened[0];
        gap[1] = -2.0 * opened[0] * opened[1];
        gap[2] = -2.0 * (opened[1] * opened[1] + opened[0] * opened[2]);
        pair_hertz_force(p->from, opened, rate, sample->of[PAIR_FORCE]);
    } else {
        for (int i = 0; i < 3; ++i) {
            gap[i] = opened[i];
            sample->of[PAIR_FORCE][i] = contact_linear_force(p->from->coefficients, gap[i], rate[i]);
        }
    }
    if (SCENE_ANY_CAPS && contact_is_rim(&p->from->shape)) {
        taylor_derivatives(p->radial, TAYLOR_TERMS, s, sample->of[PAIR_RADIAL]);
        taylor_derivatives(p->axial, TAYLOR_TERMS, s, sample->of[PAIR_AXIAL]);
    }
}

/* Returns a series of vectors at one s, in the world. */
static struct vec3 vector_at(const struct pair_series *p, const series_row *rows, double s)
{
    struct vec3 out = vec3_make(0.0, 0.0, 0.0);
    for (int j = 0; j < p->flight.dimensions; ++j) {
        out = vec3_axpy(out, taylor_at(rows[j], TAYLOR_TERMS, s), p->flight.frame[j]);
    }
    return out;
}

/* Returns the place of node i of a quadrature over [0, s], and writes its weight. Products of series have
 * coefficients beyond the last one. Twelve nodes integrate them to rounding, because a series ends within a
 * third of its radius of convergence. */
static double series_node(int i, double s, double *weight)
{
    const struct lobatto *nodes = &lobatto[LOBATTO_TWELVE];
    *weight = 0.5 * s * nodes->integral[i * LOBATTO_MAX + LOBATTO_MAX - 1];
    return 0.5 * s * (1.0 + nodes->node[i]);
}

void series_moments(const void *pair_series, double s, const struct pair_change *change, int count,
                    struct vec3 *moment)
{
    const struct pair_series *p = pair_series;
    (void)change;
    memset(moment, 0, (size_t)count * sizeof *moment);
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        double weight;
        double time[3];
        const double at = series_node(i, s, &weight);
        const struct vec3 r = vector_at(p, p->r, at);
        series_time(p, at, time);
        weight *= time[1];
        for (int j = 0; j < count; ++j) {
            moment[j] = vec3_axpy(moment[j], weight, r);
            weight *= time[0];
        }
    }
}

/* Returns the energy that the dashpot dissipates, the integral of unit drag g' ds [J]. */
static double series_dissipated(const struct pair_series *p, double s)
{
    double sum = 0.0;
    if (!((SCENE_ANY_HERTZ && p->by_root ? p->from->chi : p->from->coefficients.c) > 0.0)) {
        return 0.0;
    }
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        double weight;
        const double at = series_node(i, s, &weight);
        sum += weight * taylor_at(p->drag, TAYLOR_TERMS, at) * taylor_at(p->rate, TAYLOR_TERMS, at);
    }
    return p->unit * sum;
}

struct pair_change series_advance(const void *pair_series, double s)
{
    const struct pair_series *p = pair_series;
    const double opened = taylor_at(p->opened, TAYLOR_TERMS, s);
    return (struct pair_change){.time = series_time_at(p, s),
                                .r = vector_at(p, p->r, s),
                                .r_rate = vector_at(p, p->r_rate, s),
                                .gap = SCENE_ANY_HERTZ && p->by_root ? -opened * opened : opened,
                                .dissipated = series_dissipated(p, s)};
}

/* Numbers of samples of a segment, such that no quantity has two extrema between two samples. A series by u
 * is at most a third of its radius of convergence long. In a series by time the contact may oscillate or pass
 * the centre. */
enum { PLACES_BY_ROOT = 3, PLACES_BY_TIME = 5 };

/*
 * The accuracy of a series is the size of its last terms relative to the whole. For a series by time it is
 * ROUNDING, because one series takes most of a soft contact. For a series by u it is the segment's tolerance
 * between FINEST, some roundings, and FINE, with which energies balance to 1e-10 over thousands of segments.
 * Under a coarse tolerance it is PART_OF_COARSE times the tolerance, up to COARSEST, with which energies
 * balance to 1e-10 over an impact.
 */
static const double ROUNDING = 0.5 * DBL_EPSILON;
static const double FINEST = 8.0 * DBL_EPSILON;
static const double FINE = 1e-13;
static const double PART_OF_COARSE = 0.01;
static const double COARSEST = 1e-11;

static double series_accuracy(const struct segment *p, bool by_root)
{
    const double asked = p->tolerance / fmax(p->pair.distance, contact_reach(&p->pair.shape));
    if (!by_root) {
        return ROUNDING;
    }
    return fmax(fmin(fmax(asked, FINEST), FINE), fmin(PART_OF_COARSE * asked, COARSEST));
}

/* Whether the series is one by u. A series by u cannot start from rest at the touch, and p->longest becomes
 * the coasting time. */
static bool goes_by_root(struct segment *p)
{
    if (!(SCENE_ANY_HERTZ && contact_is_hertz(&p->pair.law))) {
        return false;
    }
    const double coasting = hertz_coasting_time(p);
    p->longest = coasting > 0.0 ? coasting : p->longest;
    return !(coasting > 0.0);
}

bool series_make(struct segment *p)
{
    struct pair_series *made = &p->as.series;
    struct series_work z;
    const bool by_root = goes_by_root(p); /* may shorten p->longest */
    begin_series(made, &z, &p->pair, by_root);
    if (SCENE_ANY_HERTZ && by_root && p->may_be_quasi_static &&
        quasi_static_is_shown(p, made->opened, made->unit)) {
        return false;
    }
    complete_series(made, &z, series_accuracy(p, by_root));
    double parting = (double)INFINITY; /* the first s at which u passes through zero */
    if (SCENE_ANY_HERTZ && by_root) {
        const bool opens = made->opened[0] == 0.0 && !(made->opened[1] > 0.0);
        parting = opens ? 0.0 : taylor_first_fall(made->opened, TAYLOR_TERMS, made->step);
    }
    p->unit = made->unit;
    p->end = fmin(made->step, parting > 0.0 ? parting : made->step);
    if (parting > 0.0 && series_time_at(made, p->end) > p->longest) {
        p->end = pair_place_by(series_time, made, p->longest, p->end);
        parting = p->end < parting ? (double)INFINITY : parting;
    }
    const int places = by_root ? PLACES_BY_ROOT : PLACES_BY_TIME;
    for (int i = 0; i < places; ++i) {
        dense_output_add(&p->output, p->end * i / (places - 1));
    }
    if (SCENE_ANY_HERTZ && by_root) {
        p->parting = parting;
    }
    return true;
}
