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

/* E*: 1/E* = (1 - nu_s^2)/E_s + (1 - nu_d^2)/E_d [Pa]. */
CONTACT_COLD double hertz_modulus(struct contact_material source, struct contact_material destination);

/* k_h [N/m^1.5] from E* [Pa] and the two coefficients of the separation, 0 < A <= B [1/m]. */
CONTACT_COLD double hertz_elliptic_stiffness(double modulus, double a, double b);

/* k_h [N/m^1.5] of a contact; inside a destination that is larger than the source. */
CONTACT_COLD double hertz_stiffness(const struct contact_shape *shape, double modulus);

/* Whether the surfaces follow each other so closely that the contact is not small beside the bodies, as the
 * theory wants it: inside a destination hardly larger than the source. */
CONTACT_COLD bool hertz_is_conforming(const struct contact_shape *shape);

/*
 * The damping that gives a free head-on impact a coefficient of restitution e, the speed after it over the
 * speed before. Free: no other force acts on either body meanwhile. Found once, when a contact is prepared.
 */

/*
 * Smaller coefficients count as this one where none but an infinite dashpot would give 0: with all dashpots
 * but the unclamped linear one. A ball that leaves with a millionth of its speed rises by 1e-12 of its drop.
 */
#define RESTITUTION_LEAST 1e-6

/*
 * The same of Hunt and Crossley's law. Its chi v is 1/e, with the approach-only dashpot 2/e^2, and
 * integration costs steps in proportion: 2e6 take some ten thousand. A millionth of the energy is left then.
 */
#define RESTITUTION_LEAST_HERTZ 1e-3

/*
 * The damping ratio zeta = p_nv / (2 sqrt(p_n m_red)) of the linear law for e in [0, 1].
 *
 *   unclamped       contact ends at g = 0:      e = exp(-pi zeta / sqrt(1 - zeta^2)); e = 0: zeta = 1
 *   non-adhesive    contact ends at F_n = 0:    e = exp(-2 h(zeta))
 *   approach-only   the spring alone returns:   e = exp(-h(zeta))
 *
 *   h(cos t) = t cot t up to critical damping, h(cosh t) = t coth t beyond.
 *
 * Source: the oscillator x'' + 2 zeta x' + x = 0 from x = 0, x' = 1. Its largest x is exp(-h), and the spring
 * alone turns that into a speed of the same number. It returns through x + 2 zeta x' = 0, where the force
 * ends, with x' = -exp(-2 h): T. Schwager, T. Poeschel, Granular Matter 9 (2007) 465, in one formula.
 */
CONTACT_COLD double restitution_damping_ratio(double restitution, enum dashpot dashpot);

/*
 * The number y = chi v of Hunt and Crossley's law, with the speed v of the onset, for e in [0, 1]; it does
 * not depend on the spring, nor on the exponent of its force.
 *
 *   full damping    y (1 + e) = ln((1 + y)/(1 - e y)); the force then never pulls: unclamped is non-adhesive
 *   approach-only   e^2 = 2 (y - ln(1 + y))/y^2
 *
 * Source: with the energy E of the spring for a state of motion, v dv/dE = -(1 + chi v)/m; both are its
 * integrals from the touch to the deepest point, E = (m/chi^2)(y - ln(1 + y)), and back. Marhefka and Orin,
 * IEEE Transactions on Systems, Man, and Cybernetics A 29 (1999) 566.
 */
CONTACT_COLD double restitution_hunt_crossley(double restitution, enum dashpot dashpot);

/*
 * The normal force law and its regimes.
 *
 *   penalty            F_n = -p_n g
 *   penalty, dynamic   F_n = -p_n g - p_nv g'
 *   viscous only       F_n = -p_nv g'             (p_n = 0)
 *
 * for g < 0, zero otherwise; or, with delta = -g, Hertz's law with the damping of Hunt and Crossley
 *
 *
 *   hertz              F_n = k_h delta^(3/2) (1 + chi delta')
 *
 * The dashpot says what becomes of the viscous term: unclamped (as it stands),
 * non-adhesive (F_n clipped at zero) or acting on approach only. In each regime the force is a smooth
 * function of the motion, of the linear law F_n = -(k g + c g') with constant k and c; the regimes change
 * where a smooth function passes through zero.
 */

struct contact_law {
    double stiffness;     /* p_n in force [N/m], 0 for viscous only; k_h [N/m^1.5] */
    double damping;       /* p_nv in force [N s/m], 0 for the undamped penalty method; chi [s/m] */
    enum dashpot dashpot; /* without damping it plays no part */
    enum contact_force_law law;
};

/* Whether it is Hertz's law; never, at compile time, where the build knows of the linear law only
 * (ContactFmu.cmake). */
bool contact_is_hertz(const struct contact_law *law);

enum contact_regime {
    REGIME_APART,       /* no contact: g >= 0 or beyond a cylinder's end */
    REGIME_COMPRESSION, /* the full law */
    REGIME_RESTITUTION, /* restitution under an approach-only dashpot (g' >= 0): the spring alone */
    REGIME_SEPARATING   /* non-adhesive dashpot while the formula would pull: overlap without force */
};

struct contact_coefficients {
    double k, c; /* F_n = -(k g + c g') [N/m, N s/m] */
};

/* The constants of the linear law in a regime, zero of any other law. For what is in closed form because the
 * law is linear, and for reporting p_n and p_nv; whoever only needs forces and events asks the functions
 * below. */
struct contact_coefficients contact_coefficients_of(const struct contact_law *law,
                                                    enum contact_regime regime);

/* -(k g + c g') [N]: the law, which stands nowhere else. */
double contact_linear_force(struct contact_coefficients linear, double gap, double gap_rate);

/* The factors of either law: p_n and p_nv, or k_h and chi. */
struct contact_coefficients contact_factors_of(const struct contact_law *law);

/* The regime of a contact with gap g and rate g', within (or beyond) the destination's extents. */
enum contact_regime contact_regime_of(const struct contact_law *law, double gap, double gap_rate,
                                      bool within);

/* F_n [N] by the smooth formula of a regime; zero where it has no force. */
double contact_force(const struct contact_law *law, enum contact_regime regime, double gap, double gap_rate);

/* The same as users see it: a law that does not pull never returns less than zero, also not by rounding. */
double contact_normal_force_of(const struct contact_law *law, enum contact_regime regime, double gap,
                               double gap_rate);

/* Derivatives of a function of g and g'. */
struct contact_slopes {
    double by_gap, by_rate; /* [unit/m], [unit s/m] */
};

struct contact_slopes contact_force_slopes(const struct contact_law *law, enum contact_regime regime,
                                           double gap, double gap_rate);

/* Coefficient `order` of F_n along a path, from coefficients 0..order of g and g'. `change`: the derivatives
 * of the law's factors along it; NULL: they are constant. */
double contact_force_term(const struct contact_law *law, const struct contact_law *change,
                          enum contact_regime regime, const double *gap, const double *gap_rate, int order);

/*
 * The event function of a regime, positive within it: its fall through zero ends the regime by the law itself
 * (not by the gap).
 *
 *   dashpot                compression   restitution   separating
 *   non-adhesive           F_n                         -F_n of compression
 *   non-adhesive, hertz    1 - chi g'                  chi g' - 1
 *   approach-only          -g'           g'
 *
 * 1 where the law ends nothing. Hertz's F_n is zero wherever g is, and says nothing there.
 */
double contact_event(const struct contact_law *law, enum contact_regime regime, double gap, double gap_rate);
struct contact_slopes contact_event_slopes(const struct contact_law *law, enum contact_regime regime,
                                           double gap, double gap_rate);

/* Coefficient `order` of the event function of separating along a path. */
double contact_separating_event_term(const struct contact_law *law, const double *gap, const double *gap_rate,
                                     int order);

/* A value of the event function as a force [N]: that of an approach-only dashpot is a rate. Of Hertz's law
 * it has no unit, and 1 N stands for 1. */
double contact_event_force(const struct contact_law *law, double event);

/* Whether the law ever ends a regime, and the regime after its event. */
bool contact_has_events(const struct contact_law *law);
enum contact_regime contact_regime_after(const struct contact_law *law, enum contact_regime regime);

/* A function that falls through zero where the unclamped law begins to pull. Under the linear law it is F_n
 * [N]. Hertz's force is also zero, without a slope, where contact ends; there it is 1 + chi delta' [1]. */
double contact_push(const struct contact_law *law, double gap, double gap_rate);

/* Whether F_n may be negative while the bodies overlap: an unclamped dashpot pulls. What any other law says
 * below zero is rounding. */
bool contact_may_pull(const struct contact_law *law);

/* Whether contact gives back all the energy that it takes. */
bool contact_is_elastic(const struct contact_law *law);

/* E_c = p_n g^2 / 2, or 2/5 k_h delta^(5/2), while overlapping [J], its first two derivatives with respect to
 * g [N], [N/m], and its coefficient `order` along a path, with `change` as in contact_force_term. */
double contact_stored_energy(const struct contact_law *law, enum contact_regime regime, double gap);
double contact_stored_slope(const struct contact_law *law, enum contact_regime regime, double gap);
double contact_stored_bend(const struct contact_law *law, enum contact_regime regime, double gap);
double contact_stored_term(const struct contact_law *law, const struct contact_law *change,
                           enum contact_regime regime, const double *gap, int order);

/* -(F_n + dE_c/dg) g' while overlapping [W], and its coefficient `order` along a path. */
double contact_dissipated_power(const struct contact_law *law, enum contact_regime regime,
                                double normal_force, double gap, double gap_rate);
double contact_dissipated_term(const struct contact_law *law, enum contact_regime regime,
                               const double *normal_force, const double *gap, const double *gap_rate,
                               int order);

/* The factors of the force law in force, from what the user chose: p_n and p_nv, or k_h and chi. */

/* What sets the penalty factors, as the user chose it. */
struct contact_factors {
    enum method method;
    enum contact_force_law law;
    enum penalty_control penalty_control;
    enum viscous_control viscous_control;
    double multiplier;             /* f_p [1] */
    double penalty_factor;         /* p_n [N/m], user defined */
    double characteristic_time;    /* tau_n [s] */
    double viscous_penalty_factor; /* p_nv [N s/m], user defined */
    double reference_modulus;      /* E_ref [Pa] */
    double restitution;            /* e [1] */
    double inverse_mass;           /* 1 / m_red: sum of the free bodies' inverse masses [1/kg] */
    double hertz_stiffness;        /* k_h [N/m^1.5], user defined or of Hertz's theory */
    double hunt_crossley_factor;   /* chi [s/m], user defined */
};

/* The factors in force. Automatic: p_n = f_p E_ref diag, p_nv = tau_n p_n; viscous only: p_n = 0,
 * p_nv = tau_n E_ref diag. Restitution: p_nv = 2 zeta sqrt(p_n m_red) with zeta of law.h. Hertz:
 * k_h as given, chi = tau_n / diag where it is automatic; with restitution chi times the speed of the onset,
 * a number, stands for it. `diagonal` is that of the bounding box of both bodies [m]. */
struct contact_law contact_law_of(const struct contact_factors *factors, enum dashpot dashpot,
                                  double diagonal);

/* The derivatives of the factors `at` the present ones where the diagonal changes at `diagonal_slope`:
 * automatic ones are proportional to it, others do not know it, that of restitution goes with the root of
 * p_n. */
struct contact_law contact_law_slope(const struct contact_factors *factors, struct contact_coefficients at,
                                     double diagonal_slope);

/* The derivatives of the factors of Hertz's law where only chi changes. */
struct contact_law contact_hunt_crossley_slope(double chi_slope);

/* The law with these factors in force. The choices, constants where a scene pins them, leave out what they do
 * not need. */
struct contact_law contact_law_with(struct contact_coefficients factors, enum method method,
                                    enum penalty_control penalty_control, enum dashpot dashpot,
                                    enum contact_force_law force_law);

#endif
