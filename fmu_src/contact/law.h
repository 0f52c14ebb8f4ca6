/*
 * The normal force law and its regimes.
 *
 *   penalty            F_n = -p_n g
 *   penalty, dynamic   F_n = -p_n g - p_nv g'
 *   viscous only       F_n = -p_nv g'             (p_n = 0)
 *
 * for g < 0, zero otherwise. The dashpot says what becomes of the viscous term: unclamped (as it stands),
 * non-adhesive (F_n clipped at zero) or acting on approach only. In each regime the force is F_n = -(k g + c
 * g') with constant k and c, a smooth function of the motion; the regimes change where a smooth function
 * passes through zero.
 */
#ifndef CONTACT_CONTACT_LAW_H
#define CONTACT_CONTACT_LAW_H

#include <stdbool.h>

#include "contact/choices.h"

struct contact_law {
    double stiffness;     /* p_n in force [N/m]; 0 for viscous only */
    double damping;       /* p_nv in force [N s/m]; 0 for the undamped penalty method */
    enum dashpot dashpot; /* without damping it plays no part */
};

enum contact_regime {
    REGIME_APART,       /* no contact: g >= 0 or beyond a cylinder's end */
    REGIME_COMPRESSION, /* the full law */
    REGIME_RESTITUTION, /* restitution under an approach-only dashpot (g' >= 0): the spring alone */
    REGIME_SEPARATING   /* non-adhesive dashpot while the formula would pull: overlap without force */
};

struct contact_coefficients {
    double k, c; /* F_n = -(k g + c g') [N/m, N s/m] */
};

/* The regime of a contact with gap g and rate g', within (or beyond) the destination's extents. */
enum contact_regime contact_regime_of(const struct contact_law *law, double gap, double gap_rate,
                                      bool within);

struct contact_coefficients contact_coefficients_of(const struct contact_law *law,
                                                    enum contact_regime regime);

/* F_n [N] in a regime. A non-adhesive law never returns less than zero, also not by rounding. */
double contact_normal_force_of(const struct contact_law *law, enum contact_regime regime, double gap,
                               double gap_rate);

/* The margin of a regime, positive within it: its fall through zero ends the regime by the law itself (not by
 * the gap). The force of a non-adhesive contact in compression; of an approach-only dashpot -g' in
 * compression and g' in restitution; 1 where the law ends nothing. */
double contact_regime_margin(const struct contact_law *law, enum contact_regime regime, double gap,
                             double gap_rate);

/* The regime after the margin has fallen (or, while separating, after the law's force has become positive
 * again). */
enum contact_regime contact_regime_after(const struct contact_law *law, enum contact_regime regime);

/* E_c = p_n g^2 / 2 while overlapping [J]. */
double contact_stored_energy(const struct contact_law *law, enum contact_regime regime, double gap);

/* -(F_n + p_n g) g' while overlapping [W]. */
double contact_dissipated_power(const struct contact_law *law, enum contact_regime regime,
                                double normal_force, double gap, double gap_rate);

/* What sets the penalty factors, as the user chose it. */
struct contact_factors {
    enum method method;
    enum penalty_control penalty_control;
    enum viscous_control viscous_control;
    double multiplier;             /* f_p [1] */
    double penalty_factor;         /* p_n [N/m], user defined */
    double characteristic_time;    /* tau_n [s] */
    double viscous_penalty_factor; /* p_nv [N s/m], user defined */
    double reference_modulus;      /* E_ref [Pa] */
};

/* The factors in force. Automatic: p_n = f_p E_ref diag, p_nv = tau_n p_n; viscous only: p_n = 0,
 * p_nv = tau_n E_ref diag. `diagonal` is that of the bounding box of both bodies [m]. */
struct contact_law contact_law_of(const struct contact_factors *factors, enum dashpot dashpot,
                                  double diagonal);

#endif
