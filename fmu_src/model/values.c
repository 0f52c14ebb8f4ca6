/* Checking and reading single variables. */
#include <math.h>
#include <string.h>

#include "model/state.h"

enum model_status model_check_real(struct model *m, const struct variable *variable, double value)
{
    if (isfinite(value) && value >= variable->min && value <= variable->max) {
        return MODEL_OK;
    }
    return model_report(m, MODEL_DISCARD, "%s = %.17g refused (allowed: %g .. %g); it stays as it was.",
                        variable->name, value, variable->min, variable->max);
}

enum model_status model_check_integer(struct model *m, const struct variable *variable, int32_t value)
{
    if (value >= variable->min && value <= variable->max) {
        return MODEL_OK;
    }
    return model_report(m, MODEL_DISCARD, "%s = %d refused (allowed: %.0f .. %.0f); it stays as it was.",
                        variable->name, (int)value, variable->min, variable->max);
}

/* Which outputs have to be computed so that a variable shows the present. */
static enum outputs outputs_for(const struct model *m, const struct variable *variable)
{
    switch (variable->row) {
    case ROW_body_displacement:
    case ROW_body_position:
    case ROW_body_velocity:
        return OUTPUTS_BODIES;
    default:
        break;
    }
    const bool given = variable->causality == VARIABLE_PARAMETER || variable->causality == VARIABLE_INPUT;
    return given && m->state.initialized ? OUTPUTS_NONE : OUTPUTS_ALL;
}

double model_get_real(struct model *m, const struct variable *variable)
{
    model_update_outputs(m, outputs_for(m, variable));
    double value;
    memcpy(&value, (const char *)&m->state.values + variable->offset, sizeof value);
    return value;
}

size_t model_get_reals(const struct model *m, const uint32_t *references, size_t count, double *values)
{
    static const uint32_t current[] = {
        [OUTPUTS_NONE] = VARIABLE_GIVEN,
        [OUTPUTS_FIXED] = VARIABLE_GIVEN,
        [OUTPUTS_BODIES] = VARIABLE_GIVEN | VARIABLE_BODY,
        [OUTPUTS_ALL] = VARIABLE_GIVEN | VARIABLE_BODY | VARIABLE_COMPUTED,
    };
    const uint32_t known = current[m->outputs];
    size_t i = 0;
    for (; references && values && i < count; ++i) {
        const uint32_t reference = references[i];
        const uint32_t real = reference < SCENE_REFERENCES ? scene_reals[reference] : 0;
        if (!(real & known)) {
            break;
        }
        memcpy(&values[i], (const char *)&m->state.values + (real & VARIABLE_OFFSET), sizeof values[i]);
    }
    return i;
}

int32_t model_get_integer(struct model *m, const struct variable *variable)
{
    model_update_outputs(m, outputs_for(m, variable));
    int32_t value;
    memcpy(&value, (const char *)&m->state.values + variable->offset, sizeof value);
    return value;
}

enum model_status model_get_output_derivative(struct model *m, const struct variable *variable, int order,
                                              double *value)
{
    struct system_instant at;
    model_update_outputs(m, OUTPUTS_ALL);
    system_now(&m->state.values, &m->state.motion, &at);
    if (order == 1) {
        switch (variable->row) {
        case ROW_body_displacement:
        case ROW_body_position:
            *value = vec3_get(at.velocity[variable->element], variable->component);
            return MODEL_OK;
        case ROW_body_velocity:
            *value = vec3_get(at.acceleration[variable->element], variable->component);
            return MODEL_OK;
        case ROW_contact_gap:
            *value = at.geometry[variable->element].gap_rate;
            return MODEL_OK;
        default:
            break;
        }
    }
    return model_report(
        m, MODEL_DISCARD,
        "Derivative %d of %s is not provided (allowed: order 1 of displacement, position, velocity "
        "and gap).",
        order, variable->name);
}
