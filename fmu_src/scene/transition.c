#include "scene/transition.h"

#include <float.h>

#include "scene/energy.h"
#include "scene/onset.h"
#include "scene/projection.h"
#include "scene/rounding.h"
#include "scene/turning_transition.h"
#include "scene/zones.h"

static void note_regime(struct scene_state *q, int contact, enum contact_regime regime)
{
    struct contact_state *state = &q->contact[contact];
    const bool touched = state->regime != REGIME_APART;
    const bool touches = regime != REGIME_APART;
    if (touches && !touched) {
        counter_add(&state->record.onsets, 1);
        state->record.onset_time = scene_time(q);
        state->record.touch_clock = q->clock;
        state->record.force_error = 0.0;
    } else if (touched && !touches) {
        state->record.last_duration = q->clock - state->record.touch_clock;
    }
    state->regime = (int32_t)regime;
}

static void set_regime(const struct scene_values *v, struct scene_state *q, int contact,
                       enum contact_regime regime)
{
#if SCENE_ANY_FRICTION
    const enum contact_regime before = (enum contact_regime)q->contact[contact].regime;
    note_regime(q, contact, regime);
    turning_take_regime(v, q, contact, before);
#else
    (void)v;
    note_regime(q, contact, regime);
#endif
}

/* Rounding of the gap after contact, besides its rounding bound: that of the distance covered into and out of
 * the contact [m]. */
static double way_rounding(const struct scene_state *q, const struct scene_instant *at, int contact,
                           double lasted)
{
    const double way = vec3_norm(at->rate[contact]) * lasted + q->contact[contact].peaks.penetration;
    return 32.0 * DBL_EPSILON * way;
}

/* The gap at a change of regime: where contact ends by the gap it is zero or more; where a touch was found by
 * an integrator, not foreseen, it is zero. */
static double gap_at_change(const struct scene_values *v, const struct scene_state *q,
                            const struct scene_instant *at, int contact, enum contact_regime regime,
                            double lasted)
{
    const double gap = at->geometry[contact].gap;
    const bool touches = q->contact[contact].regime == (int32_t)REGIME_APART;
    const double least = regime == REGIME_APART ? fmax(gap, 0.0) : gap;
    const double meant = touches && !scene_gap_is_accumulated(q, at, contact) ? 0.0 : least;
    if (meant == gap) {
        return meant;
    }
    const double rounding = regime == REGIME_APART ? way_rounding(q, at, contact, lasted) : 0.0;
    return fabs(gap) > fmax(rounding_of_gap(v, at, contact), rounding) ? gap : meant;
}

/* After a deep impact, which is long against the bodies' sizes, the gap is rounded more than positions are
 * here, so that the bodies might touch again at once. They are moved to a gap of zero. A larger gap is a
 * cylinder's end and stays. */
static void close_rounded_gap(const struct scene_values *v, struct scene_state *q, struct scene_instant *at,
                              int contact, double lasted)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const double gap = fabs(at->geometry[contact].distance - contact_reach(&shape));
    if (!(scene_inverse_mass(v, contact) > 0.0) || gap > way_rounding(q, at, contact, lasted) ||
        gap <= 0.25 * rounding_of_gap(v, at, contact)) {
        return;
    }
    q->contact[contact].physics.accumulated_gap = DBL_MAX; /* not known: as positions give it */
    projection_close_gap(v, q, contact);
    scene_rebase(v, q);
    scene_kinematics_now(v, q, at);
}

/* Start of a phase: forget foreseen changes, note the energy balance. */
static void begin_phase(const struct scene_values *v, struct scene_state *q, const struct scene_instant *at)
{
    q->horizon_clock = -(double)INFINITY;
    q->phase_energy = scene_uses_ode(v) ? projection_balance(v, q, at) : 0.0;
}

/* Takes the instant into account for the peaks of the communication step. */
static void note_peaks_of(struct scene_state *q, const struct scene_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct contact_state *state = &q->contact[j];
        if (state->regime != REGIME_APART) {
            contact_peaks_note(&state->peaks, at->normal_force[j], -at->geometry[j].gap);
        }
    }
}

static inline void note_peaks_of_touching(const struct scene_values *v, struct scene_state *q,
                                          struct scene_instant *at)
{
    if (!scene_is_apart(q)) {
        scene_forces(v, q, q->clock, at);
        note_peaks_of(q, at);
    }
}

/* Into the next zone of a capped cylinder, with the gap as it is known. */
static void pass_zone(const struct scene_values *v, struct scene_state *q, struct scene_instant *at,
                      int contact)
{
    zones_pass(v, q, at, contact);
    if (SCENE_ANY_CAPS) {
        scene_kinematics_now(v, q, at);
    }
}

void transition_change_regime(const struct scene_values *v, struct scene_state *q, int contact,
                              enum contact_regime regime, struct scene_instant *at)
{
    const double lasted = q->clock;
    scene_rebase(v, q);
    scene_kinematics_now(v, q, at);
    note_peaks_of_touching(v, q, at);
    if (regime == REGIME_APART && q->contact[contact].regime != (int32_t)REGIME_APART) {
        close_rounded_gap(v, q, at, contact, lasted);
    }
    const double before = energy_stored(v, q, at);
    at->geometry[contact].gap = gap_at_change(v, q, at, contact, regime, lasted);
    q->contact[contact].physics.accumulated_gap = at->geometry[contact].gap;
    if (regime == (enum contact_regime)q->contact[contact].regime) {
        pass_zone(v, q, at, contact);
    }
    regime = onset_note(v, q, at, contact, regime);
    set_regime(v, q, contact, regime);
    zones_follow(q, at, contact);
    q->dissipated += before - energy_stored(v, q, at);
    counter_add(&q->counters.events, 1);
    begin_phase(v, q, at);
    note_peaks_of_touching(v, q, at);
}

#if SCENE_ANY_FRICTION
void transition_change_friction(const struct scene_values *v, struct scene_state *q, int contact,
                                enum ode_event event, struct scene_instant *at)
{
    scene_rebase(v, q);
    turning_take_event(v, q, contact, event);
    counter_add(&q->counters.events, 1);
    scene_kinematics_now(v, q, at);
    begin_phase(v, q, at);
    note_peaks_of_touching(v, q, at);
}
#endif

void transition_switch_regime(const struct scene_values *v, struct scene_state *q, int contact,
                              enum contact_regime regime)
{
    struct scene_instant at;
    scene_rebase(v, q);
    scene_kinematics_now(v, q, &at);
    const double before = energy_stored(v, q, &at);
    if (SCENE_ANY_CAPS) {
        zones_settle(v, q, &at, contact);
        scene_kinematics_now(v, q, &at);
    }
    regime = onset_note(v, q, &at, contact, regime);
    set_regime(v, q, contact, regime);
    zones_follow(q, &at, contact);
    q->dissipated += before - energy_stored(v, q, &at);
    counter_add(&q->counters.events, 1);
}

#if SCENE_ANY_FRICTION
void transition_switch_friction(const struct scene_values *v, struct scene_state *q, int contact,
                                enum ode_event event)
{
    scene_rebase(v, q);
    turning_take_event(v, q, contact, event);
    counter_add(&q->counters.events, 1);
}
#endif

void transition_settle_regimes(const struct scene_values *v, struct scene_state *q, double stored_before,
                               bool starting)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    for (int j = 0; SCENE_ANY_CAPS && j < SCENE_CONTACTS; ++j) {
        zones_settle(v, q, &at, j);
        scene_now(v, q, &at);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (starting || fabs(at.geometry[j].gap) > rounding_of_gap(v, &at, j)) {
            set_regime(v, q, j, onset_note(v, q, &at, j, scene_regime(v, q, &at, j)));
            zones_follow(q, &at, j);
        }
    }
    if (!starting) {
        q->external_work += energy_stored(v, q, &at) - stored_before;
    }
    scene_rebase(v, q);
    begin_phase(v, q, &at);
}

void transition_take_law(const struct scene_values *v, struct scene_state *q, const bool *changed,
                         double stored_before)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (changed[j] && q->contact[j].regime != REGIME_APART) {
            set_regime(v, q, j, scene_regime_of_touching(v, q, &at, j));
        }
    }
    q->external_work += energy_stored(v, q, &at) - stored_before;
    begin_phase(v, q, &at);
}

void transition_scale_force_error(struct scene_state *q, int contact, struct contact_coefficients next)
{
    const struct contact_coefficients *now = &q->contact[contact].parameters.factors;
    const double by_gap = now->k > 0.0 ? next.k / now->k : 1.0;
    const double by_rate = now->c > 0.0 ? next.c / now->c : 1.0;
    double *error = &q->contact[contact].record.force_error;
    *error = fmin(*error * fmax(1.0, fmax(by_gap, by_rate)), DBL_MAX);
}

/* Peaks, and the normals for where there are none. */
static void note_instant(struct scene_state *q, const struct scene_instant *at)
{
    note_peaks_of(q, at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].normal = at->geometry[j].normal;
    }
}

void transition_begin_step(const struct scene_values *v, struct scene_state *q, struct scene_instant *at)
{
    scene_now(v, q, at);
    q->step_length = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].record.impulse_mark = q->contact[j].physics.impulse;
        q->contact[j].record.force_bound = 0.0;
#if SCENE_ANY_TURNING
        q->contact[j].torques.source_mark = q->contact[j].torques.source_impulse;
        q->contact[j].torques.destination_mark = q->contact[j].torques.destination_impulse;
#endif
        q->contact[j].peaks = (struct contact_peaks){0.0, 0.0};
    }
    note_instant(q, at);
}

void transition_end_step(const struct scene_values *v, struct scene_state *q)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    note_instant(q, &at);
}
