/* This file serves Model Exchange: it has states, rates and event indicators for an integrator of the
 * importer; see model.h. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "integrator/prediction.h"
#include "math/checksum.h"
#include "model/state.h"
#include "scene/evaluate.h"
#include "scene/transition.h"

/* Returns the opposed motion (contact/friction.h) whose spring or event indicator has the row. */
static int part_of(int row)
{
    const bool rolls = row == ROW_contact_rolling_spring_state || row == ROW_contact_rolling_stick_indicator;
    const bool spins =
        row == ROW_contact_spinning_spring_state || row == ROW_contact_spinning_stick_indicator;
    return rolls ? OPPOSED_ROLLING : spins ? OPPOSED_SPINNING : OPPOSED_SLIP;
}

/* Whether a state or its rate is in use. Any other state stays constant: that of a body that is not free or
 * does not turn freely, and a spring that a contact does not have. */
static bool is_in_use(const struct scene_values *v, const struct variable *variable)
{
    switch (variable->row) {
    case ROW_body_displacement_state:
    case ROW_body_velocity_state:
        return body_is_free(v, variable->element);
    case ROW_body_orientation_state:
    case ROW_body_angular_velocity_state:
        return body_turns_freely(v, variable->element);
    case ROW_contact_spring_state:
    case ROW_contact_rolling_spring_state:
    case ROW_contact_spinning_spring_state:
        return contact_has_spring(v, variable->element, part_of(variable->row));
    default: /* of an energy */
        return true;
    }
}

/* Returns the place of a state in the scene, or that of its change in a path; NULL: no path. The scene holds
 * a displacement relative to its body's origin. */
static double *state_at(struct scene_state *q, struct scene_jet *along, const struct variable *state)
{
    const int i = state->element;
    const int k = state->component;
    const int part = part_of(state->row);
    switch (state->row) {
    case ROW_body_orientation_state:
        return quaternion_part(along ? &along->given_orientation[i] : &q->turning.body[i].orientation, k);
    case ROW_body_angular_velocity_state:
        return vec3_part(along ? &along->angular_velocity[i][1] : &q->turning.body[i].angular_velocity, k);
    case ROW_body_displacement_state:
        return vec3_part(along ? &along->displacement[i][1] : &q->body[i].moved, k);
    case ROW_body_velocity_state:
        return vec3_part(along ? &along->velocity[i][1] : &q->body[i].velocity, k);
    case ROW_energy_dissipated_state:
        return along ? &along->dissipated[1] : &q->dissipated;
    case ROW_energy_external_work_state:
        return along ? &along->external_work[1] : &q->external_work;
    case ROW_energy_friction_state:
        return along ? &along->friction[1] : &q->friction_energy;
    default: /* of a spring */
        return vec3_part(along ? &along->spring[i][part][1] : &q->turning.spring[i][part], k);
    }
}

/* Returns the difference between a state and the value that state_at points to. */
static double state_origin(const struct scene_state *q, const struct variable *state)
{
    return state->row == ROW_body_displacement_state
               ? vec3_get(q->origin[state->element].displacement, state->component)
               : 0.0;
}

static enum ode_event event_of(int indicator)
{
    switch (indicator) {
    case ROW_contact_touch_indicator:
        return ODE_EVENT_GAP;
    case ROW_contact_dashpot_indicator:
        return ODE_EVENT_LAW;
    case ROW_contact_zone_indicator:
        return (enum ode_event)ODE_EVENT_ZONE;
    case ROW_contact_cap_indicator:
        return ODE_EVENT_CAP;
    case ROW_contact_lift_indicator:
        return ODE_EVENT_LIFT;
    default: /* of sticking */
        return ode_stick_event(part_of(indicator));
    }
}

/* Returns a checksum of the states that events may make jump: the energies, and the friction springs where
 * sliding begins or ends. */
static uint32_t booked_states(const struct scene_state *q)
{
    const double energies[] = {q->dissipated, q->external_work, q->friction_energy};
    const uint32_t mark = checksum_of(CHECKSUM_START, energies, sizeof energies);
    return checksum_of(mark, q->turning.spring, sizeof q->turning.spring);
}

void model_exchange_move(const struct scene_instant *at, const struct variable *state, double change,
                         struct scene_jet *along)
{
    if (is_in_use(at->v, state)) {
        *state_at(NULL, along, state) += change;
        if (SCENE_ANY_ROTATION && state->row == ROW_body_orientation_state) {
            turning_jet_move_orientation(at, state->element, at->q->turning.body[state->element].orientation,
                                         state->component, change, along);
        }
    }
}

double model_exchange_rate(const struct scene_instant *at, const struct scene_jet *along,
                           const struct variable *rate)
{
    const int i = rate->element;
    const int k = rate->component;
    if (!is_in_use(at->v, rate)) {
        return 0.0;
    }
    switch (rate->row) {
    case ROW_body_orientation_state: {
        const struct body_turn *turn = &at->q->turning.body[i];
        const struct vec3 omega = along ? along->angular_velocity[i][1] : turn->angular_velocity;
        struct quaternion turned = quaternion_rate(turn->orientation, omega);
        if (along) {
            const struct quaternion given = along->given_orientation[i];
            turned = quaternion_axpy(turned, 1.0, quaternion_rate(given, turn->angular_velocity));
        }
        return *quaternion_part(&turned, k);
    }
    case ROW_body_displacement_state:
        return vec3_get(along ? along->velocity[i][1] : at->velocity[i], k);
    case ROW_body_velocity_state:
        return along ? 2.0 * vec3_get(free_bodies_half_jerk(at->v, along, i), k)
                     : vec3_get(at->acceleration[i], k);
    case ROW_body_angular_velocity_state:
        return along ? 2.0 * vec3_get(turning_jet_half_jerk(at, along, i), k)
                     : vec3_get(turning_acceleration(at, i), k);
    case ROW_energy_friction_state:
    case ROW_energy_dissipated_state:
    case ROW_energy_external_work_state: {
        const struct scene_ode ode = {.values = at->v, .state = at->q, .layout = ode_layout_of(at->v, NULL)};
        const struct scene_powers power = along ? jet_powers_of(at, along, 1) : ode_powers(&ode, at);
        return rate->row == ROW_energy_friction_state     ? power.friction
               : rate->row == ROW_energy_dissipated_state ? power.dissipated
                                                          : power.external;
    }
    default: { /* of a spring */
        const int part = part_of(rate->row);
        return vec3_get(
            along ? turning_jet_spring_change(at, along, i, part) : turning_spring_rate(at, i, part), k);
    }
    }
}

double model_exchange_value(const struct scene_instant *at, const struct variable *variable)
{
    if (!SCENE_ANY_FREE) {
        return 0.0;
    }
    if (variable->causality == VARIABLE_STATE) {
        const double kept = *state_at((struct scene_state *)at->q, NULL, variable);
        return variable->row == ROW_body_displacement_state ? state_origin(at->q, variable) + kept : kept;
    }
    return variable->causality == VARIABLE_RATE
               ? model_exchange_rate(at, NULL, variable)
               : regime_margin(at, variable->element, event_of(variable->row));
}

/* Changes each regime whose event function has passed zero. Whether one has changed. */
static bool change_regimes(struct scene_state *q)
{
    bool changed = false;
    for (int j = 0; SCENE_ANY_FREE && j < SCENE_CONTACTS; ++j) {
        struct scene_instant at;
        scene_now(q, &at);
        const int event = regime_event(&at, j);
        if (event >= 0) {
            transition_take_event(q, j, event, ode_regime_after(q, j, event), &at);
            changed = true;
        }
    }
    motion_forget_integration(q);
    return changed;
}

/* Horizons of the search for a touch [s]. Each is four times the one before; the last is above an hour. A
 * search is best conditioned if its horizon is not much longer than the flight. */
static const double FIRST_HORIZON = 1.0;
static const double HORIZON_FACTOR = 4.0;
enum { HORIZONS = 7 };

/* Limit on the evaluations of one search where an axis turns. If the search finds no touch within them, the
 * importer's root finding has to find it. */
static const long MOST_EVALUATIONS = 100000;

void model_exchange_set_continuous(struct model *m, bool continuous)
{
    if (!model_apply_inputs(m)) { /* inputs of the mode that ends; where they are refused, reading says so */
        m->outputs = OUTPUTS_NONE;
    }
    m->state.exchange = continuous ? EXCHANGE_CONTINUOUS : EXCHANGE_EVENTS;
}

enum model_status model_exchange_set_time(struct model *m, double time)
{
    struct scene_state *q = &m->state.motion;
    const double event = q->base + q->base_tail;
    /* A time that should equal that of the last event may differ from it by a few roundings. */
    if (!(time >= event - 4.0 * DBL_EPSILON * fabs(event) && time <= DBL_MAX)) {
        return model_report(
            m, MODEL_ERROR,
            "The time %.17g s is refused (allowed: finite, from the last event at %.17g s on).", time, event);
    }
    q->clock = fmax((time - q->base) - q->base_tail, 0.0);
    m->outputs = OUTPUTS_NONE;
    return MODEL_OK;
}

void model_exchange_set_state(struct model *m, const struct variable *state, double value)
{
    *state_at(&m->state.motion, NULL, state) = value - state_origin(&m->state.motion, state);
    m->state.booked = booked_states(&m->state.motion);
    m->outputs = OUTPUTS_NONE;
}

enum model_status model_exchange_set_states(struct model *m, const double *states)
{
    for (int i = 0; i < SCENE_STATES; ++i) {
        const enum model_status status = model_check(m, &scene_variables[scene_states[i]], states[i]);
        if (status != MODEL_OK) {
            return status;
        }
    }
    for (int i = 0; i < SCENE_STATES; ++i) {
        model_exchange_set_state(m, &scene_variables[scene_states[i]], states[i]);
    }
    return MODEL_OK;
}

/* Takes over changed inputs. Before the end of initialization it renews the start of the motion instead. */
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
    scene_now(&m->state.motion, &at);
    for (int i = 0; i < count && status == MODEL_OK; ++i) {
        const struct variable *variable = &scene_variables[places[i]];
        values[i] = model_exchange_value(&at, variable);
        status = isfinite(values[i]) ? MODEL_OK
                                     : model_report(m, MODEL_DISCARD,
                                                    "%s is beyond the range of numbers (allowed: states and "
                                                    "inputs with finite forces and energies).",
                                                    variable->name);
    }
    if (which == EXCHANGE_STATES) {
        m->state.booked = booked_states(&m->state.motion);
    }
    return status;
}

/* Least announced time to a touch [s], divided by the time [s] or by 1 s, whichever is larger. Importers take
 * two times whose relative difference is below 1e-9 for equal, and cannot step from one to the other. */
static const double SOONEST_TOUCH = 1e-6;

/* Announces the next touch of open contacts. That of a prescribed body is not foreseen: only the importer
 * knows how it will move. */
static void foresee_touch(const struct model *m, struct exchange_news *news)
{
    const struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    const double now = scene_time(q);
    double after = (double)INFINITY;
    struct scene_instant at;
    scene_now(q, &at);
    for (int j = 0; SCENE_ANY_FREE && j < SCENE_CONTACTS; ++j) {
        const bool foreseen = q->contact[j].regime == (int32_t)REGIME_APART &&
                              !body_is_prescribed(v, contact_source(j)) &&
                              !body_is_prescribed(v, contact_destination(j));
        double found = (double)INFINITY;
        double horizon = FIRST_HORIZON;
        for (int i = 0; foreseen && i < HORIZONS && !isfinite(found); ++i) {
            found = prediction_of(&at, j, horizon, MOST_EVALUATIONS).next.after;
            horizon *= HORIZON_FACTOR;
        }
        after = fmin(after, found);
    }
    news->scheduled = after > SOONEST_TOUCH * fmax(1.0, fabs(now)) && now + after <= DBL_MAX;
    news->event_time = news->scheduled ? now + after : 0.0;
}

enum model_status model_exchange_update(struct model *m, struct exchange_news *news)
{
    struct scene_state *q = &m->state.motion;
    const enum model_status status = follow(m);
    news->again = status == MODEL_OK && change_regimes(q);
    news->jumped = booked_states(q) != m->state.booked;
    if (news->again) {
        model_report(m, MODEL_OK, "Changes of contact at %.17g s; since initialization: %d.", scene_time(q),
                     (int)q->counters.events);
    }
    m->outputs = OUTPUTS_NONE;
    if (status <= MODEL_WARNING && !news->again) {
        foresee_touch(m, news);
    }
    return status;
}

enum model_status model_exchange_accept(struct model *m)
{
    const enum model_status status = follow(m);
    struct scene_instant at;
    scene_now(&m->state.motion, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        m->state.motion.contact[j].physics.normal = at.geometry[j].normal;
    }
    return status;
}
