#include "model/turning_exchange.h"

#include "scene/present.h"
#include "scene/regime_margin.h"
#include "scene/turning_jet.h"

#if SCENE_ANY_ROTATION
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
#endif

#if SCENE_ANY_FRICTION
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
#endif

bool turning_exchange_set(struct scene_state *q, const struct variable *state, double value)
{
    bool known = false;
#if SCENE_ANY_ROTATION
    known = known || set_turn(q, state, value);
#endif
#if SCENE_ANY_FRICTION
    known = known || set_friction(q, state, value);
#endif
    (void)q, (void)state, (void)value;
    return known;
}

bool turning_exchange_get(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, const struct variable *variable, double *value)
{
    bool known = false;
#if SCENE_ANY_ROTATION
    known = known || get_turn(v, q, at, variable, value);
#endif
#if SCENE_ANY_FRICTION
    known = known || get_friction(v, q, at, variable, value);
#endif
    (void)v, (void)q, (void)at, (void)variable, (void)value;
    return known;
}

/* Springs jump where sliding begins or ends; different factors tell their components apart. */
uint64_t turning_exchange_booked(const struct scene_state *q, uint64_t mark)
{
#if SCENE_ANY_FRICTION
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct vec3 spring = q->turning.spring[j];
        const double values[3] = {spring.x, spring.y, spring.z};
        mark = mark_of(mark, values, 3);
    }
    return mark_of(mark, &q->friction_energy, 1);
#else
    (void)q;
    return mark;
#endif
}

bool turning_exchange_move(const struct scene_values *v, const struct scene_state *q,
                           const struct variable *state, double change, struct scene_jet *along)
{
    bool known = false;
#if SCENE_ANY_ROTATION
    known = known || move_turn(v, q, state, change, along);
#endif
#if SCENE_ANY_FRICTION
    known = known || move_friction(v, state, change, along);
#endif
    (void)v, (void)q, (void)state, (void)change, (void)along;
    return known;
}

bool turning_exchange_slope(const struct scene_values *v, const struct scene_state *q,
                            const struct scene_jet *along, const struct variable *variable, double *slope)
{
    bool known = false;
#if SCENE_ANY_ROTATION
    known = known || turn_slope(v, q, along, variable, slope);
#endif
#if SCENE_ANY_FRICTION
    known = known || friction_slope(v, q, along, variable, slope);
#endif
    (void)v, (void)q, (void)along, (void)variable, (void)slope;
    return known;
}
