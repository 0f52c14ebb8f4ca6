/*
 * The stiffness k_h of Hertz's theory, F_n = k_h delta^(3/2), from the moduli and shapes of two bodies.
 *
 * Near the point of contact the undeformed surfaces are A x^2 + B y^2 apart, A <= B. The contact is an
 * ellipse with the ratio k' = b/a of its semi-axes, and with the complete elliptic integrals K and E of
 * modulus e = sqrt(1 - k'^2)
 *
 *   A / B = k'^2 (K - E) / (E - k'^2 K),   k_h = (2 pi / 3) E* sqrt((K - E) / (e^2 A)) K^(-3/2)
 *
 * Source: K. L. Johnson, Contact Mechanics (1985), equations (4.25) to (4.28), solved for the load. Where A =
 * B the contact is a circle and k_h = (4/3) E* sqrt(R*), R* = 1/(2 A).
 */
#ifndef CONTACT_CONTACT_HERTZ_STIFFNESS_H
#define CONTACT_CONTACT_HERTZ_STIFFNESS_H

#include "contact/geometry.h"
#include "math/compiler.h"

struct contact_material {
    double youngs_modulus; /* E [Pa] */
    double poissons_ratio; /* nu [1] */
};

/* E*: 1/E* = (1 - nu_s^2)/E_s + (1 - nu_d^2)/E_d [Pa]. */
CONTACT_COLD double hertz_modulus(struct contact_material source, struct contact_material destination);

/* k_h [N/m^1.5] from E* [Pa] and the two coefficients of the separation, 0 < A <= B [1/m]. */
CONTACT_COLD double hertz_elliptic_stiffness(double modulus, double a, double b);

/* k_h [N/m^1.5] of a contact; inside a destination that is larger than the source. */
CONTACT_COLD double hertz_stiffness(const struct contact_shape *shape, double modulus);

/* Whether the surfaces follow each other so closely that the contact is not small beside the bodies, as the
 * theory wants it: inside a destination hardly larger than the source. */
CONTACT_COLD bool hertz_is_conforming(const struct contact_shape *shape);

#endif
