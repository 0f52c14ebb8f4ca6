/*
 * FMI 2.0: each function of the standard works on an instance of fmi/instance.h.
 */
#include <fmi2Functions.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi/instance.h"
#include "math/compiler.h"
#include "scene.h"

/* An instance of FMI 2.0. An fmi2Component is the address of such a struct. */
struct fmi2_instance {
    struct instance shared; /* is the first member, so that both have one address */
    fmi2CallbackFunctions callbacks;
};

/* The model's statuses are fmi2Status values by another name. */
_Static_assert((int)MODEL_OK == (int)fmi2OK && (int)MODEL_WARNING == (int)fmi2Warning, "status order");
_Static_assert((int)MODEL_DISCARD == (int)fmi2Discard && (int)MODEL_ERROR == (int)fmi2Error, "status order");
_Static_assert((int)MODEL_FATAL == (int)fmi2Fatal, "status order");

/*
 * The table lists all functions of the standard that take an instance, the kind of instance and the phases in
 * which each may be called, after the tables "calling sequence" of FMI 2.0.5, sections 3.2.3 and 4.2.4. It
 * has two harmless extensions: variables that have a start value may be read while instantiated, and the
 * status functions answer after a failed step too. Model Exchange is never in step mode, Co-Simulation never
 * in event mode or continuous-time mode.
 */
#define CALL2_TABLE(ROW)                                                                                     \
    ROW(SetDebugLogging, ANY, PHASES_ALL)                                                                    \
    ROW(SetupExperiment, ANY, PHASE_INSTANTIATED)                                                            \
    ROW(EnterInitializationMode, ANY, PHASE_INSTANTIATED)                                                    \
    ROW(ExitInitializationMode, ANY, PHASE_INITIALIZATION)                                                   \
    ROW(Terminate, ANY, PHASE_STEP | PHASES_EXCHANGED)                                                       \
    ROW(Reset, ANY, PHASES_ALL)                                                                              \
    ROW(GetReal, ANY, PHASES_READ(PHASES_ALL))                                                               \
    ROW(GetInteger, ANY, PHASES_READ(PHASES_ALL))                                                            \
    ROW(GetBoolean, ANY, PHASES_READ(PHASES_ALL))                                                            \
    ROW(GetString, ANY, PHASES_READ(PHASES_ALL))                                                             \
    ROW(SetReal, ANY, PHASES_SETTABLE | PHASE_CONTINUOUS)                                                    \
    ROW(SetInteger, ANY, PHASES_SETTABLE)                                                                    \
    ROW(SetBoolean, ANY, PHASES_SETTABLE)                                                                    \
    ROW(SetString, ANY, PHASES_SETTABLE)                                                                     \
    ROW(GetFMUstate, ANY, PHASES_ALL)                                                                        \
    ROW(SetFMUstate, ANY, PHASES_ALL)                                                                        \
    ROW(FreeFMUstate, ANY, PHASES_ALL)                                                                       \
    ROW(SerializedFMUstateSize, ANY, PHASES_READ(PHASES_ALL))                                                \
    ROW(SerializeFMUstate, ANY, PHASES_READ(PHASES_ALL))                                                     \
    ROW(DeSerializeFMUstate, ANY, PHASES_ALL)                                                                \
    ROW(GetDirectionalDerivative, ANY, PHASES_READ(PHASES_INITIALIZED))                                      \
    ROW(SetRealInputDerivatives, STEPS, PHASE_INSTANTIATED | PHASE_INITIALIZATION | PHASE_STEP)              \
    ROW(GetRealOutputDerivatives, STEPS, PHASES_READ(PHASES_STEPPED))                                        \
    ROW(DoStep, STEPS, PHASE_STEP)                                                                           \
    ROW(CancelStep, ANY, 0)                                                                                  \
    ROW(GetStatus, STEPS, PHASES_READ(PHASES_STEPPED))                                                       \
    ROW(GetRealStatus, STEPS, PHASES_READ(PHASES_STEPPED))                                                   \
    ROW(GetIntegerStatus, STEPS, PHASES_READ(PHASES_STEPPED))                                                \
    ROW(GetBooleanStatus, STEPS, PHASES_READ(PHASES_STEPPED))                                                \
    ROW(GetStringStatus, STEPS, PHASES_READ(PHASES_STEPPED))                                                 \
    ROW(EnterEventMode, EXCHANGE, PHASES_EXCHANGED)                                                          \
    ROW(NewDiscreteStates, EXCHANGE, PHASE_EVENT)                                                            \
    ROW(EnterContinuousTimeMode, EXCHANGE, PHASE_EVENT)                                                      \
    ROW(CompletedIntegratorStep, EXCHANGE, PHASE_CONTINUOUS)                                                 \
    ROW(SetTime, EXCHANGE, PHASES_EXCHANGED)                                                                 \
    ROW(SetContinuousStates, EXCHANGE, PHASE_CONTINUOUS)                                                     \
    ROW(GetDerivatives, EXCHANGE, PHASES_READ(PHASES_OF_STATES))                                             \
    ROW(GetEventIndicators, EXCHANGE, PHASES_READ(PHASES_OF_STATES))                                         \
    ROW(GetContinuousStates, EXCHANGE, PHASES_READ(PHASES_OF_STATES))                                        \
    ROW(GetNominalsOfContinuousStates, EXCHANGE, PHASES_READ(PHASE_INSTANTIATED | PHASES_OF_STATES))

#define CALL2_NAME(function, kind, phases) CALL2_##function,
enum fmi2_call { CALL2_TABLE(CALL2_NAME) CALL2_COUNT };
#undef CALL2_NAME

#define CALL2_RULE(function, kind, phases)                                                                   \
    {"fmi2" #function, CALL_##kind, phases, (phases) == 0 ? "no step is ever in progress here" : NULL},
static const struct call calls_of_fmi2[] = {CALL2_TABLE(CALL2_RULE)};
#undef CALL2_RULE

#define CALL2(function) (&calls_of_fmi2[CALL2_##function])

/* Functions without a row take no instance, or create or free one. */
#define CALL2_EXPORT(function, kind, phases) CONTACT_EXPORTED fmi2##function##TYPE fmi2##function;
CALL2_TABLE(CALL2_EXPORT)
#undef CALL2_EXPORT
CONTACT_EXPORTED fmi2GetTypesPlatformTYPE fmi2GetTypesPlatform;
CONTACT_EXPORTED fmi2GetVersionTYPE fmi2GetVersion;
CONTACT_EXPORTED fmi2InstantiateTYPE fmi2Instantiate;
CONTACT_EXPORTED fmi2FreeInstanceTYPE fmi2FreeInstance;

/* A function that passes its arguments on where it may be called now. */
#define PASS2(function, parameters, result)                                                                  \
    fmi2Status fmi2##function parameters                                                                     \
    {                                                                                                        \
        struct instance *instance = c;                                                                       \
        return (fmi2Status)(call_begin(instance, CALL2(function)) ? (result) : MODEL_ERROR);                 \
    }

static void fmi2_send(struct instance *instance, enum model_status status, const char *category,
                      const char *text)
{
    const fmi2CallbackFunctions *callbacks = &((const struct fmi2_instance *)instance)->callbacks;
    callbacks->logger(callbacks->componentEnvironment, instance->name, (fmi2Status)status, category, text);
}

static const struct adapter adapter_of_fmi2 = {
    .version = 2,
    .send = fmi2_send,
    /* The logger takes a printf format in which '#' marks value references (FMI 2.0.5). */
    .doubled = "%#",
    .arguments = {[ARGUMENT_REFERENCES] = "vr",
                  [ARGUMENT_VALUES] = "value",
                  [ARGUMENT_ORDERS] = "order",
                  [ARGUMENT_UNKNOWNS] = "vUnknown_ref",
                  [ARGUMENT_KNOWNS] = "vKnown_ref",
                  [ARGUMENT_SEED] = "dvKnown",
                  [ARGUMENT_SENSITIVITY] = "dvUnknown",
                  [ARGUMENT_STATE] = "FMUstate"},
    .type_names = {[VARIABLE_REAL] = "Real",
                   [VARIABLE_INTEGER] = "Integer",
                   [VARIABLE_BOOLEAN] = "Boolean",
                   [VARIABLE_ENUMERATION] = "Enumeration (fmi2Integer)"},
    .value_sizes = {[VARIABLE_REAL] = sizeof(fmi2Real),
                    [VARIABLE_INTEGER] = sizeof(fmi2Integer),
                    [VARIABLE_BOOLEAN] = sizeof(fmi2Boolean),
                    [VARIABLE_ENUMERATION] = sizeof(fmi2Integer)},
    .state_magic = 0x544E4F43u, /* "CONT" on a little-endian machine */
};

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

/* The FMU reads no resources, so any string or none is accepted as their location. */
fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn)
{
    static const struct call instantiate = {.name = "fmi2Instantiate"};
    (void)fmuResourceLocation, (void)visible;
    if (functions == NULL) {
        return NULL;
    }
    /* With only one of the importer's two memory functions, memory of one heap would be freed in another. */
    const bool memory = functions->allocateMemory != NULL && functions->freeMemory != NULL;
    struct fmi2_instance nobody = {
        .shared = {.adapter = &adapter_of_fmi2,
                   .call = &instantiate,
                   .host = {.allocate = memory ? functions->allocateMemory : calloc,
                            .release = memory ? functions->freeMemory : free,
                            .exchange = fmuType == fmi2ModelExchange},
                   .name = instanceName == NULL ? "" : instanceName,
                   .logger_given = functions->logger != NULL,
                   .log_categories = LOG_STATUS_ALL},
        .callbacks = *functions,
    };
    return instance_identified(&nobody.shared, instanceName, "fmuGUID", fmuGUID, SCENE_GUID) &&
                   instance_expects(&nobody.shared,
                                    fmuType == fmi2CoSimulation || fmuType == fmi2ModelExchange, "fmuType",
                                    "(unknown)", "fmi2CoSimulation or fmi2ModelExchange")
               ? instance_create(&nobody.shared, sizeof nobody, loggingOn != fmi2False)
               : NULL;
}

void fmi2FreeInstance(fmi2Component c)
{
    instance_free(c);
}

static enum model_status choose_categories(struct instance *instance, bool on, size_t count,
                                           const fmi2String *categories)
{
    unsigned chosen = 0;
    const enum model_status status = instance_categories(instance, count, categories, &chosen);
    if (status == MODEL_OK) {
        /* With logging off, warnings and worse are still sent. */
        instance->log_categories = !on || count == 0 ? log_default_categories(on) : chosen;
    }
    return status;
}

static enum model_status enter_initialization(struct instance *instance)
{
    return instance->experiment.set_up
               ? instance_enter(instance, PHASE_INITIALIZATION)
               : log_report(instance, MODEL_ERROR, " called before fmi2SetupExperiment");
}

PASS2(SetDebugLogging, (fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]),
      choose_categories(instance, on != fmi2False, count, categories))
PASS2(EnterInitializationMode, (fmi2Component c), enter_initialization(instance))
PASS2(SetupExperiment,
      (fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start_time,
       fmi2Boolean stop_time_defined, fmi2Real stop_time),
      instance_set_up(instance, tolerance_defined != fmi2False, tolerance, start_time,
                      stop_time_defined != fmi2False, stop_time))
PASS2(ExitInitializationMode, (fmi2Component c), instance_exit_initialization(instance, false))
PASS2(Terminate, (fmi2Component c), instance_enter(instance, PHASE_TERMINATED))
PASS2(Reset, (fmi2Component c), instance_reset(instance))

/* This part gets and sets values. Enumerations are of type fmi2Integer too. There are no string variables, so
 * that fmi2GetString refuses every reference. */

/* Reads Real variables, mostly the three components of one vector. The function is flattened, because calls
 * would be a good part of the time of such a read. */
CONTACT_FLATTEN fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       fmi2Real value[])
{
    struct instance *instance = c;
    if (instance != NULL && instance->phase == PHASE_STEP && nvr == 3 &&
        model_get_vector(instance->model, vr, value)) {
        return fmi2OK;
    }
    return (fmi2Status)(call_begin(instance, CALL2(GetReal))
                            ? instance_get_values(instance, TYPES_REAL, vr, nvr, value, nvr)
                            : MODEL_ERROR);
}

#define GETTER2(Type, types)                                                                                 \
    PASS2(Get##Type, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2##Type value[]),       \
          instance_get_values(instance, types, vr, nvr, (void *)value, nvr))
#define SETTER2(Type, types)                                                                                 \
    PASS2(Set##Type, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2##Type value[]), \
          instance_set_values(instance, types, vr, nvr, (const void *)value, nvr))
SETTER2(Real, TYPES_REAL)
GETTER2(Integer, TYPES_INTEGER | TYPES_ENUMERATION)
SETTER2(Integer, TYPES_INTEGER | TYPES_ENUMERATION)
GETTER2(Boolean, TYPES_BOOLEAN)
SETTER2(Boolean, TYPES_BOOLEAN)
GETTER2(String, TYPES_NONE)
SETTER2(String, TYPES_NONE)

static enum model_status check_input_derivative(struct instance *instance, fmi2ValueReference reference,
                                                fmi2Integer order, fmi2Real value)
{
    const struct variable *variable = find_real(instance, reference, VARIABLE_INPUT);
    if (variable == NULL) {
        return MODEL_ERROR;
    }
    const enum model_status status = check_order(instance, variable, order);
    if (status == MODEL_OK && !isfinite(value)) {
        return log_report(instance, MODEL_DISCARD,
                          ": derivative of order %d of %s = %g refused, allowed: finite", order,
                          variable->name, value);
    }
    return status;
}

static enum model_status set_input_derivatives(struct instance *instance, const fmi2ValueReference *vr,
                                               size_t nvr, const fmi2Integer *order, const fmi2Real *value)
{
    if (!arrays_given(instance, ARGUMENTS({"vr", vr, nvr}, {"order", order, nvr}, {"value", value, nvr}))) {
        return MODEL_ERROR;
    }
    enum model_status worst = MODEL_OK;
    for (size_t i = 0; i < nvr && worst == MODEL_OK; ++i) {
        worst = check_input_derivative(instance, vr[i], order[i], value[i]);
    }
    for (size_t i = 0; i < nvr && worst <= MODEL_WARNING; ++i) {
        const enum model_status status =
            model_set_input_derivative(instance->model, scene_variable(vr[i]), order[i], value[i]);
        worst = status > worst ? status : worst;
    }
    return worst;
}

PASS2(SetRealInputDerivatives,
      (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
       const fmi2Real value[]),
      set_input_derivatives(instance, vr, nvr, order, value))
PASS2(GetRealOutputDerivatives,
      (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
       fmi2Real value[]),
      instance_output_derivatives(instance, vr, order, nvr, value, nvr))

PASS2(GetDirectionalDerivative,
      (fmi2Component c, const fmi2ValueReference unknowns[], size_t unknown_count,
       const fmi2ValueReference knowns[], size_t known_count, const fmi2Real seed[], fmi2Real sensitivity[]),
      instance_product(instance, &(const struct product){.unknowns = {unknowns, unknown_count, false},
                                                         .knowns = {knowns, known_count, false},
                                                         .unknown_components = unknown_count,
                                                         .known_components = known_count,
                                                         .seed = seed,
                                                         .sensitivity = sensitivity}))

/* Takes any step and sends messages. It is not inlined into fmi2DoStep, so that a deferred flight saves no
 * registers for it. */
CONTACT_NOINLINE static fmi2Status fmi2_do_step(struct instance *instance, double point, double size)
{
    const struct step_request request = {0};
    return (fmi2Status)(call_begin(instance, CALL2(DoStep)) ? instance_step(instance, point, size, &request)
                                                            : MODEL_ERROR);
}

/*
 * noSetFMUStatePriorToCurrentPoint has no effect, because states are saved only on request. The function is
 * flattened, because calls would be a good part of the time of a deferred flight.
 */
CONTACT_FLATTEN fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                                      fmi2Real communicationStepSize,
                                      fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    struct instance *instance = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (instance == NULL) {
        return fmi2Error;
    }
    instance->asked_end = currentCommunicationPoint + communicationStepSize;
    if (step_plainly_in_order(instance, currentCommunicationPoint, communicationStepSize) &&
        model_step_deferred(instance->model, currentCommunicationPoint + communicationStepSize)) {
        return fmi2OK; /* step_status need not be written: it is MODEL_OK already */
    }
    return fmi2_do_step(instance, currentCommunicationPoint, communicationStepSize);
}

PASS2(CancelStep, (fmi2Component c), MODEL_OK)

static const char *status_kind_name(fmi2StatusKind kind)
{
    static const char *const names[] = {[fmi2DoStepStatus] = "fmi2DoStepStatus",
                                        [fmi2PendingStatus] = "fmi2PendingStatus",
                                        [fmi2LastSuccessfulTime] = "fmi2LastSuccessfulTime",
                                        [fmi2Terminated] = "fmi2Terminated"};
    return (unsigned)kind < sizeof names / sizeof names[0] ? names[kind] : "(unknown)";
}

/* Answers a status function of the kind `answered`. No call ever returns fmi2Pending, so fmi2PendingStatus is
 * refused. */
static enum model_status tell_status(struct instance *instance, fmi2StatusKind kind, const char *answered,
                                     bool known, void *value, const void *answer, size_t size)
{
    if (!array_given(instance, "value", value, 1)) {
        return MODEL_ERROR;
    }
    if (!known) {
        return log_report(instance, MODEL_DISCARD, ": %s is not available, allowed: %s",
                          status_kind_name(kind), answered);
    }
    memcpy(value, answer, size);
    return MODEL_OK;
}

/* The model never ends a run by itself. */
PASS2(GetStatus, (fmi2Component c, const fmi2StatusKind s, fmi2Status *value),
      tell_status(instance, s, "fmi2DoStepStatus", s == fmi2DoStepStatus, value,
                  &(const fmi2Status){(fmi2Status)instance->step_status}, sizeof *value))
PASS2(GetRealStatus, (fmi2Component c, const fmi2StatusKind s, fmi2Real *value),
      tell_status(instance, s, "fmi2LastSuccessfulTime", s == fmi2LastSuccessfulTime, value,
                  &(const fmi2Real){instance_time_reached(instance)}, sizeof *value))
PASS2(GetBooleanStatus, (fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value),
      tell_status(instance, s, "fmi2Terminated", s == fmi2Terminated, value, &(const fmi2Boolean){fmi2False},
                  sizeof *value))
PASS2(GetIntegerStatus, (fmi2Component c, const fmi2StatusKind s, fmi2Integer *value),
      tell_status(instance, s, "none", false, value, NULL, 0))
PASS2(GetStringStatus, (fmi2Component c, const fmi2StatusKind s, fmi2String *value),
      tell_status(instance, s, "none", false, (void *)value, NULL, 0))

/* The model never ends a run by itself. */
static enum model_status new_discrete_states(struct instance *instance, fmi2EventInfo *info)
{
    struct exchange_news news = {0};
    if (!array_given(instance, "eventInfo", info, 1)) {
        return MODEL_ERROR;
    }
    const enum model_status status = model_exchange_update(instance->model, &news);
    *info = (fmi2EventInfo){.newDiscreteStatesNeeded = news.again,
                            .terminateSimulation = fmi2False,
                            .nominalsOfContinuousStatesChanged = fmi2False,
                            .valuesOfContinuousStatesChanged = news.jumped,
                            .nextEventTimeDefined = news.scheduled,
                            .nextEventTime = news.event_time};
    return status;
}

PASS2(NewDiscreteStates, (fmi2Component c, fmi2EventInfo *eventInfo),
      new_discrete_states(instance, eventInfo))
/* noSetFMUStatePriorToCurrentPoint has no effect, because states are saved only on request. */
PASS2(CompletedIntegratorStep,
      (fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint, fmi2Boolean *enterEventMode,
       fmi2Boolean *terminateSimulation),
      ((void)noSetFMUStatePriorToCurrentPoint,
       exchange_accept_step(instance, enterEventMode, terminateSimulation, sizeof *enterEventMode)))

PASS2(EnterEventMode, (fmi2Component c), instance_enter(instance, PHASE_EVENT))
PASS2(EnterContinuousTimeMode, (fmi2Component c), instance_enter(instance, PHASE_CONTINUOUS))
PASS2(SetTime, (fmi2Component c, fmi2Real time), model_exchange_set_time(instance->model, time))
PASS2(SetContinuousStates, (fmi2Component c, const fmi2Real x[], size_t nx),
      exchange_set_states(instance, x, nx))
PASS2(GetDerivatives, (fmi2Component c, fmi2Real x[], size_t nx),
      exchange_get(instance, EXCHANGE_RATES, x, nx))
PASS2(GetEventIndicators, (fmi2Component c, fmi2Real x[], size_t nx),
      exchange_get(instance, EXCHANGE_INDICATORS, x, nx))
PASS2(GetContinuousStates, (fmi2Component c, fmi2Real x[], size_t nx),
      exchange_get(instance, EXCHANGE_STATES, x, nx))
PASS2(GetNominalsOfContinuousStates, (fmi2Component c, fmi2Real x[], size_t nx),
      exchange_get(instance, EXCHANGE_NOMINALS, x, nx))

PASS2(GetFMUstate, (fmi2Component c, fmi2FMUstate *state), state_block_get(instance, state))
PASS2(SetFMUstate, (fmi2Component c, fmi2FMUstate state), state_block_set(instance, state))
PASS2(FreeFMUstate, (fmi2Component c, fmi2FMUstate *state), state_block_free(instance, state))
PASS2(SerializedFMUstateSize, (fmi2Component c, fmi2FMUstate state, size_t *size),
      state_block_size(instance, state, size))
PASS2(SerializeFMUstate, (fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size),
      state_block_serialize(instance, state, bytes, size))
PASS2(DeSerializeFMUstate, (fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state),
      state_block_deserialize(instance, bytes, size, state))
