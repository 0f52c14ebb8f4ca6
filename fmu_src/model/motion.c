/* The outputs of the bodies. */
#include "model/motion.h"
#include "model/state.h"

void model_show_body(struct scene_values *v, int body, struct vec3 displacement, struct vec3 velocity)
{
    put_body_displacement(v, body, displacement);
    put_body_position(v, body, vec3_add(body_center(v, body), displacement));
    put_body_velocity(v, body, velocity);
}

void model_show_body_now(struct scene_values *v, const struct scene_state *q, int body)
{
    const struct body_instant at = scene_body_now(v, q, body);
    model_show_body(v, body, at.displacement, at.velocity);
}

/* Derivatives of the outputs that sum up a communication step. */

bool model_has_derivatives(const struct variable *variable)
{
    return variable->row != ROW_contact_mean_force && variable->row != ROW_contact_mean_source_torque &&
           variable->row != ROW_contact_mean_destination_torque && variable->row != ROW_contact_peak_force &&
           variable->row != ROW_contact_peak_penetration;
}

bool motion_jet_of_step(const struct model *m, const struct scene_state *q, const struct scene_instant *at,
                        const struct scene_jet *along, const struct variable *variable, int order,
                        double *term)
{
    const int j = variable->element;
    const bool touches = q->contact[j].regime != REGIME_APART;
    switch (variable->row) {
    case ROW_contact_peak_force: /* peaks are those of the start until the end of initialization */
        *term =
            !m->state.initialized && at->normal_force[j] > 0.0 ? along->contact[j].normal_force[order] : 0.0;
        return true;
    case ROW_contact_peak_penetration:
        *term = !m->state.initialized && touches ? -along->contact[j].gap[order] : 0.0;
        return true;
    case ROW_contact_mean_force:
    case ROW_contact_mean_source_torque:
    case ROW_contact_mean_destination_torque:
        *term = 0.0;
        return true;
    default:
        return false;
    }
}
