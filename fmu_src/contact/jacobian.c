#include "contact/jacobian.h"

#include "math/matrix3.h"

/* Adds factor T. */
static void add_projector(double m[3][3], double factor, const struct contact_shape *shape,
                          const struct contact_geometry *at)
{
    const struct vec3 n = at->normal;
    for (int i = 0; i < 3; ++i) {
        m[i][i] += factor;
    }
    matrix3_add_outer(m, -factor, n, n);
    if (contact_is_cylinder(shape)) {
        matrix3_add_outer(m, -factor, shape->axis, shape->axis);
    }
#ifndef CONTACT_NO_CAPS
    if (contact_is_rim(shape)) {
        matrix3_add_outer(m, -factor * at->hoop_part, at->hoop, at->hoop);
    }
#endif
}

struct contact_jacobian contact_jacobian_at(const struct contact_shape *shape,
                                            const struct contact_geometry *at, struct vec3 w,
                                            const struct contact_law *law, enum contact_regime regime)
{
    const struct vec3 n = at->normal;
    const double side = shape->side;
    const double inverse_distance = contact_turns(shape, at) ? 1.0 / at->distance : 0.0;
    const struct vec3 rate_by_c = vec3_scale(side * inverse_distance, contact_turning_part(shape, at, w));
    const double force = contact_force(law, regime, at->gap, at->gap_rate);
    const struct contact_slopes slopes = contact_force_slopes(law, regime, at->gap, at->gap_rate);
    /* dF_n/dc and dF_n/dw */
    const struct vec3 force_by_c = vec3_axpy(vec3_scale(slopes.by_gap * side, n), slopes.by_rate, rate_by_c);
    const struct vec3 force_by_w = vec3_scale(slopes.by_rate * side, n);

    struct contact_jacobian gradient = {.by_separation = {{0.0}}, .by_rate = {{0.0}}};
    matrix3_add_outer(gradient.by_separation, -side, n, force_by_c);
    add_projector(gradient.by_separation, -side * force * inverse_distance, shape, at);
    matrix3_add_outer(gradient.by_rate, -side, n, force_by_w);

    /* P = -(F_n + dE_c/dg) g' */
    const double viscous_force = force + contact_stored_slope(law, regime, at->gap);
    const struct vec3 viscous_force_by_c =
        vec3_axpy(force_by_c, contact_stored_bend(law, regime, at->gap) * side, n);
    gradient.power_by_separation =
        vec3_axpy(vec3_scale(-at->gap_rate, viscous_force_by_c), -viscous_force, rate_by_c);
    gradient.power_by_rate = vec3_axpy(vec3_scale(-at->gap_rate, force_by_w), -viscous_force * side, n);
    return gradient;
}
