#include "contact/gradient.h"

static void add_outer(double m[3][3], double factor, struct vec3 a, struct vec3 b)
{
    const double left[3] = {a.x, a.y, a.z};
    const double right[3] = {b.x, b.y, b.z};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            m[i][j] += factor * left[i] * right[j];
        }
    }
}

/* Adds factor T. */
static void add_turning(double m[3][3], double factor, const struct contact_shape *shape, struct vec3 n)
{
    for (int i = 0; i < 3; ++i) {
        m[i][i] += factor;
    }
    add_outer(m, -factor, n, n);
    if (contact_is_cylinder(shape)) {
        add_outer(m, -factor, shape->axis, shape->axis);
    }
}

struct contact_gradient contact_gradient_at(const struct contact_shape *shape,
                                            const struct contact_geometry *at, struct vec3 w,
                                            struct contact_coefficients by, double stiffness)
{
    const struct vec3 n = at->normal;
    const double side = shape->side;
    const double turning = at->degenerate ? 0.0 : 1.0 / at->distance;
    const struct vec3 rate_by_c = vec3_scale(side * turning, contact_tangential(shape, n, w));
    const double force = -(by.k * at->gap + by.c * at->gap_rate);
    /* dF_n/dc and dF_n/dw */
    const struct vec3 force_by_c = vec3_axpy(vec3_scale(-by.k * side, n), -by.c, rate_by_c);
    const struct vec3 force_by_w = vec3_scale(-by.c * side, n);

    struct contact_gradient gradient = {.by_separation = {{0.0}}, .by_rate = {{0.0}}};
    add_outer(gradient.by_separation, -side, n, force_by_c);
    add_turning(gradient.by_separation, -side * force * turning, shape, n);
    add_outer(gradient.by_rate, -side, n, force_by_w);

    /* P = -(F_n + p_n g) g' */
    const double excess = force + stiffness * at->gap;
    const struct vec3 excess_by_c = vec3_axpy(force_by_c, stiffness * side, n);
    gradient.power_by_separation = vec3_axpy(vec3_scale(-at->gap_rate, excess_by_c), -excess, rate_by_c);
    gradient.power_by_rate = vec3_axpy(vec3_scale(-at->gap_rate, force_by_w), -excess * side, n);
    return gradient;
}
