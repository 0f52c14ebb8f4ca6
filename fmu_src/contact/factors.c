#include "contact/factors.h"

#include <math.h>

#include "contact/restitution.h"

/* Whether the law is Hertz's, as in contact_is_hertz. */
static bool has_hertz(const struct contact_factors *factors)
{
    const struct contact_law law = {.law = factors->law};
    return contact_is_hertz(&law);
}

/* Whether damping follows from a coefficient of restitution; never, at compile time, where the build has no
 * such choice (ContactFmu.cmake). */
static bool is_by_restitution(const struct contact_factors *factors)
{
#ifdef CONTACT_NO_RESTITUTION
    (void)factors;
    return false;
#else
    return factors->viscous_control == VISCOUS_CONTROL_RESTITUTION;
#endif
}

/* p_nv that gives the coefficient of restitution with the spring p_n; 0 between bodies that cannot
 * rebound. */
static double damping_by_restitution(const struct contact_factors *factors, enum dashpot dashpot, double p_n)
{
    if (!(factors->inverse_mass > 0.0)) {
        return 0.0;
    }
    const double ratio = restitution_damping_ratio(factors->restitution, dashpot);
    return 2.0 * ratio * sqrt(p_n) / sqrt(factors->inverse_mass);
}

/* chi, or with restitution the number chi v. */
static double hunt_crossley_factor(const struct contact_factors *factors, enum dashpot dashpot,
                                   double diagonal)
{
    if (is_by_restitution(factors)) {
        return restitution_hunt_crossley(factors->restitution, dashpot);
    }
    return factors->viscous_control == VISCOUS_CONTROL_USER_DEFINED ? factors->hunt_crossley_factor
                                                                    : factors->characteristic_time / diagonal;
}

struct contact_law contact_law_of(const struct contact_factors *factors, enum dashpot dashpot,
                                  double diagonal)
{
    if (has_hertz(factors)) {
        return (struct contact_law){.stiffness = factors->hertz_stiffness,
                                    .damping = factors->method == METHOD_PENALTY
                                                   ? 0.0
                                                   : hunt_crossley_factor(factors, dashpot, diagonal),
                                    .dashpot = dashpot,
                                    .law = LAW_HERTZ};
    }
    const double scale = factors->reference_modulus * diagonal;
    const bool viscous_only = factors->penalty_control == PENALTY_CONTROL_VISCOUS_ONLY;
    struct contact_law law = {.stiffness = factors->penalty_factor, .dashpot = dashpot, .law = LAW_LINEAR};
    if (factors->penalty_control == PENALTY_CONTROL_AUTOMATIC) {
        law.stiffness = factors->multiplier * scale;
    }
    if (factors->viscous_control == VISCOUS_CONTROL_USER_DEFINED) {
        law.damping = factors->viscous_penalty_factor;
    } else if (is_by_restitution(factors)) {
        law.damping = damping_by_restitution(factors, dashpot, law.stiffness);
    } else {
        law.damping = factors->characteristic_time * (viscous_only ? scale : law.stiffness);
    }
    if (viscous_only) {
        law.stiffness = 0.0;
    }
    if (factors->method == METHOD_PENALTY) {
        law.damping = 0.0;
    }
    return law;
}

struct contact_law contact_law_slope(const struct contact_factors *factors, struct contact_coefficients at,
                                     double diagonal_slope)
{
    if (has_hertz(factors)) { /* chi = tau_n / diag */
        const bool automatic =
            factors->method != METHOD_PENALTY && factors->viscous_control == VISCOUS_CONTROL_AUTOMATIC;
        const double by_diagonal = at.c * at.c / factors->characteristic_time;
        return (struct contact_law){.damping = automatic && at.c > 0.0 ? -by_diagonal * diagonal_slope : 0.0,
                                    .law = LAW_HERTZ};
    }
    const struct contact_law none = contact_law_of(factors, DASHPOT_UNCLAMPED, 0.0);
    struct contact_law slope = contact_law_of(factors, DASHPOT_UNCLAMPED, diagonal_slope);
    slope.stiffness -= none.stiffness;
    slope.damping -= none.damping;
    if (is_by_restitution(factors)) {
        slope.damping = 0.5 * at.c * slope.stiffness / at.k;
    }
    return slope;
}

struct contact_law contact_hunt_crossley_slope(double chi_slope)
{
    return (struct contact_law){.damping = chi_slope, .law = LAW_HERTZ};
}

struct contact_law contact_law_with(struct contact_coefficients factors, enum method method,
                                    enum penalty_control penalty_control, enum dashpot dashpot,
                                    enum contact_force_law force_law)
{
    struct contact_law law = {.dashpot = dashpot, .law = force_law};
    if (penalty_control != PENALTY_CONTROL_VISCOUS_ONLY) {
        law.stiffness = factors.k;
    }
    if (method == METHOD_PENALTY_DYNAMIC) {
        law.damping = factors.c;
    }
    /* Without a spring both let go when the bodies stop approaching; a separating contact is known to fly. */
    if (law.dashpot == DASHPOT_APPROACH_ONLY && !(law.stiffness > 0.0)) {
        law.dashpot = DASHPOT_NON_ADHESIVE;
    }
    return law;
}
