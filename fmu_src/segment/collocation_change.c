/* Dense output of a collocated step: motion at any s. */
#include "segment/collocation.h"
#include "segment/collocation_rim.h"
#include "segment/collocation_turning.h"

static struct vec3 acceleration_then(const struct collocation *p, double t)
{
    return vec3_axpy(vec3_axpy(p->local.acceleration[0], t, p->local.acceleration[1]), t * t,
                     p->local.acceleration[2]);
}

/* Change of n and H since the start, y included. */
static void frame_change_at(const struct collocation *p, double s, const double x[4],
                            struct vec3 *normal_change, struct vec3 *momentum_change)
{
    const struct lobatto *nodes = p->nodes;
    normal_change->x = nodal_integral_to(nodes, p->result.n.x, p->result.n_rate.x, s);
    normal_change->y = nodal_integral_to(nodes, p->result.n.y, p->result.n_rate.y, s);
    momentum_change->z = nodal_integral_to(nodes, p->result.h.z, p->result.h_rate.z, s);
    if (!p->local.planar) {
        normal_change->z = nodal_integral_to(nodes, p->result.n.z, p->result.n_rate.z, s);
        momentum_change->x = nodal_integral_to(nodes, p->result.h.x, p->result.h_rate.x, s);
        momentum_change->y = nodal_integral_to(nodes, p->result.h.y, p->result.h_rate.y, s);
    }
    if (p->kind != COLLOCATION_RESOLVED) {
        double slow[4];
        collocation_averaged_deviation(p, s, slow);
        *normal_change = vec3_sub(*normal_change, p->result.normal_correction);
        *momentum_change = vec3_sub(*momentum_change, p->result.momentum_correction);
        const struct collocation_correction correction = collocation_correction_of(
            p, x[0] - slow[0], x[1] - slow[1], vec3_add(vec3_make(1.0, 0.0, 0.0), *normal_change),
            vec3_add(p->local.momentum, *momentum_change), acceleration_then(p, p->half * s),
            p->from.reach + x[0]);
        *normal_change = vec3_add(*normal_change, correction.normal);
        *momentum_change = vec3_add(*momentum_change, correction.momentum);
    }
}

struct collocation_change collocation_change_at(const struct collocation *p, double s)
{
    const struct vec3 normal = {1.0, 0.0, 0.0};
    if (collocation_at_rim(p)) {
        return collocation_rim_change_at(p, s);
    }
    double x[4];
    collocation_deviation(p, s, x);
    struct vec3 normal_change = {0.0, 0.0, 0.0};
    struct vec3 momentum_change = {0.0, 0.0, 0.0};
    if (!p->local.head_on) {
        frame_change_at(p, s, x, &normal_change, &momentum_change);
    }
    const double d = p->from.reach + x[0];
    /* n keeps its length: |normal + normal_change|^2 = 1 + longer */
    const double longer = vec3_dot(vec3_axpy(normal_change, 2.0, normal), normal_change);
    const double root = sqrt(1.0 + longer);
    normal_change =
        vec3_axpy(normal_change, -longer / (root * (1.0 + root)), vec3_add(normal, normal_change));
    /* Differences of c = d n and c' = x' n + H x n / d, so that a short step keeps its digits. */
    const double grown = x[0] - p->from.deviation;
    const double radial = x[1] / p->half;
    struct vec3 gained = vec3_axpy(vec3_scale(radial, normal_change), radial - p->local.rate.x, normal);
    if (!p->local.head_on) { /* which may be at the centre, where d = 0 */
        const struct vec3 swing = vec3_add(vec3_cross(momentum_change, vec3_add(normal, normal_change)),
                                           vec3_cross(p->local.momentum, normal_change));
        gained = vec3_axpy(gained, 1.0 / d, swing);
        gained = vec3_axpy(gained, -grown / (d * p->local.distance), vec3_cross(p->local.momentum, normal));
    }
    return (struct collocation_change){
        collocation_in_world(p, vec3_axpy(vec3_scale(d, normal_change), grown, normal)),
        collocation_in_world(p, gained), x[0]};
}
