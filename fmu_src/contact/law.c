#include "contact/law.h"

#include <math.h>

#include "contact/restitution.h"
#include "math/taylor.h"

struct contact_coefficients contact_coefficients_of(const struct contact_law *law, enum contact_regime regime)
{
    struct contact_coefficients coefficients = {0.0, 0.0};
    if (regime == REGIME_COMPRESSION || regime == REGIME_RESTITUTION) {
        coefficients.k = law->stiffness;
    }
    if (regime == REGIME_COMPRESSION) {
        coefficients.c = law->damping;
    }
    return coefficients;
}

enum contact_regime contact_regime_of(const struct contact_law *law, double gap, double gap_rate, bool within)
{
    if (!(gap < 0.0) || !within) {
        return REGIME_APART;
    }
    if (law->damping > 0.0) {
        if (law->dashpot == DASHPOT_NON_ADHESIVE &&
            contact_force(law, REGIME_COMPRESSION, gap, gap_rate) <= 0.0) {
            return REGIME_SEPARATING;
        }
        if (law->dashpot == DASHPOT_APPROACH_ONLY && gap_rate >= 0.0) {
            return REGIME_RESTITUTION;
        }
    }
    return REGIME_COMPRESSION;
}

double contact_force(const struct contact_law *law, enum contact_regime regime, double gap, double gap_rate)
{
    const struct contact_coefficients linear = contact_coefficients_of(law, regime);
    return linear.k == 0.0 && linear.c == 0.0 ? 0.0 : contact_linear_force(linear, gap, gap_rate);
}

double contact_normal_force_of(const struct contact_law *law, enum contact_regime regime, double gap,
                               double gap_rate)
{
    const double force = contact_force(law, regime, gap, gap_rate);
    return law->dashpot == DASHPOT_UNCLAMPED ? force : fmax(force, 0.0);
}

struct contact_slopes contact_force_slopes(const struct contact_law *law, enum contact_regime regime,
                                           double gap, double gap_rate)
{
    (void)gap, (void)gap_rate; /* the linear law's are constant */
    const struct contact_coefficients linear = contact_coefficients_of(law, regime);
    return (struct contact_slopes){-linear.k, -linear.c};
}

double contact_force_term(const struct contact_law *law, const struct contact_law *change,
                          enum contact_regime regime, const double *gap, const double *gap_rate, int order)
{
    const struct contact_coefficients linear = contact_coefficients_of(law, regime);
    const double force = contact_linear_force(linear, gap[order], gap_rate[order]);
    if (!change || order == 0) {
        return force;
    }
    const struct contact_coefficients slope = contact_coefficients_of(change, regime);
    return force + contact_linear_force(slope, gap[order - 1], gap_rate[order - 1]);
}

bool contact_has_events(const struct contact_law *law)
{
    return law->damping > 0.0 && law->dashpot != DASHPOT_UNCLAMPED;
}

double contact_event(const struct contact_law *law, enum contact_regime regime, double gap, double gap_rate)
{
    if (regime == REGIME_APART || !contact_has_events(law)) {
        return 1.0;
    }
    if (law->dashpot == DASHPOT_APPROACH_ONLY) {
        return regime == REGIME_RESTITUTION ? gap_rate : -gap_rate;
    }
    const double force = contact_force(law, REGIME_COMPRESSION, gap, gap_rate);
    return regime == REGIME_SEPARATING ? -force : force;
}

double contact_event_force(const struct contact_law *law, double event)
{
    return law->dashpot == DASHPOT_APPROACH_ONLY ? law->damping * event : event;
}

struct contact_slopes contact_event_slopes(const struct contact_law *law, enum contact_regime regime,
                                           double gap, double gap_rate)
{
    if (regime == REGIME_APART || !contact_has_events(law)) {
        return (struct contact_slopes){0.0, 0.0};
    }
    if (law->dashpot == DASHPOT_APPROACH_ONLY) {
        return (struct contact_slopes){0.0, regime == REGIME_RESTITUTION ? 1.0 : -1.0};
    }
    const struct contact_slopes slopes = contact_force_slopes(law, REGIME_COMPRESSION, gap, gap_rate);
    return regime == REGIME_SEPARATING ? (struct contact_slopes){-slopes.by_gap, -slopes.by_rate} : slopes;
}

enum contact_regime contact_regime_after(const struct contact_law *law, enum contact_regime regime)
{
    if (regime != REGIME_COMPRESSION) {
        return REGIME_COMPRESSION;
    }
    return law->dashpot == DASHPOT_NON_ADHESIVE ? REGIME_SEPARATING : REGIME_RESTITUTION;
}

bool contact_is_elastic(const struct contact_law *law)
{
    return !(law->damping > 0.0);
}

double contact_stored_energy(const struct contact_law *law, enum contact_regime regime, double gap)
{
    return regime == REGIME_APART ? 0.0 : 0.5 * law->stiffness * gap * gap;
}

double contact_stored_slope(const struct contact_law *law, enum contact_regime regime, double gap)
{
    return regime == REGIME_APART ? 0.0 : law->stiffness * gap;
}

double contact_stored_bend(const struct contact_law *law, enum contact_regime regime, double gap)
{
    (void)gap; /* the linear law's is constant */
    return regime == REGIME_APART ? 0.0 : law->stiffness;
}

double contact_stored_term(const struct contact_law *law, const struct contact_law *change,
                           enum contact_regime regime, const double *gap, int order)
{
    if (regime == REGIME_APART) {
        return 0.0;
    }
    const double energy = 0.5 * law->stiffness * taylor_multiply(gap, gap, order);
    return change && order > 0 ? energy + 0.5 * change->stiffness * taylor_multiply(gap, gap, order - 1)
                               : energy;
}

double contact_dissipated_power(const struct contact_law *law, enum contact_regime regime,
                                double normal_force, double gap, double gap_rate)
{
    return regime == REGIME_APART ? 0.0 : -(normal_force + law->stiffness * gap) * gap_rate;
}

double contact_dissipated_term(const struct contact_law *law, enum contact_regime regime,
                               const double *normal_force, const double *gap, const double *gap_rate,
                               int order)
{
    return regime == REGIME_APART ? 0.0
                                  : -(taylor_multiply(normal_force, gap_rate, order) +
                                      law->stiffness * taylor_multiply(gap, gap_rate, order));
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

struct contact_law contact_law_of(const struct contact_factors *factors, enum dashpot dashpot,
                                  double diagonal)
{
    const double scale = factors->reference_modulus * diagonal;
    const bool viscous_only = factors->penalty_control == PENALTY_CONTROL_VISCOUS_ONLY;
    struct contact_law law = {.stiffness = factors->penalty_factor, .dashpot = dashpot};
    if (factors->penalty_control == PENALTY_CONTROL_AUTOMATIC) {
        law.stiffness = factors->multiplier * scale;
    }
    if (factors->viscous_control == VISCOUS_CONTROL_USER_DEFINED) {
        law.damping = factors->viscous_penalty_factor;
    } else if (factors->viscous_control == VISCOUS_CONTROL_RESTITUTION) {
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
    const struct contact_law none = contact_law_of(factors, DASHPOT_UNCLAMPED, 0.0);
    struct contact_law slope = contact_law_of(factors, DASHPOT_UNCLAMPED, diagonal_slope);
    slope.stiffness -= none.stiffness;
    slope.damping -= none.damping;
    if (factors->viscous_control == VISCOUS_CONTROL_RESTITUTION) {
        slope.damping = 0.5 * at.c * slope.stiffness / at.k;
    }
    return slope;
}

struct contact_law contact_law_with(struct contact_coefficients factors, enum method method,
                                    enum penalty_control penalty_control, enum dashpot dashpot)
{
    struct contact_law law = {.dashpot = dashpot};
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
