/* Setting up, starting, ending and resetting an instance; instantiate.c creates it. */
#include "fmi/lifecycle.h"

#include "fmi/log.h"
#include "fmi3/call_order.h"

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

void fmi3FreeInstance(fmi3Instance c)
{
    instance_free(c);
}

/* Named categories are switched on or off beside the others; none are all of them (FMI 3.0.2, section
 * 2.3.1). */
fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[])
{
    struct instance *instance = c;
    unsigned chosen = 0;
    const enum model_status status =
        instance_categories(instance, CALL3(SetDebugLogging), nCategories, categories, &chosen);
    if (status == MODEL_OK) {
        const unsigned bits = nCategories == 0 ? (unsigned)LOG_ALL : chosen;
        instance->log_categories =
            loggingOn ? instance->log_categories | bits : instance->log_categories & ~bits;
    }
    return fmi3_status(status);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined,
                                       fmi3Float64 stopTime)
{
    struct instance *instance = c;
    const enum model_status status =
        instance_set_up(instance, CALL3(EnterInitializationMode), toleranceDefined, tolerance, startTime,
                        stopTimeDefined, stopTime);
    if (status <= MODEL_WARNING) {
        instance->phase = PHASE_INITIALIZATION;
    }
    return fmi3_status(status);
}

/* With event mode the run begins there, and so it does in Model Exchange. */
fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    const struct fmi3_instance *own = c;
    const bool events = own != NULL && (own->event_mode_used || own->shared.host.exchange);
    const enum phase next = events ? PHASE_EVENT : PHASE_STEP;
    return fmi3_status(instance_exit_initialization(c, CALL3(ExitInitializationMode), next));
}

fmi3Status fmi3Terminate(fmi3Instance c)
{
    return fmi3_status(instance_enter(c, CALL3(Terminate), PHASE_TERMINATED));
}

fmi3Status fmi3Reset(fmi3Instance c)
{
    return fmi3_status(instance_reset(c, CALL3(Reset)));
}
