/* Derivatives with respect to time of inputs and outputs, and of outputs with respect to inputs. */
#include "fmi/derivatives.h"

#include <math.h>

#include "fmi/log.h"
#include "fmi2/call_order.h"

static bool arrays_given(struct instance *instance, const struct call *call, const fmi2ValueReference vr[],
                         size_t nvr, const fmi2Integer order[], const fmi2Real value[])
{
    return call_allowed_in_steps(instance, call) && call_array_given(instance, call, "vr", vr, nvr) &&
           call_array_given(instance, call, "order", order, nvr) &&
           call_array_given(instance, call, "value", value, nvr);
}

static enum model_status check_input_derivative(struct instance *instance, fmi2ValueReference reference,
                                                fmi2Integer order, fmi2Real value)
{
    const struct variable *variable =
        find_real(instance, CALL2(SetRealInputDerivatives), reference, VARIABLE_INPUT);
    if (variable == NULL) {
        return MODEL_ERROR;
    }
    const enum model_status status = check_order(instance, CALL2(SetRealInputDerivatives), variable, order);
    if (status == MODEL_OK && !isfinite(value)) {
        return log_report(
            instance, MODEL_DISCARD,
            "fmi2SetRealInputDerivatives: derivative of order %d of %s = %g refused, allowed: finite", order,
            variable->name, value);
    }
    return status;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    struct instance *instance = c;
    if (!arrays_given(instance, CALL2(SetRealInputDerivatives), vr, nvr, order, value)) {
        return fmi2Error;
    }
    for (size_t i = 0; i < nvr; ++i) {
        const enum model_status status = check_input_derivative(instance, vr[i], order[i], value[i]);
        if (status != MODEL_OK) {
            return fmi2_status(status);
        }
    }
    enum model_status worst = MODEL_OK;
    for (size_t i = 0; i < nvr && worst <= MODEL_WARNING; ++i) {
        const struct variable *variable = scene_variable(vr[i]);
        const enum model_status status =
            model_set_input_derivative(instance->model, variable, order[i], value[i]);
        worst = status > worst ? status : worst;
    }
    return fmi2_status(worst);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[])
{
    struct instance *instance = c;
    return arrays_given(instance, CALL2(GetRealOutputDerivatives), vr, nvr, order, value)
               ? fmi2_status(
                     output_derivatives(instance, CALL2(GetRealOutputDerivatives), vr, order, nvr, value))
               : fmi2Error;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[], size_t nKnown,
                                        const fmi2Real dvKnown[], fmi2Real dvUnknown[])
{
    struct instance *instance = c;
    const struct call *call = CALL2(GetDirectionalDerivative);
    if (!call_allowed(instance, call) ||
        !call_array_given(instance, call, "vUnknown_ref", vUnknown_ref, nUnknown) ||
        !call_array_given(instance, call, "vKnown_ref", vKnown_ref, nKnown) ||
        !call_array_given(instance, call, "dvKnown", dvKnown, nKnown) ||
        !call_array_given(instance, call, "dvUnknown", dvUnknown, nUnknown)) {
        return fmi2Error;
    }
    enum model_status status = check_unknowns(instance, call, vUnknown_ref, nUnknown);
    for (size_t i = 0; i < nKnown && status == MODEL_OK; ++i) {
        status = check_known(instance, call, vKnown_ref[i]);
        status = status == MODEL_OK ? check_seed(instance, call, vKnown_ref[i], dvKnown[i]) : status;
    }
    if (status != MODEL_OK) {
        return fmi2_status(status);
    }
    return fmi2_status(model_get_directional_derivative(instance->model, vUnknown_ref, nUnknown, vKnown_ref,
                                                        nKnown, dvKnown, dvUnknown));
}
