#include "dynamics/events.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "dynamics/energy.h"
#include "dynamics/projection.h"
#include "dynamics/resolution.h"

static void set_regime(struct motion *q, int contact, enum contact_regime regime)
{
    struct contact_state *state = &q->contact[contact];
    const bool touched = state->regime != REGIME_APART;
    const bool touches = regime != REGIME_APART;
    if (touches && !touched) {
        counter_add(&state->onsets, 1);
        state->onset_time = motion_time(q);
        state->touch_clock = q->clock;
    } else if (touched && !touches) {
        state->last_duration = q->clock - state->touch_clock;
    }
    state->regime = (int32_t)regime;
}

/* What the gap lacks after a contact, besides its resolution: the rounding of the way that the bodies have gone, far in and out. */
static double way_rounding(const struct motion *q, const struct system_instant *at, int contact,
                           double lasted)
{
    const double way = vec3_norm(at->rate[contact]) * lasted + q->contact[contact].peak_penetration;
    return 32.0 * DBL_EPSILON * way;
}

/* Bodies that part by the gap do so at zero or more; those that touch where no touch was foreseen, by an integrator's root, do so
 * at zero. */
static double gap_at_change(const struct scene_values *v, const struct motion *q,
                            const struct system_instant *at, int contact, enum contact_regime regime,
                            double lasted)
{
    const double gap = at->geometry[contact].gap;
    const double rounding = regime == REGIME_APART ? way_rounding(q, at, contact, lasted) : 0.0;
    if (fabs(gap) > fmax(resolution_of_gap(v, at, contact), rounding)) {
        return gap;
    }
    if (q->contact[contact].regime == (int32_t)REGIME_APART && !system_gap_is_known(q, at, contact)) {
        return 0.0;
    }
    return regime == REGIME_APART ? fmax(gap, 0.0) : gap;
}

/* Bodies that part after a way long against their sizes, out of a deep impact, do so with a gap rounded as that way is: by more than
 * their positions here, so that they would touch again at once. They are put where the gap is zero. A larger gap is a cylinder's end. */
static void close_rounded_gap(const struct scene_values *v, struct motion *q, struct system_instant *at,
                              int contact, double lasted)
{
    const struct contact_shape shape = system_shape(v, q, contact);
    const double gap = fabs(at->geometry[contact].distance - contact_reach(&shape));
    if (!(system_inverse_mass(v, contact) > 0.0) || gap > way_rounding(q, at, contact, lasted) ||
        gap <= 0.25 * resolution_of_gap(v, at, contact)) {
        return;
    }
    q->contact[contact].carried_gap = DBL_MAX; /* not known: by positions */
    projection_close_gap(v, q, contact);
    motion_rebase(v, q);
    system_place(v, q, at);
}

/* A smooth piece of the motion starts here: nothing is known ahead, the balance is taken. */
static void begin_phase(const struct scene_values *v, struct motion *q, const struct system_instant *at)
{
    q->horizon_clock = -(double)INFINITY;
    q->phase_energy = projection_balance(v, q, at);
}

static void note_peaks_of_touching(const struct scene_values *v, struct motion *q, struct system_instant *at)
{
    if (!system_is_apart(q)) {
        system_forces(v, q, q->clock, at);
        event_note_peaks(q, at);
    }
}

void event_change_regime(const struct scene_values *v, struct motion *q, int contact,
                         enum contact_regime regime, struct system_instant *at)
{
    const double lasted = q->clock;
    motion_rebase(v, q);
    system_place(v, q, at);
    note_peaks_of_touching(v, q, at);
    if (regime == REGIME_APART && q->contact[contact].regime != (int32_t)REGIME_APART) {
        close_rounded_gap(v, q, at, contact, lasted);
    }
    const double before = energy_stored(v, q, at);
    at->geometry[contact].gap = gap_at_change(v, q, at, contact, regime, lasted);
    q->contact[contact].carried_gap = at->geometry[contact].gap;
    set_regime(q, contact, regime);
    q->dissipated += before - energy_stored(v, q, at);
    counter_add(&q->counters.events, 1);
    begin_phase(v, q, at);
    note_peaks_of_touching(v, q, at);
}

void event_settle_regimes(const struct scene_values *v, struct motion *q, double stored_before, bool starting)
{
    struct system_instant at;
    system_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (starting || fabs(at.geometry[j].gap) > resolution_of_gap(v, &at, j)) {
            set_regime(q, j, system_regime(v, q, &at, j));
        }
    }
    if (!starting) {
        q->external_work += energy_stored(v, q, &at) - stored_before;
    }
    motion_rebase(v, q);
    begin_phase(v, q, &at);
}

/* Peaks, and the normals for where there are none. */
static void note_instant(struct motion *q, const struct system_instant *at)
{
    event_note_peaks(q, at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].normal = at->geometry[j].normal;
    }
}

void event_begin_window(const struct scene_values *v, struct motion *q, struct system_instant *at)
{
    system_now(v, q, at);
    q->window = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].impulse_mark = q->contact[j].impulse;
        q->contact[j].peak_force = 0.0;
        q->contact[j].peak_penetration = 0.0;
    }
    note_instant(q, at);
}

void event_end_window(const struct scene_values *v, struct motion *q)
{
    struct system_instant at;
    system_now(v, q, &at);
    note_instant(q, &at);
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
