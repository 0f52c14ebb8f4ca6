/* Checking and reading single variables. */
#include <math.h>
#include <string.h>

#include "model/motion.h"
#include "model/shortest.h"

enum model_status model_check(struct model *m, const struct variable *variable, const void *value)
{
    const double number = variable_number(variable, value);
    if (isfinite(number) && number >= variable->min && number <= variable->max) {
        const bool tunes = m->state.initialized && variable->causality == VARIABLE_PARAMETER;
        return !tunes || model_can_tune(m, variable, value)
                   ? MODEL_OK
                   : model_report(m, MODEL_DISCARD,
                                  "%s = %s refused: a force or an energy would be beyond the range of "
                                  "numbers (allowed: values with finite ones); it stays as it was.",
                                  variable->name, shortest_digits(number).text);
    }
    return model_report(m, MODEL_DISCARD, "%s = %s refused (allowed: %s .. %s); it stays as it was.",
                        variable->name, shortest_digits(number).text, shortest_digits(variable->min).text,
                        shortest_digits(variable->max).text);
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

enum model_status model_read(struct model *m, const struct variable *variable, void *value)
{
    if (!model_update_outputs(m, outputs_for(m, variable))) {
        return model_refuse_inputs(m);
    }
    const char *unknown = motion_unknown(m, variable);
    if (unknown) {
        return model_report(m, MODEL_DISCARD, "%s is not known: %s.", variable->name, unknown);
    }
    double local = 0.0;
    const void *at = (const char *)&m->state.values + variable->offset;
    if (variable_is_local(variable)) {
        struct scene_instant now;
        scene_now(&m->state.values, &m->state.motion, &now);
        local = motion_local(&m->state.values, &m->state.motion, &now, variable);
        at = &local;
    }
    if (!isfinite(variable_number(variable, at))) {
        return model_report(m, MODEL_DISCARD,
                            "%s is beyond the range of numbers (allowed: parameters and inputs with finite "
                            "forces and energies).",
                            variable->name);
    }
    memcpy(value, at, variable_size(variable));
    return MODEL_OK;
}

/* Where a Real stands, if it can be read as it stands and its table entry has these marks; else NULL. */
static inline const double *known_real(const struct model *m, uint32_t reference, uint32_t marks)
{
    const uint32_t real = reference < SCENE_REFERENCES ? scene_reals[reference] : 0;
    const bool known = (real & (uint32_t)m->outputs) && (real & marks) == marks;
    return known ? (const double *)&m->state.values + (real & VARIABLE_OFFSET) / sizeof(double) : NULL;
}

bool model_get_vector(const struct model *m, const uint32_t *references, double *values)
{
    if (!references || !values) {
        return false;
    }
    const uint32_t first = references[0];
    const bool in_order = references[1] == first + 1 && references[2] == first + 2;
    const double *from = in_order ? known_real(m, first, VARIABLE_VECTOR) : NULL;
    if (!from) {
        return false;
    }
    /* One by one: what is read in wider portions than it was written in keeps the processor waiting. */
    values[0] = from[0];
    values[1] = from[1];
    values[2] = from[2];
    return true;
}

size_t model_get_reals(const struct model *m, const uint32_t *references, size_t count, double *values)
{
    size_t i = 0;
    const double *from = NULL;
    while (i < count && (from = known_real(m, references[i], 0)) != NULL) {
        values[i++] = *from;
    }
    return i;
}
