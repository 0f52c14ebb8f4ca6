/* The laws of friction (friction.h) along a path, as contact/jet.h has the normal one. */
#ifndef CONTACT_CONTACT_FRICTION_JET_H
#define CONTACT_CONTACT_FRICTION_JET_H

#include "contact/friction.h"
#include "contact/jet.h"

/* What F_t depends on: F_n, v_t, xi and d/ds of v_0. */
struct friction_path {
    double normal_force[JET_TERMS];
    struct vec3 slip[JET_TERMS], spring[JET_TERMS];
    double slip_velocity_slope;
};

/* Coefficient `order` of F_t, from those of the path up to it. At rest the speed of the slip grows with |s|:
 * its coefficients are those of s > 0. */
CONTACT_COLD struct vec3 friction_force_term(const struct friction_law *law, enum friction_regime regime,
                                             const struct friction_path *path, int order);

/* And of the energy stored in the spring [J]. */
CONTACT_COLD double friction_stored_term(const struct friction_law *law, enum friction_regime regime,
                                         const struct friction_path *path, int order);

/* The length of a vector. */
CONTACT_COLD void jet_length(const struct vec3 a[JET_TERMS], double length[JET_TERMS]);

#endif
