/*
 * Derivatives of the contact force, for implicit integration.
 *
 * With F_n by the law, T = P - n n^T (P the identity for a sphere, I - e_d e_d^T for a cylinder;
 * of a rim contact_turning_part):
 *   dg/dc = side n,   dn/dc = T / d,   dg'/dc = side T w / d,   dg'/dw = side n
 * and the force on the source is F_src = -side F_n n.
 */
#ifndef CONTACT_CONTACT_JACOBIAN_H
#define CONTACT_CONTACT_JACOBIAN_H

#include "contact/geometry.h"
#include "contact/law.h"

struct contact_jacobian {
    double by_separation[3][3];      /* dF_src / dc [N/m] */
    double by_rate[3][3];            /* dF_src / dw [N s/m] */
    struct vec3 power_by_separation; /* d/dc of the dissipated power [W/m] */
    struct vec3 power_by_rate;       /* d/dw of the dissipated power [W s/m] */
};

/* At separation rate w, in a regime of contact. Where d = 0 the direction stays as it is and T is taken as
 * zero. */
struct contact_jacobian contact_jacobian_at(const struct contact_shape *shape,
                                            const struct contact_geometry *at, struct vec3 w,
                                            const struct contact_law *law, enum contact_regime regime);

#endif
