#include <float.h>

#include "segment/hertz_recurrence.h"

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

/* fmax, but for NaN as the first, without a call. */
static inline double hertz_larger(double so_far, double a)
{
    return a > so_far ? a : so_far;
}

/* Jorba and Zou: the step at which the first term left out is this part of the whole, by the least radius of
 * convergence that the last coefficients tell. */
static double hertz_reliable_step(const struct pair_hertz *p, const struct hertz_recurrence *z,
                                  double accuracy)
{
    /* u is as large as its first coefficients, for s is of order one */
    const double root = hertz_larger(hertz_larger(fabs(p->root[0]), fabs(p->root[1])), fabs(p->root[2]));
    double speed = fabs(p->rate[0]);
    double growth = -(double)INFINITY; /* binary logarithm of 1 / the radius of convergence */
    for (int i = 1; i < TAYLOR_TERMS; ++i) {
        for (int j = 0; j < p->flight.dimensions; ++j) {
            speed = hertz_larger(speed, fabs(p->r_rate[j][i]));
        }
    }
    for (int i = TAYLOR_TERMS - HERTZ_LAST; i < TAYLOR_TERMS; ++i) {
        double part = hertz_larger(fabs(p->root[i]) / root, fabs(p->rate[i]) / speed);
        for (int j = 0; j < p->flight.dimensions; ++j) {
            part = hertz_larger(hertz_larger(part, fabs(p->r_rate[j][i]) / speed), fabs(z->n[j][i]));
        }
        growth = hertz_larger(growth, log2(part) / i);
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
