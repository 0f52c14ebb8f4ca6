/*
 * Event mode. A contact that begins or ends has changed its regime when fmi3DoStep returns: nothing is left
 * to iterate, and nothing is scheduled.
 */
#include "fmi/lifecycle.h"
#include "fmi3/call_order.h"

fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
    struct fmi3_instance *own = c;
    if (!call_allowed(c, CALL(EnterEventMode))) {
        return fmi3Error;
    }
    if (!own->event_mode_used) {
        return status_of(call_refuse(c, CALL(EnterEventMode), "instantiated with eventModeUsed = false"));
    }
    own->shared.phase = PHASE_EVENT;
    return fmi3OK;
}

fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
    return status_of(instance_enter(c, CALL(EnterStepMode), PHASE_STEP));
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation,
                                    fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged,
                                    fmi3Boolean *nextEventTimeDefined, fmi3Float64 *nextEventTime)
{
    const struct call *call = CALL(UpdateDiscreteStates);
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
    *discreteStatesNeedUpdate = fmi3False;
    *terminateSimulation = fmi3False;
    *nominalsOfContinuousStatesChanged = fmi3False;
    *valuesOfContinuousStatesChanged = fmi3False;
    *nextEventTimeDefined = fmi3False;
    *nextEventTime = 0.0;
    return fmi3OK;
}
