#include "scene/turning_jet.h"

#if SCENE_ANY_TURNING

double turning_jet_of_rotational(const struct scene_values *v, const struct scene_jet *along, int order)
{
    double sum = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_turns_freely(v, i)) {
            const struct body_inertia inertia = body_inertia_of(v, i);
            double axial = 0.0;
            for (int k = 0; k <= order; ++k) {
                axial += jet_dot(along->angular_velocity[i], along->axis[i], k) *
                         jet_dot(along->angular_velocity[i], along->axis[i], order - k);
            }
            const double square = jet_dot(along->angular_velocity[i], along->angular_velocity[i], order);
            sum += 0.5 * (inertia.transverse * square + (inertia.axial - inertia.transverse) * axial);
        }
    }
    return sum;
}

double turning_jet_of_tangential(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_jet *along, int order)
{
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_rubs_elastically(v, j) && q->contact[j].regime != (int32_t)REGIME_APART) {
            sum += along->turning[j].stored[order];
        }
    }
    return sum;
}

double turning_jet_friction_power(const struct scene_values *v, const struct scene_jet *along, int order)
{
    double power = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_rubs(v, j)) {
            power -= jet_dot(along->turning[j].friction_force, along->turning[j].slip, order);
        }
    }
    return power;
}

double turning_jet_external_power(const struct scene_values *v, const struct scene_state *q,
                                  const struct scene_jet *along, int order)
{
    double power = 0.0;
#if SCENE_ANY_ROTATION
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_turns_freely(v, i)) {
            const struct vec3 torque[2] = {path_at(q->path[i].torque, 3, q->clock), along->torque[i]};
            power += jet_dot(torque, along->angular_velocity[i], order);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int source = contact_source(j);
        const int destination = contact_destination(j);
        if (body_turn_is_prescribed(v, source)) {
            power -= jet_dot(along->turning[j].source_torque, along->angular_velocity[source], order);
        }
        if (body_turn_is_prescribed(v, destination)) {
            power -=
                jet_dot(along->turning[j].destination_torque, along->angular_velocity[destination], order);
        }
    }
#else
    (void)v, (void)q, (void)along, (void)order;
#endif
    return power;
}

#endif
