/*
 * Event mode. In Co-Simulation a contact that begins or ends has changed its regime when fmi3DoStep returns:
 * nothing is left to iterate, nor scheduled. In Model Exchange regimes change here, and touches of bodies in
 * flight are announced.
 */
#include "fmi/exchange.h"
#include "fmi/lifecycle.h"
#include "fmi3/call_order.h"

fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
    struct fmi3_instance *own = c;
    const struct call *call = CALL3(EnterEventMode);
    if (!call_allowed(c, call)) {
        return fmi3Error;
    }
    if (own->shared.host.exchange) {
        return fmi3_status(exchange_enter(c, call, PHASE_EVENT));
    }
    if (!own->event_mode_used) {
        return fmi3_status(call_refuse(c, call, "instantiated with eventModeUsed = false"));
    }
    own->shared.phase = PHASE_EVENT;
    return fmi3OK;
}

fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
    const struct call *call = CALL3(EnterStepMode);
    return call_allowed_in_steps(c, call) ? fmi3_status(instance_enter(c, call, PHASE_STEP)) : fmi3Error;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation,
                                    fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged,
                                    fmi3Boolean *nextEventTimeDefined, fmi3Float64 *nextEventTime)
{
    struct instance *instance = c;
    const struct call *call = CALL3(UpdateDiscreteStates);
    if (!call_allowed(c, call) ||
        !call_array_given(c, call, "discreteStatesNeedUpdate", discreteStatesNeedUpdate, 1) ||
        !call_array_given(c, call, "terminateSimulation", terminateSimulation, 1) ||
        !call_array_given(c, call, "nominalsOfContinuousStatesChanged", nominalsOfContinuousStatesChanged,
                          1) ||
        !call_array_given(c, call, "valuesOfContinuousStatesChanged", valuesOfContinuousStatesChanged, 1) ||
        !call_array_given(c, call, "nextEventTimeDefined", nextEventTimeDefined, 1) ||
        !call_array_given(c, call, "nextEventTime", nextEventTime, 1)) {
        return fmi3Error;
    }
    struct exchange_news news = {0};
    const enum model_status status =
        instance->host.exchange ? exchange_update(instance, call, &news) : MODEL_OK;
    *discreteStatesNeedUpdate = news.again;
    *terminateSimulation = fmi3False;
    *nominalsOfContinuousStatesChanged = fmi3False;
    *valuesOfContinuousStatesChanged = news.jumped;
    *nextEventTimeDefined = news.scheduled;
    *nextEventTime = news.event_time;
    return fmi3_status(status);
}
