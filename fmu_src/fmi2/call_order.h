/* Which function of FMI 2.0 may be called in which phase: one row, one mask a function. */
#ifndef CONTACT_FMI2_CALL_ORDER_H
#define CONTACT_FMI2_CALL_ORDER_H

#include "fmi/call_order.h"
#include "fmi2/instance.h"

#define PHASES2_SETTABLE (PHASE_INSTANTIATED | PHASE_INITIALIZATION | PHASE_STEP | PHASE_EVENT)
#define PHASES2_STEPPED (PHASE_STEP | PHASE_TERMINATED | PHASE_ERROR)
#define PHASES2_EXCHANGED (PHASE_EVENT | PHASE_CONTINUOUS)
#define PHASES2_INITIALIZED (PHASE_INITIALIZATION | PHASES2_EXCHANGED | PHASES2_STEPPED)
#define PHASES2_ALL (PHASE_INSTANTIATED | PHASES2_INITIALIZED)
/* In which a state vector can be read. */
#define PHASES2_OF_STATES (PHASE_INITIALIZATION | PHASES2_EXCHANGED | PHASE_TERMINATED | PHASE_ERROR)

/*
 * After the tables "calling sequence" of FMI 2.0.5, sections 3.2.3 and 4.2.4: an instance of Model Exchange
 * is never in step mode, one of Co-Simulation never in event or continuous-time mode. Two harmless
 * extensions: values may be read while instantiated (values.c: only those that have a start value), and the
 * status functions answer after a failed step too. fmi2CancelStep needs a step in progress, which never is.
 */
#define CALL2_TABLE(ROW)                                                                                     \
    ROW(SetDebugLogging, PHASES2_ALL)                                                                        \
    ROW(SetupExperiment, PHASE_INSTANTIATED)                                                                 \
    ROW(EnterInitializationMode, PHASE_INSTANTIATED)                                                         \
    ROW(ExitInitializationMode, PHASE_INITIALIZATION)                                                        \
    ROW(Terminate, PHASE_STEP | PHASES2_EXCHANGED)                                                           \
    ROW(Reset, PHASES2_ALL)                                                                                  \
    ROW(GetReal, PHASES_READ(PHASES2_ALL))                                                                   \
    ROW(GetInteger, PHASES_READ(PHASES2_ALL))                                                                \
    ROW(GetBoolean, PHASES_READ(PHASES2_ALL))                                                                \
    ROW(GetString, PHASES_READ(PHASES2_ALL))                                                                 \
    ROW(SetReal, PHASES2_SETTABLE | PHASE_CONTINUOUS)                                                        \
    ROW(SetInteger, PHASES2_SETTABLE)                                                                        \
    ROW(SetBoolean, PHASES2_SETTABLE)                                                                        \
    ROW(SetString, PHASES2_SETTABLE)                                                                         \
    ROW(GetFMUstate, PHASES2_ALL)                                                                            \
    ROW(SetFMUstate, PHASES2_ALL)                                                                            \
    ROW(FreeFMUstate, PHASES2_ALL)                                                                           \
    ROW(SerializedFMUstateSize, PHASES_READ(PHASES2_ALL))                                                    \
    ROW(SerializeFMUstate, PHASES_READ(PHASES2_ALL))                                                         \
    ROW(DeSerializeFMUstate, PHASES2_ALL)                                                                    \
    ROW(GetDirectionalDerivative, PHASES_READ(PHASES2_INITIALIZED))                                          \
    ROW(SetRealInputDerivatives, PHASE_INSTANTIATED | PHASE_INITIALIZATION | PHASE_STEP)                     \
    ROW(GetRealOutputDerivatives, PHASES_READ(PHASES2_STEPPED))                                              \
    ROW(DoStep, PHASE_STEP)                                                                                  \
    ROW(CancelStep, 0)                                                                                       \
    ROW(GetStatus, PHASES_READ(PHASES2_STEPPED))                                                             \
    ROW(GetRealStatus, PHASES_READ(PHASES2_STEPPED))                                                         \
    ROW(GetIntegerStatus, PHASES_READ(PHASES2_STEPPED))                                                      \
    ROW(GetBooleanStatus, PHASES_READ(PHASES2_STEPPED))                                                      \
    ROW(GetStringStatus, PHASES_READ(PHASES2_STEPPED))                                                       \
    ROW(EnterEventMode, PHASES2_EXCHANGED)                                                                   \
    ROW(NewDiscreteStates, PHASE_EVENT)                                                                      \
    ROW(EnterContinuousTimeMode, PHASE_EVENT)                                                                \
    ROW(CompletedIntegratorStep, PHASE_CONTINUOUS)                                                           \
    ROW(SetTime, PHASES2_EXCHANGED)                                                                          \
    ROW(SetContinuousStates, PHASE_CONTINUOUS)                                                               \
    ROW(GetDerivatives, PHASES_READ(PHASES2_OF_STATES))                                                      \
    ROW(GetEventIndicators, PHASES_READ(PHASES2_OF_STATES))                                                  \
    ROW(GetContinuousStates, PHASES_READ(PHASES2_OF_STATES))                                                 \
    ROW(GetNominalsOfContinuousStates, PHASES_READ(PHASE_INSTANTIATED | PHASES2_OF_STATES))

#define CALL2_NAME(function, phases) CALL2_##function,
enum fmi2_call { CALL2_TABLE(CALL2_NAME) CALL2_COUNT };
#undef CALL2_NAME

extern const struct call calls_of_fmi2[];

#define CALL2(function) (&calls_of_fmi2[CALL2_##function])

#endif
