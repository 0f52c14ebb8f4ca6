/*
 * Functions of the standard for what these FMUs do not have: there, because importers look for all of them,
 * and refused in words.
 */
#include "fmi3/call_order.h"

static const char NO_CLOCKS[] = "there are no clocks";
static const char NO_PARTITIONS[] = "there are no model partitions, Scheduled Execution is not provided";
static const char NO_STRUCTURE[] = "there are no structural parameters";
static const char NO_EVALUATION[] = "providesEvaluateDiscreteStates is false";
static const char NO_ELEMENTS[] = "providesPerElementDependencies is false";
static const char NO_MODEL_EXCHANGE[] = "Model Exchange is not provided";

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        fmi3Clock values[])
{
    (void)valueReferences, (void)nValueReferences, (void)values;
    return status_of(call_refuse(c, CALL(GetClock), NO_CLOCKS));
}

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        const fmi3Clock values[])
{
    (void)valueReferences, (void)nValueReferences, (void)values;
    return status_of(call_refuse(c, CALL(SetClock), NO_CLOCKS));
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                  size_t nValueReferences, fmi3Float64 intervals[],
                                  fmi3IntervalQualifier qualifiers[])
{
    (void)valueReferences, (void)nValueReferences, (void)intervals, (void)qualifiers;
    return status_of(call_refuse(c, CALL(GetIntervalDecimal), NO_CLOCKS));
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                   size_t nValueReferences, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                   fmi3IntervalQualifier qualifiers[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions, (void)qualifiers;
    return status_of(call_refuse(c, CALL(GetIntervalFraction), NO_CLOCKS));
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference valueReferences[],
                               size_t nValueReferences, fmi3Float64 shifts[])
{
    (void)valueReferences, (void)nValueReferences, (void)shifts;
    return status_of(call_refuse(c, CALL(GetShiftDecimal), NO_CLOCKS));
}

fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                size_t nValueReferences, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
    return status_of(call_refuse(c, CALL(GetShiftFraction), NO_CLOCKS));
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                  size_t nValueReferences, const fmi3Float64 intervals[])
{
    (void)valueReferences, (void)nValueReferences, (void)intervals;
    return status_of(call_refuse(c, CALL(SetIntervalDecimal), NO_CLOCKS));
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                   size_t nValueReferences, const fmi3UInt64 counters[],
                                   const fmi3UInt64 resolutions[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
    return status_of(call_refuse(c, CALL(SetIntervalFraction), NO_CLOCKS));
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference valueReferences[],
                               size_t nValueReferences, const fmi3Float64 shifts[])
{
    (void)valueReferences, (void)nValueReferences, (void)shifts;
    return status_of(call_refuse(c, CALL(SetShiftDecimal), NO_CLOCKS));
}

fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                size_t nValueReferences, const fmi3UInt64 counters[],
                                const fmi3UInt64 resolutions[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
    return status_of(call_refuse(c, CALL(SetShiftFraction), NO_CLOCKS));
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clockReference,
                                      fmi3Float64 activationTime)
{
    (void)clockReference, (void)activationTime;
    return status_of(call_refuse(c, CALL(ActivateModelPartition), NO_PARTITIONS));
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    return status_of(call_refuse(c, CALL(EnterConfigurationMode), NO_STRUCTURE));
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    return status_of(call_refuse(c, CALL(ExitConfigurationMode), NO_STRUCTURE));
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c)
{
    return status_of(call_refuse(c, CALL(EvaluateDiscreteStates), NO_EVALUATION));
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference valueReference,
                                               size_t *nDependencies)
{
    (void)valueReference, (void)nDependencies;
    return status_of(call_refuse(c, CALL(GetNumberOfVariableDependencies), NO_ELEMENTS));
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent,
                                       size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
                                       size_t elementIndicesOfIndependents[],
                                       fmi3DependencyKind dependencyKinds[], size_t nDependencies)
{
    (void)dependent, (void)elementIndicesOfDependent, (void)independents, (void)elementIndicesOfIndependents,
        (void)dependencyKinds, (void)nDependencies;
    return status_of(call_refuse(c, CALL(GetVariableDependencies), NO_ELEMENTS));
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c)
{
    return status_of(call_refuse(c, CALL(EnterContinuousTimeMode), NO_MODEL_EXCHANGE));
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation)
{
    (void)noSetFMUStatePriorToCurrentPoint, (void)enterEventMode, (void)terminateSimulation;
    return status_of(call_refuse(c, CALL(CompletedIntegratorStep), NO_MODEL_EXCHANGE));
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time)
{
    (void)time;
    return status_of(call_refuse(c, CALL(SetTime), NO_MODEL_EXCHANGE));
}

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 continuousStates[],
                                   size_t nContinuousStates)
{
    (void)continuousStates, (void)nContinuousStates;
    return status_of(call_refuse(c, CALL(SetContinuousStates), NO_MODEL_EXCHANGE));
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[],
                                             size_t nContinuousStates)
{
    (void)derivatives, (void)nContinuousStates;
    return status_of(call_refuse(c, CALL(GetContinuousStateDerivatives), NO_MODEL_EXCHANGE));
}

fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 eventIndicators[], size_t nEventIndicators)
{
    (void)eventIndicators, (void)nEventIndicators;
    return status_of(call_refuse(c, CALL(GetEventIndicators), NO_MODEL_EXCHANGE));
}

fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 continuousStates[], size_t nContinuousStates)
{
    (void)continuousStates, (void)nContinuousStates;
    return status_of(call_refuse(c, CALL(GetContinuousStates), NO_MODEL_EXCHANGE));
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t nContinuousStates)
{
    (void)nominals, (void)nContinuousStates;
    return status_of(call_refuse(c, CALL(GetNominalsOfContinuousStates), NO_MODEL_EXCHANGE));
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *nEventIndicators)
{
    (void)nEventIndicators;
    return status_of(call_refuse(c, CALL(GetNumberOfEventIndicators), NO_MODEL_EXCHANGE));
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *nContinuousStates)
{
    (void)nContinuousStates;
    return status_of(call_refuse(c, CALL(GetNumberOfContinuousStates), NO_MODEL_EXCHANGE));
}
