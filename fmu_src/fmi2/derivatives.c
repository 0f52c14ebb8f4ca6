/* Derivatives with respect to time of inputs and outputs. */
#include <math.h>

#include "fmi2/call_order.h"
#include "fmi2/log.h"

/* maxOutputDerivativeOrder of the model description; inputs are polynomials of second degree at most. */
enum { LOWEST_ORDER = 1, HIGHEST_INPUT_ORDER = 2, HIGHEST_OUTPUT_ORDER = 1 };

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
                              fmi2Integer order, int highest)
{
    if (order < LOWEST_ORDER || order > highest) {
        return log_report(instance, fmi2Discard,
                          "%s: derivative of order %d of %s refused, allowed: %d to %d", call_name(call),
                          order, variable->name, LOWEST_ORDER, highest);
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
    const fmi2Status status =
        check_order(instance, CALL_SetRealInputDerivatives, variable, order, HIGHEST_INPUT_ORDER);
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

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[])
{
    struct instance *instance = c;
    if (!arrays_given(instance, CALL_GetRealOutputDerivatives, vr, nvr, order, value)) {
        return fmi2Error;
    }
    for (size_t i = 0; i < nvr; ++i) {
        const struct variable *variable =
            find_real(instance, CALL_GetRealOutputDerivatives, vr[i], VARIABLE_OUTPUT);
        if (variable == NULL) {
            return fmi2Error;
        }
        fmi2Status status =
            check_order(instance, CALL_GetRealOutputDerivatives, variable, order[i], HIGHEST_OUTPUT_ORDER);
        if (status == fmi2OK) {
            status = status_of(model_get_output_derivative(instance->model, variable, order[i], &value[i]));
        }
        if (status > fmi2Warning) {
            return status;
        }
    }
    return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[], size_t nKnown,
                                        const fmi2Real dvKnown[], fmi2Real dvUnknown[])
{
    struct instance *instance = c;
    (void)vUnknown_ref;
    (void)nUnknown;
    (void)vKnown_ref;
    (void)nKnown;
    (void)dvKnown;
    (void)dvUnknown;
    if (call_allowed(instance, CALL_GetDirectionalDerivative)) {
        log_report(instance, fmi2Error,
                   "fmi2GetDirectionalDerivative: not provided (providesDirectionalDerivative is false)");
    }
    return fmi2Error;
}
