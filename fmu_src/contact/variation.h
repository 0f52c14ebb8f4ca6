/*
 * One contact along a path: every quantity as c[0] + c[1] s + c[2] s^2 + ... for a separation c(s) and a rate w(s) that are
 * given so. With s the time since the present the coefficients are time derivatives over factorials; with s a step in some
 * direction the first ones are directional derivatives.
 *
 *   d d = n.d c (n.e_d = 0),   d n = offset,   g = side (d - reach),   g' = side n.w,   F_n = -(k g + c g')
 *
 * in the regime in force, on whose edges the derivatives are those of its own side. Where d = 0 the direction is held.
 */
#ifndef CONTACT_VARIATION_H
#define CONTACT_VARIATION_H

#include "contact/geometry.h"
#include "contact/law.h"

enum { VARIATION_TERMS = 3 };

struct contact_variation {
    struct vec3 normal[VARIATION_TERMS];
    double distance[VARIATION_TERMS], gap[VARIATION_TERMS], gap_rate[VARIATION_TERMS];
    double normal_force[VARIATION_TERMS];
    struct vec3 source_force[VARIATION_TERMS]; /* -side F_n n */
};

/* From the geometry at s = 0 (c[0] itself is not used), the regime's coefficients and their rates of change d/ds. */
__attribute__((cold)) void contact_vary(const struct contact_shape *shape, const struct contact_geometry *at,
                                        const struct vec3 c[VARIATION_TERMS],
                                        const struct vec3 w[VARIATION_TERMS], struct contact_coefficients by,
                                        struct contact_coefficients slope, struct contact_variation *result);

/* Coefficient `order` of a product. */
double variation_product(const double *a, const double *b, int order);
double variation_dot(const struct vec3 *a, const struct vec3 *b, int order);
struct vec3 variation_scale(const double *a, const struct vec3 *b, int order);

#endif
