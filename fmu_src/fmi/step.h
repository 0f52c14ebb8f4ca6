/* Whether a communication step is in order, and what its status leaves behind. */
#ifndef CONTACT_FMI_STEP_H
#define CONTACT_FMI_STEP_H

#include <math.h>

#include "fmi/call_order.h"

/* Part of a step size by which two times that should agree may differ. */
#define STEP_SLACK 1e-6

/*
 * Whether a step is in order at first sight. What passes here passes in step_check, whose limits are wider;
 * what does not is left to it. A size of zero, below zero or NaN never passes; an infinite one does where
 * there is no stop time, but model_step_deferred goes no such way.
 */
static inline bool step_plainly_in_order(const struct instance *instance, double point, double size)
{
    const double time = model_time(instance->model);
    const double end = point + size;
    return instance->phase == PHASE_STEP && instance->step_status == MODEL_OK &&
           fabs(point - time) <= STEP_SLACK * size && end > time && end <= instance->experiment.stop_time;
}

/* Refuses a step of no length or from, or to, a wrong time. */
enum model_status step_check(struct instance *instance, const struct call *call, double point, double size);

/* Keeps the status of a step that was taken; after an error the instance is of little use any more. */
enum model_status step_end(struct instance *instance, enum model_status status);

#endif
