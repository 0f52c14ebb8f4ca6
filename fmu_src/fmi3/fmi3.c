/*
 * Here each function of FMI 3.0 works on an instance of fmi/instance.h.
 */
#include <float.h>
#include <fmi3Functions.h>
#include <stdlib.h>
#include <string.h>

#include "fmi/instance.h"
#include "math/compiler.h"
#include "scene.h"

/* This struct is an instance of FMI 3.0. An fmi3Instance is the address of such a struct. */
struct fmi3_instance {
    struct instance shared; /* is the first member, so that both have one address */
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log_message;
    fmi3IntermediateUpdateCallback intermediate_update; /* NULL: none */
    bool event_mode_used;
    bool early_return_allowed;
    double event_time; /* time of the last event in the last step [s]; NaN: there was none */
};

/* The model's statuses are fmi3Status values by another name. */
_Static_assert((int)MODEL_OK == (int)fmi3OK && (int)MODEL_WARNING == (int)fmi3Warning, "status order");
_Static_assert((int)MODEL_DISCARD == (int)fmi3Discard && (int)MODEL_ERROR == (int)fmi3Error, "status order");
_Static_assert((int)MODEL_FATAL == (int)fmi3Fatal, "status order");

/* Phases in which a function may also be called from the intermediate update callback, where outputs may be
 * read, and from the logger. */
#define PHASES_WITHIN(phases) (PHASES_READ(phases) | PHASE_INTERMEDIATE)

/*
 * Each function of the standard that takes an instance names the kind of instance and the phases in which it
 * may be called (struct call), after the state machines of FMI 3.0.2, sections 2.3, 3.2 and 4.2. Three
 * extensions do no harm: variables that have a start value may be read while instantiated, outputs may be
 * read between setting an input and the next step, and the numbers of states and indicators are always told.
 * Model Exchange is never in step mode, Co-Simulation never in continuous-time mode.
 */
#define CALL3(function, kind, phases, parameters, result)                                                    \
    CALL_OF(3, function, kind, phases, NULL, parameters, result)

static void fmi3_send(struct instance *instance, enum model_status status, const char *category,
                      const char *text)
{
    const struct fmi3_instance *own = (const struct fmi3_instance *)instance;
    own->log_message(own->environment, (fmi3Status)status, category, text);
}

static const struct adapter adapter_of_fmi3 = {
    .version = 3,
    .token_name = "instantiationToken",
    .token = SCENE_TOKEN,
    .send = fmi3_send,
    .doubled = "", /* the message is plain text */
    .type_names = {[VARIABLE_REAL] = "Float64",
                   [VARIABLE_INTEGER] = "Int32",
                   [VARIABLE_BOOLEAN] = "Boolean",
                   [VARIABLE_ENUMERATION] = "Enumeration (fmi3Int64)"},
    .value_sizes = {[VARIABLE_REAL] = sizeof(fmi3Float64),
                    [VARIABLE_INTEGER] = sizeof(fmi3Int32),
                    [VARIABLE_BOOLEAN] = sizeof(fmi3Boolean),
                    [VARIABLE_ENUMERATION] = sizeof(fmi3Int64)},
    .state_magic = 0x334E4F43u, /* "CON3" on a little-endian machine */
};

/* Returns an instance that lives only for messages and that the new instance is copied from. */
static struct fmi3_instance make_nobody(const struct call *call, const char *name, bool exchange,
                                        fmi3InstanceEnvironment environment,
                                        fmi3LogMessageCallback log_message)
{
    return (struct fmi3_instance){
        .shared = {.adapter = &adapter_of_fmi3,
                   .call = call,
                   .host = {.allocate = calloc, .release = free, .exchange = exchange},
                   .name = name == NULL ? "" : name,
                   .logger_given = log_message != NULL,
                   .log_categories = LOG_STATUS_ALL},
        .environment = environment,
        .log_message = log_message,
    };
}

/* Whether the required intermediate variables are variables of the FMU; if not, a message says so. */
static bool intermediate_in_order(struct instance *nobody, const fmi3ValueReference required[], size_t count)
{
    bool known = array_given(nobody, "requiredIntermediateVariables", required, count);
    for (size_t i = 0; known && i < count; ++i) {
        known = vector_variable(required[i]) != NULL;
        if (!known) {
            log_report(nobody, MODEL_ERROR,
                       ": requiredIntermediateVariables has the unknown value reference %u",
                       (unsigned)required[i]);
        }
    }
    return known;
}

/* The FMU reads no resources, so any string or none is accepted as their path. */
CONTACT_EXPORTED fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
    const fmi3ValueReference requiredIntermediateVariables[], size_t nRequiredIntermediateVariables,
    fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3IntermediateUpdateCallback intermediateUpdate)
{
    static const struct call call = {.name = "fmi3InstantiateCoSimulation"};
    (void)resourcePath, (void)visible;
    struct fmi3_instance nobody = make_nobody(&call, instanceName, false, instanceEnvironment, logMessage);
    nobody.intermediate_update = intermediateUpdate;
    nobody.event_mode_used = eventModeUsed;
    nobody.early_return_allowed = earlyReturnAllowed;
    if (!instance_expects(&nobody.shared, !eventModeUsed || SCENE_ANY_FREE, "eventModeUsed", "true",
                          "false, as hasEventMode says") ||
        !intermediate_in_order(&nobody.shared, requiredIntermediateVariables,
                               nRequiredIntermediateVariables)) {
        return NULL;
    }
    struct instance *instance = instance_create(&nobody.shared, sizeof nobody, instantiationToken, loggingOn);
    if (instance != NULL && eventModeUsed) { /* FMI 3.0.2, section 2.4.7.4: tuning needs event mode */
        instance->tuning_phases = PHASE_EVENT;
    }
    return instance;
}

CONTACT_EXPORTED fmi3Instance fmi3InstantiateModelExchange(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage)
{
    static const struct call call = {.name = "fmi3InstantiateModelExchange"};
    (void)resourcePath, (void)visible;
    struct fmi3_instance nobody = make_nobody(&call, instanceName, true, instanceEnvironment, logMessage);
    return instance_create(&nobody.shared, sizeof nobody, instantiationToken, loggingOn);
}

CONTACT_EXPORTED fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
    fmi3UnlockPreemptionCallback unlockPreemption)
{
    static const struct call call = {.name = "fmi3InstantiateScheduledExecution"};
    (void)instantiationToken, (void)resourcePath, (void)visible, (void)loggingOn;
    (void)clockUpdate, (void)lockPreemption, (void)unlockPreemption;
    struct fmi3_instance nobody = make_nobody(&call, instanceName, false, instanceEnvironment, logMessage);
    (void)instance_expects(&nobody.shared, false, "interface type", "Scheduled Execution",
                           "Co-Simulation or Model Exchange");
    return NULL;
}

CONTACT_EXPORTED const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

CONTACT_EXPORTED void fmi3FreeInstance(fmi3Instance c)
{
    instance_free(c);
}

CALLS_OF_BOTH(3, State, Deserialize)
CALL3(EnterInitializationMode, ANY, PHASE_INSTANTIATED,
      (fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance, fmi3Float64 start_time,
       fmi3Boolean stop_time_defined, fmi3Float64 stop_time),
      instance_enter(instance,
                     instance_set_up(instance, tolerance_defined, tolerance, start_time, stop_time_defined,
                                     stop_time),
                     PHASE_INITIALIZATION))
CALL3(ExitInitializationMode, ANY, PHASE_INITIALIZATION, (fmi3Instance c),
      instance_enter(instance, model_exit_initialization(instance->model),
                     instance->host.exchange || ((struct fmi3_instance *)c)->event_mode_used ? PHASE_EVENT
                                                                                             : PHASE_STEP))

/* This part gets and sets values. A vector is read and written as a whole. */

/* Defines the getter and the setter of the standard for one type of its own. Both serve the variables of the
 * `types`, bits 1 << enum variable_type; the setter may be called in the phases `phases_to_set`. */
#define VALUES3(Type, types, phases_to_set)                                                                  \
    CALL3(Get##Type, ANY, PHASES_WITHIN(PHASES_ALL),                                                         \
          (fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3##Type values[], size_t count),    \
          instance_get_values(instance, types, vr, nvr, (void *)values, count))                              \
    CALL3(Set##Type, ANY, phases_to_set,                                                                     \
          (fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3##Type values[],             \
           size_t count),                                                                                    \
          instance_set_values(instance, types, vr, nvr, (const void *)values, count))
VALUES3(Float64, 1 << VARIABLE_REAL, PHASES_SETTABLE | PHASE_CONTINUOUS)
VALUES3(Int32, 1 << VARIABLE_INTEGER, PHASES_SETTABLE)
VALUES3(Int64, 1 << VARIABLE_ENUMERATION, PHASES_SETTABLE)
VALUES3(Boolean, 1 << VARIABLE_BOOLEAN, PHASES_SETTABLE)

/* No variable has one of these types, so that every reference is refused. */
VALUES3(Float32, 0, PHASES_SETTABLE)
VALUES3(Int8, 0, PHASES_SETTABLE)
VALUES3(UInt8, 0, PHASES_SETTABLE)
VALUES3(Int16, 0, PHASES_SETTABLE)
VALUES3(UInt16, 0, PHASES_SETTABLE)
VALUES3(UInt32, 0, PHASES_SETTABLE)
VALUES3(UInt64, 0, PHASES_SETTABLE)
VALUES3(String, 0, PHASES_SETTABLE)
CALL3(GetBinary, ANY, PHASES_WITHIN(PHASES_ALL),
      (fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, size_t sizes[], fmi3Binary values[],
       size_t count),
      ((void)sizes, instance_get_values(instance, 0, vr, nvr, (void *)values, count)))
CALL3(SetBinary, ANY, PHASES_SETTABLE,
      (fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const size_t sizes[],
       const fmi3Binary values[], size_t count),
      ((void)sizes, instance_set_values(instance, 0, vr, nvr, (const void *)values, count)))

CALL3(GetOutputDerivatives, STEPS, PHASES_WITHIN(PHASES_STEPPED),
      (fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3Int32 orders[],
       fmi3Float64 values[], size_t count),
      instance_output_derivatives(instance, vr, orders, nvr, values, count))

/* Defines a function that multiplies with the matrix of derivatives. */
#define PRODUCT3(function, is_adjoint)                                                                       \
    CALL3(function, ANY, PHASES_READ(PHASES_INITIALIZED),                                                    \
          (fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,                            \
           const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,        \
           fmi3Float64 sensitivity[], size_t nSensitivity),                                                  \
          instance_product(                                                                                  \
              instance,                                                                                      \
              &(const struct product){                                                                       \
                  is_adjoint, {unknowns, nUnknowns, true}, {knowns, nKnowns, true}, seed, sensitivity},      \
              nSeed, nSensitivity))
PRODUCT3(GetDirectionalDerivative, false)
PRODUCT3(GetAdjointDerivative, true)

/* Is called when a contact begins or ends within a step, and calls the intermediate update callback. Returns
 * the time at which the step shall end [s] (struct step_request): the importer may want it to end early. */
static double at_event(void *context, double end_time)
{
    struct fmi3_instance *own = context;
    struct instance *instance = &own->shared;
    const double now = model_time(instance->model);
    const struct call *call = instance->call;
    bool requested = false;
    double requested_time = end_time;
    own->event_time = now;
    if (own->intermediate_update != NULL) {
        instance->experiment.phase = (enum phase)(PHASE_STEP | PHASE_INTERMEDIATE);
        own->intermediate_update(own->environment, now, fmi3False, fmi3True, fmi3True,
                                 own->early_return_allowed, &requested, &requested_time);
        instance->experiment.phase = PHASE_STEP;
        instance->call = call;
    }
    if (!own->early_return_allowed) {
        return end_time;
    }
    if (own->event_mode_used || (requested && !(requested_time > now))) {
        return now;
    }
    return requested ? fmin(requested_time, end_time) : end_time;
}

/* Sets the results of a step besides its status. The model never ends a run by itself. */
static inline void put_results(fmi3Boolean *event_to, fmi3Boolean *terminate_to, fmi3Boolean *early_to,
                               fmi3Float64 *time_to, bool event, bool early, double time)
{
    *event_to = event;
    *terminate_to = fmi3False;
    *early_to = early;
    *time_to = time;
}

/* Takes any step and sends messages. It is not inlined into fmi3DoStep, so that a deferred flight saves no
 * registers for it; its few arguments all fit in registers. A step that gets stuck is undone, because
 * fmi3Discard has to leave an instance as it was. */
CONTACT_NOINLINE static fmi3Status fmi3_do_step(struct instance *instance, double point, double size,
                                                fmi3Boolean *event, fmi3Boolean *terminate,
                                                fmi3Boolean *early, fmi3Float64 *time)
{
    static const struct call call = {"fmi3DoStep", CALL_STEPS, PHASE_STEP, NULL};
    struct fmi3_instance *own = (struct fmi3_instance *)instance;
    const bool ready = call_begin(instance, &call) &&
                       array_given(instance, "eventHandlingNeeded", event, 1) &&
                       array_given(instance, "terminateSimulation", terminate, 1) &&
                       array_given(instance, "earlyReturn", early, 1) &&
                       array_given(instance, "lastSuccessfulTime", time, 1);
    if (!ready || event == NULL || terminate == NULL || early == NULL || time == NULL) {
        return fmi3Error;
    }
    const struct step_request request = {
        .end_time = point + size,
        .at_event = own->event_mode_used || own->intermediate_update != NULL ? at_event : NULL,
        .context = own,
        .whole = true,
    };
    own->event_time = (double)NAN;
    const enum model_status status = instance_step(instance, point, size, &request);
    const double reached = model_time(instance->model);
    const double end = request.end_time;
    put_results(event, terminate, early, time, own->event_mode_used && own->event_time == reached,
                status <= MODEL_WARNING && end - reached > 4.0 * DBL_EPSILON * fabs(end),
                instance_time_reached(instance));
    return (fmi3Status)status;
}

/*
 * noSetFMUStatePriorToCurrentPoint has no effect, because states are saved only on request. The function is
 * flattened, because calls would be a good part of the time of a deferred flight.
 */
CONTACT_EXPORTED CONTACT_FLATTEN fmi3Status
fmi3DoStep(fmi3Instance c, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
           fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
           fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    struct instance *instance = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (instance == NULL) {
        return fmi3Error;
    }
    if (eventHandlingNeeded != NULL && terminateSimulation != NULL && earlyReturn != NULL &&
        lastSuccessfulTime != NULL &&
        step_plainly_in_order(instance, currentCommunicationPoint, communicationStepSize) &&
        model_step_deferred(instance->model, currentCommunicationPoint + communicationStepSize)) {
        put_results(eventHandlingNeeded, terminateSimulation, earlyReturn, lastSuccessfulTime, false, false,
                    currentCommunicationPoint + communicationStepSize);
        return fmi3OK; /* step_status need not be written: it is MODEL_OK already */
    }
    return fmi3_do_step(instance, currentCommunicationPoint, communicationStepSize, eventHandlingNeeded,
                        terminateSimulation, earlyReturn, lastSuccessfulTime);
}

/*
 * The functions of event mode follow. In Co-Simulation a contact that begins or ends has changed its regime
 * when fmi3DoStep returns. Event mode then has nothing to iterate and schedules no event. In Model Exchange
 * regimes change in event mode, and touches of bodies in flight are announced.
 */

CALL3(EnterEventMode, ANY, PHASE_STEP | PHASE_CONTINUOUS, (fmi3Instance c),
      instance->host.exchange || ((struct fmi3_instance *)c)->event_mode_used
          ? instance_enter(instance, MODEL_OK, PHASE_EVENT)
          : log_report(instance, MODEL_ERROR,
                       " called in phase step mode: instantiated with eventModeUsed = false"))
CALL3(EnterStepMode, STEPS, PHASE_EVENT, (fmi3Instance c), instance_enter(instance, MODEL_OK, PHASE_STEP))

static enum model_status update_discrete_states(struct instance *instance, bool *again, bool *terminate,
                                                bool *nominals_changed, bool *values_changed,
                                                bool *time_defined, double *time)
{
    if (!array_given(instance, "discreteStatesNeedUpdate", again, 1) ||
        !array_given(instance, "terminateSimulation", terminate, 1) ||
        !array_given(instance, "nominalsOfContinuousStatesChanged", nominals_changed, 1) ||
        !array_given(instance, "valuesOfContinuousStatesChanged", values_changed, 1) ||
        !array_given(instance, "nextEventTimeDefined", time_defined, 1) ||
        !array_given(instance, "nextEventTime", time, 1)) {
        return MODEL_ERROR;
    }
    struct exchange_news news = {0};
    const enum model_status status =
        instance->host.exchange ? model_exchange_update(instance->model, &news) : MODEL_OK;
    *again = news.again;
    *terminate = false;
    *nominals_changed = false;
    *values_changed = news.jumped;
    *time_defined = news.scheduled;
    *time = news.event_time;
    return status;
}

CALL3(UpdateDiscreteStates, ANY, PHASE_EVENT,
      (fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
       fmi3Boolean *values_changed, fmi3Boolean *time_defined, fmi3Float64 *time),
      update_discrete_states(instance, again, terminate, nominals_changed, values_changed, time_defined,
                             time))

static enum model_status put_count(struct instance *instance, const char *argument, size_t count, size_t *to)
{
    if (!array_given(instance, argument, to, 1)) {
        return MODEL_ERROR;
    }
    *to = count;
    return MODEL_OK;
}

CALL3(GetNumberOfEventIndicators, EXCHANGE, PHASES_READ(PHASES_ALL), (fmi3Instance c, size_t *count),
      put_count(instance, "nEventIndicators", SCENE_INDICATORS, count))
CALL3(GetNumberOfContinuousStates, EXCHANGE, PHASES_READ(PHASES_ALL), (fmi3Instance c, size_t *count),
      put_count(instance, "nContinuousStates", SCENE_STATES, count))
CALL3(SetTime, EXCHANGE, PHASE_CONTINUOUS, (fmi3Instance c, fmi3Float64 time),
      model_exchange_set_time(instance->model, time))
NUMBERS_OF(3, GetContinuousStateDerivatives, EXCHANGE_RATES, SCENE_STATES, PHASES_OF_STATES)
NUMBERS_OF(3, GetNominalsOfContinuousStates, EXCHANGE_NOMINALS, SCENE_STATES, PHASES_OF_STATES)

/* A state saved in event mode of Co-Simulation puts an instance without event mode into step mode. */
static enum model_status set_state(struct instance *instance, fmi3FMUState state)
{
    const struct fmi3_instance *own = (const struct fmi3_instance *)instance;
    const enum model_status status = state_block_set(instance, state);
    if (status <= MODEL_WARNING && instance->experiment.phase == PHASE_EVENT && !instance->host.exchange &&
        !own->event_mode_used) {
        instance->experiment.phase = PHASE_STEP;
    }
    return status;
}

CALL3(SetFMUState, ANY, PHASES_ALL, (fmi3Instance c, fmi3FMUState state), set_state(instance, state))

/*
 * These FMUs refuse the functions below with a message. They exist because importers look for all functions
 * of the standard. They do not use their arguments.
 */
#ifdef __GNUC__
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
/* NOLINTBEGIN(misc-unused-parameters) */
#define ABSENT3(function, reason, parameters) CALL_OF(3, function, ANY, 0, reason, parameters, MODEL_OK)

#define NO_CLOCKS "there are no clocks"
#define CLOCKS fmi3Instance c, const fmi3ValueReference clocks[], size_t count
ABSENT3(GetClock, NO_CLOCKS, (CLOCKS, fmi3Clock values[]))
ABSENT3(SetClock, NO_CLOCKS, (CLOCKS, const fmi3Clock values[]))
ABSENT3(GetIntervalDecimal, NO_CLOCKS, (CLOCKS, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]))
ABSENT3(GetIntervalFraction, NO_CLOCKS,
        (CLOCKS, fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]))
ABSENT3(GetShiftDecimal, NO_CLOCKS, (CLOCKS, fmi3Float64 shifts[]))
ABSENT3(GetShiftFraction, NO_CLOCKS, (CLOCKS, fmi3UInt64 counters[], fmi3UInt64 resolutions[]))
ABSENT3(SetIntervalDecimal, NO_CLOCKS, (CLOCKS, const fmi3Float64 intervals[]))
ABSENT3(SetIntervalFraction, NO_CLOCKS, (CLOCKS, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
ABSENT3(SetShiftDecimal, NO_CLOCKS, (CLOCKS, const fmi3Float64 shifts[]))
ABSENT3(SetShiftFraction, NO_CLOCKS, (CLOCKS, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
ABSENT3(ActivateModelPartition, "there are no model partitions, Scheduled Execution is not provided",
        (fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time))
#define NO_ELEMENTS "providesPerElementDependencies is false"
ABSENT3(GetNumberOfVariableDependencies, NO_ELEMENTS,
        (fmi3Instance c, fmi3ValueReference reference, size_t *count))
ABSENT3(GetVariableDependencies, NO_ELEMENTS,
        (fmi3Instance c, fmi3ValueReference dependent, size_t elements[], fmi3ValueReference independents[],
         size_t others[], fmi3DependencyKind which[], size_t count))
#define NO_STRUCTURE "there are no structural parameters"
ABSENT3(EnterConfigurationMode, NO_STRUCTURE, (fmi3Instance c))
ABSENT3(ExitConfigurationMode, NO_STRUCTURE, (fmi3Instance c))
ABSENT3(EvaluateDiscreteStates, "providesEvaluateDiscreteStates is false", (fmi3Instance c))
/* NOLINTEND(misc-unused-parameters) */
#ifdef __GNUC__
#pragma GCC diagnostic pop
#endif
