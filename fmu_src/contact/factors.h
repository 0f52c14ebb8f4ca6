/* The factors of the force law in force, from what the user chose: p_n and p_nv, or k_h and chi. */
#ifndef CONTACT_CONTACT_FACTORS_H
#define CONTACT_CONTACT_FACTORS_H

#include "contact/law.h"

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
 * p_nv = tau_n E_ref diag. Restitution: p_nv = 2 zeta sqrt(p_n m_red) with zeta of restitution.h. Hertz:
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
