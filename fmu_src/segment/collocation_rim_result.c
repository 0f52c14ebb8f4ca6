#include "segment/collocation_rim.h"
#include "segment/collocation_turning.h"

#ifndef CONTACT_NO_CAPS

/* c - c(0), in the frame: differences that keep their digits. */
static struct vec3 rim_moved(const struct collocation *p, const struct rim_state *at)
{
    const double grown = at->d - p->local.distance;
    const double half_angle = 0.5 * (at->tilt - p->local.tilt);
    const double mean = 0.5 * (at->tilt + p->local.tilt);
    const double cosine_change = -2.0 * sin(mean) * sin(half_angle);
    const double sine_change = 2.0 * cos(mean) * sin(half_angle);
    const double outward = grown * cos(at->tilt) + p->local.distance * cosine_change;
    const double half_turn = sin(0.5 * at->azimuth);
    return vec3_make(outward * cos(at->azimuth) - 2.0 * p->local.rho * half_turn * half_turn,
                     at->rho * sin(at->azimuth), -(grown * sin(at->tilt) + p->local.distance * sine_change));
}

/* c', with d' given, in the frame. */
static struct vec3 rim_velocity(const struct rim_state *at, double radial)
{
    const double along = at->over / at->d;
    const double outward = radial * cos(at->tilt) - along * sin(at->tilt);
    const double hoop = at->round / at->rho;
    const double c = cos(at->azimuth);
    const double s = sin(at->azimuth);
    return vec3_make(c * outward - s * hoop, s * outward + c * hoop,
                     -(radial * sin(at->tilt) + along * cos(at->tilt)));
}

void collocation_rim_at_node(const struct collocation *p, int node, struct vec3 *moved, struct vec3 *normal)
{
    const struct rim_state at = rim_state_at_node(p, node);
    const double c = cos(at.tilt);
    *moved = collocation_in_world(p, rim_moved(p, &at));
    *normal = collocation_in_world(p, vec3_make(c * cos(at.azimuth), c * sin(at.azimuth), -sin(at.tilt)));
}

static struct vec3 rim_acceleration(const struct collocation *p, double t)
{
    const struct vec3 *a = p->local.acceleration;
    return vec3_axpy(vec3_axpy(a[0], t, a[1]), t * t, a[2]);
}

/* The state at s; x as collocation_deviation says, or the averaged one. */
static struct rim_state rim_state_then(const struct collocation *p, double s, const double x[4])
{
    const struct lobatto *nodes = p->nodes;
    struct vec3 n = {nodal_integral_to(nodes, p->result.n.x, p->result.n_rate.x, s),
                     nodal_integral_to(nodes, p->result.n.y, p->result.n_rate.y, s), 0.0};
    struct vec3 h = {nodal_integral_to(nodes, p->result.h.x, p->result.h_rate.x, s),
                     nodal_integral_to(nodes, p->result.h.y, p->result.h_rate.y, s), 0.0};
    if (p->kind == COLLOCATION_RESOLVED) {
        return rim_state_of(p, n, h, x[0]);
    }
    double slow[4];
    collocation_averaged_deviation(p, s, slow);
    n = vec3_sub(n, p->result.normal_correction);
    h = vec3_sub(h, p->result.momentum_correction);
    const struct rim_state then = rim_state_of(p, n, h, x[0]);
    const struct collocation_correction correction =
        rim_correction(p, &then, rim_acceleration(p, p->half * s), x[0] - slow[0], x[1] - slow[1]);
    return rim_state_of(p, vec3_add(n, correction.normal), vec3_add(h, correction.momentum), x[0]);
}

struct collocation_change collocation_rim_change_at(const struct collocation *p, double s)
{
    double x[4];
    collocation_deviation(p, s, x);
    const struct rim_state start = rim_state_at_start(p);
    const struct rim_state then = rim_state_then(p, s, x);
    const struct vec3 before = rim_velocity(&start, p->local.rate.x);
    return (struct collocation_change){
        collocation_in_world(p, rim_moved(p, &then)),
        collocation_in_world(p, vec3_sub(rim_velocity(&then, x[1] / p->half), before)), x[0]};
}

void collocation_edges(const struct collocation *p, double s, const double x[4], double radial[3],
                       double axial[3])
{
    const double reach = p->from.reach;
    double c = p->from.rim.cosine;
    double sine = p->from.rim.sine;
    double rate = 0.0;
    double bend = 0.0;
    if (p->local.at_rim) {
        const struct rim_state at = rim_state_then(p, s, x);
        const struct rim_slopes slopes = rim_slopes_at(&at, rim_acceleration(p, p->half * s));
        c = cos(at.tilt);
        sine = sin(at.tilt);
        rate = p->half * slopes.tilt;
        bend = p->half * p->half * slopes.over / (at.d * at.d) - 2.0 * rate * x[1] / at.d;
    }
    radial[0] = reach * c;
    radial[1] = -reach * sine * rate;
    radial[2] = -reach * (c * rate * rate + sine * bend);
    axial[0] = reach * sine;
    axial[1] = reach * c * rate;
    axial[2] = reach * (c * bend - sine * rate * rate);
}

#endif
