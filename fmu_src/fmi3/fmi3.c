#include <float.h>
#include <fmi3Functions.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi/instance.h"
#include "fmi/log.h"
#include "fmi3/fmi3.h"
#include "math/compiler.h"
#include "model/exchange.h"
#include "scene.h"

/* One FMU instance for FMI 3.0. */

/* An fmi3Instance is the address of one. */
struct fmi3_instance {
    struct instance shared; /* comes first, so that both have one address */
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log_message;
    fmi3IntermediateUpdateCallback intermediate_update; /* NULL: none */
    bool event_mode_used;
    bool early_return_allowed;
    double event_time; /* of the last event in the last step [s]; NaN: there was none */
};

/* The model's statuses are fmi3Status values by another name. */
_Static_assert((int)MODEL_OK == (int)fmi3OK && (int)MODEL_WARNING == (int)fmi3Warning, "status order");
_Static_assert((int)MODEL_DISCARD == (int)fmi3Discard && (int)MODEL_ERROR == (int)fmi3Error, "status order");
_Static_assert((int)MODEL_FATAL == (int)fmi3Fatal, "status order");

static inline fmi3Status fmi3_status(enum model_status status)
{
    return (fmi3Status)status;
}

/* What is FMI 3.0's own in messages, names and saved states. */

extern const struct adapter adapter_of_fmi3;

/* Which function of FMI 3.0 may be called in which phase: one row, one mask a function. */

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

/* What is never in order: there are no clocks and no structural parameters. */
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

static void fmi3_send(struct instance *instance, enum model_status status, const char *category,
                      const char *text)
{
    const struct fmi3_instance *own = (const struct fmi3_instance *)instance;
    own->log_message(own->environment, fmi3_status(status), category, text);
}

const struct adapter adapter_of_fmi3 = {
    .send = fmi3_send,
    .doubled = "", /* the message is plain text */
    .type_names = {[VARIABLE_REAL] = "Float64",
                   [VARIABLE_INTEGER] = "Int32",
                   [VARIABLE_BOOLEAN] = "Boolean",
                   [VARIABLE_ENUMERATION] = "Enumeration (fmi3Int64)"},
    .state_name = "FMUState",
    .seed_name = "seed",
    .state_magic = 0x334E4F43u, /* "CON3" on a little-endian machine */
    .state_phases = (PHASES3_ALL | PHASE_FATAL) & ~PHASE_CONTINUOUS,
    .exchange_phases = (PHASES3_ALL | PHASE_FATAL) & ~PHASE_STEP,
    .knows_states_in_steps = true,
};

#define CALL3_RULE(function, phases) {"fmi3" #function, phases},
const struct call calls_of_fmi3[] = {CALL3_TABLE(CALL3_RULE)};
#undef CALL3_RULE

/* All functions of the standard, and those without a row, since they have no instance yet or no more. */
#define CALL3_EXPORT(function, phases) CONTACT_EXPORTED fmi3##function##TYPE fmi3##function;
CALL3_TABLE(CALL3_EXPORT)
#undef CALL3_EXPORT
CONTACT_EXPORTED fmi3GetVersionTYPE fmi3GetVersion;
CONTACT_EXPORTED fmi3InstantiateModelExchangeTYPE fmi3InstantiateModelExchange;
CONTACT_EXPORTED fmi3InstantiateCoSimulationTYPE fmi3InstantiateCoSimulation;
CONTACT_EXPORTED fmi3InstantiateScheduledExecutionTYPE fmi3InstantiateScheduledExecution;
CONTACT_EXPORTED fmi3FreeInstanceTYPE fmi3FreeInstance;

/* Creating an instance of Co-Simulation or of Model Exchange. */

/* An instance that lives only for messages, about why there is no other. */
static struct fmi3_instance make_nobody(const char *name, fmi3InstanceEnvironment environment,
                                        fmi3LogMessageCallback log_message)
{
    return (struct fmi3_instance){
        .shared = {.adapter = &adapter_of_fmi3,
                   .name = name == NULL ? "" : name,
                   .logger_given = log_message != NULL,
                   .log_categories = LOG_STATUS_ALL},
        .environment = environment,
        .log_message = log_message,
    };
}

static bool identity_in_order(struct instance *nobody, const char *function, const char *name,
                              const char *token)
{
    return instance_expects(nobody, function, name != NULL && name[0] != '\0', "instanceName", name,
                            "any name") &&
           instance_expects(nobody, function, token != NULL && strcmp(token, SCENE_TOKEN) == 0,
                            "instantiationToken", token, SCENE_TOKEN);
}

/* Only instances with an intermediate update need these; all of them are variables. */
static bool intermediate_in_order(struct instance *nobody, const char *function,
                                  const fmi3ValueReference required[], size_t count)
{
    if (required == NULL && count > 0) {
        return instance_expects(nobody, function, false, "requiredIntermediateVariables", "(null)",
                                "as many value references as told");
    }
    for (size_t i = 0; i < count; ++i) {
        char given[16]; /* 32 bits in decimal */
        (void)snprintf(given, sizeof given, "%u", (unsigned)required[i]);
        if (!instance_expects(nobody, function, vector_variable(required[i]) != NULL,
                              "requiredIntermediateVariables", given, "value references of variables")) {
            return false;
        }
    }
    return true;
}

/* A new instance with the name and the logger of `nobody`; NULL after a message where memory is exhausted. */
static struct fmi3_instance *instance_like(struct fmi3_instance *nobody, const char *function,
                                           bool logging_on, bool exchange)
{
    const struct model_host host = {.allocate = calloc, .release = free, .exchange = exchange};
    struct instance *instance = instance_create(&adapter_of_fmi3, &host, sizeof(struct fmi3_instance),
                                                nobody->shared.name, logging_on);
    if (instance == NULL) {
        (void)instance_expects(&nobody->shared, function, false, "memory", "exhausted",
                               "room for an instance");
        return NULL;
    }
    struct fmi3_instance *own = (struct fmi3_instance *)instance;
    own->environment = nobody->environment;
    own->log_message = nobody->log_message;
    instance->logger_given = nobody->shared.logger_given;
    return own;
}

/*
 * The resource path is not needed: the FMU has no resources it reads. Any string, or none, is accepted.
 */
fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken,
                                         fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                         fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables,
                                         fmi3InstanceEnvironment instanceEnvironment,
                                         fmi3LogMessageCallback logMessage,
                                         fmi3IntermediateUpdateCallback intermediateUpdate)
{
    const char *function = "fmi3InstantiateCoSimulation";
    (void)resourcePath;
    (void)visible;
    struct fmi3_instance nobody = make_nobody(instanceName, instanceEnvironment, logMessage);
    if (!identity_in_order(&nobody.shared, function, instanceName, instantiationToken) ||
        !instance_expects(&nobody.shared, function, !eventModeUsed || SCENE_ANY_FREE, "eventModeUsed", "true",
                          "false, as hasEventMode says") ||
        !intermediate_in_order(&nobody.shared, function, requiredIntermediateVariables,
                               nRequiredIntermediateVariables)) {
        return NULL;
    }
    struct fmi3_instance *own = instance_like(&nobody, function, loggingOn, false);
    if (own != NULL) {
        own->intermediate_update = intermediateUpdate;
        own->event_mode_used = eventModeUsed;
        if (eventModeUsed) { /* FMI 3.0.2, section 2.4.7.4: else at communication points */
            own->shared.tuning_phases = PHASE_EVENT;
        }
        own->early_return_allowed = earlyReturnAllowed;
    }
    return own;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment,
                                          fmi3LogMessageCallback logMessage)
{
    const char *function = "fmi3InstantiateModelExchange";
    (void)resourcePath;
    (void)visible;
    struct fmi3_instance nobody = make_nobody(instanceName, instanceEnvironment, logMessage);
    return identity_in_order(&nobody.shared, function, instanceName, instantiationToken)
               ? instance_like(&nobody, function, loggingOn, true)
               : NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
    fmi3UnlockPreemptionCallback unlockPreemption)
{
    (void)instantiationToken, (void)resourcePath, (void)visible, (void)loggingOn;
    (void)clockUpdate, (void)lockPreemption, (void)unlockPreemption;
    struct fmi3_instance nobody = make_nobody(instanceName, instanceEnvironment, logMessage);
    (void)instance_expects(&nobody.shared, "fmi3InstantiateScheduledExecution", false, "interface type",
                           "Scheduled Execution", "Co-Simulation or Model Exchange");
    return NULL;
}

/* Setting up, starting, ending and resetting an instance; fmi3.c creates it. */

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

void fmi3FreeInstance(fmi3Instance c)
{
    instance_free(c);
}

/* Named categories are switched on or off beside the others; none are all of them (FMI 3.0.2, section
 * 2.3.1). */
fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[])
{
    struct instance *instance = c;
    unsigned chosen = 0;
    const enum model_status status =
        instance_categories(instance, CALL3(SetDebugLogging), nCategories, categories, &chosen);
    if (status == MODEL_OK) {
        const unsigned bits = nCategories == 0 ? (unsigned)LOG_ALL : chosen;
        instance->log_categories =
            loggingOn ? instance->log_categories | bits : instance->log_categories & ~bits;
    }
    return fmi3_status(status);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined,
                                       fmi3Float64 stopTime)
{
    struct instance *instance = c;
    const enum model_status status =
        instance_set_up(instance, CALL3(EnterInitializationMode), toleranceDefined, tolerance, startTime,
                        stopTimeDefined, stopTime);
    if (status <= MODEL_WARNING) {
        instance->phase = PHASE_INITIALIZATION;
    }
    return fmi3_status(status);
}

/* With event mode the run begins there, and so it does in Model Exchange. */
fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    const struct fmi3_instance *own = c;
    const bool events = own != NULL && (own->event_mode_used || own->shared.host.exchange);
    const enum phase next = events ? PHASE_EVENT : PHASE_STEP;
    return fmi3_status(instance_exit_initialization(c, CALL3(ExitInitializationMode), next));
}

fmi3Status fmi3Terminate(fmi3Instance c)
{
    return fmi3_status(instance_enter(c, CALL3(Terminate), PHASE_TERMINATED));
}

fmi3Status fmi3Reset(fmi3Instance c)
{
    return fmi3_status(instance_reset(c, CALL3(Reset)));
}

const struct variable *vector_variable(uint32_t reference)
{
    const struct variable *variable = scene_variable(reference);
    return variable != NULL && variable->component == 0 ? variable : NULL;
}

size_t vector_length(const struct variable *first)
{
    const struct variable *end = scene_variables + scene_variable_count;
    size_t length = 1;
    while (first + length < end && first[length].row == first->row &&
           first[length].element == first->element && first[length].component == length) {
        ++length;
    }
    return length;
}

bool vectors_match(struct instance *instance, const struct call *call, const uint32_t *references,
                   size_t count, const char *values_name, size_t values)
{
    size_t components = 0;
    for (size_t i = 0; i < count; ++i) {
        const struct variable *variable = vector_variable(references[i]);
        if (variable == NULL) {
            report_wrong_reference(instance, call, NULL, references[i]);
            return false;
        }
        components += vector_length(variable);
    }
    if (components != values) {
        log_report(instance, MODEL_ERROR, "%s: %s = %lu, expected %lu for the %lu value references",
                   call->name, values_name, (unsigned long)values, (unsigned long)components,
                   (unsigned long)count);
        return false;
    }
    return true;
}

void vector_walk_next(struct vector_walk *walk, struct vector_chunk *chunk)
{
    chunk->count = 0;
    while (walk->at < walk->count && chunk->count < VECTOR_CHUNK) {
        const struct variable *first = vector_variable(walk->references[walk->at]);
        chunk->references[chunk->count] = first[walk->component].reference;
        chunk->origins[chunk->count] = walk->at;
        chunk->count += 1;
        walk->component += 1;
        if (walk->component == vector_length(first)) {
            walk->component = 0;
            walk->at += 1;
        }
    }
}

/*
 * Getting and setting values: known reference, right type, right time; every value is checked before any is
 * written. A vector is read and written as a whole.
 */

/* The independent variable: its reference is 0, which no variable of the model has. */
enum { TIME_REFERENCE = 0 };

/* A value as the model keeps it. */
union model_value {
    double real;
    int32_t integer; /* of everything else */
};

/* Writes a value to its place in the importer's array, whose elements are of the variable's type. */
static void put_value(const struct variable *variable, const union model_value *value, void *values,
                      size_t at)
{
    switch ((enum variable_type)variable->type) {
    case VARIABLE_REAL:
        ((fmi3Float64 *)values)[at] = value->real;
        break;
    case VARIABLE_INTEGER:
        ((fmi3Int32 *)values)[at] = value->integer;
        break;
    case VARIABLE_BOOLEAN:
        ((fmi3Boolean *)values)[at] = value->integer != 0;
        break;
    case VARIABLE_ENUMERATION:
        ((fmi3Int64 *)values)[at] = value->integer;
        break;
    }
}

/* Reads one from there; an enumeration's has been checked to fit. */
static void take_value(const struct variable *variable, const void *values, size_t at,
                       union model_value *value)
{
    switch ((enum variable_type)variable->type) {
    case VARIABLE_REAL:
        value->real = ((const fmi3Float64 *)values)[at];
        break;
    case VARIABLE_INTEGER:
        value->integer = ((const fmi3Int32 *)values)[at];
        break;
    case VARIABLE_BOOLEAN:
        value->integer = ((const fmi3Boolean *)values)[at] ? 1 : 0;
        break;
    case VARIABLE_ENUMERATION:
        value->integer = (int32_t)((const fmi3Int64 *)values)[at];
        break;
    }
}

/* What every get and set function asks first. */
static bool ready(struct instance *instance, const struct call *call, const fmi3ValueReference vr[],
                  size_t nvr, const void *values, size_t count)
{
    return call_allowed(instance, call) && call_array_given(instance, call, "valueReferences", vr, nvr) &&
           call_array_given(instance, call, "values", values, count);
}

static bool is_time(uint32_t reference, unsigned types)
{
    return reference == TIME_REFERENCE && (types & TYPES_REAL) != 0;
}

static enum model_status report_count(struct instance *instance, const struct call *call, size_t given,
                                      size_t expected)
{
    return log_report(instance, MODEL_ERROR, "%s: nValues = %lu, expected %lu for the value references",
                      call->name, (unsigned long)given, (unsigned long)expected);
}

/* In Model Exchange states may be set one by one; in event mode not those that events may make jump (FMI
 * 3.0.2, sections 2.3.5 and 3.2.1). */
static bool is_settable_state(const struct instance *instance, const struct variable *variable,
                              unsigned types)
{
    return variable->causality == VARIABLE_STATE && instance->host.exchange && (types & TYPES_REAL) != 0 &&
           (instance->phase == PHASE_CONTINUOUS || (instance->phase == PHASE_EVENT && !variable->reinit));
}

/* The variable, of a vector its first component, as find_readable and find_settable have it. */
static const struct variable *find_first(struct instance *instance, const struct call *call,
                                         uint32_t reference, unsigned types, bool to_set)
{
    const struct variable *first = vector_variable(reference);
    if (first == NULL) {
        return report_wrong_reference(instance, call, NULL, reference);
    }
    if (to_set && is_settable_state(instance, first, types)) {
        return first;
    }
    return to_set ? find_settable(instance, call, reference, types)
                  : find_readable(instance, call, reference, types);
}

/* How many values the references have, all of which may be read. */
static enum model_status check_readable(struct instance *instance, const struct call *call, unsigned types,
                                        const fmi3ValueReference vr[], size_t nvr, size_t count)
{
    size_t components = 0;
    for (size_t i = 0; i < nvr; ++i) {
        if (is_time(vr[i], types)) {
            components += 1;
            continue;
        }
        const struct variable *first = find_first(instance, call, vr[i], types, false);
        if (first == NULL) {
            return MODEL_ERROR;
        }
        components += vector_length(first);
    }
    return components == count ? MODEL_OK : report_count(instance, call, count, components);
}

CONTACT_NOINLINE static enum model_status fmi3_get_values(struct instance *instance, const struct call *call,
                                                          unsigned types, const fmi3ValueReference vr[],
                                                          size_t nvr, void *values, size_t count)
{
    if (!ready(instance, call, vr, nvr, values, count)) {
        return MODEL_ERROR;
    }
    enum model_status status = check_readable(instance, call, types, vr, nvr, count);
    size_t at = 0;
    for (size_t i = 0; i < nvr && status == MODEL_OK; ++i) {
        if (is_time(vr[i], types)) {
            ((fmi3Float64 *)values)[at++] = model_time(instance->model);
            continue;
        }
        const struct variable *first = vector_variable(vr[i]);
        const size_t length = vector_length(first);
        for (size_t k = 0; k < length && status == MODEL_OK; ++k) {
            union model_value value;
            status = model_read(instance->model, first + k, &value);
            if (status == MODEL_OK) {
                put_value(first, &value, values, at++);
            }
        }
    }
    return status;
}

/* An enumeration's value has 64 bits here and 32 in the model, of which it needs few. */
static enum model_status check_value(struct instance *instance, const struct variable *variable,
                                     const void *values, size_t at)
{
    if (variable->type == VARIABLE_ENUMERATION) {
        const fmi3Int64 given = ((const fmi3Int64 *)values)[at];
        if (given < INT32_MIN || given > INT32_MAX) {
            return log_report(instance, MODEL_DISCARD,
                              "%s = %lld refused (allowed: %.10g .. %.10g); it stays as it was.",
                              variable->name, (long long)given, variable->min, variable->max);
        }
    }
    union model_value value;
    take_value(variable, values, at, &value);
    return model_check(instance->model, variable, &value);
}

static enum model_status check_settable(struct instance *instance, const struct call *call, unsigned types,
                                        const fmi3ValueReference vr[], size_t nvr, const void *values,
                                        size_t count)
{
    size_t components = 0;
    for (size_t i = 0; i < nvr; ++i) {
        if (is_time(vr[i], types)) {
            return log_report(instance, MODEL_ERROR, "%s: time is the independent variable and cannot be set",
                              call->name);
        }
        const struct variable *first = find_first(instance, call, vr[i], types, true);
        if (first == NULL) {
            return MODEL_ERROR;
        }
        const size_t length = vector_length(first);
        for (size_t k = 0; k < length && components + k < count; ++k) {
            const enum model_status status = check_value(instance, first + k, values, components + k);
            if (status > MODEL_WARNING) {
                return status;
            }
        }
        components += length;
    }
    return components == count ? MODEL_OK : report_count(instance, call, count, components);
}

static enum model_status fmi3_set_values(struct instance *instance, const struct call *call, unsigned types,
                                         const fmi3ValueReference vr[], size_t nvr, const void *values,
                                         size_t count)
{
    if (!ready(instance, call, vr, nvr, values, count)) {
        return MODEL_ERROR;
    }
    const enum model_status status = check_settable(instance, call, types, vr, nvr, values, count);
    size_t at = 0;
    for (size_t i = 0; i < nvr && status == MODEL_OK; ++i) {
        const struct variable *first = vector_variable(vr[i]);
        const size_t length = vector_length(first);
        for (size_t k = 0; k < length; ++k) {
            union model_value value;
            take_value(first, values, at++, &value);
            if (first->causality == VARIABLE_STATE) {
                model_exchange_set_state(instance->model, first + k, value.real);
            } else {
                model_set(instance->model, first + k, &value);
            }
        }
    }
    return status;
}

/* One vector, as they are mostly read in a run. Flattened, because calls would be a good part of what that
 * costs. */
CONTACT_FLATTEN fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr,
                                          fmi3Float64 values[], size_t count)
{
    struct instance *instance = c;
    if (instance != NULL && instance->phase == PHASE_STEP && nvr == 1 && count == 3 && vr != NULL) {
        const uint32_t components[3] = {vr[0], vr[0] + 1, vr[0] + 2};
        if (model_get_vector(instance->model, components, values)) {
            return fmi3OK;
        }
    }
    return fmi3_status(fmi3_get_values(instance, CALL3(GetFloat64), TYPES_REAL, vr, nvr, values, count));
}

/* A function for each type that some variable has, ... */
#define GETTER(Type, types)                                                                                  \
    fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3##Type values[], \
                             size_t count)                                                                   \
    {                                                                                                        \
        return fmi3_status(fmi3_get_values(c, CALL3(Get##Type), types, vr, nvr, (void *)values, count));     \
    }
#define SETTER(Type, types)                                                                                  \
    fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr,                      \
                             const fmi3##Type values[], size_t count)                                        \
    {                                                                                                        \
        return fmi3_status(                                                                                  \
            fmi3_set_values(c, CALL3(Set##Type), types, vr, nvr, (const void *)values, count));              \
    }
SETTER(Float64, TYPES_REAL)
GETTER(Int32, TYPES_INTEGER)
SETTER(Int32, TYPES_INTEGER)
GETTER(Int64, TYPES_ENUMERATION)
SETTER(Int64, TYPES_ENUMERATION)
GETTER(Boolean, TYPES_BOOLEAN)
SETTER(Boolean, TYPES_BOOLEAN)

/* ... and for those that none has, so that every reference is a wrong one. */
#define BOTH(Type)                                                                                           \
    GETTER(Type, TYPES_NONE)                                                                                 \
    SETTER(Type, TYPES_NONE)
BOTH(Float32)
BOTH(Int8)
BOTH(UInt8)
BOTH(Int16)
BOTH(UInt16)
BOTH(UInt32)
BOTH(UInt64)
BOTH(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, size_t valueSizes[],
                         fmi3Binary values[], size_t count)
{
    (void)valueSizes;
    return fmi3_status(fmi3_get_values(c, CALL3(GetBinary), TYPES_NONE, vr, nvr, (void *)values, count));
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const size_t valueSizes[],
                         const fmi3Binary values[], size_t count)
{
    (void)valueSizes;
    return fmi3_status(
        fmi3_set_values(c, CALL3(SetBinary), TYPES_NONE, vr, nvr, (const void *)values, count));
}

/* Derivatives of outputs with respect to time. */

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr,
                                    const fmi3Int32 orders[], fmi3Float64 values[], size_t count)
{
    struct instance *instance = c;
    const struct call *call = CALL3(GetOutputDerivatives);
    if (!call_allowed_in_steps(instance, call) ||
        !call_array_given(instance, call, "valueReferences", vr, nvr) ||
        !call_array_given(instance, call, "orders", orders, nvr) ||
        !call_array_given(instance, call, "values", values, count) ||
        !vectors_match(instance, call, vr, nvr, "nValues", count)) {
        return fmi3Error;
    }
    struct vector_walk walk = {vr, nvr, 0, 0};
    struct vector_chunk chunk;
    enum model_status status = MODEL_OK;
    for (size_t done = 0; done < count && status == MODEL_OK; done += chunk.count) {
        int order_of[VECTOR_CHUNK];
        vector_walk_next(&walk, &chunk);
        for (size_t i = 0; i < chunk.count; ++i) {
            order_of[i] = orders[chunk.origins[i]];
        }
        status = output_derivatives(instance, call, chunk.references, order_of, chunk.count, values + done);
    }
    return fmi3_status(status);
}

/*
 * Derivatives of outputs with respect to inputs, along a direction of inputs and, adjoint, of outputs.
 * Vectors are taken apart into chunks of components on the stack, and the products of the chunks summed up.
 */

/* The unknowns and knowns of a matrix J of derivatives, and what it is multiplied with and gives. */
struct product {
    bool adjoint; /* seed J, with a seed for each unknown; else J seed, with one for each known */
    const fmi3ValueReference *unknowns, *knowns;
    size_t unknown_count, known_count;           /* references */
    size_t unknown_components, known_components; /* as the importer counts them */
    const fmi3Float64 *seed;
    fmi3Float64 *sensitivity;
};

static bool arrays_in_order(struct instance *instance, const struct call *call, const struct product *p)
{
    const size_t seeds = p->adjoint ? p->unknown_components : p->known_components;
    const size_t sensitivities = p->adjoint ? p->known_components : p->unknown_components;
    return call_array_given(instance, call, "unknowns", p->unknowns, p->unknown_count) &&
           call_array_given(instance, call, "knowns", p->knowns, p->known_count) &&
           call_array_given(instance, call, "seed", p->seed, seeds) &&
           call_array_given(instance, call, "sensitivity", p->sensitivity, sensitivities) &&
           vectors_match(instance, call, p->unknowns, p->unknown_count, p->adjoint ? "nSeed" : "nSensitivity",
                         p->unknown_components) &&
           vectors_match(instance, call, p->knowns, p->known_count, p->adjoint ? "nSensitivity" : "nSeed",
                         p->known_components);
}

static enum model_status check_seeds(struct instance *instance, const struct call *call,
                                     const fmi3ValueReference references[], size_t count,
                                     const fmi3Float64 seed[])
{
    struct vector_walk walk = {references, count, 0, 0};
    struct vector_chunk chunk;
    enum model_status status = MODEL_OK;
    for (vector_walk_next(&walk, &chunk); chunk.count > 0; vector_walk_next(&walk, &chunk)) {
        for (size_t i = 0; i < chunk.count && status == MODEL_OK; ++i) {
            status = check_seed(instance, call, chunk.references[i], *seed++);
        }
    }
    return status;
}

static enum model_status check_product(struct instance *instance, const struct call *call,
                                       const struct product *p)
{
    enum model_status status = check_unknowns(instance, call, p->unknowns, p->unknown_count);
    for (size_t i = 0; i < p->known_count && status == MODEL_OK; ++i) {
        status = check_known(instance, call, p->knowns[i]);
    }
    if (status != MODEL_OK) {
        return status;
    }
    return p->adjoint ? check_seeds(instance, call, p->unknowns, p->unknown_count, p->seed)
                      : check_seeds(instance, call, p->knowns, p->known_count, p->seed);
}

/* Sets the first chunk's part of a sum, or adds a later one's: 0 + x would lose the sign of a zero. */
static void add_up(double *sum, const double *part, size_t count, bool first)
{
    for (size_t i = 0; i < count; ++i) {
        sum[i] = first ? part[i] : sum[i] + part[i];
    }
}

/* An importer's array from an element on; it may be missing where there are none. */
static const double *given_from(const double *array, size_t at)
{
    return at > 0 ? array + at : array;
}

static double *room_from(double *array, size_t at)
{
    return at > 0 ? array + at : array;
}

static enum model_status multiply(struct instance *instance, const struct product *p)
{
    struct vector_walk unknowns = {p->unknowns, p->unknown_count, 0, 0};
    struct vector_chunk unknown, known;
    enum model_status status = MODEL_OK;
    size_t row = 0;
    do {
        struct vector_walk knowns = {p->knowns, p->known_count, 0, 0};
        size_t column = 0;
        vector_walk_next(&unknowns, &unknown);
        do {
            double part[VECTOR_CHUNK];
            vector_walk_next(&knowns, &known);
            if (p->adjoint) {
                status = model_get_adjoint_derivative(instance->model, unknown.references, unknown.count,
                                                      known.references, known.count, given_from(p->seed, row),
                                                      part);
                add_up(room_from(p->sensitivity, column), part, known.count, row == 0);
            } else {
                status = model_get_directional_derivative(instance->model, unknown.references, unknown.count,
                                                          known.references, known.count,
                                                          given_from(p->seed, column), part);
                add_up(room_from(p->sensitivity, row), part, unknown.count, column == 0);
            }
            column += known.count;
        } while (status <= MODEL_WARNING && column < p->known_components);
        row += unknown.count;
    } while (status <= MODEL_WARNING && row < p->unknown_components);
    return status;
}

static fmi3Status product(struct instance *instance, const struct call *call, const struct product *p)
{
    if (!call_allowed(instance, call) || !arrays_in_order(instance, call, p)) {
        return fmi3Error;
    }
    const enum model_status status = check_product(instance, call, p);
    return fmi3_status(status == MODEL_OK ? multiply(instance, p) : status);
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                        const fmi3ValueReference knowns[], size_t nKnowns,
                                        const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[],
                                        size_t nSensitivity)
{
    const struct product p = {.adjoint = false,
                              .unknowns = unknowns,
                              .knowns = knowns,
                              .unknown_count = nUnknowns,
                              .known_count = nKnowns,
                              .unknown_components = nSensitivity,
                              .known_components = nSeed,
                              .seed = seed,
                              .sensitivity = sensitivity};
    return product(c, CALL3(GetDirectionalDerivative), &p);
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                    const fmi3ValueReference knowns[], size_t nKnowns,
                                    const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[],
                                    size_t nSensitivity)
{
    const struct product p = {.adjoint = true,
                              .unknowns = unknowns,
                              .knowns = knowns,
                              .unknown_count = nUnknowns,
                              .known_count = nKnowns,
                              .unknown_components = nSeed,
                              .known_components = nSensitivity,
                              .seed = seed,
                              .sensitivity = sensitivity};
    return product(c, CALL3(GetAdjointDerivative), &p);
}

/* Communication steps, and the events and intermediate updates within them. */

/* Tells the importer of an instant within the step; when it wants the step to end. */
static double tell_importer(struct fmi3_instance *own, double end_time)
{
    struct instance *instance = &own->shared;
    const double now = own->event_time;
    bool requested = false;
    double requested_time = end_time;
    instance->phase = (enum phase)(PHASE_STEP | PHASE_INTERMEDIATE);
    own->intermediate_update(own->environment, now, fmi3False, fmi3True, fmi3True, own->early_return_allowed,
                             &requested, &requested_time);
    instance->phase = PHASE_STEP;
    if (!requested || !own->early_return_allowed) {
        return end_time;
    }
    return requested_time > now ? fmin(requested_time, end_time) : now;
}

/* A contact begins or ends (struct step_request). */
static double at_event(void *context, double end_time)
{
    struct fmi3_instance *own = context;
    own->event_time = model_time(own->shared.model);
    if (own->intermediate_update != NULL) {
        end_time = tell_importer(own, end_time);
    }
    return own->event_mode_used && own->early_return_allowed ? own->event_time : end_time;
}

/* Where to put what a step tells besides its status. */
struct results {
    fmi3Boolean *event, *terminate, *early;
    fmi3Float64 *time; /* reached [s] */
};

/* The model never ends a run by itself. */
static inline void put_results(const struct results *to, bool event, bool early, double time)
{
    *to->event = event;
    *to->terminate = fmi3False;
    *to->early = early;
    *to->time = time;
}

/* A step that gets stuck is undone: fmi3Discard leaves an instance as it was. */
static enum model_status take_checked_step(struct fmi3_instance *own, double end, const struct results *to)
{
    struct instance *instance = &own->shared;
    const struct step_request request = {
        .end_time = end,
        .at_event = own->event_mode_used || own->intermediate_update != NULL ? at_event : NULL,
        .context = own,
        .whole = true,
    };
    own->event_time = (double)NAN;
    const enum model_status status = step_end(instance, model_step_requested(instance->model, &request));
    const double time = model_time(instance->model);
    const bool early = status <= MODEL_WARNING && end - time > 4.0 * DBL_EPSILON * fabs(end);
    /* The model's time is a sum, which may differ from the end by a rounding: who goes on while its own time
     * is before the stop time is told the time that it asked for. */
    const bool reached = status <= MODEL_WARNING && !early;
    put_results(to, own->event_mode_used && own->event_time == time, early, reached ? end : time);
    return status;
}

static bool has_room(struct instance *instance, const char *name, const void *room)
{
    if (room == NULL) {
        (void)call_array_given(instance, CALL3(DoStep), name, NULL, 1); /* says so */
    }
    return room != NULL;
}

static bool have_room(struct instance *instance, const struct results *to)
{
    return has_room(instance, "eventHandlingNeeded", to->event) &&
           has_room(instance, "terminateSimulation", to->terminate) &&
           has_room(instance, "earlyReturn", to->early) && has_room(instance, "lastSuccessfulTime", to->time);
}

/* Any step, with messages. Apart from fmi3DoStep, so that a deferred flight does not save registers for it;
 * its arguments are so few that all of them are in registers. */
CONTACT_NOINLINE static fmi3Status fmi3_do_step(struct instance *instance, double point, double size,
                                                fmi3Boolean *event, fmi3Boolean *terminate,
                                                fmi3Boolean *early, fmi3Float64 *time)
{
    const struct results to = {event, terminate, early, time};
    if (!call_allowed_in_steps(instance, CALL3(DoStep)) || !have_room(instance, &to)) {
        return fmi3Error;
    }
    enum model_status status = step_check(instance, CALL3(DoStep), point, size);
    if (status == MODEL_OK) {
        status = take_checked_step((struct fmi3_instance *)instance, point + size, &to);
    } else {
        put_results(&to, false, false, model_time(instance->model));
    }
    instance->step_status = status;
    return fmi3_status(status);
}

/*
 * Nothing is kept for going back (states are saved on request), so noSetFMUStatePriorToCurrentPoint is idle.
 * Flattened, because calls would be a good part of what a deferred flight costs.
 */
CONTACT_FLATTEN fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 currentCommunicationPoint,
                                      fmi3Float64 communicationStepSize,
                                      fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                      fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
                                      fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
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
        const struct results to = {eventHandlingNeeded, terminateSimulation, earlyReturn, lastSuccessfulTime};
        put_results(&to, false, false, currentCommunicationPoint + communicationStepSize);
        return fmi3OK; /* as the step before, so that step_status need not be written */
    }
    return fmi3_do_step(instance, currentCommunicationPoint, communicationStepSize, eventHandlingNeeded,
                        terminateSimulation, earlyReturn, lastSuccessfulTime);
}

/*
 * Event mode. In Co-Simulation a contact that begins or ends has changed its regime when fmi3DoStep returns:
 * nothing is left to iterate, nor scheduled. In Model Exchange regimes change here, and touches of bodies in
 * flight are announced.
 */

fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
    struct fmi3_instance *own = c;
    const struct call *call = CALL3(EnterEventMode);
    if (!call_allowed(c, call)) {
        return fmi3Error;
    }
    if (own->shared.host.exchange) {
        return fmi3_status(exchange_enter(c, call, PHASE_EVENT));
    }
    if (!own->event_mode_used) {
        return fmi3_status(call_refuse(c, call, "instantiated with eventModeUsed = false"));
    }
    own->shared.phase = PHASE_EVENT;
    return fmi3OK;
}

fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
    const struct call *call = CALL3(EnterStepMode);
    return call_allowed_in_steps(c, call) ? fmi3_status(instance_enter(c, call, PHASE_STEP)) : fmi3Error;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation,
                                    fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged,
                                    fmi3Boolean *nextEventTimeDefined, fmi3Float64 *nextEventTime)
{
    struct instance *instance = c;
    const struct call *call = CALL3(UpdateDiscreteStates);
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
    struct exchange_news news = {0};
    const enum model_status status =
        instance->host.exchange ? exchange_update(instance, call, &news) : MODEL_OK;
    *discreteStatesNeedUpdate = news.again;
    *terminateSimulation = fmi3False;
    *nominalsOfContinuousStatesChanged = fmi3False;
    *valuesOfContinuousStatesChanged = news.jumped;
    *nextEventTimeDefined = news.scheduled;
    *nextEventTime = news.event_time;
    return fmi3_status(status);
}

/* Model Exchange by the names of FMI 3.0; event mode is in fmi3.c. */

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

/* Saved states by the names of FMI 3.0. */

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *FMUState)
{
    return fmi3_status(state_block_get(c, CALL3(GetFMUState), FMUState));
}

/* A state of another instance of Co-Simulation may be one of event mode, which this one may not have. */
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState FMUState)
{
    struct fmi3_instance *own = c;
    const enum model_status status = state_block_set(c, CALL3(SetFMUState), FMUState);
    if (status <= MODEL_WARNING && own->shared.phase == PHASE_EVENT && !own->shared.host.exchange &&
        !own->event_mode_used) {
        own->shared.phase = PHASE_STEP;
    }
    return fmi3_status(status);
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *FMUState)
{
    return fmi3_status(state_block_free(c, CALL3(FreeFMUState), FMUState));
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState FMUState, size_t *size)
{
    return fmi3_status(state_block_size(c, CALL3(SerializedFMUStateSize), FMUState, size));
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState FMUState, fmi3Byte serializedState[],
                                 size_t size)
{
    return fmi3_status(state_block_serialize(c, CALL3(SerializeFMUState), FMUState, serializedState, size));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte serializedState[], size_t size,
                                   fmi3FMUState *FMUState)
{
    return fmi3_status(
        state_block_deserialize(c, CALL3(DeserializeFMUState), serializedState, size, FMUState));
}

/*
 * Functions of the standard for what these FMUs do not have: there, because importers look for all of them,
 * and refused in words.
 */

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
