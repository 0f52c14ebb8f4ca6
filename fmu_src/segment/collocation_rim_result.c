/* Dense output of a step at a rim. */
#include "segment/collocation_rim.h"
#include "segment/collocation_turning.h"

#ifndef CONTACT_NO_CAPS

void collocation_rim_at_node(const struct collocation *p, int node, struct vec3 *moved, struct vec3 *normal)
{
    const struct rim_state at = collocation_rim_state_at_node(p, node);
    *moved = collocation_in_world(p, rim_moved(&p->from.rim, &at));
    *normal = collocation_in_world(p, rim_normal(&at));
}

static struct vec3 acceleration_at_rim(const struct collocation *p, double t)
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
        return collocation_rim_state(p, n, h, x[0]);
    }
    double slow[4];
    collocation_averaged_deviation(p, s, slow);
    n = vec3_sub(n, p->result.normal_correction);
    h = vec3_sub(h, p->result.momentum_correction);
    const struct rim_state then = collocation_rim_state(p, n, h, x[0]);
    const struct collocation_correction correction = collocation_rim_correction(
        p, &then, acceleration_at_rim(p, p->half * s), x[0] - slow[0], x[1] - slow[1]);
    return collocation_rim_state(p, vec3_add(n, correction.normal), vec3_add(h, correction.momentum), x[0]);
}

struct collocation_change collocation_rim_change_at(const struct collocation *p, double s)
{
    const double none[4] = {0.0, 0.0, 0.0, 0.0};
    double x[4];
    collocation_deviation(p, s, x);
    const struct rim_state start = rim_state_of(&p->from.rim, none, 0.0);
    const struct rim_state then = rim_state_then(p, s, x);
    const struct vec3 before = rim_velocity(&start, p->local.rate.x);
    return (struct collocation_change){
        collocation_in_world(p, rim_moved(&p->from.rim, &then)),
        collocation_in_world(p, vec3_sub(rim_velocity(&then, x[1] / p->half), before)), x[0]};
}

void collocation_edges(const struct collocation *p, double s, const double x[4], double radial[3],
                       double axial[3])
{
    const double none[4] = {0.0, 0.0, 0.0, 0.0};
    struct rim_state at = rim_state_of(&p->from.rim, none, 0.0);
    struct rim_slopes slopes = {.tilt = 0.0, .over = 0.0};
    if (!p->local.head_on) {
        at = rim_state_then(p, s, x);
        slopes = rim_slopes_at(&at, acceleration_at_rim(p, p->half * s));
    }
    rim_edges(&at, &slopes, p->half, x[1], p->from.reach, radial, axial);
}

#endif
