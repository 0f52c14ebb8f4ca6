#include "dynamics/events.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "dynamics/energy.h"

static void set_regime(struct motion *q, int contact, enum contact_regime regime)
{
    struct contact_state *state = &q->contact[contact];
    const bool touched = state->regime != REGIME_APART;
    const bool touches = regime != REGIME_APART;
    if (touches && !touched) {
        state->onsets += 1;
        state->onset_time = motion_time(q);
        state->touch_clock = q->clock;
    } else if (touched && !touches) {
        state->last_duration = q->clock - state->touch_clock;
    }
    state->regime = regime;
}

void event_change_regime(const struct scene_values *v, struct motion *q, int contact, enum contact_regime regime)
{
    struct system_instant at;
    system_now(v, q, &at);
    event_note_peaks(q, &at);
    const double before = energy_stored(v, q, &at);
    set_regime(q, contact, regime);
    q->dissipated += before - energy_stored(v, q, &at);
    q->counters.events += 1;
    q->horizon_clock = -INFINITY;
    motion_rebase(q);
    system_now(v, q, &at);
    event_note_peaks(q, &at);
}

/* Eight roundings of the terms behind the gap. */
static bool gap_is_rounding(const struct scene_values *v, const struct contact_geometry *geometry, int contact)
{
    const double size = geometry->distance + body_radius(v, contact_source(contact)) +
                        body_radius(v, contact_destination(contact));
    return fabs(geometry->gap) <= 8.0 * DBL_EPSILON * size;
}

void event_settle_regimes(const struct scene_values *v, struct motion *q, double stored_before, bool starting)
{
    struct system_instant at;
    system_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (starting || !gap_is_rounding(v, &at.geometry[j], j)) {
            set_regime(q, j, system_regime(v, q, &at, j));
        }
    }
    if (!starting) {
        q->external_work += energy_stored(v, q, &at) - stored_before;
    }
    q->horizon_clock = -INFINITY;
    motion_rebase(q);
}

void event_begin_window(const struct scene_values *v, struct motion *q)
{
    struct system_instant at;
    system_now(v, q, &at);
    q->window = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].impulse_mark = q->contact[j].impulse;
        q->contact[j].peak_force = 0.0;
        q->contact[j].peak_penetration = 0.0;
    }
    event_note_peaks(q, &at);
}

void event_note_peaks(struct motion *q, const struct system_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct contact_state *state = &q->contact[j];
        if (state->regime != REGIME_APART) {
            state->peak_force = fmax(state->peak_force, at->normal_force[j]);
            state->peak_penetration = fmax(state->peak_penetration, -at->geometry[j].gap);
        }
    }
}

#endif
