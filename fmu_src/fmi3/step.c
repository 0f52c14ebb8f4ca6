/* Communication steps, and the events and intermediate updates within them. */
#include "fmi/step.h"

#include <float.h>

#include "fmi3/call_order.h"

/* Tells the importer of an instant within the step; when it wants the step to end. */
static double tell_importer(struct fmi3_instance *own, double end_time)
{
    struct instance *instance = &own->shared;
    const double now = own->event_time;
    bool requested = false;
    double requested_time = end_time;
    instance->phase = (enum phase)(PHASE_STEP | PHASE_INTERMEDIATE);
    own->intermediate_update(own->environment, now, fmi3False, fmi3True, fmi3True, own->early_return_allowed,
                             &requested, &requested_time);
    instance->phase = PHASE_STEP;
    if (!requested || !own->early_return_allowed) {
        return end_time;
    }
    return requested_time > now ? fmin(requested_time, end_time) : now;
}

/* A contact begins or ends (struct step_request). */
static double at_event(void *context, double end_time)
{
    struct fmi3_instance *own = context;
    own->event_time = model_time(own->shared.model);
    if (own->intermediate_update != NULL) {
        end_time = tell_importer(own, end_time);
    }
    return own->event_mode_used && own->early_return_allowed ? own->event_time : end_time;
}

/* Where the step ended. */
struct outcome {
    fmi3Boolean *event, *terminate, *early;
    fmi3Float64 *time;
};

/* The model never ends a run by itself. */
static void put_outcome(const struct outcome *out, bool event, bool early, double time)
{
    *out->event = event;
    *out->terminate = fmi3False;
    *out->early = early;
    *out->time = time;
}

static bool outcome_wanted(struct instance *instance, const struct outcome *out)
{
    const struct call *call = CALL(DoStep);
    return call_array_given(instance, call, "eventHandlingNeeded", out->event, 1) &&
           call_array_given(instance, call, "terminateSimulation", out->terminate, 1) &&
           call_array_given(instance, call, "earlyReturn", out->early, 1) &&
           call_array_given(instance, call, "lastSuccessfulTime", out->time, 1);
}

/* Without early return a step that gets stuck is undone: FMI 3.0 knows no other fmi3Discard. */
static enum model_status take_checked_step(struct fmi3_instance *own, double end, const struct outcome *out)
{
    struct instance *instance = &own->shared;
    const struct step_request request = {
        .end_time = end,
        .at_event = own->event_mode_used || own->intermediate_update != NULL ? at_event : NULL,
        .context = own,
        .whole = true,
    };
    own->event_time = (double)NAN;
    const enum model_status status = step_end(instance, model_step_requested(instance->model, &request));
    const double time = model_time(instance->model);
    const bool event = own->event_mode_used && own->event_time == time;
    put_outcome(out, event, status <= MODEL_WARNING && end - time > 4.0 * DBL_EPSILON * fabs(end), time);
    return status;
}

/* Any step, with messages. */
static enum model_status do_step(struct instance *instance, double point, double size,
                                 const struct outcome *out)
{
    if (!call_allowed(instance, CALL(DoStep)) || !outcome_wanted(instance, out)) {
        return MODEL_ERROR;
    }
    enum model_status status = step_check(instance, CALL(DoStep), point, size);
    if (status == MODEL_OK) {
        status = take_checked_step((struct fmi3_instance *)instance, point + size, out);
    } else {
        put_outcome(out, false, false, model_time(instance->model));
    }
    instance->step_status = status;
    return status;
}

/*
 * Nothing is kept for going back (states are saved on request), so noSetFMUStatePriorToCurrentPoint is idle.
 */
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 currentCommunicationPoint,
                      fmi3Float64 communicationStepSize, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                      fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
                      fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    struct instance *instance = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    const struct outcome out = {eventHandlingNeeded, terminateSimulation, earlyReturn, lastSuccessfulTime};
    const double end = currentCommunicationPoint + communicationStepSize;
    if (instance != NULL && eventHandlingNeeded != NULL && terminateSimulation != NULL &&
        earlyReturn != NULL && lastSuccessfulTime != NULL &&
        step_plainly_in_order(instance, currentCommunicationPoint, communicationStepSize) &&
        model_step_deferred(instance->model, end)) {
        put_outcome(&out, false, false, model_time(instance->model));
        return fmi3OK; /* as the step before, so that step_status need not be written */
    }
    return status_of(do_step(instance, currentCommunicationPoint, communicationStepSize, &out));
}
