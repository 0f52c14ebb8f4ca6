#include "fmi/step.h"

#include <float.h>

#include "fmi/log.h"
#include "model/shortest.h"

/*
 * How far two times that should agree may differ: importers add up step sizes, which rounds. Part of a step
 * of size h, or a few units in the last place of the time t where steps are that small.
 */
static double time_slack(double t, double h)
{
    const double relative = 4.0 * DBL_EPSILON * fabs(t);
    return STEP_SLACK * h > relative ? STEP_SLACK * h : relative;
}

static enum model_status refuse_step_size(struct instance *instance, const struct call *call, double time,
                                          double size)
{
    return log_report(instance, MODEL_DISCARD,
                      "%s: communicationStepSize = %s s, allowed: finite and large enough to change the "
                      "time %s s, that is more than %.3g s",
                      call->name, shortest_digits(size).text, shortest_digits(time).text,
                      DBL_EPSILON * fabs(time));
}

enum model_status step_check(struct instance *instance, const struct call *call, double point, double size)
{
    const double time = model_time(instance->model);
    if (!(size > 0.0)) {
        return refuse_step_size(instance, call, time, size);
    }
    /* written so that a NaN is refused */
    if (!(fabs(point - time) <= time_slack(time, size))) {
        return log_report(instance, MODEL_ERROR,
                          "%s: currentCommunicationPoint = %s s, expected the time reached, %s s", call->name,
                          shortest_digits(point).text, shortest_digits(time).text);
    }
    const double end = point + size; /* infinite where the size is */
    if (!(end > time && end <= DBL_MAX)) {
        return refuse_step_size(instance, call, time, size);
    }
    const double stop = instance->experiment.stop_time;
    if (end > stop + time_slack(stop, size)) {
        return log_report(instance, MODEL_ERROR, "%s: step to %s s goes past stopTime = %s s", call->name,
                          shortest_digits(end).text, shortest_digits(stop).text);
    }
    return MODEL_OK;
}

enum model_status step_end(struct instance *instance, enum model_status status)
{
    if (status == MODEL_ERROR) {
        instance->phase = PHASE_ERROR;
    } else if (status == MODEL_FATAL) {
        instance->phase = PHASE_FATAL;
    }
    return status;
}
