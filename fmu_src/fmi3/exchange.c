/* Model Exchange by the names of FMI 3.0; event mode is in events.c. */
#include "fmi/exchange.h"
#include "fmi3/call_order.h"

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c)
{
    return fmi3_status(exchange_enter(c, CALL3(EnterContinuousTimeMode), PHASE_CONTINUOUS));
}

/* Nothing is kept for going back, so noSetFMUStatePriorToCurrentPoint is idle. */
fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation)
{
    const struct call *call = CALL3(CompletedIntegratorStep);
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!call_allowed_in_exchange(c, call) ||
        !call_array_given(c, call, "enterEventMode", enterEventMode, 1) ||
        !call_array_given(c, call, "terminateSimulation", terminateSimulation, 1)) {
        return fmi3Error;
    }
    *enterEventMode = fmi3False;
    *terminateSimulation = fmi3False;
    return fmi3_status(exchange_accept_step(c, call));
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time)
{
    return fmi3_status(exchange_set_time(c, CALL3(SetTime), time));
}

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 continuousStates[],
                                   size_t nContinuousStates)
{
    return fmi3_status(
        exchange_set_states(c, CALL3(SetContinuousStates), continuousStates, nContinuousStates));
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[],
                                             size_t nContinuousStates)
{
    return fmi3_status(exchange_get(c, CALL3(GetContinuousStateDerivatives), EXCHANGE_RATES, derivatives,
                                    nContinuousStates));
}

fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 eventIndicators[], size_t nEventIndicators)
{
    return fmi3_status(
        exchange_get(c, CALL3(GetEventIndicators), EXCHANGE_INDICATORS, eventIndicators, nEventIndicators));
}

fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 continuousStates[], size_t nContinuousStates)
{
    return fmi3_status(
        exchange_get(c, CALL3(GetContinuousStates), EXCHANGE_STATES, continuousStates, nContinuousStates));
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t nContinuousStates)
{
    return fmi3_status(
        exchange_get_nominals(c, CALL3(GetNominalsOfContinuousStates), nominals, nContinuousStates));
}

static fmi3Status put_count(struct instance *instance, const struct call *call, const char *argument,
                            size_t count, size_t *to)
{
    if (!call_allowed_in_exchange(instance, call) || !call_array_given(instance, call, argument, to, 1)) {
        return fmi3Error;
    }
    *to = count;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *nEventIndicators)
{
    return put_count(c, CALL3(GetNumberOfEventIndicators), "nEventIndicators", model_exchange_indicators(),
                     nEventIndicators);
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *nContinuousStates)
{
    return put_count(c, CALL3(GetNumberOfContinuousStates), "nContinuousStates", model_exchange_states(),
                     nContinuousStates);
}
