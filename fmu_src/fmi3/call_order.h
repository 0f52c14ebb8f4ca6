/* Which function of FMI 3.0 may be called in which phase: one row, one mask a function. */
#ifndef CONTACT_FMI3_CALL_ORDER_H
#define CONTACT_FMI3_CALL_ORDER_H

#include "fmi/call_order.h"
#include "fmi3/instance.h"

#define PHASES3_SETTABLE (PHASE_INSTANTIATED | PHASE_INITIALIZATION | PHASE_STEP | PHASE_EVENT)
#define PHASES3_STEPPED (PHASE_STEP | PHASE_TERMINATED | PHASE_ERROR)
#define PHASES3_EXCHANGED (PHASE_EVENT | PHASE_CONTINUOUS)
#define PHASES3_INITIALIZED (PHASE_INITIALIZATION | PHASES3_EXCHANGED | PHASES3_STEPPED)
#define PHASES3_ALL (PHASE_INSTANTIATED | PHASES3_INITIALIZED)
/* In which a state vector can be read. */
#define PHASES3_OF_STATES (PHASE_INITIALIZATION | PHASES3_EXCHANGED | PHASE_TERMINATED | PHASE_ERROR)
/* In an intermediate update outputs are read, and the logger may be told of it. */
#define PHASES3_WITHIN(phases) (PHASES_READ(phases) | PHASE_INTERMEDIATE)

/* Rows of all types of variables but Float64, whether there are such variables or not. */
#define CALL_TYPES(ROW, Verb, phases)                                                                        \
    ROW(Verb##Float32, phases)                                                                               \
    ROW(Verb##Int8, phases)                                                                                  \
    ROW(Verb##UInt8, phases)                                                                                 \
    ROW(Verb##Int16, phases)                                                                                 \
    ROW(Verb##UInt16, phases)                                                                                \
    ROW(Verb##Int32, phases)                                                                                 \
    ROW(Verb##UInt32, phases)                                                                                \
    ROW(Verb##Int64, phases)                                                                                 \
    ROW(Verb##UInt64, phases)                                                                                \
    ROW(Verb##Boolean, phases)                                                                               \
    ROW(Verb##String, phases)                                                                                \
    ROW(Verb##Binary, phases)

/* What is never in order: there are no clocks and no structural parameters (absent.c). */
#define CALL_ABSENT(ROW)                                                                                     \
    ROW(GetClock, 0)                                                                                         \
    ROW(SetClock, 0)                                                                                         \
    ROW(GetIntervalDecimal, 0)                                                                               \
    ROW(GetIntervalFraction, 0)                                                                              \
    ROW(GetShiftDecimal, 0)                                                                                  \
    ROW(GetShiftFraction, 0)                                                                                 \
    ROW(SetIntervalDecimal, 0)                                                                               \
    ROW(SetIntervalFraction, 0)                                                                              \
    ROW(SetShiftDecimal, 0)                                                                                  \
    ROW(SetShiftFraction, 0)                                                                                 \
    ROW(ActivateModelPartition, 0)                                                                           \
    ROW(EnterConfigurationMode, 0)                                                                           \
    ROW(ExitConfigurationMode, 0)                                                                            \
    ROW(EvaluateDiscreteStates, 0)                                                                           \
    ROW(GetNumberOfVariableDependencies, 0)                                                                  \
    ROW(GetVariableDependencies, 0)

/* Of Model Exchange alone (exchange.c). */
#define CALL_EXCHANGE(ROW)                                                                                   \
    ROW(EnterContinuousTimeMode, PHASE_EVENT)                                                                \
    ROW(CompletedIntegratorStep, PHASE_CONTINUOUS)                                                           \
    ROW(SetTime, PHASE_CONTINUOUS)                                                                           \
    ROW(SetContinuousStates, PHASE_CONTINUOUS)                                                               \
    ROW(GetContinuousStateDerivatives, PHASES_READ(PHASES3_OF_STATES))                                       \
    ROW(GetEventIndicators, PHASES_READ(PHASES3_OF_STATES))                                                  \
    ROW(GetContinuousStates, PHASES_READ(PHASES3_OF_STATES))                                                 \
    ROW(GetNominalsOfContinuousStates, PHASES_READ(PHASES3_OF_STATES))                                       \
    ROW(GetNumberOfEventIndicators, PHASES_READ(PHASES3_ALL))                                                \
    ROW(GetNumberOfContinuousStates, PHASES_READ(PHASES3_ALL))

/*
 * After the state machines of FMI 3.0.2, sections 2.3, 3.2 and 4.2: an instance of Model Exchange is never in
 * step mode, one of Co-Simulation never in continuous-time mode. Three harmless extensions: values may be
 * read while instantiated (only those that have a start value), and between setting an input and the next
 * step; how many states and event indicators there are is always told.
 */
#define CALL3_TABLE(ROW)                                                                                     \
    ROW(SetDebugLogging, PHASES3_ALL)                                                                        \
    ROW(EnterInitializationMode, PHASE_INSTANTIATED)                                                         \
    ROW(ExitInitializationMode, PHASE_INITIALIZATION)                                                        \
    ROW(EnterEventMode, PHASE_STEP | PHASE_CONTINUOUS)                                                       \
    ROW(UpdateDiscreteStates, PHASE_EVENT)                                                                   \
    ROW(EnterStepMode, PHASE_EVENT)                                                                          \
    ROW(Terminate, PHASE_STEP | PHASES3_EXCHANGED)                                                           \
    ROW(Reset, PHASES3_ALL)                                                                                  \
    ROW(GetFloat64, PHASES3_WITHIN(PHASES3_ALL))                                                             \
    CALL_TYPES(ROW, Get, PHASES3_WITHIN(PHASES3_ALL))                                                        \
    ROW(SetFloat64, PHASES3_SETTABLE | PHASE_CONTINUOUS)                                                     \
    CALL_TYPES(ROW, Set, PHASES3_SETTABLE)                                                                   \
    ROW(GetFMUState, PHASES3_ALL)                                                                            \
    ROW(SetFMUState, PHASES3_ALL)                                                                            \
    ROW(FreeFMUState, PHASES3_ALL)                                                                           \
    ROW(SerializedFMUStateSize, PHASES_READ(PHASES3_ALL))                                                    \
    ROW(SerializeFMUState, PHASES_READ(PHASES3_ALL))                                                         \
    ROW(DeserializeFMUState, PHASES3_ALL)                                                                    \
    ROW(GetDirectionalDerivative, PHASES_READ(PHASES3_INITIALIZED))                                          \
    ROW(GetAdjointDerivative, PHASES_READ(PHASES3_INITIALIZED))                                              \
    ROW(GetOutputDerivatives, PHASES3_WITHIN(PHASES3_STEPPED))                                               \
    ROW(DoStep, PHASE_STEP)                                                                                  \
    CALL_EXCHANGE(ROW)                                                                                       \
    CALL_ABSENT(ROW)

#define CALL3_NAME(function, phases) CALL3_##function,
enum fmi3_call { CALL3_TABLE(CALL3_NAME) CALL3_COUNT };
#undef CALL3_NAME

extern const struct call calls_of_fmi3[];

#define CALL3(function) (&calls_of_fmi3[CALL3_##function])

#endif
