/*
 * This file has the normal force laws, and first the stiffness k_h [N/m^1.5] of Hertz's force F_n = k_h
 * delta^(3/2) [N] at the penetration delta [m]. The stiffness follows from the elastic moduli and the radii
 * of the two bodies.
 *
 * Near the point of contact the undeformed surfaces are the distance A x^2 + B y^2 apart, with A <= B. The
 * contact area is an ellipse whose semi-axes b <= a have the ratio k' = b/a. With the effective modulus E*
 * [Pa] and the complete elliptic integrals K and E of the modulus e = sqrt(1 - k'^2):
 *
 *   A / B = k'^2 (K - E) / (E - k'^2 K),   k_h = (2 pi / 3) E* sqrt((K - E) / (e^2 A)) K^(-3/2)
 *
 * Source: K. L. Johnson, Contact Mechanics (1985), equations (4.25) to (4.28), solved for the load. Where A =
 * B, the contact area is a circle and k_h = (4/3) E* sqrt(R*) with the effective radius R* = 1/(2 A).
 */
#ifndef CONTACT_CONTACT_LAW_H
#define CONTACT_CONTACT_LAW_H

#include <stdbool.h>

#include "contact/choices.h"
#include "contact/shape.h"
#include "math/compiler.h"

struct contact_material {
    double youngs_modulus; /* E [Pa] */
    double poissons_ratio; /* nu [1] */
};

/* Returns the effective modulus E* [Pa]: 1/E* = (1 - nu_s^2)/E_s + (1 - nu_d^2)/E_d. */
CONTACT_COLD double hertz_modulus(struct contact_material source, struct contact_material destination);

/* Returns the ratio k_t / (dF_n/ddelta) = 4 G* / E* [1] of two elastic bodies that do not slip in the contact
 * area: 1/G* = (2 - nu_s)/G_s + (2 - nu_d)/G_d with the shear moduli G = E/(2 (1 + nu)), from k_t = 8 G* a
 * and dF_n/ddelta = 2 E* a with the radius a of the contact area. Source: K. L. Johnson, Contact Mechanics
 * (1985), section 7.2. */
CONTACT_COLD double mindlin_ratio(struct contact_material source, struct contact_material destination);

/* Returns k_h [N/m^1.5] of a contact from E* [Pa]. A source inside must be smaller than the destination. */
CONTACT_COLD double hertz_stiffness(const struct contact_shape *shape, double modulus);

/*
 * The normal force law has these regimes.
 *
 *   penalty            F_n = -p_n g
 *   penalty, dynamic   F_n = -p_n g - p_nv g'
 *   viscous only       F_n = -p_nv g'             (p_n = 0)
 *
 * for g < 0, zero otherwise. With the penetration delta = -g, Hertz's law with the damping of Hunt and
 * Crossley is
 *
 *   hertz              F_n = k_h delta^(3/2) (1 + chi delta')
 *
 * for delta > 0. Source: K. H. Hunt, F. R. E. Crossley, Journal of Applied Mechanics 42 (1975) 440.
 *
 * The choice of dashpot determines the viscous term: unclamped (the formula as it stands), non-adhesive (F_n
 * clipped at zero) or acting on approach only. In each regime the force is a smooth function of g and g';
 * with the linear law it is F_n = -(k g + c g') with constant k and c. A regime ends where a smooth event
 * function falls through zero.
 */

struct contact_law {
    double stiffness;     /* p_n in force [N/m] (0: viscous only), or k_h [N/m^1.5] of Hertz's law */
    double damping;       /* p_nv in force [N s/m] (0: undamped), or chi [s/m] of Hertz's law */
    enum dashpot dashpot; /* has no effect without damping */
    enum contact_force_law law;
};

/* Whether the law is Hertz's; a compile-time false in builds without Hertz's law (ContactFmu.cmake). */
bool contact_is_hertz(const struct contact_law *law);

enum contact_regime {
    REGIME_APART,       /* no contact: g >= 0, or the source is beyond an end plane */
    REGIME_COMPRESSION, /* the full law */
    REGIME_RESTITUTION, /* rebound (g' >= 0) with an approach-only dashpot: the spring alone acts */
    REGIME_SEPARATING   /* non-adhesive dashpot where the formula would pull: penetration without force */
};

struct contact_coefficients {
    double k, c; /* F_n = -(k g + c g') [N/m, N s/m] */
};

/* Returns the factors in force in a regime: p_n and p_nv of the linear law, k_h and chi of Hertz's law. */
struct contact_coefficients contact_factors_of(const struct contact_law *law, enum contact_regime regime);

/* Returns -(k g + c g') [N]. No other function contains this formula. */
double contact_linear_force(struct contact_coefficients linear, double gap, double gap_rate);

/* Returns the regime at g [m] and g' [m/s]; `within`: the source is between the destination's end planes. */
enum contact_regime contact_regime_of(const struct contact_law *law, double gap, double gap_rate,
                                      bool within);

/* Returns F_n [N] by the smooth formula of a regime, or zero in a regime without force. */
double contact_force(const struct contact_law *law, enum contact_regime regime, double gap, double gap_rate);

/* This struct holds the derivatives of a function with respect to the gap g [m] and the gap rate g' [m/s]. */
struct contact_slopes {
    double by_gap, by_rate; /* [unit/m], [unit s/m] */
};

struct contact_slopes contact_force_slopes(const struct contact_law *law, enum contact_regime regime,
                                           double gap, double gap_rate);

/* Returns the Taylor coefficient `order` of F_n along a path from the coefficients 0..order of g and g'.
 * `change` holds the derivatives of the law's factors along the path. */
double contact_force_term(const struct contact_law *law, const struct contact_law *change,
                          enum contact_regime regime, const double *gap, const double *gap_rate, int order);

/*
 * Returns the event function of a regime, which is positive within the regime. Where it falls through zero,
 * the law ends the regime; a zero of the gap is another kind of event.
 *
 *   dashpot                compression   restitution   separating
 *   non-adhesive           F_n                         -F_n of compression
 *   non-adhesive, hertz    1 - chi g'                  chi g' - 1
 *   approach-only          -g'           g'
 *
 * The event function is 1 where the law ends no regime. Hertz's F_n cannot serve: it vanishes at g = 0. All
 * are linear in g and g', so that their slopes are constants.
 */
double contact_event(const struct contact_law *law, enum contact_regime regime, double gap, double gap_rate);
struct contact_slopes contact_event_slopes(const struct contact_law *law, enum contact_regime regime);

/* Whether the law ever ends a regime; and the regime that follows the event of `regime`. */
bool contact_has_events(const struct contact_law *law);

enum contact_regime contact_regime_after(const struct contact_law *law, enum contact_regime regime);

/* Returns a function that falls through zero where the unclamped law begins to pull: F_n [N] for the linear
 * law, 1 + chi delta' [1] for Hertz's law, whose force is also zero, with zero slope, where contact ends. */
double contact_push(const struct contact_law *law, double gap, double gap_rate);

/* Whether the law is without damping, so that contact returns all the energy that it stores. */
bool contact_is_elastic(const struct contact_law *law);

/* Whether F_n may be negative during penetration: an unclamped dashpot pulls. Any other F_n < 0 is
 * rounding. */
bool contact_may_pull(const struct contact_law *law);

/* The stored energy E_c [J] during penetration: p_n g^2 / 2 of the linear law, 2/5 k_h delta^(5/2) of Hertz's
 * law. The functions return E_c, its derivative with respect to g [N], and its Taylor coefficient `order`
 * along a path with `change` as in contact_force_term. */
double contact_stored_energy(const struct contact_law *law, enum contact_regime regime, double gap);
double contact_stored_slope(const struct contact_law *law, enum contact_regime regime, double gap);
double contact_stored_term(const struct contact_law *law, const struct contact_law *change,
                           enum contact_regime regime, const double *gap, int order);

/* Returns the Taylor coefficient `order` of the dissipated power -(F_n + dE_c/dg) g' [W] in contact. */
double contact_dissipated_term(const struct contact_law *law, enum contact_regime regime,
                               const double *normal_force, const double *gap, const double *gap_rate,
                               int order);

/* Return the damping that gives a free impact the coefficient of restitution e in [0, 1]: the damping ratio
 * zeta = p_nv / (2 sqrt(p_n m_red)) [1] of the linear law, and the number chi v [1] of Hertz's law with the
 * approach speed v at the onset. */
CONTACT_COLD double restitution_damping_ratio(double restitution, enum dashpot dashpot);
CONTACT_COLD double restitution_hunt_crossley(double restitution, enum dashpot dashpot);

#endif
