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
    double tilt[3] = {p->from.rim.tilt, 0.0, 0.0};
    if (!p->local.head_on) {
        const int points = p->nodes->points;
        tilt[0] += nodal_integral(p->result.tilt_rate, points, s) - p->result.normal_correction.y;
        tilt[1] = nodal_polynomial_at(p->result.tilt_rate, points, s);
        tilt[2] = nodal_slope(p->result.tilt_rate, points, s);
        if (p->kind != COLLOCATION_RESOLVED) { /* what y adds, as collocation_rim_correction says */
            double slow[4];
            collocation_averaged_deviation(p, s, slow);
            const double by = -2.0 * tilt[1] / (p->from.reach + x[0]);
            const double y = x[0] - slow[0];
            const double y_rate = x[1] - slow[1];
            tilt[0] += by * collocation_oscillation_integral(p, y, y_rate) / p->half;
            tilt[1] += by * y;
            tilt[2] += by * y_rate;
        }
    }
    rim_edges(tilt, p->from.reach, radial, axial);
}

#endif
