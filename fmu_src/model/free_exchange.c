/* States, rates and event indicators of scenes with a body that may be free, for an integrator outside. */
#include <float.h>
#include <math.h>

#include "model/motion.h"
#include "model/turning_exchange.h"
#include "scene/energy.h"
#include "scene/free_bodies.h"
#include "scene/regime_margin.h"
#include "scene/transition.h"
#include "segment/outlook.h"

void motion_set_state(struct scene_state *q, const struct variable *state, double value)
{
    const int body = state->element;
    if (turning_exchange_set(q, state, value)) {
        return;
    }
    switch (state->row) {
    case ROW_body_displacement_state: {
        const double origin = vec3_get(q->origin[body].displacement, state->component);
        vec3_set(&q->body[body].moved, state->component, value - origin);
        break;
    }
    case ROW_body_velocity_state:
        vec3_set(&q->body[body].velocity, state->component, value);
        break;
    case ROW_energy_dissipated_state:
        q->dissipated = value;
        break;
    case ROW_energy_external_work_state:
        q->external_work = value;
        break;
    default:
        break;
    }
}

static double body_local(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, const struct variable *variable)
{
    const int body = variable->element;
    const struct vec3 none = {0.0, 0.0, 0.0};
    const bool free = body_is_free(v, body);
    struct vec3 value;
    switch (variable->row) {
    case ROW_body_displacement_state:
        value = vec3_add(q->origin[body].displacement, q->body[body].moved);
        break;
    case ROW_body_velocity_state:
        value = q->body[body].velocity;
        break;
    case ROW_body_displacement_rate:
        value = free ? at->velocity[body] : none;
        break;
    default: /* ROW_body_acceleration */
        value = free ? at->acceleration[body] : none;
        break;
    }
    return vec3_get(value, variable->component);
}

double motion_local(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                    const struct variable *variable)
{
    double value = 0.0;
    if (turning_exchange_get(v, q, at, variable, &value)) {
        return value;
    }
    switch (variable->row) {
    case ROW_energy_dissipated_state:
        return q->dissipated;
    case ROW_energy_external_work_state:
        return q->external_work;
    case ROW_energy_dissipated_power:
        return energy_dissipated_power(v, q, at);
    case ROW_energy_external_power:
        return scene_external_power(v, q, q->clock, at);
    case ROW_contact_touch_indicator:
        return regime_touch_margin(v, q, at, variable->element);
    case ROW_contact_dashpot_indicator:
        return regime_dashpot_margin(v, q, at, variable->element);
    case ROW_contact_zone_indicator:
        return regime_zone_margin(v, q, at, variable->element);
    default:
        return body_local(v, q, at, variable);
    }
}

uint64_t motion_booked(const struct scene_state *q)
{
    const double energies[2] = {q->dissipated, q->external_work};
    return turning_exchange_booked(q, mark_of(0, energies, 2));
}

/* What only integration within the model knows. */
static void forget_integration(struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct contact_state *contact = &q->contact[j];
        contact->physics.accumulated_gap = DBL_MAX; /* as positions give it */
        contact->schedule.change_clock = (double)INFINITY;
        contact->peaks = (struct contact_peaks){0.0, 0.0};
    }
}

void motion_begin_exchange(struct scene_state *q)
{
    forget_integration(q);
}

bool motion_change_regimes(const struct scene_values *v, struct scene_state *q)
{
    bool changed = false;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct scene_instant at;
        scene_now(v, q, &at);
        const enum contact_regime next = regime_by_margins(v, q, &at, j);
        const bool passes = SCENE_ANY_CAPS && regime_zone_margin(v, q, &at, j) < 0.0;
        if (passes || next != (enum contact_regime)q->contact[j].regime) {
            transition_switch_regime(v, q, j, next);
            changed = true;
            continue;
        }
#if SCENE_ANY_FRICTION
        const enum ode_event event = regime_friction_event(v, q, &at, j);
        if (event != ODE_EVENT_GAP) {
            transition_switch_friction(v, q, j, event);
            changed = true;
        }
#endif
    }
    forget_integration(q);
    return changed;
}

/* Horizons of the search for a touch [s]: the first is enlarged so often, up to an hour. Conditions of a
 * horizon not much longer than the flight are the best conditioned. */
static const double FIRST_HORIZON = 1.0, HORIZON_FACTOR = 4.0;
enum { HORIZONS = 7 };

/* Of a search for each horizon where an axis turns: beyond it the importer's own root finding is left. */
static const long MOST_EVALUATIONS = 100000;

/* Of a contact apart, unless the importer leads one of its bodies: where to, only it knows. */
static double touch_after(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, int contact)
{
    double after = (double)INFINITY;
    const bool led =
        body_is_prescribed(v, contact_source(contact)) || body_is_prescribed(v, contact_destination(contact));
    if (led || q->contact[contact].regime != (int32_t)REGIME_APART) {
        return after;
    }
    double horizon = FIRST_HORIZON;
    for (int i = 0; i < HORIZONS && !isfinite(after); ++i) {
        after = outlook_of(v, q, at, contact, horizon, MOST_EVALUATIONS).next.after;
        horizon *= HORIZON_FACTOR;
    }
    return after;
}

double motion_touch_after(const struct scene_values *v, const struct scene_state *q)
{
    double after = (double)INFINITY;
    struct scene_instant at;
    scene_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        after = fmin(after, touch_after(v, q, &at, j));
    }
    return after;
}

/* Of a body that is not free the states have no effect. */
void motion_move_state(const struct scene_values *v, const struct scene_state *q,
                       const struct variable *state, double change, struct scene_jet *along)
{
    const int body = state->element;
    if (turning_exchange_move(v, q, state, change, along)) {
        return;
    }
    switch (state->row) {
    case ROW_energy_dissipated_state:
        along->dissipated[1] += change;
        break;
    case ROW_energy_external_work_state:
        along->external_work[1] += change;
        break;
    case ROW_body_displacement_state:
        if (body_is_free(v, body)) {
            vec3_add_to(&along->displacement[body][1], state->component, change);
        }
        break;
    default: /* ROW_body_velocity_state */
        if (body_is_free(v, body)) {
            vec3_add_to(&along->velocity[body][1], state->component, change);
        }
        break;
    }
}

/* Of rates; states are what they are. */
double motion_local_slope(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_jet *along, const struct variable *variable)
{
    const int body = variable->element;
    double slope = 0.0;
    if (turning_exchange_slope(v, q, along, variable, &slope)) {
        return slope;
    }
    switch (variable->row) {
    case ROW_body_displacement_rate:
        return body_is_free(v, body) ? vec3_get(along->velocity[body][1], variable->component) : 0.0;
    case ROW_body_acceleration:
        return body_is_free(v, body)
                   ? 2.0 * vec3_get(free_bodies_half_jerk(v, along, body), variable->component)
                   : 0.0;
    case ROW_energy_dissipated_power:
        return free_bodies_dissipated_power(v, q, along, 1);
    case ROW_energy_external_power:
        return free_bodies_external_power(v, q, along, 1);
    default:
        return 0.0;
    }
}
