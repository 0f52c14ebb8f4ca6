#include "model/exchange.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "model/motion.h"

bool model_is_exchange(const struct model *m)
{
    return m->state.exchange != EXCHANGE_NONE;
}

size_t model_exchange_states(void)
{
    return SCENE_STATES;
}

size_t model_exchange_indicators(void)
{
    return SCENE_INDICATORS;
}

void model_exchange_set_continuous(struct model *m, bool continuous)
{
    if (!model_apply_inputs(m)) { /* set in the mode that ends; if they are too large, reading says so */
        m->outputs = OUTPUTS_NONE;
    }
    m->state.exchange = continuous ? EXCHANGE_CONTINUOUS : EXCHANGE_EVENTS;
}

enum model_status model_exchange_set_time(struct model *m, double time)
{
    struct scene_state *q = &m->state.motion;
    const double event = q->base + q->base_tail;
    /* Times that should agree may differ by a few roundings. */
    if (!(time >= event - 4.0 * DBL_EPSILON * fabs(event) && time <= DBL_MAX)) {
        return model_report(
            m, MODEL_ERROR,
            "The time %.17g s is refused (allowed: finite, from the last event at %.17g s on).", time, event);
    }
    q->clock = fmax((time - q->base) - q->base_tail, 0.0);
    model_forget_outputs(m);
    return MODEL_OK;
}

void model_exchange_set_state(struct model *m, const struct variable *state, double value)
{
    motion_set_state(&m->state.motion, state, value);
    m->state.booked = motion_booked(&m->state.motion);
    model_forget_outputs(m);
}

enum model_status model_exchange_set_states(struct model *m, const double *states)
{
    for (int i = 0; i < SCENE_STATES; ++i) {
        const enum model_status status = model_check(m, &scene_variables[scene_states[i]], &states[i]);
        if (status != MODEL_OK) {
            return status;
        }
    }
    for (int i = 0; i < SCENE_STATES; ++i) {
        model_exchange_set_state(m, &scene_variables[scene_states[i]], states[i]);
    }
    return MODEL_OK;
}

/* Brings inputs, or before the end of initialization the start, up to date. */
static enum model_status follow(struct model *m)
{
    if (!m->state.initialized) {
        model_prepare(m);
        return MODEL_OK;
    }
    return model_apply_inputs(m) ? MODEL_OK : model_refuse_inputs(m);
}

enum model_status model_exchange_get(struct model *m, enum exchange_values which, double *values)
{
    if (which == EXCHANGE_NOMINALS) {
        memcpy(values, scene_state_nominals, SCENE_STATES * sizeof *values);
        return MODEL_OK;
    }
    enum model_status status = follow(m);
    const uint16_t *places = which == EXCHANGE_STATES  ? scene_states
                             : which == EXCHANGE_RATES ? scene_rates
                                                       : scene_indicators;
    const int count = which == EXCHANGE_INDICATORS ? SCENE_INDICATORS : SCENE_STATES;
    struct scene_instant at;
    scene_now(&m->state.values, &m->state.motion, &at);
    for (int i = 0; i < count && status == MODEL_OK; ++i) {
        const struct variable *variable = &scene_variables[places[i]];
        values[i] = motion_local(&m->state.values, &m->state.motion, &at, variable);
        status =
            isfinite(values[i])
                ? MODEL_OK
                : model_report(m, MODEL_DISCARD,
                               "%s is beyond the range of numbers (allowed: states and inputs with finite "
                               "forces and energies).",
                               variable->name);
    }
    if (which == EXCHANGE_STATES) {
        m->state.booked = motion_booked(&m->state.motion);
    }
    return status;
}

/* Energies and springs of friction are what events make jump. */
enum model_status model_exchange_update(struct model *m, bool *changed, bool *jumped)
{
    struct scene_state *q = &m->state.motion;
    const enum model_status status = follow(m);
    *changed = false;
    if (status == MODEL_OK) {
        *changed = motion_change_regimes(&m->state.values, q);
    }
    *jumped = motion_booked(q) != m->state.booked;
    if (*changed) {
        model_report(m, MODEL_OK, "Changes of contact at %.17g s; since initialization: %d.", scene_time(q),
                     (int)q->counters.events);
    }
    model_forget_outputs(m);
    return status;
}

/* Part of the time, or of a second where that is more, below which a touch is not announced: importers take
 * times that differ by 1e-9 of them for the same, and cannot step to one. */
static const double SOONEST_TOUCH = 1e-6;

double model_exchange_next_touch(const struct model *m)
{
    const double now = scene_time(&m->state.motion);
    const double after = motion_touch_after(&m->state.values, &m->state.motion);
    const double time = now + after;
    return after > SOONEST_TOUCH * fmax(1.0, fabs(now)) && time <= DBL_MAX ? time : (double)INFINITY;
}

enum model_status model_exchange_accept(struct model *m)
{
    const enum model_status status = follow(m);
    struct scene_instant at;
    scene_now(&m->state.values, &m->state.motion, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        m->state.motion.contact[j].normal = at.geometry[j].normal;
    }
    return status;
}
