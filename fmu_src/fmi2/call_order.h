/* Which function of FMI 2.0 may be called in which phase: one row, one mask a function. */
#ifndef CONTACT_FMI2_CALL_ORDER_H
#define CONTACT_FMI2_CALL_ORDER_H

#include "fmi/call_order.h"
#include "fmi2/instance.h"

#define PHASES_SETTABLE (PHASE_INSTANTIATED | PHASE_INITIALIZATION | PHASE_STEP | PHASE_EVENT)
#define PHASES_STEPPED (PHASE_STEP | PHASE_TERMINATED | PHASE_ERROR)
#define PHASES_EXCHANGED (PHASE_EVENT | PHASE_CONTINUOUS)
#define PHASES_INITIALIZED (PHASE_INITIALIZATION | PHASES_EXCHANGED | PHASES_STEPPED)
#define PHASES_ALL (PHASE_INSTANTIATED | PHASES_INITIALIZED)
/* In which a state vector can be read. */
#define PHASES_OF_STATES (PHASE_INITIALIZATION | PHASES_EXCHANGED | PHASE_TERMINATED | PHASE_ERROR)

/*
 * After the tables "calling sequence" of FMI 2.0.5, sections 3.2.3 and 4.2.4: an instance of Model Exchange
 * is never in step mode, one of Co-Simulation never in event or continuous-time mode. Two harmless
 * extensions: values may be read while instantiated (values.c: only those that have a start value), and the
 * status functions answer after a failed step too. fmi2CancelStep needs a step in progress, which never is.
 */
#define CALL_TABLE(ROW)                                                                                      \
    ROW(SetDebugLogging, PHASES_ALL)                                                                         \
    ROW(SetupExperiment, PHASE_INSTANTIATED)                                                                 \
    ROW(EnterInitializationMode, PHASE_INSTANTIATED)                                                         \
    ROW(ExitInitializationMode, PHASE_INITIALIZATION)                                                        \
    ROW(Terminate, PHASE_STEP | PHASES_EXCHANGED)                                                            \
    ROW(Reset, PHASES_ALL)                                                                                   \
    ROW(GetReal, PHASES_READ(PHASES_ALL))                                                                    \
    ROW(GetInteger, PHASES_READ(PHASES_ALL))                                                                 \
    ROW(GetBoolean, PHASES_READ(PHASES_ALL))                                                                 \
    ROW(GetString, PHASES_READ(PHASES_ALL))                                                                  \
    ROW(SetReal, PHASES_SETTABLE | PHASE_CONTINUOUS)                                                         \
    ROW(SetInteger, PHASES_SETTABLE)                                                                         \
    ROW(SetBoolean, PHASES_SETTABLE)                                                                         \
    ROW(SetString, PHASES_SETTABLE)                                                                          \
    ROW(GetFMUstate, PHASES_ALL)                                                                             \
    ROW(SetFMUstate, PHASES_ALL)                                                                             \
    ROW(FreeFMUstate, PHASES_ALL)                                                                            \
    ROW(SerializedFMUstateSize, PHASES_READ(PHASES_ALL))                                                     \
    ROW(SerializeFMUstate, PHASES_READ(PHASES_ALL))                                                          \
    ROW(DeSerializeFMUstate, PHASES_ALL)                                                                     \
    ROW(GetDirectionalDerivative, PHASES_READ(PHASES_INITIALIZED))                                           \
    ROW(SetRealInputDerivatives, PHASE_INSTANTIATED | PHASE_INITIALIZATION | PHASE_STEP)                     \
    ROW(GetRealOutputDerivatives, PHASES_READ(PHASES_STEPPED))                                               \
    ROW(DoStep, PHASE_STEP)                                                                                  \
    ROW(CancelStep, 0)                                                                                       \
    ROW(GetStatus, PHASES_READ(PHASES_STEPPED))                                                              \
    ROW(GetRealStatus, PHASES_READ(PHASES_STEPPED))                                                          \
    ROW(GetIntegerStatus, PHASES_READ(PHASES_STEPPED))                                                       \
    ROW(GetBooleanStatus, PHASES_READ(PHASES_STEPPED))                                                       \
    ROW(GetStringStatus, PHASES_READ(PHASES_STEPPED))                                                        \
    ROW(EnterEventMode, PHASES_EXCHANGED)                                                                    \
    ROW(NewDiscreteStates, PHASE_EVENT)                                                                      \
    ROW(EnterContinuousTimeMode, PHASE_EVENT)                                                                \
    ROW(CompletedIntegratorStep, PHASE_CONTINUOUS)                                                           \
    ROW(SetTime, PHASES_EXCHANGED)                                                                           \
    ROW(SetContinuousStates, PHASE_CONTINUOUS)                                                               \
    ROW(GetDerivatives, PHASES_READ(PHASES_OF_STATES))                                                       \
    ROW(GetEventIndicators, PHASES_READ(PHASES_OF_STATES))                                                   \
    ROW(GetContinuousStates, PHASES_READ(PHASES_OF_STATES))                                                  \
    ROW(GetNominalsOfContinuousStates, PHASES_READ(PHASE_INSTANTIATED | PHASES_OF_STATES))

#define CALL_NAME(function, phases) CALL_##function,
enum fmi2_call { CALL_TABLE(CALL_NAME) CALL_COUNT };
#undef CALL_NAME

extern const struct call calls_of_fmi2[];

#define CALL(function) (&calls_of_fmi2[CALL_##function])

#endif
