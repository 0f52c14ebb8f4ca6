/*
 * The normal force law and its regimes.
 *
 *   penalty            F_n = -p_n g
 *   penalty, dynamic   F_n = -p_n g - p_nv g'
 *   viscous only       F_n = -p_nv g'             (p_n = 0)
 *
 * for g < 0, zero otherwise; or, with delta = -g, Hertz's law with the damping of Hunt and Crossley
 * (hertz_law.h)
 *
 *   hertz              F_n = k_h delta^(3/2) (1 + chi delta')
 *
 * The dashpot says what becomes of the viscous term: unclamped (as it stands),
 * non-adhesive (F_n clipped at zero) or acting on approach only. In each regime the force is a smooth
 * function of the motion, of the linear law F_n = -(k g + c g') with constant k and c; the regimes change
 * where a smooth function passes through zero.
 */
#ifndef CONTACT_CONTACT_LAW_H
#define CONTACT_CONTACT_LAW_H

#include <stdbool.h>

#include "contact/choices.h"

struct contact_law {
    double stiffness;     /* p_n in force [N/m], 0 for viscous only; k_h [N/m^1.5] */
    double damping;       /* p_nv in force [N s/m], 0 for the undamped penalty method; chi [s/m] */
    enum dashpot dashpot; /* without damping it plays no part */
    enum contact_force_law law;
};

/* Whether it is Hertz's law; never, at compile time, where the build knows of the linear law only
 * (ContactFmu.cmake). */
static inline bool contact_is_hertz(const struct contact_law *law)
{
#ifdef CONTACT_NO_HERTZ
    (void)law;
    return false;
#else
    return law->law == LAW_HERTZ;
#endif
}

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
static inline double contact_linear_force(struct contact_coefficients linear, double gap, double gap_rate)
{
    return -(linear.k * gap + linear.c * gap_rate);
}

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

/* Where the unclamped law begins to pull it falls through zero: F_n [N]; of Hertz's law, whose force ends
 * with the contact, too, and has no slope there, the factor 1 + chi delta' that changes its sign [1]. */
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

#endif
