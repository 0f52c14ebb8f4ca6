/*
 * One contact along a path: every quantity as c[0] + c[1] s + c[2] s^2 + ... for a separation c(s) and a rate
 * w(s) that are given so. With s the time since the present the coefficients are time derivatives over
 * factorials; with s a step in some direction the first ones are directional derivatives.
 *
 *   d d = n.d c (n.e_d = 0),   d n = offset,   g = side (d - reach),   g' = side n.w,   F_n by the law
 *
 * in the regime in force, on whose edges the derivatives are those of its own side. Where d = 0 the direction
 * stays as it is.
 */
#ifndef CONTACT_CONTACT_JET_H
#define CONTACT_CONTACT_JET_H

#include "contact/geometry.h"
#include "contact/law.h"
#include "math/compiler.h"

enum { JET_TERMS = 3 };

struct contact_jet {
    struct vec3 normal[JET_TERMS];
    double distance[JET_TERMS], gap[JET_TERMS], gap_rate[JET_TERMS];
    double normal_force[JET_TERMS];
    struct vec3 source_force[JET_TERMS]; /* -side F_n n */
};

/* From the geometry at s = 0 (c[0] itself is not used), the law and the change d/ds of its factors. */
CONTACT_COLD void contact_jet_make(const struct contact_shape *shape, const struct contact_geometry *at,
                                   const struct vec3 c[JET_TERMS], const struct vec3 w[JET_TERMS],
                                   const struct contact_law *law, const struct contact_law *change,
                                   enum contact_regime regime, struct contact_jet *result);

/* Coefficient `order` of a product. */
double jet_dot(const struct vec3 *a, const struct vec3 *b, int order);
struct vec3 jet_scale(const double *a, const struct vec3 *b, int order);

#endif
