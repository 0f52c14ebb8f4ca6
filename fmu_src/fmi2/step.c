/* Communication steps and what can be asked about the last one. */
#include "fmi/step.h"

#include "fmi/log.h"
#include "fmi2/call_order.h"
#include "math/compiler.h"

/* Any step, with messages. Apart from fmi2DoStep, so that a deferred flight does not save registers for
 * it. */
CONTACT_NOINLINE static fmi2Status fmi2_do_step(struct instance *instance, double point, double size)
{
    if (!call_allowed_in_steps(instance, CALL2(DoStep))) {
        return fmi2Error;
    }
    enum model_status status = step_check(instance, CALL2(DoStep), point, size);
    if (status == MODEL_OK) {
        status = step_end(instance, model_step(instance->model, point + size));
    }
    instance->step_status = status;
    return fmi2_status(status);
}

/*
 * Nothing is kept for going back (states are saved on request), so noSetFMUStatePriorToCurrentPoint is idle.
 * Flattened, because calls would be a good part of what a deferred flight costs.
 */
CONTACT_FLATTEN fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                                      fmi2Real communicationStepSize,
                                      fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    struct instance *instance = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (instance == NULL) {
        return fmi2Error;
    }
    if (step_plainly_in_order(instance, currentCommunicationPoint, communicationStepSize) &&
        model_step_deferred(instance->model, currentCommunicationPoint + communicationStepSize)) {
        return fmi2OK; /* as the step before, so that step_status need not be written */
    }
    return fmi2_do_step(instance, currentCommunicationPoint, communicationStepSize);
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return fmi2_status(call_refuse(c, CALL2(CancelStep), "no step is ever in progress here"));
}

static const char *status_kind_name(fmi2StatusKind kind)
{
    switch (kind) {
    case fmi2DoStepStatus:
        return "fmi2DoStepStatus";
    case fmi2PendingStatus:
        return "fmi2PendingStatus";
    case fmi2LastSuccessfulTime:
        return "fmi2LastSuccessfulTime";
    case fmi2Terminated:
        return "fmi2Terminated";
    }
    return "(unknown)";
}

/* Checks a status question. No call ever answers fmi2Pending, so fmi2PendingStatus has no answer either. */
static fmi2Status ask_status(struct instance *instance, const struct call *call, fmi2StatusKind kind,
                             const char *answered, bool known, const void *value)
{
    if (!call_allowed_in_steps(instance, call) || !call_array_given(instance, call, "value", value, 1)) {
        return fmi2Error;
    }
    if (!known) {
        return fmi2_status(log_report(instance, MODEL_DISCARD, "%s: %s is not available, allowed: %s",
                                      call->name, status_kind_name(kind), answered));
    }
    return fmi2OK;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    struct instance *instance = c;
    const fmi2Status asked =
        ask_status(instance, CALL2(GetStatus), s, "fmi2DoStepStatus", s == fmi2DoStepStatus, value);
    if (asked == fmi2OK) {
        *value = fmi2_status(instance->step_status);
    }
    return asked;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    struct instance *instance = c;
    const bool known = s == fmi2LastSuccessfulTime;
    const fmi2Status asked =
        ask_status(instance, CALL2(GetRealStatus), s, "fmi2LastSuccessfulTime", known, value);
    if (asked == fmi2OK) {
        *value = model_time(instance->model);
    }
    return asked;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    return ask_status(c, CALL2(GetIntegerStatus), s, "none", false, value);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    const fmi2Status asked =
        ask_status(c, CALL2(GetBooleanStatus), s, "fmi2Terminated", s == fmi2Terminated, value);
    if (asked == fmi2OK) {
        *value = fmi2False; /* the model never ends a run by itself */
    }
    return asked;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    return ask_status(c, CALL2(GetStringStatus), s, "none", false, value);
}
