#include "scene/onset.h"

#include <float.h>

#if SCENE_ANY_HERTZ

/* The square of the speed at the touch by motion and stored energy alone [m^2/s^2]. */
static double own_speed_squared(const struct scene_values *v, const struct scene_state *q,
                                const struct scene_instant *at, int contact)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_law law = scene_contact_law(v, q, contact);
    const double stored = contact_stored_energy(&law, REGIME_COMPRESSION, g->gap);
    return g->gap_rate * g->gap_rate + 2.0 * stored * scene_inverse_mass(v, contact);
}

/*
 * The speed of the onset [m/s]. A load m a presses m x'' = m a - k x^(3/2) from rest to its largest speed
 * where both balance, x_0 = (m a/k)^(2/3), v^2/2 = a x_0 - (2/5) (k/m) x_0^(5/2) = (3/5) a x_0.
 */
static double onset_speed(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, int contact)
{
    const double per_mass = scene_inverse_mass(v, contact);
    const double speed_squared = own_speed_squared(v, q, at, contact);
    if (!(per_mass > 0.0)) {
        return sqrt(speed_squared);
    }
    const struct contact_law law = scene_contact_law(v, q, contact);
    struct scene_instant apart = *at;
    scene_forces(v, q, q->clock, &apart); /* the contact has no force yet */
    const double a = scene_pressing_acceleration(v, q, &apart, contact);
    const double depth = cbrt(pow(a / (contact_factors_of(&law).k * per_mass), 2.0));
    return sqrt(fmax(speed_squared, 1.2 * a * depth));
}

enum contact_regime onset_take_damping(const struct scene_values *v, struct scene_state *q,
                                       const struct scene_instant *at, int contact, enum contact_regime next)
{
    struct contact_state *state = &q->contact[contact];
    if (next == REGIME_APART || state->regime != (int32_t)REGIME_APART) {
        return next;
    }
    const double damping = state->parameters.factors.c / onset_speed(v, q, at, contact);
    state->onset_damping = isfinite(damping) ? damping : 0.0;
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const enum contact_regime deep = scene_regime(v, q, at, contact);
    return deep != REGIME_APART ? deep : contact_regime_of(&law, -DBL_MIN, g->gap_rate, true);
}

/* With 2 v dv = d(v^2), and chi v given. */
double onset_damping_slope(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at, int contact, double gap_slope, double rate_slope)
{
    const struct contact_state *state = &q->contact[contact];
    if (!scene_damps_by_onset(v, contact) || state->regime == (int32_t)REGIME_APART ||
        !(state->onset_damping > 0.0)) {
        return 0.0;
    }
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_law law = scene_contact_law(v, q, contact);
    const double speed = state->parameters.factors.c / state->onset_damping;
    const double by_load = 1e-9; /* own speed smaller by more than this part: the load's counts */
    if (own_speed_squared(v, q, at, contact) < (1.0 - by_load) * speed * speed) {
        return 0.0;
    }
    const double stored_slope = contact_stored_slope(&law, REGIME_COMPRESSION, g->gap);
    const double half = g->gap_rate * rate_slope + stored_slope * scene_inverse_mass(v, contact) * gap_slope;
    return -state->onset_damping * half / (speed * speed);
}

#endif
