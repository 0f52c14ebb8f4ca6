#include <float.h>
#include <math.h>
#include <string.h>

#include "flight/flight.h"
#include "integrator/prediction.h"
#include "math/compiler.h"
#include "model/motion.h"
#include "model/report.h"
#include "prescribed/prescribed.h"
#include "scene/evaluate.h"
#include "scene/present.h"
#include "scene/scene_jet.h"
#include "scene/transition.h"

/*
 * What free_motion.c has of bodies that turn and contacts that rub: orientations, of any length,
 * angular velocities, springs of elastic friction and the work of friction as states; their rates; event
 * indicators of friction. All are false, or zero, for what is none of these.
 */

static bool turning_exchange_set(struct scene_state *q, const struct variable *state, double value);
static bool turning_exchange_get(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_instant *at, const struct variable *variable,
                                 double *value);

/* Mixes the bits of numbers into a mark (FNV-1a, by words). */
static inline uint64_t mark_of(uint64_t mark, const double *values, int count)
{
    for (int i = 0; i < count; ++i) {
        uint64_t bits;
        memcpy(&bits, values + i, sizeof bits);
        mark = (mark ^ bits) * UINT64_C(1099511628211);
    }
    return mark;
}

/* The mark with the states of what rubs that events make jump. */
static uint64_t turning_exchange_booked(const struct scene_state *q, uint64_t mark);

/* Along a path: a change of a state; what a rate changes by. */
static bool turning_exchange_move(const struct scene_values *v, const struct scene_state *q,
                                  const struct variable *state, double change, struct scene_jet *along);
static bool turning_exchange_slope(const struct scene_values *v, const struct scene_state *q,
                                   const struct scene_jet *along, const struct variable *variable,
                                   double *slope);

static double *orientation_part(struct quaternion *q, int component)
{
    double *const parts[] = {&q->w, &q->x, &q->y, &q->z};
    return parts[component];
}

static bool set_turn(struct scene_state *q, const struct variable *state, double value)
{
    struct body_turn *turn = &q->turning.body[state->element];
    switch (state->row) {
    case ROW_body_orientation_state:
        *orientation_part(&turn->orientation, state->component) = value;
        return true;
    case ROW_body_angular_velocity_state:
        vec3_set(&turn->angular_velocity, state->component, value);
        return true;
    default:
        return false;
    }
}

static bool get_turn(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at, const struct variable *variable, double *value)
{
    const int body = variable->element;
    const bool free = body_turns_freely(v, body);
    struct body_turn turn = q->turning.body[body];
    struct quaternion rate = quaternion_rate(turn.orientation, turn.angular_velocity);
    switch (variable->row) {
    case ROW_body_orientation_state:
        *value = *orientation_part(&turn.orientation, variable->component);
        return true;
    case ROW_body_angular_velocity_state:
        *value = vec3_get(turn.angular_velocity, variable->component);
        return true;
    case ROW_body_orientation_rate:
        *value = free ? *orientation_part(&rate, variable->component) : 0.0;
        return true;
    case ROW_body_angular_acceleration:
        *value = free ? vec3_get(turning_acceleration(v, q, q->clock, at, body), variable->component) : 0.0;
        return true;
    default:
        return false;
    }
}

/* A change of the orientation in force, which is unit, turns the axis with it. */
static bool move_turn(const struct scene_values *v, const struct scene_state *q, const struct variable *state,
                      double change, struct scene_jet *along)
{
    const int body = state->element;
    if (state->row != ROW_body_orientation_state && state->row != ROW_body_angular_velocity_state) {
        return false;
    }
    if (!body_turns_freely(v, body)) {
        return true; /* without effect */
    }
    if (state->row == ROW_body_angular_velocity_state) {
        vec3_add_to(&along->angular_velocity[body][1], state->component, change);
        return true;
    }
    const struct quaternion raw = q->turning.body[body].orientation;
    const struct quaternion unit = quaternion_unit(raw);
    struct quaternion by = {0.0, 0.0, 0.0, 0.0};
    *orientation_part(&by, state->component) = change;
    along->given_orientation[body] = quaternion_axpy(along->given_orientation[body], 1.0, by);
    by = quaternion_scale(1.0 / sqrt(quaternion_dot(raw, raw)),
                          quaternion_axpy(by, -quaternion_dot(by, unit), unit));
    along->orientation[body][1] = quaternion_axpy(along->orientation[body][1], 1.0, by);
    /* by = (0, r) unit / 2 turns by the rotation vector r */
    const struct vec3 turned =
        vec3_scale(2.0, quaternion_vector(quaternion_product(by, quaternion_inverse(unit))));
    along->axis[body][1] = vec3_add(along->axis[body][1], vec3_cross(turned, quaternion_third_axis(unit)));
    return true;
}

static bool turn_slope(const struct scene_values *v, const struct scene_state *q,
                       const struct scene_jet *along, const struct variable *variable, double *slope)
{
    const int body = variable->element;
    const struct body_turn *turn = &q->turning.body[body];
    if (variable->row == ROW_body_orientation_rate) {
        struct quaternion rate = quaternion_rate(turn->orientation, along->angular_velocity[body][1]);
        rate = quaternion_axpy(rate, 1.0,
                               quaternion_rate(along->given_orientation[body], turn->angular_velocity));
        *slope = body_turns_freely(v, body) ? *orientation_part(&rate, variable->component) : 0.0;
        return true;
    }
    if (variable->row != ROW_body_angular_acceleration) {
        return false;
    }
    struct scene_instant at;
    scene_now(v, q, &at);
    *slope = body_turns_freely(v, body)
                 ? vec3_get(turning_jet_spin_change(v, q, &at, along, body), variable->component)
                 : 0.0;
    return true;
}

static bool set_friction(struct scene_state *q, const struct variable *state, double value)
{
    switch (state->row) {
    case ROW_contact_spring_state:
        vec3_set(&q->turning.spring[state->element], state->component, value);
        return true;
    case ROW_energy_friction_state:
        q->friction_energy = value;
        return true;
    default:
        return false;
    }
}

static bool get_friction(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, const struct variable *variable, double *value)
{
    const int j = variable->element;
    switch (variable->row) {
    case ROW_contact_spring_state:
        *value = vec3_get(q->turning.spring[j], variable->component);
        return true;
    case ROW_contact_spring_rate:
        *value = contact_rubs_elastically(v, j)
                     ? vec3_get(turning_spring_rate(v, q, &q->turning, at, j), variable->component)
                     : 0.0;
        return true;
    case ROW_contact_stick_indicator:
        *value = regime_friction_margin(v, q, at, j, ODE_EVENT_STICK);
        return true;
    case ROW_contact_cap_indicator:
        *value = regime_friction_margin(v, q, at, j, ODE_EVENT_CAP);
        return true;
    case ROW_contact_lift_indicator:
        *value = regime_friction_margin(v, q, at, j, ODE_EVENT_LIFT);
        return true;
    case ROW_energy_friction_state:
        *value = q->friction_energy;
        return true;
    case ROW_energy_friction_power:
        *value = scene_turns(v) ? turning_friction_power(v, at) : 0.0;
        return true;
    default:
        return false;
    }
}

static bool move_friction(const struct scene_values *v, const struct variable *state, double change,
                          struct scene_jet *along)
{
    if (state->row == ROW_energy_friction_state) {
        along->friction[1] += change;
        return true;
    }
    if (state->row == ROW_contact_spring_state && contact_rubs_elastically(v, state->element)) {
        vec3_add_to(&along->spring[state->element][1], state->component, change);
    }
    return state->row == ROW_contact_spring_state;
}

/* The change of a contact's motion along the path. */
static struct turning_motion motion_along(const struct scene_jet *along, int contact)
{
    const int from = contact_source(contact);
    const int to = contact_destination(contact);
    return (struct turning_motion){.separation =
                                       vec3_sub(along->displacement[to][1], along->displacement[from][1]),
                                   .rate = vec3_sub(along->velocity[to][1], along->velocity[from][1]),
                                   .source_rotation = along->angular_velocity[from][1],
                                   .destination_rotation = along->angular_velocity[to][1],
                                   .axis = along->axis[to][1],
                                   .spring = along->spring[contact][1]};
}

static bool friction_slope(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_jet *along, const struct variable *variable, double *slope)
{
    const int j = variable->element;
    if (variable->row == ROW_energy_friction_power) {
        *slope = scene_turns(v) ? turning_jet_friction_power(v, along, 1) : 0.0;
        return true;
    }
    if (variable->row != ROW_contact_spring_rate) {
        return false;
    }
    *slope = 0.0;
    if (contact_rubs_elastically(v, j) && q->contact[j].regime != (int32_t)REGIME_APART) {
        struct scene_instant at;
        scene_now(v, q, &at);
        const struct contact_shape shape = scene_shape_met(v, q, &at, j);
        const struct turning_motion motion = turning_motion_of(&q->turning, &at, j);
        const struct turning_laws laws = turning_laws_of(v, q, j);
        const struct turning_slopes slopes = turning_slopes_at(&shape, &at.geometry[j], &motion, &laws);
        const struct turning_motion change = motion_along(along, j);
        *slope = vec3_get(turning_slopes_along(&slopes, &change).spring_rate, variable->component);
    }
    return true;
}

static bool turning_exchange_set(struct scene_state *q, const struct variable *state, double value)
{
    return (SCENE_ANY_ROTATION && set_turn(q, state, value)) ||
           (SCENE_ANY_FRICTION && set_friction(q, state, value));
}

static bool turning_exchange_get(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_instant *at, const struct variable *variable,
                                 double *value)
{
    return (SCENE_ANY_ROTATION && get_turn(v, q, at, variable, value)) ||
           (SCENE_ANY_FRICTION && get_friction(v, q, at, variable, value));
}

/* Springs jump where sliding begins or ends; different factors tell their components apart. */
static uint64_t turning_exchange_booked(const struct scene_state *q, uint64_t mark)
{
    if (SCENE_ANY_FRICTION) {
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            const struct vec3 spring = q->turning.spring[j];
            const double values[3] = {spring.x, spring.y, spring.z};
            mark = mark_of(mark, values, 3);
        }
        return mark_of(mark, &q->friction_energy, 1);
    }
    return mark;
}

static bool turning_exchange_move(const struct scene_values *v, const struct scene_state *q,
                                  const struct variable *state, double change, struct scene_jet *along)
{
    return (SCENE_ANY_ROTATION && move_turn(v, q, state, change, along)) ||
           (SCENE_ANY_FRICTION && move_friction(v, state, change, along));
}

static bool turning_exchange_slope(const struct scene_values *v, const struct scene_state *q,
                                   const struct scene_jet *along, const struct variable *variable,
                                   double *slope)
{
    return (SCENE_ANY_ROTATION && turn_slope(v, q, along, variable, slope)) ||
           (SCENE_ANY_FRICTION && friction_slope(v, q, along, variable, slope));
}

/* States, rates and event indicators of scenes with a body that may be free, for an integrator outside. */

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
        const bool passes = SCENE_ANY_CAPS && regime_zone_margin(v, q, &at, j) <= 0.0;
        if (passes || next != (enum contact_regime)q->contact[j].regime) {
            transition_switch_regime(v, q, j, next);
            changed = true;
            continue;
        }
        if (SCENE_ANY_FRICTION) {
            const enum ode_event event = regime_friction_event(v, q, &at, j);
            if (event != ODE_EVENT_GAP) {
                transition_switch_friction(v, q, j, event);
                changed = true;
            }
        }
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

/* The outputs that only integrated motion has, and their derivatives. */

/* Divided, not scaled by 1/window, which is infinite for steps of less than 1e-308 s. */
static struct vec3 mean_of(struct vec3 impulse, double window)
{
    return window > 0.0 ? vec3_make(impulse.x / window, impulse.y / window, impulse.z / window)
                        : vec3_make(0.0, 0.0, 0.0);
}

/* Part of a peak that rounding may change and that is still the same peak: what a contact's force is known to
 * (touch/segment.c). */
static const double KNOWN = 1e-6;

static bool peaks_are_known(const struct contact_state *state)
{
    return !(state->record.force_bound > state->peaks.force * (1.0 + KNOWN));
}

const char *motion_unknown(const struct model *m, const struct variable *variable)
{
    const bool is_peak =
        variable->row == ROW_contact_peak_force || variable->row == ROW_contact_peak_penetration;
    if (!is_peak || peaks_are_known(&m->state.motion.contact[variable->element])) {
        return NULL;
    }
    return "in a contact as stiff as this, rounding of gap and speed where it began makes more than 1e-6 of "
           "the "
           "peak (allowed: a smaller penalty factor, or, where the contact is damped, a later communication "
           "step; other outputs can be read)";
}

static double put_history(struct scene_values *v, const struct scene_state *q, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    const struct vec3 impulse = vec3_sub(state->physics.impulse, state->record.impulse_mark);
    const bool touching = state->regime != REGIME_APART;
    const struct vec3 mean = mean_of(impulse, q->step_length);
    put_contact_mean_force(v, contact, mean);
    if (SCENE_ANY_TURNING) {
        const struct contact_torques *torques = &state->torques;
        put_contact_mean_source_torque(
            v, contact, mean_of(vec3_sub(torques->source_impulse, torques->source_mark), q->step_length));
        put_contact_mean_destination_torque(
            v, contact,
            mean_of(vec3_sub(torques->destination_impulse, torques->destination_mark), q->step_length));
    }
    put_contact_peak_force(v, contact, state->peaks.force);
    put_contact_peak_penetration(v, contact, state->peaks.penetration);
    put_contact_onsets(v, contact, state->record.onsets);
    put_contact_last_onset_time(v, contact, state->record.onset_time);
    put_contact_last_duration(v, contact,
                              touching ? q->clock - state->record.touch_clock : state->record.last_duration);
    const double known = peaks_are_known(state) ? 0.0 : (double)INFINITY;
    return mean.x + mean.y + mean.z + state->peaks.force + known;
}

/* Their sum. Nothing is added where nothing turns or rubs. */
static double put_turning_energies(struct scene_values *v, const struct scene_state *q,
                                   const struct scene_instant *at)
{
    if (scene_turns(v)) {
        const double rotational = energy_rotational_of(v, at);
        const double tangential = energy_tangential_of(v, q, at);
        put_energy_rotational(v, rotational);
        put_energy_tangential(v, tangential);
        put_energy_friction(v, q->friction_energy - tangential);
        return rotational + q->friction_energy;
    }
    put_energy_friction(v, q->friction_energy); /* zero but for what an integrator outside says */
    return q->friction_energy;
}

static double put_energies(struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at)
{
    const double kinetic = energy_kinetic_of(v, at);
    const double potential = energy_potential_of(v, at);
    const double stored = energy_stored(v, q, at);
    put_energy_kinetic(v, kinetic);
    put_energy_potential(v, potential);
    put_energy_contact(v, stored);
    put_energy_dissipated(v, q->dissipated);
    put_energy_external_work(v, q->external_work);
    const double total =
        kinetic + potential + stored + q->dissipated - q->external_work + put_turning_energies(v, q, at);
    put_energy_total(v, total);
    put_solver_steps(v, q->counters.steps);
    put_solver_force_evaluations(v, q->counters.force_evaluations);
    put_solver_events(v, q->counters.events);
    put_solver_rejected_steps(v, q->counters.rejected_steps);
    put_solver_fallbacks(v, q->counters.fallbacks);
    return total;
}

const struct scene_state *motion_shown(const struct scene_values *v, const struct scene_state *q,
                                       struct scene_state *settled)
{
    (void)v, (void)settled;
    return q;
}

double motion_show(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at)
{
    double sum = put_energies(v, q, at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += put_history(v, q, j);
    }
    return sum;
}

double motion_energy(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at)
{
    return scene_is_force_element(v)
               ? 0.0
               : energy_kinetic_of(v, at) + energy_potential_of(v, at) + energy_stored(v, q, at);
}

/* What turns and rubs has of the balance. */
static double turning_balance_term(const struct scene_values *v, const struct scene_jet *along, int order)
{
    return SCENE_ANY_TURNING ? turning_jet_of_rotational(v, along, order) + along->friction[order] : 0.0;
}

static double energy_term(const struct model *m, const struct scene_jet *along, int row, int order)
{
    const struct scene_values *v = &m->state.values;
    const double kinetic = jet_of_kinetic(v, along, order);
    const double potential = jet_of_potential(v, along, order);
    const double stored = jet_of_stored(v, &m->state.motion, along, order);
    switch (row) {
    case ROW_energy_kinetic:
        return kinetic;
    case ROW_energy_potential:
        return potential;
    case ROW_energy_contact:
        return stored;
    case ROW_energy_rotational:
        return turning_jet_of_rotational(v, along, order);
    case ROW_energy_tangential:
        return turning_jet_of_tangential(v, &m->state.motion, along, order);
    case ROW_energy_friction:
        return along->friction[order] - turning_jet_of_tangential(v, &m->state.motion, along, order);
    case ROW_energy_dissipated:
        return along->dissipated[order];
    case ROW_energy_external_work:
        return along->external_work[order];
    case ROW_energy_total:
        return kinetic + potential + stored + along->dissipated[order] - along->external_work[order] +
               turning_balance_term(v, along, order);
    default:
        return 0.0;
    }
}

bool motion_jet(const struct model *m, const struct scene_state *q, const struct scene_jet *along,
                const struct variable *variable, int order, double *term)
{
    const struct contact_state *contact = q->contact;
    const int j = variable->element;
    switch (variable->row) {
    case ROW_energy_kinetic:
    case ROW_energy_potential:
    case ROW_energy_contact:
    case ROW_energy_dissipated:
    case ROW_energy_external_work:
    case ROW_energy_total:
    case ROW_energy_rotational:
    case ROW_energy_tangential:
    case ROW_energy_friction:
        *term = energy_term(m, along, variable->row, order);
        return true;
    case ROW_contact_last_duration: /* grows with the time while the bodies touch */
        *term = contact[j].regime != REGIME_APART ? along->time[order] : 0.0;
        return true;
    case ROW_contact_last_onset_time:
        *term = 0.0;
        return true;
    default:
        return false;
    }
}

void motion_jet_of_work(const struct scene_values *v, const struct scene_state *q, struct scene_jet *along)
{
    along->external_work[1] = jet_of_stored(v, q, along, 1);
}

enum model_status motion_open(struct model *m, const struct scene_values *v, const char *otherwise)
{
    const struct integrator_memory memory = {m->host.allocate, m->host.release};
    return integrator_open(&m->integrator, v, &memory)
               ? MODEL_OK
               : model_report(m, MODEL_ERROR, "%s: %s.", otherwise, m->integrator.message);
}

void motion_close(struct model *m)
{
    integrator_close(&m->integrator);
}

bool motion_has_history(const struct scene_values *v)
{
    return solver_method(v) != SOLVER_METHOD_EVENT_DRIVEN;
}

void motion_place(const struct scene_values *v, struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            q->origin[i] = (struct body_origin){body_initial_displacement(v, i), body_initial_velocity(v, i)};
            q->body[i].velocity = q->origin[i].velocity;
        }
    }
    if (SCENE_ANY_ROTATION) {
        turning_place(v, q);
    }
}

void motion_begin(const struct scene_values *v, struct scene_state *q)
{
    transition_settle_regimes(v, q, 0.0, true);
    struct scene_instant at;
    transition_begin_step(v, q, &at);
}

bool motion_follow(const struct scene_values *v, struct scene_state *q, const struct body_path *next,
                   bool jumps)
{
    struct scene_state before;
    scene_state_copy(v, q, &before);
    struct scene_instant at;
    scene_now(v, q, &at);
    const double stored = energy_stored(v, q, &at);
    scene_rebase(v, q);
    memcpy(q->path, next, sizeof q->path);
    turning_take_axes(v, q);
#if SCENE_ANY_FRICTION
    if (jumps && scene_turns(v) && scene_is_force_element(v)) {
        prescribed_lay_springs(v, q);
    }
#else
    (void)jumps;
#endif
    transition_settle_regimes(v, q, stored, false);
    if (isfinite(q->external_work) || scene_is_force_element(v)) {
        return true;
    }
    scene_state_copy(v, &before, q);
    return false;
}

/* Factors and forces: a sum that is finite only if all are. */
static double size_of_forces(const struct scene_values *v, const struct scene_state *q)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_coefficients *factors = &q->contact[j].parameters.factors;
        sum += factors->k + factors->c + fabs(at.normal_force[j]);
    }
    return sum;
}

bool motion_tune(const struct scene_values *v, struct scene_state *q, const struct motion_tuning *tuning)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    const double stored = energy_stored(v, q, &at);
    q->external_work += energy_potential_change(v, &at, tuning->more_gravity);
    scene_rebase(v, q);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        transition_scale_force_error(q, j, tuning->factors[j]);
        q->contact[j].parameters.factors = tuning->factors[j];
    }
    transition_take_law(v, q, tuning->law_changed, stored);
    return isfinite(size_of_forces(v, q)) && (isfinite(q->external_work) || scene_is_force_element(v));
}

static enum model_status report_step_limit(const struct model *m, const struct step_request *request)
{
    return model_report(
        m, MODEL_DISCARD,
        "The step to %s s %s at %s s: solver.max_internal_steps = %d are used up, by number or "
        "by work (allowed: 1 .. 2147483647). Go on from %s, if need be in smaller steps, or set a larger "
        "limit.",
        shortest_digits(request->end_time).text, request->whole ? "is undone, it got stuck" : "stopped",
        shortest_digits(scene_time(&m->state.motion)).text, (int)solver_max_internal_steps(&m->state.values),
        request->whole ? "where it began" : "there");
}

/* No body is free or turns freely, but something turns or rubs. */
static enum model_status advance_prescribed_turning(struct model *m, const struct step_request *request)
{
    const struct scene_values *v = &m->state.values;
    struct scene_state *q = &m->state.motion;
    const struct scene_state before = *q;
    const double length = scene_remaining(q, request->end_time);
    const long limit = solver_max_internal_steps(v);
    struct scene_instant at;
    transition_begin_step(v, q, &at);
    if (!prescribed_over(v, q, length, limit < PRESCRIBED_PANELS ? limit : PRESCRIBED_PANELS)) {
        const struct step_request whole = {.end_time = request->end_time, .whole = true};
        *q = before;
        return limit < PRESCRIBED_PANELS ? report_step_limit(m, &whole) : model_report_stalled(m, &whole);
    }
    q->clock += length;
    q->step_length = length;
    scene_rebase(v, q);
    transition_end_step(v, q);
    return MODEL_OK;
}

enum model_status motion_advance(struct model *m, const struct step_request *request)
{
    if (scene_turns(&m->state.values) && scene_is_force_element(&m->state.values)) {
        return advance_prescribed_turning(m, request);
    }
    const double end_time = request->end_time;
    const struct scene_values *v = &m->state.values;
    const int32_t events = m->state.motion.counters.events;
    switch (integrator_run(&m->integrator, v, &m->state.motion, request)) {
    case INTEGRATOR_DONE:
        break;
    case INTEGRATOR_STEP_LIMIT:
        return report_step_limit(m, request);
    case INTEGRATOR_STALLED:
        return model_report_stalled(m, request);
    case INTEGRATOR_FAILED:
    default:
        return model_report(m, MODEL_ERROR, "The step to %s s failed at %s s: %s",
                            shortest_digits(end_time).text,
                            shortest_digits(scene_time(&m->state.motion)).text, m->integrator.message);
    }
    if (m->state.motion.counters.events != events && model_reports(m, MODEL_OK)) {
        model_report(m, MODEL_OK, "Changes of contact up to %s s: %d; since initialization: %d.",
                     shortest_digits(end_time).text, (int)(m->state.motion.counters.events - events),
                     (int)m->state.motion.counters.events);
    }
    return MODEL_OK;
}

void motion_catch_up(const struct scene_values *v, struct scene_state *q)
{
    flight_catch_up(v, q);
}

/* Apart from foresee_reading, which need not save registers for it. */
CONTACT_NOINLINE static void show_prescribed(struct scene_values *v, const struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_prescribed(v, i)) {
            present_body_now(v, q, i);
        }
    }
}

/* After a deferred flight to `clock`: a caller that has read outputs after the step before will read again,
 * so body states are computed at once where that is cheap. The clock is passed by value, because reading it
 * back just after it was written costs more. */
static void foresee_reading(struct model *m, double clock)
{
    struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    m->outputs = OUTPUTS_BODIES;
    _Static_assert(((int)MOTION_PRESCRIBED & ~(int)MOTION_FIXED) != 0, "fixed bodies hide prescribed ones");
    int others = 0; /* bits of the motions that are not free: one instruction a body */
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const struct body_state at = flight_unforced_at(v, q, i, clock);
            present_body(v, i, vec3_add(q->origin[i].displacement, at.moved), at.velocity);
        } else {
            others |= body_motion(v, i);
        }
    }
    if (others & ~(int)MOTION_FIXED) {
        show_prescribed(v, q);
    }
}

/* Apart from motion_defer, which need not save registers for it. */
CONTACT_NOINLINE static bool defer_further(struct model *m, double end_time)
{
    return integrator_defer_further(&m->state.values, &m->state.motion, end_time);
}

bool motion_defer(struct model *m, double end_time)
{
    struct scene_state *q = &m->state.motion;
    if (!flight_defer(q, end_time) && !(q->deferrable_clock > 0.0 && defer_further(m, end_time))) {
        return false;
    }
    if (m->outputs > OUTPUTS_FIXED) {
        foresee_reading(m, m->state.motion.clock);
    }
    return true;
}

/* A measure of a free body's motion that is infinite or NaN where any part of it is. */
static double size_of_motion(const struct scene_values *v, const struct scene_state *q, int body)
{
    const struct vec3 speed = q->body[body].velocity;
    return body_mass(v, body) * vec3_dot(speed, speed) + vec3_norm(q->body[body].moved);
}

double motion_size(const struct scene_values *v, const struct scene_state *q)
{
    double sum = scene_is_force_element(v) ? 0.0 : q->dissipated + q->external_work;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        sum += body_is_free(v, i) ? size_of_motion(v, q, i) : 0.0;
    }
    return sum;
}

double motion_least_speed(const struct scene_values *v)
{
    return solver_absolute_tolerance(v);
}
