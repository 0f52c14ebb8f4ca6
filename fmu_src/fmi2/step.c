/* Communication steps and what can be asked about the last one. */
#include <float.h>
#include <math.h>

#include "fmi2/call_order.h"
#include "fmi2/log.h"

/* Part of a step size by which two times that should agree may differ. */
#define STEP_SLACK 1e-6

/*
 * How far two times that should agree may differ: importers add up step sizes, which rounds. Part of a step
 * of size h, or a few units in the last place of the time t where steps are that small.
 */
static double time_slack(double t, double h)
{
    const double relative = 4.0 * DBL_EPSILON * fabs(t);
    return STEP_SLACK * h > relative ? STEP_SLACK * h : relative;
}

static fmi2Status refuse_step_size(struct instance *instance, double time, double size)
{
    return log_report(
        instance, fmi2Discard,
        "fmi2DoStep: communicationStepSize = %.17g s, allowed: finite and large enough to change the "
        "time %.17g s, that is more than %.3g s",
        size, time, DBL_EPSILON * fabs(time));
}

/*
 * Whether a step is in order at first sight. What passes here passes in checked_step, whose limits are wider;
 * what does not is left to it. A size of zero, below zero or NaN never passes; an infinite one does where
 * there is no stop time, but model_step_deferred goes no such way.
 */
static inline bool plainly_in_order(const struct instance *instance, double point, double size)
{
    const double time = model_time(instance->model);
    const double end = point + size;
    return instance->phase == PHASE_STEP && instance->step_status == fmi2OK &&
           fabs(point - time) <= STEP_SLACK * size && end > time && end <= instance->experiment.stop_time;
}

static fmi2Status checked_step(struct instance *instance, double point, double size)
{
    const double time = model_time(instance->model);
    if (!(size > 0.0)) {
        return refuse_step_size(instance, time, size);
    }
    /* written so that a NaN is refused */
    if (!(fabs(point - time) <= time_slack(time, size))) {
        return log_report(
            instance, fmi2Error,
            "fmi2DoStep: currentCommunicationPoint = %.17g s, expected the time reached, %.17g s", point,
            time);
    }
    const double end = point + size; /* infinite where the size is */
    if (!(end > time && end <= DBL_MAX)) {
        return refuse_step_size(instance, time, size);
    }
    const double stop = instance->experiment.stop_time;
    if (end > stop + time_slack(stop, size)) {
        return log_report(instance, fmi2Error, "fmi2DoStep: step to %.17g s goes past stopTime = %.17g s",
                          end, stop);
    }
    const fmi2Status status = status_of(model_step(instance->model, end));
    if (status == fmi2Error) {
        instance->phase = PHASE_ERROR;
    } else if (status == fmi2Fatal) {
        instance->phase = PHASE_FATAL;
    }
    return status;
}

/* Any step, with messages. Apart from fmi2DoStep, so that a deferred flight does not save registers for
 * it. */
__attribute__((noinline)) static fmi2Status do_step(struct instance *instance, double point, double size)
{
    if (!call_allowed(instance, CALL_DoStep)) {
        return fmi2Error;
    }
    instance->step_status = checked_step(instance, point, size);
    return instance->step_status;
}

/*
 * Nothing is kept for going back (states are saved on request), so noSetFMUStatePriorToCurrentPoint is idle.
 * Flattened, because calls would be a good part of what a deferred flight costs.
 */
__attribute__((flatten)) fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                                               fmi2Real communicationStepSize,
                                               fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    struct instance *instance = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (instance == NULL) {
        return fmi2Error;
    }
    if (plainly_in_order(instance, currentCommunicationPoint, communicationStepSize) &&
        model_step_deferred(instance->model, currentCommunicationPoint + communicationStepSize)) {
        return fmi2OK; /* as the step before, so that step_status need not be written */
    }
    return do_step(instance, currentCommunicationPoint, communicationStepSize);
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    (void)call_allowed(c, CALL_CancelStep); /* says that nothing runs */
    return fmi2Error;
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
static fmi2Status ask_status(struct instance *instance, enum call call, fmi2StatusKind kind,
                             const char *answered, bool known, const void *value)
{
    if (!call_allowed(instance, call) || !call_array_given(instance, call, "value", value, 1)) {
        return fmi2Error;
    }
    if (!known) {
        return log_report(instance, fmi2Discard, "%s: %s is not available, allowed: %s", call_name(call),
                          status_kind_name(kind), answered);
    }
    return fmi2OK;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    struct instance *instance = c;
    const fmi2Status asked =
        ask_status(instance, CALL_GetStatus, s, "fmi2DoStepStatus", s == fmi2DoStepStatus, value);
    if (asked == fmi2OK) {
        *value = instance->step_status;
    }
    return asked;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    struct instance *instance = c;
    const bool known = s == fmi2LastSuccessfulTime;
    const fmi2Status asked =
        ask_status(instance, CALL_GetRealStatus, s, "fmi2LastSuccessfulTime", known, value);
    if (asked == fmi2OK) {
        *value = model_time(instance->model);
    }
    return asked;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    return ask_status(c, CALL_GetIntegerStatus, s, "none", false, value);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    const fmi2Status asked =
        ask_status(c, CALL_GetBooleanStatus, s, "fmi2Terminated", s == fmi2Terminated, value);
    if (asked == fmi2OK) {
        *value = fmi2False; /* the model never ends a run by itself */
    }
    return asked;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    return ask_status(c, CALL_GetStringStatus, s, "none", false, value);
}
