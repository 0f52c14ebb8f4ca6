/* Derivatives with respect to time of inputs and outputs, and of outputs with respect to inputs. */
#include <math.h>

#include "fmi2/call_order.h"
#include "fmi2/log.h"

/* maxOutputDerivativeOrder of the model description; inputs are polynomials of second degree at most. */
enum { LOWEST_ORDER = 1, HIGHEST_ORDER = 2 };

/* The Real variable of a reference with the wanted causality, or NULL after a message. */
static const struct variable *find_real(struct instance *instance, enum call call,
                                        fmi2ValueReference reference, enum variable_causality causality)
{
    const struct variable *variable = scene_variable(reference);
    if (variable == NULL) {
        log_report(instance, fmi2Error, "%s: unknown value reference %u", call_name(call), reference);
    } else if (variable->type != VARIABLE_REAL || variable->causality != causality) {
        log_report(instance, fmi2Error, "%s: value reference %u is %s, which is no Real %s", call_name(call),
                   reference, variable->name, causality == VARIABLE_INPUT ? "input" : "output");
    } else {
        return variable;
    }
    return NULL;
}

static bool arrays_given(struct instance *instance, enum call call, const fmi2ValueReference vr[], size_t nvr,
                         const fmi2Integer order[], const fmi2Real value[])
{
    return call_allowed(instance, call) && call_array_given(instance, call, "vr", vr, nvr) &&
           call_array_given(instance, call, "order", order, nvr) &&
           call_array_given(instance, call, "value", value, nvr);
}

static fmi2Status check_order(struct instance *instance, enum call call, const struct variable *variable,
                              fmi2Integer order)
{
    if (order < LOWEST_ORDER || order > HIGHEST_ORDER) {
        return log_report(instance, fmi2Discard,
                          "%s: derivative of order %d of %s refused, allowed: %d to %d", call_name(call),
                          order, variable->name, LOWEST_ORDER, HIGHEST_ORDER);
    }
    return fmi2OK;
}

static fmi2Status check_input_derivative(struct instance *instance, fmi2ValueReference reference,
                                         fmi2Integer order, fmi2Real value)
{
    const struct variable *variable =
        find_real(instance, CALL_SetRealInputDerivatives, reference, VARIABLE_INPUT);
    if (variable == NULL) {
        return fmi2Error;
    }
    const fmi2Status status = check_order(instance, CALL_SetRealInputDerivatives, variable, order);
    if (status == fmi2OK && !isfinite(value)) {
        return log_report(
            instance, fmi2Discard,
            "fmi2SetRealInputDerivatives: derivative of order %d of %s = %g refused, allowed: finite", order,
            variable->name, value);
    }
    return status;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    struct instance *instance = c;
    if (!arrays_given(instance, CALL_SetRealInputDerivatives, vr, nvr, order, value)) {
        return fmi2Error;
    }
    for (size_t i = 0; i < nvr; ++i) {
        const fmi2Status status = check_input_derivative(instance, vr[i], order[i], value[i]);
        if (status != fmi2OK) {
            return status;
        }
    }
    fmi2Status worst = fmi2OK;
    for (size_t i = 0; i < nvr && worst <= fmi2Warning; ++i) {
        const struct variable *variable = scene_variable(vr[i]);
        const fmi2Status status =
            status_of(model_set_input_derivative(instance->model, variable, order[i], value[i]));
        worst = status > worst ? status : worst;
    }
    return worst;
}

static fmi2Status check_output_derivative(struct instance *instance, fmi2ValueReference reference,
                                          fmi2Integer order)
{
    const struct variable *variable =
        find_real(instance, CALL_GetRealOutputDerivatives, reference, VARIABLE_OUTPUT);
    if (variable == NULL) {
        return fmi2Error;
    }
    if (!model_has_derivatives(variable)) {
        return log_report(instance, fmi2Discard,
                          "fmi2GetRealOutputDerivatives: %s sums up the last step; its derivatives are not "
                          "provided, allowed: those of the other Real outputs",
                          variable->name);
    }
    return check_order(instance, CALL_GetRealOutputDerivatives, variable, order);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[])
{
    struct instance *instance = c;
    if (!arrays_given(instance, CALL_GetRealOutputDerivatives, vr, nvr, order, value)) {
        return fmi2Error;
    }
    for (size_t i = 0; i < nvr; ++i) {
        const fmi2Status status = check_output_derivative(instance, vr[i], order[i]);
        if (status != fmi2OK) {
            return status;
        }
    }
    return status_of(model_get_output_derivatives(instance->model, vr, order, nvr, value));
}

/* Unknowns are the outputs; in initialization mode the calculated parameters too (ModelStructure:
 * InitialUnknowns). */
static bool is_unknown(struct instance *instance, fmi2ValueReference reference)
{
    const struct variable *variable = scene_variable(reference);
    if ((instance->phase & PHASE_INITIALIZATION) != 0 && variable != NULL &&
        variable->causality == VARIABLE_CALCULATED_PARAMETER) {
        return true;
    }
    return find_real(instance, CALL_GetDirectionalDerivative, reference, VARIABLE_OUTPUT) != NULL;
}

static fmi2Status check_known(struct instance *instance, fmi2ValueReference reference, fmi2Real change)
{
    const struct variable *variable = scene_variable(reference);
    if (variable != NULL && (instance->phase & PHASE_INITIALIZATION) != 0 &&
        variable->causality == VARIABLE_PARAMETER && variable->type == VARIABLE_REAL) {
        return log_report(
            instance, fmi2Discard,
            "fmi2GetDirectionalDerivative: derivatives with respect to the parameter %s are not "
            "provided, allowed: with respect to Real inputs",
            variable->name);
    }
    variable = find_real(instance, CALL_GetDirectionalDerivative, reference, VARIABLE_INPUT);
    if (variable == NULL) {
        return fmi2Error;
    }
    if (!isfinite(change)) {
        return log_report(instance, fmi2Discard,
                          "fmi2GetDirectionalDerivative: dvKnown of %s = %g refused, allowed: finite",
                          variable->name, change);
    }
    return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[], size_t nKnown,
                                        const fmi2Real dvKnown[], fmi2Real dvUnknown[])
{
    struct instance *instance = c;
    const enum call call = CALL_GetDirectionalDerivative;
    if (!call_allowed(instance, call) ||
        !call_array_given(instance, call, "vUnknown_ref", vUnknown_ref, nUnknown) ||
        !call_array_given(instance, call, "vKnown_ref", vKnown_ref, nKnown) ||
        !call_array_given(instance, call, "dvKnown", dvKnown, nKnown) ||
        !call_array_given(instance, call, "dvUnknown", dvUnknown, nUnknown)) {
        return fmi2Error;
    }
    for (size_t i = 0; i < nUnknown; ++i) {
        if (!is_unknown(instance, vUnknown_ref[i])) {
            return fmi2Error;
        }
    }
    for (size_t i = 0; i < nKnown; ++i) {
        const fmi2Status status = check_known(instance, vKnown_ref[i], dvKnown[i]);
        if (status != fmi2OK) {
            return status;
        }
    }
    return status_of(model_get_directional_derivative(instance->model, vUnknown_ref, nUnknown, vKnown_ref,
                                                      nKnown, dvKnown, dvUnknown));
}
