/* Communication steps, and the events and intermediate updates within them. */
#include "fmi/step.h"

#include <float.h>

#include "fmi3/call_order.h"
#include "math/compiler.h"

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

/* Where to put what a step tells besides its status. */
struct results {
    fmi3Boolean *event, *terminate, *early;
    fmi3Float64 *time; /* reached [s] */
};

/* The model never ends a run by itself. */
static inline void put_results(const struct results *to, bool event, bool early, double time)
{
    *to->event = event;
    *to->terminate = fmi3False;
    *to->early = early;
    *to->time = time;
}

/* A step that gets stuck is undone: fmi3Discard leaves an instance as it was. */
static enum model_status take_checked_step(struct fmi3_instance *own, double end, const struct results *to)
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
    const bool early = status <= MODEL_WARNING && end - time > 4.0 * DBL_EPSILON * fabs(end);
    /* The model's time is a sum, which may differ from the end by a rounding: who goes on while its own time
     * is before the stop time is told the time that it asked for. */
    const bool reached = status <= MODEL_WARNING && !early;
    put_results(to, own->event_mode_used && own->event_time == time, early, reached ? end : time);
    return status;
}

static bool has_room(struct instance *instance, const char *name, const void *room)
{
    if (room == NULL) {
        (void)call_array_given(instance, CALL3(DoStep), name, NULL, 1); /* says so */
    }
    return room != NULL;
}

static bool have_room(struct instance *instance, const struct results *to)
{
    return has_room(instance, "eventHandlingNeeded", to->event) &&
           has_room(instance, "terminateSimulation", to->terminate) &&
           has_room(instance, "earlyReturn", to->early) && has_room(instance, "lastSuccessfulTime", to->time);
}

/* Any step, with messages. Apart from fmi3DoStep, so that a deferred flight does not save registers for it;
 * its arguments are so few that all of them are in registers. */
CONTACT_NOINLINE static fmi3Status fmi3_do_step(struct instance *instance, double point, double size,
                                                fmi3Boolean *event, fmi3Boolean *terminate,
                                                fmi3Boolean *early, fmi3Float64 *time)
{
    const struct results to = {event, terminate, early, time};
    if (!call_allowed_in_steps(instance, CALL3(DoStep)) || !have_room(instance, &to)) {
        return fmi3Error;
    }
    enum model_status status = step_check(instance, CALL3(DoStep), point, size);
    if (status == MODEL_OK) {
        status = take_checked_step((struct fmi3_instance *)instance, point + size, &to);
    } else {
        put_results(&to, false, false, model_time(instance->model));
    }
    instance->step_status = status;
    return fmi3_status(status);
}

/*
 * Nothing is kept for going back (states are saved on request), so noSetFMUStatePriorToCurrentPoint is idle.
 * Flattened, because calls would be a good part of what a deferred flight costs.
 */
CONTACT_FLATTEN fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 currentCommunicationPoint,
                                      fmi3Float64 communicationStepSize,
                                      fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                      fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
                                      fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    struct instance *instance = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (instance == NULL) {
        return fmi3Error;
    }
    if (eventHandlingNeeded != NULL && terminateSimulation != NULL && earlyReturn != NULL &&
        lastSuccessfulTime != NULL &&
        step_plainly_in_order(instance, currentCommunicationPoint, communicationStepSize) &&
        model_step_deferred(instance->model, currentCommunicationPoint + communicationStepSize)) {
        const struct results to = {eventHandlingNeeded, terminateSimulation, earlyReturn, lastSuccessfulTime};
        put_results(&to, false, false, currentCommunicationPoint + communicationStepSize);
        return fmi3OK; /* as the step before, so that step_status need not be written */
    }
    return fmi3_do_step(instance, currentCommunicationPoint, communicationStepSize, eventHandlingNeeded,
                        terminateSimulation, earlyReturn, lastSuccessfulTime);
}
