#include "fmi/derivatives.h"

#include <math.h>

#include "fmi/log.h"

const struct variable *find_real(struct instance *instance, const struct call *call, uint32_t reference,
                                 enum variable_causality causality)
{
    const struct variable *variable = scene_variable(reference);
    if (variable == NULL) {
        log_report(instance, MODEL_ERROR, "%s: unknown value reference %u", call->name, (unsigned)reference);
    } else if (variable->type != VARIABLE_REAL || variable->causality != causality) {
        log_report(instance, MODEL_ERROR, "%s: value reference %u is %s, which is no %s %s", call->name,
                   (unsigned)reference, variable->name, instance->adapter->type_names[VARIABLE_REAL],
                   causality == VARIABLE_INPUT ? "input" : "output");
    } else {
        return variable;
    }
    return NULL;
}

enum model_status check_order(struct instance *instance, const struct call *call,
                              const struct variable *variable, int order)
{
    if (order < LOWEST_ORDER || order > HIGHEST_ORDER) {
        return log_report(instance, MODEL_DISCARD,
                          "%s: derivative of order %d of %s refused, allowed: %d to %d", call->name, order,
                          variable->name, LOWEST_ORDER, HIGHEST_ORDER);
    }
    return MODEL_OK;
}

static enum model_status check_output_derivative(struct instance *instance, const struct call *call,
                                                 uint32_t reference, int order)
{
    const struct variable *variable = find_real(instance, call, reference, VARIABLE_OUTPUT);
    if (variable == NULL) {
        return MODEL_ERROR;
    }
    if (!model_has_derivatives(variable)) {
        return log_report(instance, MODEL_DISCARD,
                          "%s: %s sums up the last step; its derivatives are not provided, allowed: those of "
                          "the other %s outputs",
                          call->name, variable->name, instance->adapter->type_names[VARIABLE_REAL]);
    }
    return check_order(instance, call, variable, order);
}

enum model_status output_derivatives(struct instance *instance, const struct call *call,
                                     const uint32_t *references, const int *orders, size_t count,
                                     double *values)
{
    for (size_t i = 0; i < count; ++i) {
        const enum model_status status = check_output_derivative(instance, call, references[i], orders[i]);
        if (status != MODEL_OK) {
            return status;
        }
    }
    return model_get_output_derivatives(instance->model, references, orders, count, values);
}

/* Whether the states and their rates are unknowns and knowns of the importer. */
static bool knows_states(const struct instance *instance)
{
    return instance->host.exchange || instance->adapter->knows_states_in_steps;
}

/* Unknowns are the outputs and the rates of the states; in initialization mode the calculated parameters and
 * the states too (ModelStructure: initial unknowns). */
static bool is_unknown(struct instance *instance, const struct call *call, uint32_t reference)
{
    const struct variable *variable = scene_variable(reference);
    const bool starting = (instance->phase & PHASE_INITIALIZATION) != 0;
    if (variable != NULL && starting && variable->causality == VARIABLE_CALCULATED_PARAMETER) {
        return true;
    }
    if (variable != NULL && knows_states(instance) &&
        (variable->causality == VARIABLE_RATE || (starting && variable->causality == VARIABLE_STATE))) {
        return true;
    }
    return find_real(instance, call, reference, VARIABLE_OUTPUT) != NULL;
}

enum model_status check_unknowns(struct instance *instance, const struct call *call, const uint32_t *unknowns,
                                 size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        if (!is_unknown(instance, call, unknowns[i])) {
            return MODEL_ERROR;
        }
    }
    return MODEL_OK;
}

enum model_status check_known(struct instance *instance, const struct call *call, uint32_t reference)
{
    const struct variable *variable = scene_variable(reference);
    const bool starting = (instance->phase & PHASE_INITIALIZATION) != 0;
    if (variable != NULL && knows_states(instance) && !starting && variable->causality == VARIABLE_STATE) {
        return MODEL_OK;
    }
    if (variable != NULL && starting && variable->causality == VARIABLE_PARAMETER &&
        variable->type == VARIABLE_REAL) {
        return log_report(instance, MODEL_DISCARD,
                          "%s: derivatives with respect to the parameter %s are not provided, allowed: with "
                          "respect to %s inputs",
                          call->name, variable->name, instance->adapter->type_names[VARIABLE_REAL]);
    }
    return find_real(instance, call, reference, VARIABLE_INPUT) != NULL ? MODEL_OK : MODEL_ERROR;
}

enum model_status check_seed(struct instance *instance, const struct call *call, uint32_t reference,
                             double seed)
{
    return isfinite(seed)
               ? MODEL_OK
               : log_report(instance, MODEL_DISCARD, "%s: %s of %s = %g refused, allowed: finite", call->name,
                            instance->adapter->seed_name, scene_variable(reference)->name, seed);
}
