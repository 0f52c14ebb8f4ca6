#include "segment/collocation_rim.h"

#include <string.h>

#include "segment/collocation_turning.h"

#ifndef CONTACT_NO_CAPS

/* The azimuth is scaled by it. */
static double rim_scale(const struct collocation *p)
{
    return p->local.rho / p->local.distance;
}

struct rim_state rim_state_of(const struct collocation *p, struct vec3 n, struct vec3 h, double x)
{
    const double scale = rim_scale(p);
    const double d = p->from.reach + x;
    const double tilt = p->local.tilt + n.y;
    return (struct rim_state){.d = d,
                              .rho = p->from.rim.radius + d * cos(tilt),
                              .azimuth = n.x / scale,
                              .tilt = tilt,
                              .round = p->local.momentum.x + scale * h.x,
                              .over = p->local.momentum.y + h.y};
}

struct rim_state rim_state_at_start(const struct collocation *p)
{
    const struct vec3 zero = {0.0, 0.0, 0.0};
    return rim_state_of(p, zero, zero, p->from.deviation);
}

struct rim_state rim_state_at_node(const struct collocation *p, int i)
{
    const struct vec3 *n = &p->result.normal_correction;
    const struct vec3 *h = &p->result.momentum_correction;
    return rim_state_of(p, vec3_make(p->result.n.x[i] - n->x, p->result.n.y[i] - n->y, 0.0),
                        vec3_make(p->result.h.x[i] - h->x, p->result.h.y[i] - h->y, 0.0), p->result.x[i]);
}

/* What a vector of the frame is along a, b and e at a state. */
struct rim_parts {
    double outward, hoop, axial;
};

static struct rim_parts rim_parts_of(const struct rim_state *at, struct vec3 a)
{
    const double c = cos(at->azimuth);
    const double s = sin(at->azimuth);
    return (struct rim_parts){c * a.x + s * a.y, c * a.y - s * a.x, a.z};
}

/* Along n. */
static double rim_normal_part(const struct rim_state *at, struct vec3 a)
{
    const struct rim_parts parts = rim_parts_of(at, a);
    return cos(at->tilt) * parts.outward - sin(at->tilt) * parts.axial;
}

struct rim_slopes rim_slopes_at(const struct rim_state *at, struct vec3 acceleration)
{
    const struct rim_parts a = rim_parts_of(at, acceleration);
    const double c = cos(at->tilt);
    const double s = sin(at->tilt);
    const double push = at->round * at->round / (at->rho * at->rho * at->rho) + a.outward;
    return (struct rim_slopes){.azimuth = at->round / (at->rho * at->rho),
                               .tilt = at->over / (at->d * at->d),
                               .round = at->rho * a.hoop,
                               .over = -at->d * (s * push + c * a.axial),
                               .load =
                                   at->over * at->over / (at->d * at->d * at->d) + c * push - s * a.axial};
}

/* As collocation_correction_of: the slopes of the rates with d, times the integral of y. */
struct collocation_correction rim_correction(const struct collocation *p, const struct rim_state *at,
                                             struct vec3 acceleration, double y, double y_rate)
{
    const double by = collocation_oscillation_integral(p, y, y_rate);
    const double scale = rim_scale(p);
    const struct rim_parts a = rim_parts_of(at, acceleration);
    const struct rim_slopes slopes = rim_slopes_at(at, acceleration);
    const double c = cos(at->tilt);
    const double spin = at->round / (at->rho * at->rho);
    const double over = slopes.over / at->d + 3.0 * at->d * sin(at->tilt) * c * spin * spin;
    return (struct collocation_correction){
        vec3_make(-2.0 * by * scale * spin * c / at->rho, -2.0 * by * slopes.tilt / at->d, 0.0),
        vec3_make(by * c * a.hoop / scale, by * over, 0.0)};
}

void collocation_rim_begin(struct collocation *p)
{
    const struct collocation_rim *rim = &p->from.rim;
    p->local.frame[0] = rim->outward;
    p->local.frame[1] = vec3_cross(rim->axis, rim->outward);
    p->local.frame[2] = rim->axis;
    p->local.planar = false;
    p->local.tilt = atan2(rim->sine, rim->cosine);
    p->local.rho = rim->radius + p->local.distance * rim->cosine;
    for (int i = 0; i < COLLOCATION_ACCELERATION_TERMS; ++i) {
        p->local.acceleration[i] = collocation_in_frame(p, p->from.acceleration[i]);
    }
    for (int i = 0; i < COLLOCATION_MISMATCH_TERMS && p->from.has_mismatch; ++i) {
        p->local.mismatch[i] = collocation_in_frame(p, p->from.mismatch[i]);
    }
    const struct vec3 rate = collocation_in_frame(p, p->from.rate);
    p->local.rate = vec3_make(p->from.radial, 0.0, 0.0);
    p->local.momentum = vec3_make(p->local.rho * rate.y,
                                  -p->local.distance * (rim->sine * rate.x + rim->cosine * rate.z), 0.0);
    memset(&p->result.n.z, 0, sizeof p->result.n.z);
    memset(&p->result.h.z, 0, sizeof p->result.h.z);
    memset(&p->result.n_rate.z, 0, sizeof p->result.n_rate.z);
    memset(&p->result.h_rate.z, 0, sizeof p->result.h_rate.z);
}

double collocation_rim_load_at_start(const struct collocation *p)
{
    const struct rim_state at = rim_state_at_start(p);
    const double mismatch =
        p->from.has_mismatch ? p->from.damping_rate * rim_normal_part(&at, p->local.mismatch[0]) : 0.0;
    return rim_slopes_at(&at, p->local.acceleration[0]).load - mismatch;
}

void collocation_rim_guess(struct collocation *p, double half)
{
    const struct rim_state at = rim_state_at_start(p);
    const struct rim_slopes slopes = rim_slopes_at(&at, p->local.acceleration[0]);
    const double scale = rim_scale(p);
    for (int i = 0; i < p->nodes->points; ++i) {
        const double t = half * (1.0 + p->nodes->node[i]);
        const double azimuth = slopes.azimuth + 0.5 * t * slopes.round / (at.rho * at.rho);
        const double tilt = slopes.tilt + 0.5 * t * slopes.over / (at.d * at.d);
        nodal_put_vec3(&p->result.h, i, vec3_make(t * slopes.round / scale, t * slopes.over, 0.0));
        nodal_put_vec3(&p->result.n, i, vec3_make(t * scale * azimuth, t * tilt, 0.0));
    }
}

static struct vec3 rim_row(const struct nodal_vec3 *row, int i)
{
    return vec3_make(row->x[i], row->y[i], row->z[i]);
}

void collocation_rim_load(const struct collocation *p, double *values, double *softening)
{
    const double half2 = p->half * p->half;
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct rim_state at = rim_state_at_node(p, i);
        const double spin = at.round * cos(at.tilt) / (at.rho * at.rho);
        const double tilting = at.over / (at.d * at.d);
        values[i] = half2 * rim_slopes_at(&at, rim_row(&p->work.drive_at, i)).load;
        softening[i] = 1.5 * half2 * (spin * spin + tilting * tilting);
    }
}

/* One pair of rows from its rates; returns the largest change. */
static double rim_integrate(const struct collocation *p, const struct nodal_vec3 *rate,
                            struct nodal_vec3 *sum)
{
    return fmax(nodal_integrate(p->nodes, rate->x, sum->x), nodal_integrate(p->nodes, rate->y, sum->y));
}

double collocation_rim_turn(struct collocation *p)
{
    const double scale = rim_scale(p);
    if (p->kind != COLLOCATION_RESOLVED) {
        const struct rim_state start = rim_state_at_start(p);
        const struct collocation_correction correction =
            rim_correction(p, &start, p->local.acceleration[0], p->result.y, p->result.y_rate);
        p->result.normal_correction = correction.normal;
        p->result.momentum_correction = correction.momentum;
    }
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct rim_state at = rim_state_at_node(p, i);
        const struct rim_slopes slopes = rim_slopes_at(&at, rim_row(&p->work.acceleration_at, i));
        nodal_put_vec3(&p->result.h_rate, i,
                       vec3_make(p->half * slopes.round / scale, p->half * slopes.over, 0.0));
    }
    const double by_momentum = rim_integrate(p, &p->result.h_rate, &p->result.h);
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct rim_state at = rim_state_at_node(p, i);
        nodal_put_vec3(&p->result.n_rate, i,
                       vec3_make(p->half * scale * at.round / (at.rho * at.rho),
                                 p->half * at.over / (at.d * at.d), 0.0));
    }
    return fmax(2.0 * p->half / p->local.distance * by_momentum,
                p->local.distance * rim_integrate(p, &p->result.n_rate, &p->result.n));
}

void collocation_rim_mismatch(const struct collocation *p, double *values)
{
    for (int i = 0; i < p->nodes->points; ++i) {
        const struct rim_state at = rim_state_at_node(p, i);
        values[i] = rim_normal_part(&at, rim_row(&p->work.mismatch_at, i));
    }
}

#endif
