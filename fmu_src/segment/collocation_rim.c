#include "segment/collocation_rim.h"

#include <string.h>

#include "segment/collocation_turning.h"

#ifndef CONTACT_NO_CAPS

struct rim_state collocation_rim_state(const struct collocation *p, struct vec3 n, struct vec3 h, double x)
{
    const double change[4] = {n.x, n.y, h.x, h.y};
    return rim_state_of(&p->from.rim, change, x - p->from.deviation);
}

static struct rim_state rim_state_at_start(const struct collocation *p)
{
    const struct vec3 zero = {0.0, 0.0, 0.0};
    return collocation_rim_state(p, zero, zero, p->from.deviation);
}

static struct vec3 rim_row(const struct nodal_vec3 *row, int i)
{
    return vec3_make(row->x[i], row->y[i], row->z[i]);
}

static void put_rim_rates(const struct collocation *p, int i, double factor, const struct rim_slopes *slopes,
                          struct nodal_vec3 *n, struct nodal_vec3 *h)
{
    double rates[4];
    rim_change_rates(&p->from.rim, slopes, rates);
    nodal_put_vec3(n, i, vec3_make(factor * rates[0], factor * rates[1], 0.0));
    nodal_put_vec3(h, i, vec3_make(factor * rates[2], factor * rates[3], 0.0));
}

struct rim_state collocation_rim_state_at_node(const struct collocation *p, int i)
{
    return collocation_rim_state(p, vec3_sub(rim_row(&p->result.n, i), p->result.normal_correction),
                                 vec3_sub(rim_row(&p->result.h, i), p->result.momentum_correction),
                                 p->result.x[i]);
}

/* As collocation_correction_of: the slopes of the rates with d, times the integral of y. */
struct collocation_correction collocation_rim_correction(const struct collocation *p,
                                                         const struct rim_state *at, struct vec3 acceleration,
                                                         double y, double y_rate)
{
    const double by = collocation_oscillation_integral(p, y, y_rate);
    double slopes[4];
    rim_slopes_by_distance(&p->from.rim, at, acceleration, slopes);
    return (struct collocation_correction){vec3_make(by * slopes[0], by * slopes[1], 0.0),
                                           vec3_make(by * slopes[2], by * slopes[3], 0.0)};
}

void collocation_rim_begin(struct collocation *p)
{
    memcpy(p->local.frame, p->from.rim.frame, sizeof p->local.frame);
    memset(p->result.tilt_rate, 0, sizeof p->result.tilt_rate);
    p->local.planar = false;
    p->local.rate = vec3_make(p->from.radial, 0.0, 0.0);
    for (int i = 0; i < COLLOCATION_ACCELERATION_TERMS; ++i) {
        p->local.acceleration[i] = collocation_in_frame(p, p->from.acceleration[i]);
    }
    for (int i = 0; i < COLLOCATION_MISMATCH_TERMS && p->from.has_mismatch; ++i) {
        p->local.mismatch[i] = collocation_in_frame(p, p->from.mismatch[i]);
    }
}

double collocation_rim_load_at_start(const struct collocation *p)
{
    const struct rim_state at = rim_state_at_start(p);
    const double mismatch =
        p->from.has_mismatch ? p->from.damping_rate * vec3_dot(rim_normal(&at), p->local.mismatch[0]) : 0.0;
    return rim_slopes_at(&at, p->local.acceleration[0]).load - mismatch;
}

void collocation_rim_guess(struct collocation *p, double half)
{
    const struct rim_state at = rim_state_at_start(p);
    const struct rim_slopes first = rim_slopes_at(&at, p->local.acceleration[0]);
    for (int i = 0; i < p->nodes->points; ++i) {
        const double t = half * (1.0 + p->nodes->node[i]);
        struct rim_slopes slopes = first;
        slopes.azimuth += 0.5 * t * first.round / (at.rho * at.rho);
        slopes.tilt += 0.5 * t * first.over / (at.d * at.d);
        put_rim_rates(p, i, t, &slopes, &p->result.n, &p->result.h);
    }
}

void collocation_rim_load(const struct collocation *p, double *values, double *softening)
{
    const double half2 = p->half * p->half;
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct rim_state at = collocation_rim_state_at_node(p, i);
        const struct rim_slopes slopes = rim_slopes_at(&at, rim_row(&p->work.drive_at, i));
        const double spin = slopes.azimuth * at.cosine;
        values[i] = half2 * slopes.load;
        softening[i] = 1.5 * half2 * (spin * spin + slopes.tilt * slopes.tilt);
    }
}

/* Two rows from their rates; returns the largest change. */
static double rim_integrate(const struct collocation *p, const struct nodal_vec3 *rate,
                            struct nodal_vec3 *sum)
{
    return fmax(nodal_integrate(p->nodes, rate->x, sum->x), nodal_integrate(p->nodes, rate->y, sum->y));
}

double collocation_rim_turn(struct collocation *p)
{
    const double distance = p->local.distance;
    if (p->kind != COLLOCATION_RESOLVED) {
        const struct rim_state start = rim_state_at_start(p);
        const struct collocation_correction correction =
            collocation_rim_correction(p, &start, p->local.acceleration[0], p->result.y, p->result.y_rate);
        p->result.normal_correction = correction.normal;
        p->result.momentum_correction = correction.momentum;
    }
    nodal_values per_rho_squared;
    nodal_values per_d_squared;
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct rim_state at = collocation_rim_state_at_node(p, i);
        const struct rim_slopes slopes = rim_slopes_at(&at, rim_row(&p->work.acceleration_at, i));
        put_rim_rates(p, i, p->half, &slopes, &p->result.n_rate, &p->result.h_rate);
        per_rho_squared[i] = 1.0 / (at.rho * at.rho);
        per_d_squared[i] = 1.0 / (at.d * at.d);
    }
    const double by_momentum = 2.0 * p->half / distance * rim_integrate(p, &p->result.h_rate, &p->result.h);
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct vec3 h = vec3_sub(rim_row(&p->result.h, i), p->result.momentum_correction);
        const double scale = p->from.rim.rho / distance;
        p->result.n_rate.x[i] = p->half * scale * (p->from.rim.round + scale * h.x) * per_rho_squared[i];
        p->result.n_rate.y[i] = p->half * (p->from.rim.over + h.y) * per_d_squared[i];
    }
    return fmax(by_momentum, distance * rim_integrate(p, &p->result.n_rate, &p->result.n));
}

void collocation_rim_keep_tilt(struct collocation *p)
{
    nodal_coefficients(p->nodes, p->result.n_rate.y, p->result.tilt_rate);
}

void collocation_rim_mismatch(const struct collocation *p, double *values)
{
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct rim_state at = collocation_rim_state_at_node(p, i);
        values[i] = vec3_dot(rim_normal(&at), rim_row(&p->work.mismatch_at, i));
    }
}

#endif
