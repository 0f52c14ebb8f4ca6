#include "contact/law.h"

#include <math.h>

enum contact_regime contact_regime_of(const struct contact_law *law, double gap, double gap_rate, bool within)
{
    if (!(gap < 0.0) || !within) {
        return REGIME_APART;
    }
    if (law->damping > 0.0) {
        if (law->dashpot == DASHPOT_NON_ADHESIVE && law->stiffness * gap + law->damping * gap_rate >= 0.0) {
            return REGIME_SEPARATING;
        }
        if (law->dashpot == DASHPOT_APPROACH_ONLY && gap_rate >= 0.0) {
            return REGIME_RESTITUTION;
        }
    }
    return REGIME_COMPRESSION;
}

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

double contact_normal_force_of(const struct contact_law *law, enum contact_regime regime, double gap,
                               double gap_rate)
{
    if (regime == REGIME_APART || regime == REGIME_SEPARATING) {
        return 0.0;
    }
    const struct contact_coefficients coefficients = contact_coefficients_of(law, regime);
    const double force = -(coefficients.k * gap + coefficients.c * gap_rate);
    return law->dashpot == DASHPOT_UNCLAMPED ? force : fmax(force, 0.0);
}

double contact_regime_margin(const struct contact_law *law, enum contact_regime regime, double gap,
                             double gap_rate)
{
    if (law->damping > 0.0) {
        if (regime == REGIME_COMPRESSION && law->dashpot == DASHPOT_NON_ADHESIVE) {
            return -(law->stiffness * gap + law->damping * gap_rate);
        }
        if (regime == REGIME_COMPRESSION && law->dashpot == DASHPOT_APPROACH_ONLY) {
            return -gap_rate;
        }
        if (regime == REGIME_RESTITUTION) {
            return gap_rate;
        }
    }
    return 1.0;
}

enum contact_regime contact_regime_after(const struct contact_law *law, enum contact_regime regime)
{
    if (regime != REGIME_COMPRESSION) {
        return REGIME_COMPRESSION;
    }
    return law->dashpot == DASHPOT_NON_ADHESIVE ? REGIME_SEPARATING : REGIME_RESTITUTION;
}

double contact_stored_energy(const struct contact_law *law, enum contact_regime regime, double gap)
{
    return regime == REGIME_APART ? 0.0 : 0.5 * law->stiffness * gap * gap;
}

double contact_dissipated_power(const struct contact_law *law, enum contact_regime regime,
                                double normal_force, double gap, double gap_rate)
{
    return regime == REGIME_APART ? 0.0 : -(normal_force + law->stiffness * gap) * gap_rate;
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
