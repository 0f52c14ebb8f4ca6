#include "contact/law.h"

#include <math.h>
#include <stddef.h>

#include "contact/hertz_law.h"
#include "math/taylor.h"

struct contact_coefficients contact_coefficients_of(const struct contact_law *law, enum contact_regime regime)
{
    struct contact_coefficients coefficients = {0.0, 0.0};
    if (contact_is_hertz(law)) {
        return coefficients;
    }
    if (regime == REGIME_COMPRESSION || regime == REGIME_RESTITUTION) {
        coefficients.k = law->stiffness;
    }
    if (regime == REGIME_COMPRESSION) {
        coefficients.c = law->damping;
    }
    return coefficients;
}

struct contact_coefficients contact_factors_of(const struct contact_law *law)
{
    return (struct contact_coefficients){law->stiffness, law->damping};
}

/* Whether Hertz's law pushes in a regime, and with which factors. */
static bool hertz_pushes(enum contact_regime regime)
{
    return regime == REGIME_COMPRESSION || regime == REGIME_RESTITUTION;
}

static struct hertz_law hertz_law_of(const struct contact_law *law, enum contact_regime regime)
{
    return (struct hertz_law){law->stiffness, regime == REGIME_COMPRESSION ? law->damping : 0.0};
}

/* Whether the non-adhesive law would pull. */
static bool pulls(const struct contact_law *law, double gap, double gap_rate)
{
    return contact_is_hertz(law) ? contact_event(law, REGIME_COMPRESSION, gap, gap_rate) <= 0.0
                                 : contact_force(law, REGIME_COMPRESSION, gap, gap_rate) <= 0.0;
}

enum contact_regime contact_regime_of(const struct contact_law *law, double gap, double gap_rate, bool within)
{
    if (!(gap < 0.0) || !within) {
        return REGIME_APART;
    }
    if (law->damping > 0.0) {
        if (law->dashpot == DASHPOT_NON_ADHESIVE && pulls(law, gap, gap_rate)) {
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
    if (contact_is_hertz(law)) {
        return hertz_pushes(regime) ? hertz_force(hertz_law_of(law, regime), gap, gap_rate) : 0.0;
    }
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
    if (contact_is_hertz(law)) {
        const struct hertz_law hertz = hertz_law_of(law, regime);
        return hertz_pushes(regime) ? (struct contact_slopes){hertz_force_by_gap(hertz, gap, gap_rate),
                                                              hertz_force_by_rate(hertz, gap)}
                                    : (struct contact_slopes){0.0, 0.0};
    }
    const struct contact_coefficients linear = contact_coefficients_of(law, regime);
    return (struct contact_slopes){-linear.k, -linear.c};
}

/* k_h grows with the path, and with it the whole force; chi the damping's part. */
static double hertz_term(const struct contact_law *law, const struct contact_law *change,
                         enum contact_regime regime, const double *gap, const double *gap_rate, int order)
{
    if (!hertz_pushes(regime)) {
        return 0.0;
    }
    const struct hertz_law hertz = hertz_law_of(law, regime);
    const double force = hertz_force_term(hertz, gap, gap_rate, order);
    if (!change || order == 0) {
        return force;
    }
    const struct hertz_law stiffer = {change->stiffness, hertz.damping};
    const struct hertz_law damped = {law->stiffness, hertz_law_of(change, regime).damping};
    return force + hertz_force_term(stiffer, gap, gap_rate, order - 1) +
           (hertz_force_term(damped, gap, gap_rate, order - 1) -
            hertz_spring_term(law->stiffness, gap, order - 1));
}

double contact_force_term(const struct contact_law *law, const struct contact_law *change,
                          enum contact_regime regime, const double *gap, const double *gap_rate, int order)
{
    if (contact_is_hertz(law)) {
        return hertz_term(law, change, regime, gap, gap_rate, order);
    }
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
    const double push = contact_push(law, gap, gap_rate);
    return regime == REGIME_SEPARATING ? -push : push;
}

double contact_separating_event_term(const struct contact_law *law, const double *gap, const double *gap_rate,
                                     int order)
{
    if (contact_is_hertz(law)) {
        return law->damping * gap_rate[order] - (order == 0 ? 1.0 : 0.0);
    }
    return -contact_force_term(law, NULL, REGIME_COMPRESSION, gap, gap_rate, order);
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
    const struct contact_slopes slopes = contact_is_hertz(law)
                                             ? (struct contact_slopes){0.0, -law->damping}
                                             : contact_force_slopes(law, REGIME_COMPRESSION, gap, gap_rate);
    return regime == REGIME_SEPARATING ? (struct contact_slopes){-slopes.by_gap, -slopes.by_rate} : slopes;
}

enum contact_regime contact_regime_after(const struct contact_law *law, enum contact_regime regime)
{
    if (regime != REGIME_COMPRESSION) {
        return REGIME_COMPRESSION;
    }
    return law->dashpot == DASHPOT_NON_ADHESIVE ? REGIME_SEPARATING : REGIME_RESTITUTION;
}

double contact_push(const struct contact_law *law, double gap, double gap_rate)
{
    return contact_is_hertz(law) ? 1.0 - law->damping * gap_rate
                                 : contact_force(law, REGIME_COMPRESSION, gap, gap_rate);
}

bool contact_may_pull(const struct contact_law *law)
{
    return law->dashpot == DASHPOT_UNCLAMPED && !contact_is_elastic(law);
}

bool contact_is_elastic(const struct contact_law *law)
{
    return !(law->damping > 0.0);
}

double contact_stored_energy(const struct contact_law *law, enum contact_regime regime, double gap)
{
    if (contact_is_hertz(law)) {
        return regime == REGIME_APART ? 0.0 : hertz_energy(law->stiffness, gap);
    }
    return regime == REGIME_APART ? 0.0 : 0.5 * law->stiffness * gap * gap;
}

double contact_stored_slope(const struct contact_law *law, enum contact_regime regime, double gap)
{
    if (contact_is_hertz(law)) {
        return regime == REGIME_APART ? 0.0 : hertz_energy_slope(law->stiffness, gap);
    }
    return regime == REGIME_APART ? 0.0 : law->stiffness * gap;
}

double contact_stored_bend(const struct contact_law *law, enum contact_regime regime, double gap)
{
    if (contact_is_hertz(law)) {
        return regime == REGIME_APART ? 0.0 : hertz_energy_bend(law->stiffness, gap);
    }
    return regime == REGIME_APART ? 0.0 : law->stiffness;
}

double contact_stored_term(const struct contact_law *law, const struct contact_law *change,
                           enum contact_regime regime, const double *gap, int order)
{
    if (regime == REGIME_APART) {
        return 0.0;
    }
    if (contact_is_hertz(law)) {
        const double energy = hertz_energy_term(law->stiffness, gap, order);
        return change && order > 0 ? energy + hertz_energy_term(change->stiffness, gap, order - 1) : energy;
    }
    const double energy = 0.5 * law->stiffness * taylor_multiply(gap, gap, order);
    return change && order > 0 ? energy + 0.5 * change->stiffness * taylor_multiply(gap, gap, order - 1)
                               : energy;
}

double contact_dissipated_power(const struct contact_law *law, enum contact_regime regime,
                                double normal_force, double gap, double gap_rate)
{
    if (contact_is_hertz(law)) {
        return regime == REGIME_APART ? 0.0
                                      : -(normal_force + hertz_energy_slope(law->stiffness, gap)) * gap_rate;
    }
    return regime == REGIME_APART ? 0.0 : -(normal_force + law->stiffness * gap) * gap_rate;
}

/* -(F_n - spring's part) g' */
static double hertz_dissipated_term(const struct contact_law *law, const double *normal_force,
                                    const double *gap, const double *gap_rate, int order)
{
    double viscous[TAYLOR_TERMS];
    for (int i = 0; i <= order; ++i) {
        viscous[i] = normal_force[i] - hertz_spring_term(law->stiffness, gap, i);
    }
    return -taylor_multiply(viscous, gap_rate, order);
}

double contact_dissipated_term(const struct contact_law *law, enum contact_regime regime,
                               const double *normal_force, const double *gap, const double *gap_rate,
                               int order)
{
    if (contact_is_hertz(law)) {
        return regime == REGIME_APART ? 0.0 : hertz_dissipated_term(law, normal_force, gap, gap_rate, order);
    }
    return regime == REGIME_APART ? 0.0
                                  : -(taylor_multiply(normal_force, gap_rate, order) +
                                      law->stiffness * taylor_multiply(gap, gap_rate, order));
}
