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

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        fmi3Clock values[])
{
    (void)valueReferences, (void)nValueReferences, (void)values;
    return fmi3_status(call_refuse(c, CALL3(GetClock), NO_CLOCKS));
}

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        const fmi3Clock values[])
{
    (void)valueReferences, (void)nValueReferences, (void)values;
    return fmi3_status(call_refuse(c, CALL3(SetClock), NO_CLOCKS));
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                  size_t nValueReferences, fmi3Float64 intervals[],
                                  fmi3IntervalQualifier qualifiers[])
{
    (void)valueReferences, (void)nValueReferences, (void)intervals, (void)qualifiers;
    return fmi3_status(call_refuse(c, CALL3(GetIntervalDecimal), NO_CLOCKS));
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                   size_t nValueReferences, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                   fmi3IntervalQualifier qualifiers[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions, (void)qualifiers;
    return fmi3_status(call_refuse(c, CALL3(GetIntervalFraction), NO_CLOCKS));
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference valueReferences[],
                               size_t nValueReferences, fmi3Float64 shifts[])
{
    (void)valueReferences, (void)nValueReferences, (void)shifts;
    return fmi3_status(call_refuse(c, CALL3(GetShiftDecimal), NO_CLOCKS));
}

fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                size_t nValueReferences, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
    return fmi3_status(call_refuse(c, CALL3(GetShiftFraction), NO_CLOCKS));
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                  size_t nValueReferences, const fmi3Float64 intervals[])
{
    (void)valueReferences, (void)nValueReferences, (void)intervals;
    return fmi3_status(call_refuse(c, CALL3(SetIntervalDecimal), NO_CLOCKS));
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                   size_t nValueReferences, const fmi3UInt64 counters[],
                                   const fmi3UInt64 resolutions[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
    return fmi3_status(call_refuse(c, CALL3(SetIntervalFraction), NO_CLOCKS));
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference valueReferences[],
                               size_t nValueReferences, const fmi3Float64 shifts[])
{
    (void)valueReferences, (void)nValueReferences, (void)shifts;
    return fmi3_status(call_refuse(c, CALL3(SetShiftDecimal), NO_CLOCKS));
}

fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference valueReferences[],
                                size_t nValueReferences, const fmi3UInt64 counters[],
                                const fmi3UInt64 resolutions[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
    return fmi3_status(call_refuse(c, CALL3(SetShiftFraction), NO_CLOCKS));
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clockReference,
                                      fmi3Float64 activationTime)
{
    (void)clockReference, (void)activationTime;
    return fmi3_status(call_refuse(c, CALL3(ActivateModelPartition), NO_PARTITIONS));
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    return fmi3_status(call_refuse(c, CALL3(EnterConfigurationMode), NO_STRUCTURE));
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    return fmi3_status(call_refuse(c, CALL3(ExitConfigurationMode), NO_STRUCTURE));
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c)
{
    return fmi3_status(call_refuse(c, CALL3(EvaluateDiscreteStates), NO_EVALUATION));
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference valueReference,
                                               size_t *nDependencies)
{
    (void)valueReference, (void)nDependencies;
    return fmi3_status(call_refuse(c, CALL3(GetNumberOfVariableDependencies), NO_ELEMENTS));
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent,
                                       size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
                                       size_t elementIndicesOfIndependents[],
                                       fmi3DependencyKind dependencyKinds[], size_t nDependencies)
{
    (void)dependent, (void)elementIndicesOfDependent, (void)independents, (void)elementIndicesOfIndependents,
        (void)dependencyKinds, (void)nDependencies;
    return fmi3_status(call_refuse(c, CALL3(GetVariableDependencies), NO_ELEMENTS));
}
