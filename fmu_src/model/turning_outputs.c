/* The outputs of bodies that turn and of contacts that have torques and friction. */
#include "model/motion.h"
#include "scene/turning.h"

#if SCENE_ANY_TURNING

static void put_turn(struct scene_values *v, const struct turning_instant *turning, int body)
{
    const struct body_turn *turn = &turning->body[body];
    struct quaternion orientation = turn->orientation;
    struct vec3 axis = quaternion_third_axis(orientation);
#if SCENE_ANY_ROTATION
    if (!body_turns(v, body)) {
        orientation = turning_start_orientation(v, body);
        axis = quaternion_third_axis(orientation);
    }
#endif
    put_body_angular_velocity(v, body, turn->angular_velocity);
    put_body_orientation(v, body, orientation);
    put_body_current_axis(v, body, axis);
}

static bool sticks(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                   int contact)
{
#if SCENE_ANY_FRICTION
    if (!contact_rubs(v, contact) || q->contact[contact].regime == (int32_t)REGIME_APART) {
        return false;
    }
    return contact_rubs_elastically(v, contact)
               ? q->contact[contact].friction_regime == (int32_t)FRICTION_STICKING
               : vec3_norm(at->turning.slip[contact]) < q->contact[contact].parameters.slip_velocity;
#else
    (void)v, (void)q, (void)at, (void)contact;
    return false;
#endif
}

static double put_rubbing(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                          int contact)
{
    const struct turning_instant *turning = &at->turning;
    const int source = contact_source(contact);
    const struct vec3 centre = vec3_add(body_center(v, source), at->displacement[source]);
    const struct vec3 friction = turning->friction_force[contact];
    const struct vec3 force = at->source_force[contact];
#if SCENE_ANY_FRICTION
    put_contact_effective_slip_velocity(v, contact, q->contact[contact].parameters.slip_velocity);
#endif
    if (contact_rubs(v, contact)) {
        put_contact_source_force(v, contact, force);
        put_contact_destination_force(v, contact, vec3_scale(-1.0, force));
    }
    put_contact_sticking(v, contact, sticks(v, q, at, contact));
    put_contact_friction_force(v, contact, friction);
    put_contact_slip_velocity(v, contact, turning->slip[contact]);
    put_contact_source_point(v, contact, vec3_add(centre, turning->source_arm[contact]));
    put_contact_source_torque(v, contact, turning->source_torque[contact]);
    put_contact_destination_torque(v, contact, turning->destination_torque[contact]);
    return vec3_norm(friction) + vec3_norm(turning->slip[contact]) +
           vec3_norm(turning->source_torque[contact]) + vec3_norm(turning->destination_torque[contact]);
}

double model_show_turning(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at)
{
    struct scene_instant known = *at;
    double sum = 0.0;
    if (!scene_turns(v)) {
        turning_complete(v, q, &known);
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        put_turn(v, &known.turning, i);
        sum += vec3_norm(known.turning.body[i].angular_velocity);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += put_rubbing(v, q, &known, j);
    }
    return sum;
}

#else

double model_show_turning(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at)
{
    (void)v, (void)q, (void)at;
    return 0.0;
}

#endif
