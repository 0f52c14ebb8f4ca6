/* Model Exchange by the names of FMI 2.0. */
#include "fmi/exchange.h"
#include "fmi2/call_order.h"

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    return fmi2_status(exchange_enter(c, CALL2(EnterEventMode), PHASE_EVENT));
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    return fmi2_status(exchange_enter(c, CALL2(EnterContinuousTimeMode), PHASE_CONTINUOUS));
}

/* The model never ends a run by itself. */
fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *eventInfo)
{
    const struct call *call = CALL2(NewDiscreteStates);
    struct exchange_news news = {0};
    if (!call_allowed_in_exchange(c, call) || !call_array_given(c, call, "eventInfo", eventInfo, 1)) {
        return fmi2Error;
    }
    const enum model_status status = exchange_update(c, call, &news);
    *eventInfo = (fmi2EventInfo){.newDiscreteStatesNeeded = news.again ? fmi2True : fmi2False,
                                 .terminateSimulation = fmi2False,
                                 .nominalsOfContinuousStatesChanged = fmi2False,
                                 .valuesOfContinuousStatesChanged = news.jumped ? fmi2True : fmi2False,
                                 .nextEventTimeDefined = news.scheduled ? fmi2True : fmi2False,
                                 .nextEventTime = news.event_time};
    return fmi2_status(status);
}

/* Nothing is kept for going back, so noSetFMUStatePriorToCurrentPoint is idle. */
fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation)
{
    const struct call *call = CALL2(CompletedIntegratorStep);
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!call_allowed_in_exchange(c, call) ||
        !call_array_given(c, call, "enterEventMode", enterEventMode, 1) ||
        !call_array_given(c, call, "terminateSimulation", terminateSimulation, 1)) {
        return fmi2Error;
    }
    *enterEventMode = fmi2False;
    *terminateSimulation = fmi2False;
    return fmi2_status(exchange_accept_step(c, call));
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    return fmi2_status(exchange_set_time(c, CALL2(SetTime), time));
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx)
{
    return fmi2_status(exchange_set_states(c, CALL2(SetContinuousStates), x, nx));
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx)
{
    return fmi2_status(exchange_get(c, CALL2(GetDerivatives), EXCHANGE_RATES, derivatives, nx));
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real eventIndicators[], size_t ni)
{
    return fmi2_status(exchange_get(c, CALL2(GetEventIndicators), EXCHANGE_INDICATORS, eventIndicators, ni));
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx)
{
    return fmi2_status(exchange_get(c, CALL2(GetContinuousStates), EXCHANGE_STATES, x, nx));
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx)
{
    return fmi2_status(exchange_get_nominals(c, CALL2(GetNominalsOfContinuousStates), x_nominal, nx));
}
