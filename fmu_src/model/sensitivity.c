/* Derivatives of outputs, with respect to time and with respect to inputs: both are coefficients along a path
 * (scene_jet.h). */
#include <math.h>
#include <string.h>

#include "contact/law.h"
#include "model/motion.h"
#include "model/state.h"
#include "scene/present.h"
#include "scene/scene_jet.h"

/* Torques and slip where nothing turns or rubs. */
static void complete(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    if (SCENE_ANY_TURNING && !scene_turns(v)) {
        turning_complete(v, q, at);
    }
}

static enum model_status check_finite(const struct model *m, const struct variable *variable, double value)
{
    return isfinite(value)
               ? MODEL_OK
               : model_report(m, MODEL_DISCARD,
                              "A derivative of %s is beyond the range of numbers (allowed: finite).",
                              variable->name);
}

enum model_status model_get_output_derivatives(struct model *m, const uint32_t *references, const int *orders,
                                               size_t count, double *values)
{
    enum model_status status = MODEL_OK;
    const struct scene_values *v = &m->state.values;
    struct scene_state settled;
    struct scene_instant at;
    struct scene_jet along;
    if (!model_update_outputs(m, OUTPUTS_ALL)) {
        return model_refuse_inputs(m);
    }
    const struct scene_state *q = motion_shown(v, &m->state.motion, &settled);
    scene_now(v, q, &at);
    complete(v, q, &at);
    jet_in_time(v, q, &at, &along);
    for (size_t i = 0; i < count && status == MODEL_OK; ++i) {
        const struct variable *variable = scene_variable(references[i]);
        values[i] = orders[i] * output_term(m, q, &at, &along, variable, orders[i]); /* 1! and 2! */
        status = check_finite(m, variable, values[i]);
    }
    return status;
}

/* Of a prescribed body its motion has an effect at once; of a free one the force, on its acceleration. */
static void move_inputs(const struct scene_values *v, const struct scene_state *q,
                        const struct scene_instant *at, const struct variable *known, double change,
                        struct scene_jet *along)
{
    if (known->causality == VARIABLE_STATE) {
        motion_move_state(v, q, known, change, along);
        return;
    }
    if (known->row == ROW_body_external_force && body_is_free(v, known->element)) {
        vec3_add_to(&along->force[known->element], known->component, change);
    }
    if (SCENE_ANY_ROTATION) {
        if (body_turn_is_prescribed(v, known->element)) {
            if (known->row == ROW_body_prescribed_angular_velocity) {
                vec3_add_to(&along->angular_velocity[known->element][1], known->component, change);
            } else if (known->row == ROW_body_prescribed_axis) {
                turning_jet_move_axis(v, at, known->element, known->component, change, along);
            }
        }
        if (known->row == ROW_body_external_torque && body_turns_freely(v, known->element)) {
            vec3_add_to(&along->torque[known->element], known->component, change);
        }
    }
    if (!body_is_prescribed(v, known->element)) {
        return;
    }
    if (known->row == ROW_body_prescribed_displacement) {
        vec3_add_to(&along->displacement[known->element][1], known->component, change);
    } else if (known->row == ROW_body_prescribed_velocity) {
        vec3_add_to(&along->velocity[known->element][1], known->component, change);
    }
}

static bool factors_are_given(const struct scene_values *v, int contact)
{
    return contact_penalty_control(v, contact) == PENALTY_CONTROL_USER_DEFINED &&
           contact_viscous_control(v, contact) == VISCOUS_CONTROL_USER_DEFINED;
}

/* Until the end of initialization the diagonal follows the start. */
static double diagonal_slope(const struct model *m, const struct scene_jet *along, int contact)
{
    if (m->state.initialized) {
        return 0.0;
    }
    return model_diagonal_slope(m, contact,
                                vec3_sub(along->displacement[contact_destination(contact)][1],
                                         along->displacement[contact_source(contact)][1]));
}

static void vary_factors(const struct model *m, struct scene_jet *along)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!factors_are_given(&m->state.values, j)) {
            along->law_slope[j] = model_law_slope(m, j, diagonal_slope(m, along, j));
        }
        if (SCENE_ANY_FRICTION &&
            contact_slip_velocity_control(&m->state.values, j) == SLIP_VELOCITY_CONTROL_AUTOMATIC) {
            along->slip_velocity_slope[j] = 1e-3 * diagonal_slope(m, along, j); /* as prepare.c has it */
        }
    }
}

/* Until the end of initialization a contact begins at the start: its damping follows gap and rate there. */
static void vary_onsets(const struct model *m, const struct scene_state *q, const struct scene_instant *at,
                        struct scene_jet *along)
{
    if (SCENE_ANY_HERTZ) {
        const struct scene_values *v = &m->state.values;
        for (int j = 0; !m->state.initialized && j < SCENE_CONTACTS; ++j) {
            if (scene_damps_by_onset(v, j)) {
                jet_of_contacts(v, q, at, along);
                const struct contact_jet *contact = &along->contact[j];
                along->law_slope[j] = contact_hunt_crossley_slope(
                    onset_damping_slope(v, q, at, j, contact->gap[1], contact->gap_rate[1]));
            }
        }
    }
}

/* Calculated parameters, too, are those of the start until the end of initialization. */
static double input_derivative(const struct model *m, const struct scene_state *q,
                               const struct scene_instant *at, const struct scene_jet *along,
                               const struct variable *variable)
{
    const int j = variable->element;
    if (variable_is_local(variable)) {
        return motion_local_slope(&m->state.values, q, along, variable);
    }
    switch (variable->row) {
    case ROW_contact_effective_slip_velocity:
        return along->slip_velocity_slope[j];
    case ROW_contact_effective_penalty_factor:
        return contact_coefficients_of(&along->law_slope[j], REGIME_COMPRESSION).k;
    case ROW_contact_effective_viscous_penalty_factor:
        return contact_coefficients_of(&along->law_slope[j], REGIME_COMPRESSION).c;
    case ROW_contact_effective_hertz_stiffness:
        return 0.0; /* of shapes and materials, which inputs do not change */
    case ROW_contact_effective_hunt_crossley_factor:
        return contact_is_hertz(&along->law_slope[j]) ? contact_factors_of(&along->law_slope[j]).c : 0.0;
#if HAS_contact_diagonal
    case ROW_contact_diagonal:
        return diagonal_slope(m, along, j);
#endif
    default:
        return output_term(m, q, at, along, variable, 1);
    }
}

/* Springs as the state has them, which a reading does not lay onto the tangent planes. */
static void note_lifts(const struct model *m, const struct scene_instant *at, struct scene_jet *along)
{
    if (SCENE_ANY_FRICTION) {
        for (int j = 0; scene_turns(&m->state.values) && j < SCENE_CONTACTS; ++j) {
            along->spring_lift[j] = vec3_dot(m->state.motion.turning.spring[j], at->geometry[j].normal);
        }
    }
}

enum model_status model_get_directional_derivative(struct model *m, const uint32_t *unknowns,
                                                   size_t unknown_count, const uint32_t *knowns,
                                                   size_t known_count, const double *direction,
                                                   double *values)
{
    enum model_status status = MODEL_OK;
    const struct scene_values *v = &m->state.values;
    struct scene_state settled;
    struct scene_instant at;
    struct scene_jet along;
    if (!model_update_outputs(m, OUTPUTS_ALL)) {
        return model_refuse_inputs(m);
    }
    const struct scene_state *q = motion_shown(v, &m->state.motion, &settled);
    scene_now(v, q, &at);
    memset(&along, 0, sizeof along);
    complete(v, q, &at);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        along.velocity[i][0] = at.velocity[i];
        if (SCENE_ANY_TURNING) {
            along.angular_velocity[i][0] = at.turning.body[i].angular_velocity;
            along.axis[i][0] = quaternion_third_axis(at.turning.body[i].orientation);
        }
    }
    if (SCENE_ANY_TURNING) {
        along.jumps = !m->host.exchange && scene_is_force_element(v);
    }
    note_lifts(m, &at, &along);
    for (size_t i = 0; i < known_count; ++i) {
        move_inputs(v, q, &at, scene_variable(knowns[i]), direction[i], &along);
    }
    vary_factors(m, &along);
    vary_onsets(m, q, &at, &along);
    jet_of_contacts(v, q, &at, &along);
    if (m->state.initialized && !m->host.exchange) { /* there the work is a state */
        motion_jet_of_work(v, q, &along);
    }
    for (size_t i = 0; i < unknown_count && status == MODEL_OK; ++i) {
        const struct variable *variable = scene_variable(unknowns[i]);
        values[i] = input_derivative(m, q, &at, &along, variable);
        status = check_finite(m, variable, values[i]);
    }
    return status;
}

/* Adjoint derivatives, column by column of the directional ones: there are few inputs, and each column costs
 * as much as reading all outputs. */

/* J's column of one known, multiplied by the seed. */
static enum model_status add_column(struct model *m, const uint32_t *unknowns, size_t unknown_count,
                                    const uint32_t *known, const double *seed, double *value)
{
    const double one = 1.0;
    double column[MODEL_ADJOINT_MOST] = {0.0};
    const enum model_status status =
        model_get_directional_derivative(m, unknowns, unknown_count, known, 1, &one, column);
    *value = 0.0;
    for (size_t i = 0; i < unknown_count && status == MODEL_OK; ++i) {
        *value += seed[i] * column[i];
    }
    return status == MODEL_OK && !isfinite(*value)
               ? model_report(m, MODEL_DISCARD,
                              "An adjoint derivative with respect to %s is beyond the range of numbers "
                              "(allowed: finite).",
                              scene_variable(*known)->name)
               : status;
}

enum model_status model_get_adjoint_derivative(struct model *m, const uint32_t *unknowns,
                                               size_t unknown_count, const uint32_t *knowns,
                                               size_t known_count, const double *seed, double *values)
{
    enum model_status status = MODEL_OK;
    for (size_t i = 0; i < known_count && status == MODEL_OK; ++i) {
        status = add_column(m, unknowns, unknown_count, knowns + i, seed, values + i);
    }
    return status;
}
