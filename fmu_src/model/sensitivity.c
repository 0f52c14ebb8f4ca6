/* Derivatives of outputs, with respect to time and with respect to inputs: both are coefficients along a path
 * (scene_jet.h). */
#include <math.h>
#include <string.h>

#include "model/state.h"
#include "scene/scene_jet.h"

static double contact_term(const struct model *m, const struct scene_instant *at,
                           const struct scene_jet *along, const struct variable *variable, int order)
{
    const struct scene_values *v = &m->state.values;
    const int j = variable->element;
    const struct contact_shape shape = scene_contact_shape(v, &m->state.motion, j);
    const struct contact_jet *contact = &along->contact[j];
    const struct contact_geometry *g = &at->geometry[j];
    struct vec3 vector = {0.0, 0.0, 0.0};
    switch (variable->row) {
    case ROW_contact_gap:
        return scene_within_extents(&shape, g) ? contact->gap[order] : 0.0;
    case ROW_contact_gap_rate:
        return scene_within_extents(&shape, g) ? contact->gap_rate[order] : 0.0;
    case ROW_contact_distance:
        return contact->distance[order];
    case ROW_contact_normal_force:
        return contact->normal_force[order];
    case ROW_contact_direction: {
        const struct contact_geometry turned = {.normal = contact->normal[order]};
        vector = contact_direction_of(&shape, &turned);
        break;
    }
    case ROW_contact_source_force:
        vector = contact->source_force[order];
        break;
    case ROW_contact_destination_force:
        vector = vec3_scale(-1.0, contact->source_force[order]);
        break;
    case ROW_contact_point: { /* x_src + (d - r_d) n */
        const double radius = body_radius(v, contact_destination(j));
        vector = vec3_add(along->displacement[contact_source(j)][order],
                          jet_scale(contact->distance, contact->normal, order));
        vector = vec3_axpy(vector, -radius, contact->normal[order]);
        break;
    }
    default:
        break;
    }
    return vec3_get(vector, variable->component);
}

#if SCENE_ANY_FREE
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
    case ROW_energy_dissipated:
        return along->dissipated[order];
    case ROW_energy_external_work:
        return along->external_work[order];
    case ROW_energy_total:
        return kinetic + potential + stored + along->dissipated[order] - along->external_work[order];
    default:
        return 0.0;
    }
}
#endif

/* Coefficient `order` of a variable; zero where nothing along the path changes it. */
static double term_of(const struct model *m, const struct scene_instant *at, const struct scene_jet *along,
                      const struct variable *variable, int order)
{
    switch (variable->row) {
    case ROW_body_displacement:
    case ROW_body_position:
        return vec3_get(along->displacement[variable->element][order], variable->component);
    case ROW_body_velocity:
        return vec3_get(along->velocity[variable->element][order], variable->component);
#if SCENE_ANY_FREE
    case ROW_energy_kinetic:
    case ROW_energy_potential:
    case ROW_energy_contact:
    case ROW_energy_dissipated:
    case ROW_energy_external_work:
    case ROW_energy_total:
        return energy_term(m, along, variable->row, order);
    case ROW_contact_mean_force:
    case ROW_contact_peak_force:
    case ROW_contact_peak_penetration:
    case ROW_contact_last_onset_time:
    case ROW_contact_last_duration:
        return 0.0;
#endif
    default:
        return contact_term(m, at, along, variable, order);
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

bool model_has_derivatives(const struct variable *variable)
{
#if SCENE_ANY_FREE
    return variable->row != ROW_contact_mean_force && variable->row != ROW_contact_peak_force &&
           variable->row != ROW_contact_peak_penetration;
#else
    (void)variable;
    return true;
#endif
}

/* d/dt, or d^2/dt^2, of the one output that is a duration: it grows with the time while the bodies touch. */
static double time_derivative(const struct model *m, const struct scene_instant *at,
                              const struct scene_jet *along, const struct variable *variable, int order)
{
#if SCENE_ANY_FREE
    if (variable->row == ROW_contact_last_duration) {
        return order == 1 && m->state.motion.contact[variable->element].regime != REGIME_APART ? 1.0 : 0.0;
    }
#endif
    return order * term_of(m, at, along, variable, order); /* 1! and 2! */
}

enum model_status model_get_output_derivatives(struct model *m, const uint32_t *references, const int *orders,
                                               size_t count, double *values)
{
    enum model_status status = MODEL_OK;
    struct scene_instant at;
    struct scene_jet along;
    if (!model_update_outputs(m, OUTPUTS_ALL)) {
        return model_refuse_inputs(m);
    }
    scene_now(&m->state.values, &m->state.motion, &at);
    jet_in_time(&m->state.values, &m->state.motion, &at, &along);
    for (size_t i = 0; i < count && status == MODEL_OK; ++i) {
        const struct variable *variable = scene_variable(references[i]);
        values[i] = time_derivative(m, &at, &along, variable, orders[i]);
        status = check_finite(m, variable, values[i]);
    }
    return status;
}

static void add_component(struct vec3 *a, int component, double value)
{
    a->x += component == 0 ? value : 0.0;
    a->y += component == 1 ? value : 0.0;
    a->z += component == 2 ? value : 0.0;
}

/* Forces change accelerations, which are no outputs: at once only prescribed motion has an effect. */
static void move_inputs(const struct scene_values *v, const struct variable *known, double change,
                        struct scene_jet *along)
{
    if (!body_is_prescribed(v, known->element)) {
        return;
    }
    if (known->row == ROW_body_prescribed_displacement) {
        add_component(&along->displacement[known->element][1], known->component, change);
    } else if (known->row == ROW_body_prescribed_velocity) {
        add_component(&along->velocity[known->element][1], known->component, change);
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
    }
}

/* What depends on inputs besides the state of the present: calculated parameters and peaks are those of the
 * start until the end of initialization, and whoever moves a body by a jump does the work on the contact. */
static double input_derivative(const struct model *m, const struct scene_instant *at,
                               const struct scene_jet *along, const struct variable *variable)
{
    const int j = variable->element;
    switch (variable->row) {
    case ROW_contact_effective_penalty_factor:
        return contact_coefficients_of(&along->law_slope[j], REGIME_COMPRESSION).k;
    case ROW_contact_effective_viscous_penalty_factor:
        return contact_coefficients_of(&along->law_slope[j], REGIME_COMPRESSION).c;
#if HAS_contact_diagonal
    case ROW_contact_diagonal:
        return diagonal_slope(m, along, j);
#endif
#if SCENE_ANY_FREE
    case ROW_contact_peak_force:
        return !m->state.initialized && at->normal_force[j] > 0.0 ? along->contact[j].normal_force[1] : 0.0;
    case ROW_contact_peak_penetration:
        return !m->state.initialized && m->state.motion.contact[j].regime != REGIME_APART
                   ? -along->contact[j].gap[1]
                   : 0.0;
#endif
    default:
        return term_of(m, at, along, variable, 1);
    }
}

enum model_status model_get_directional_derivative(struct model *m, const uint32_t *unknowns,
                                                   size_t unknown_count, const uint32_t *knowns,
                                                   size_t known_count, const double *direction,
                                                   double *values)
{
    enum model_status status = MODEL_OK;
    struct scene_instant at;
    struct scene_jet along;
    if (!model_update_outputs(m, OUTPUTS_ALL)) {
        return model_refuse_inputs(m);
    }
    scene_now(&m->state.values, &m->state.motion, &at);
    memset(&along, 0, sizeof along);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        along.velocity[i][0] = at.velocity[i];
    }
    for (size_t i = 0; i < known_count; ++i) {
        move_inputs(&m->state.values, scene_variable(knowns[i]), direction[i], &along);
    }
    vary_factors(m, &along);
    jet_of_contacts(&m->state.values, &m->state.motion, &at, &along);
#if SCENE_ANY_FREE
    if (m->state.initialized) {
        along.external_work[1] = jet_of_stored(&m->state.values, &m->state.motion, &along, 1);
    }
#endif
    for (size_t i = 0; i < unknown_count && status == MODEL_OK; ++i) {
        const struct variable *variable = scene_variable(unknowns[i]);
        values[i] = input_derivative(m, &at, &along, variable);
        status = check_finite(m, variable, values[i]);
    }
    return status;
}
