#include <float.h>
#include <fmi2Functions.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi/instance.h"
#include "fmi/log.h"
#include "math/compiler.h"
#include "scene.h"

/* One FMU instance for FMI 2.0. */

/* An fmi2Component is the address of one. */
struct fmi2_instance {
    struct instance shared; /* comes first, so that both have one address */
    fmi2CallbackFunctions callbacks;
    double asked_end; /* of the last step, as the importer asked for it [s] */
};

/* The model's statuses are fmi2Status values by another name. */
_Static_assert((int)MODEL_OK == (int)fmi2OK && (int)MODEL_WARNING == (int)fmi2Warning, "status order");
_Static_assert((int)MODEL_DISCARD == (int)fmi2Discard && (int)MODEL_ERROR == (int)fmi2Error, "status order");
_Static_assert((int)MODEL_FATAL == (int)fmi2Fatal, "status order");

static inline fmi2Status fmi2_status(enum model_status status)
{
    return (fmi2Status)status;
}

/* What is FMI 2.0's own in messages, names and saved states. */

extern const struct adapter adapter_of_fmi2;

/* Which function of FMI 2.0 may be called in which phase: one row, one mask a function. */

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

static void fmi2_send(struct instance *instance, enum model_status status, const char *category,
                      const char *text)
{
    const fmi2CallbackFunctions *callbacks = &((const struct fmi2_instance *)instance)->callbacks;
    callbacks->logger(callbacks->componentEnvironment, instance->name, fmi2_status(status), category, text);
}

const struct adapter adapter_of_fmi2 = {
    .send = fmi2_send,
    /* The logger takes a printf format in which '#' marks value references (FMI 2.0.5). */
    .doubled = "%#",
    .type_names = {[VARIABLE_REAL] = "Real",
                   [VARIABLE_INTEGER] = "Integer",
                   [VARIABLE_BOOLEAN] = "Boolean",
                   [VARIABLE_ENUMERATION] = "Enumeration (fmi2Integer)"},
    .state_name = "FMUstate",
    .seed_name = "dvKnown",
    .state_magic = 0x544E4F43u, /* "CONT" on a little-endian machine */
    .state_phases = (PHASES2_ALL | PHASE_FATAL) & ~PHASES2_EXCHANGED,
    .exchange_phases = (PHASES2_ALL | PHASE_FATAL) & ~PHASE_STEP,
};

#define CALL2_RULE(function, phases) {"fmi2" #function, phases},
const struct call calls_of_fmi2[] = {CALL2_TABLE(CALL2_RULE)};
#undef CALL2_RULE

/* All functions of the standard, and those without a row, since they have no instance yet or no more. */
#define CALL2_EXPORT(function, phases) CONTACT_EXPORTED fmi2##function##TYPE fmi2##function;
CALL2_TABLE(CALL2_EXPORT)
#undef CALL2_EXPORT
CONTACT_EXPORTED fmi2GetTypesPlatformTYPE fmi2GetTypesPlatform;
CONTACT_EXPORTED fmi2GetVersionTYPE fmi2GetVersion;
CONTACT_EXPORTED fmi2InstantiateTYPE fmi2Instantiate;
CONTACT_EXPORTED fmi2FreeInstanceTYPE fmi2FreeInstance;

/* Creating, setting up, starting, ending and resetting an instance. */

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

/* The importer's memory functions where it gives both; one without the other would mix two heaps. */
static struct model_host host_of(const fmi2CallbackFunctions *callbacks, fmi2Type type)
{
    const bool given = callbacks->allocateMemory != NULL && callbacks->freeMemory != NULL;
    return (struct model_host){.allocate = given ? callbacks->allocateMemory : calloc,
                               .release = given ? callbacks->freeMemory : free,
                               .exchange = type == fmi2ModelExchange};
}

/* Whether the arguments are in order; else says what is not, through an instance that lives only for that. */
static bool arguments_in_order(struct instance *nobody, const char *name, fmi2Type type, const char *guid)
{
    const char *function = "fmi2Instantiate";
    return instance_expects(nobody, function, name != NULL && name[0] != '\0', "instanceName", name,
                            "any name") &&
           instance_expects(nobody, function, type == fmi2CoSimulation || type == fmi2ModelExchange,
                            "fmuType", "(unknown)", "fmi2CoSimulation or fmi2ModelExchange") &&
           instance_expects(nobody, function, guid != NULL && strcmp(guid, SCENE_GUID) == 0, "fmuGUID", guid,
                            SCENE_GUID);
}

/*
 * The resource location is not needed: the FMU has no resources it reads. Any string, or none, is accepted.
 */
fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn)
{
    (void)fmuResourceLocation;
    (void)visible;
    if (functions == NULL) {
        return NULL;
    }
    struct fmi2_instance nobody = {
        .shared = {.adapter = &adapter_of_fmi2,
                   .name = instanceName == NULL ? "" : instanceName,
                   .logger_given = functions->logger != NULL,
                   .log_categories = LOG_STATUS_ALL},
        .callbacks = *functions,
    };
    if (!arguments_in_order(&nobody.shared, instanceName, fmuType, fmuGUID)) {
        return NULL;
    }
    const struct model_host host = host_of(functions, fmuType);
    struct instance *instance = instance_create(&adapter_of_fmi2, &host, sizeof(struct fmi2_instance),
                                                instanceName, loggingOn != fmi2False);
    if (instance == NULL) {
        instance_expects(&nobody.shared, "fmi2Instantiate", false, "memory", "exhausted",
                         "room for an instance");
        return NULL;
    }
    ((struct fmi2_instance *)instance)->callbacks = *functions;
    instance->logger_given = functions->logger != NULL;
    return instance;
}

void fmi2FreeInstance(fmi2Component c)
{
    instance_free(c);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    struct instance *instance = c;
    unsigned chosen = 0;
    const enum model_status status =
        instance_categories(instance, CALL2(SetDebugLogging), nCategories, categories, &chosen);
    if (status == MODEL_OK) {
        /* Switching off means: no more than what everybody gets, never silence by accident. */
        const bool all = loggingOn == fmi2False || nCategories == 0;
        instance->log_categories = all ? log_default_categories(loggingOn != fmi2False) : chosen;
    }
    return fmi2_status(status);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    return fmi2_status(instance_set_up(c, CALL2(SetupExperiment), toleranceDefined != fmi2False, tolerance,
                                       startTime, stopTimeDefined != fmi2False, stopTime));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL2(EnterInitializationMode))) {
        return fmi2Error;
    }
    if (!instance->experiment.set_up) {
        return fmi2_status(log_report(instance, MODEL_ERROR,
                                      "fmi2EnterInitializationMode called before fmi2SetupExperiment"));
    }
    instance->phase = PHASE_INITIALIZATION;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    const struct instance *instance = c;
    const bool exchange = instance != NULL && instance->host.exchange;
    return fmi2_status(
        instance_exit_initialization(c, CALL2(ExitInitializationMode), exchange ? PHASE_EVENT : PHASE_STEP));
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    return fmi2_status(instance_enter(c, CALL2(Terminate), PHASE_TERMINATED));
}

fmi2Status fmi2Reset(fmi2Component c)
{
    return fmi2_status(instance_reset(c, CALL2(Reset)));
}

/*
 * Getting and setting values: known reference, right type, right time; every value is checked before any is
 * written.
 */

/* fmi2SetInteger takes enumerations too. */
enum { TYPES_WHOLE = TYPES_INTEGER | TYPES_ENUMERATION };

/* What every get and set function asks first. */
static inline bool fmi2_ready(struct instance *instance, const struct call *call,
                              const fmi2ValueReference vr[], size_t nvr, const void *value)
{
    return call_allowed(instance, call) && call_array_given(instance, call, "vr", vr, nvr) &&
           call_array_given(instance, call, "value", value, nvr);
}

/* value: nvr values of `size` bytes. */
static inline fmi2Status read_values(struct instance *instance, const struct call *call, unsigned types,
                                     const fmi2ValueReference vr[], size_t nvr, void *value, size_t size)
{
    for (size_t i = 0; i < nvr; ++i) {
        if (find_readable(instance, call, vr[i], types) == NULL) {
            return fmi2Error;
        }
    }
    enum model_status status = MODEL_OK;
    for (size_t i = 0; i < nvr && status == MODEL_OK; ++i) {
        status = model_read(instance->model, scene_variable(vr[i]), (char *)value + i * size);
    }
    return fmi2_status(status);
}

static fmi2Status fmi2_get_values(struct instance *instance, const struct call *call, unsigned types,
                                  const fmi2ValueReference vr[], size_t nvr, void *value, size_t size)
{
    return fmi2_ready(instance, call, vr, nvr, value)
               ? read_values(instance, call, types, vr, nvr, value, size)
               : fmi2Error;
}

/* Any number, with messages. Apart from fmi2GetReal, so that reading a vector does not save registers for
 * it. */
CONTACT_NOINLINE static fmi2Status get_reals(struct instance *instance, const fmi2ValueReference vr[],
                                             size_t nvr, fmi2Real value[])
{
    if (!fmi2_ready(instance, CALL2(GetReal), vr, nvr, value)) {
        return fmi2Error;
    }
    if (instance->phase == PHASE_STEP && model_get_reals(instance->model, vr, nvr, value) == nvr) {
        return fmi2OK;
    }
    return read_values(instance, CALL2(GetReal), TYPES_REAL, vr, nvr, value, sizeof *value);
}

/* Vectors are mostly read as a whole. Flattened, because calls would be a good part of what that costs. */
CONTACT_FLATTEN fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       fmi2Real value[])
{
    struct instance *instance = c;
    if (instance == NULL) {
        return fmi2Error;
    }
    if (instance->phase == PHASE_STEP && nvr == 3 && model_get_vector(instance->model, vr, value)) {
        return fmi2OK;
    }
    return get_reals(instance, vr, nvr, value);
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Integer value[])
{
    return fmi2_get_values(c, CALL2(GetInteger), TYPES_WHOLE, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[])
{
    return fmi2_get_values(c, CALL2(GetBoolean), TYPES_BOOLEAN, vr, nvr, value, sizeof *value);
}

/* There are no string variables, so that every reference is a wrong one. */
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[])
{
    return fmi2_get_values(c, CALL2(GetString), TYPES_NONE, vr, nvr, (void *)value, sizeof *value);
}

static fmi2Status fmi2_set_values(struct instance *instance, const struct call *call, unsigned types,
                                  const fmi2ValueReference vr[], size_t nvr, const void *value, size_t size)
{
    if (!fmi2_ready(instance, call, vr, nvr, value)) {
        return fmi2Error;
    }
    const char *bytes = value;
    for (size_t i = 0; i < nvr; ++i) {
        const struct variable *variable = find_settable(instance, call, vr[i], types);
        if (variable == NULL) {
            return fmi2Error;
        }
        const enum model_status status = model_check(instance->model, variable, bytes + i * size);
        if (status > MODEL_WARNING) {
            return fmi2_status(status);
        }
    }
    for (size_t i = 0; i < nvr; ++i) {
        model_set(instance->model, scene_variable(vr[i]), bytes + i * size);
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    return fmi2_set_values(c, CALL2(SetReal), TYPES_REAL, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Integer value[])
{
    return fmi2_set_values(c, CALL2(SetInteger), TYPES_WHOLE, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Boolean value[])
{
    return fmi2_set_values(c, CALL2(SetBoolean), TYPES_BOOLEAN, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[])
{
    return fmi2_set_values(c, CALL2(SetString), TYPES_NONE, vr, nvr, (const void *)value, sizeof *value);
}

/* Derivatives with respect to time of inputs and outputs, and of outputs with respect to inputs. */

static bool arrays_given(struct instance *instance, const struct call *call, const fmi2ValueReference vr[],
                         size_t nvr, const fmi2Integer order[], const fmi2Real value[])
{
    return call_allowed_in_steps(instance, call) && call_array_given(instance, call, "vr", vr, nvr) &&
           call_array_given(instance, call, "order", order, nvr) &&
           call_array_given(instance, call, "value", value, nvr);
}

static enum model_status check_input_derivative(struct instance *instance, fmi2ValueReference reference,
                                                fmi2Integer order, fmi2Real value)
{
    const struct variable *variable =
        find_real(instance, CALL2(SetRealInputDerivatives), reference, VARIABLE_INPUT);
    if (variable == NULL) {
        return MODEL_ERROR;
    }
    const enum model_status status = check_order(instance, CALL2(SetRealInputDerivatives), variable, order);
    if (status == MODEL_OK && !isfinite(value)) {
        return log_report(
            instance, MODEL_DISCARD,
            "fmi2SetRealInputDerivatives: derivative of order %d of %s = %g refused, allowed: finite", order,
            variable->name, value);
    }
    return status;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    struct instance *instance = c;
    if (!arrays_given(instance, CALL2(SetRealInputDerivatives), vr, nvr, order, value)) {
        return fmi2Error;
    }
    for (size_t i = 0; i < nvr; ++i) {
        const enum model_status status = check_input_derivative(instance, vr[i], order[i], value[i]);
        if (status != MODEL_OK) {
            return fmi2_status(status);
        }
    }
    enum model_status worst = MODEL_OK;
    for (size_t i = 0; i < nvr && worst <= MODEL_WARNING; ++i) {
        const struct variable *variable = scene_variable(vr[i]);
        const enum model_status status =
            model_set_input_derivative(instance->model, variable, order[i], value[i]);
        worst = status > worst ? status : worst;
    }
    return fmi2_status(worst);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[])
{
    struct instance *instance = c;
    return arrays_given(instance, CALL2(GetRealOutputDerivatives), vr, nvr, order, value)
               ? fmi2_status(
                     output_derivatives(instance, CALL2(GetRealOutputDerivatives), vr, order, nvr, value))
               : fmi2Error;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[], size_t nKnown,
                                        const fmi2Real dvKnown[], fmi2Real dvUnknown[])
{
    struct instance *instance = c;
    const struct call *call = CALL2(GetDirectionalDerivative);
    if (!call_allowed(instance, call) ||
        !call_array_given(instance, call, "vUnknown_ref", vUnknown_ref, nUnknown) ||
        !call_array_given(instance, call, "vKnown_ref", vKnown_ref, nKnown) ||
        !call_array_given(instance, call, "dvKnown", dvKnown, nKnown) ||
        !call_array_given(instance, call, "dvUnknown", dvUnknown, nUnknown)) {
        return fmi2Error;
    }
    enum model_status status = check_unknowns(instance, call, vUnknown_ref, nUnknown);
    for (size_t i = 0; i < nKnown && status == MODEL_OK; ++i) {
        status = check_known(instance, call, vKnown_ref[i]);
        status = status == MODEL_OK ? check_seed(instance, call, vKnown_ref[i], dvKnown[i]) : status;
    }
    if (status != MODEL_OK) {
        return fmi2_status(status);
    }
    return fmi2_status(model_get_directional_derivative(instance->model, vUnknown_ref, nUnknown, vKnown_ref,
                                                        nKnown, dvKnown, dvUnknown));
}

/* Communication steps and what can be asked about the last one. */

/* Any step, with messages. Apart from fmi2DoStep, so that a deferred flight does not save registers for
 * it. */
CONTACT_NOINLINE static fmi2Status fmi2_do_step(struct instance *instance, double point, double size)
{
    if (!call_allowed_in_steps(instance, CALL2(DoStep))) {
        return fmi2Error;
    }
    enum model_status status = step_check(instance, CALL2(DoStep), point, size);
    if (status == MODEL_OK) {
        status = step_end(instance, model_step(instance->model, point + size));
    }
    instance->step_status = status;
    return fmi2_status(status);
}

/*
 * Nothing is kept for going back (states are saved on request), so noSetFMUStatePriorToCurrentPoint is idle.
 * Flattened, because calls would be a good part of what a deferred flight costs.
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
    ((struct fmi2_instance *)instance)->asked_end = currentCommunicationPoint + communicationStepSize;
    if (step_plainly_in_order(instance, currentCommunicationPoint, communicationStepSize) &&
        model_step_deferred(instance->model, currentCommunicationPoint + communicationStepSize)) {
        return fmi2OK; /* as the step before, so that step_status need not be written */
    }
    return fmi2_do_step(instance, currentCommunicationPoint, communicationStepSize);
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return fmi2_status(call_refuse(c, CALL2(CancelStep), "no step is ever in progress here"));
}

static const char *status_kind_name(fmi2StatusKind kind)
{
    switch (kind) {
    case fmi2DoStepStatus:
        return "fmi2DoStepStatus";
    case fmi2PendingStatus:
        return "fmi2PendingStatus";
    case fmi2LastSuccessfulTime:
        return "fmi2LastSuccessfulTime";
    case fmi2Terminated:
        return "fmi2Terminated";
    }
    return "(unknown)";
}

/* Checks a status question. No call ever answers fmi2Pending, so fmi2PendingStatus has no answer either. */
static fmi2Status ask_status(struct instance *instance, const struct call *call, fmi2StatusKind kind,
                             const char *answered, bool known, const void *value)
{
    if (!call_allowed_in_steps(instance, call) || !call_array_given(instance, call, "value", value, 1)) {
        return fmi2Error;
    }
    if (!known) {
        return fmi2_status(log_report(instance, MODEL_DISCARD, "%s: %s is not available, allowed: %s",
                                      call->name, status_kind_name(kind), answered));
    }
    return fmi2OK;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    struct instance *instance = c;
    const fmi2Status asked =
        ask_status(instance, CALL2(GetStatus), s, "fmi2DoStepStatus", s == fmi2DoStepStatus, value);
    if (asked == fmi2OK) {
        *value = fmi2_status(instance->step_status);
    }
    return asked;
}

/* The model's time is a sum, which may differ from the end of a step by a rounding: who goes on while its own
 * time is before the stop time is told the time that it asked for. */
static double time_reached(const struct fmi2_instance *own)
{
    const double time = model_time(own->shared.model);
    return fabs(own->asked_end - time) <= 4.0 * DBL_EPSILON * fabs(time) ? own->asked_end : time;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    struct instance *instance = c;
    const bool known = s == fmi2LastSuccessfulTime;
    const fmi2Status asked =
        ask_status(instance, CALL2(GetRealStatus), s, "fmi2LastSuccessfulTime", known, value);
    if (asked == fmi2OK) {
        *value = time_reached(c);
    }
    return asked;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    return ask_status(c, CALL2(GetIntegerStatus), s, "none", false, value);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    const fmi2Status asked =
        ask_status(c, CALL2(GetBooleanStatus), s, "fmi2Terminated", s == fmi2Terminated, value);
    if (asked == fmi2OK) {
        *value = fmi2False; /* the model never ends a run by itself */
    }
    return asked;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    return ask_status(c, CALL2(GetStringStatus), s, "none", false, value);
}

/* Model Exchange by the names of FMI 2.0. */

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

/* Saved states by the names of FMI 2.0. */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return fmi2_status(state_block_get(c, CALL2(GetFMUstate), FMUstate));
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    return fmi2_status(state_block_set(c, CALL2(SetFMUstate), FMUstate));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return fmi2_status(state_block_free(c, CALL2(FreeFMUstate), FMUstate));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    return fmi2_status(state_block_size(c, CALL2(SerializedFMUstateSize), FMUstate, size));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[],
                                 size_t size)
{
    return fmi2_status(state_block_serialize(c, CALL2(SerializeFMUstate), FMUstate, serializedState, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    return fmi2_status(
        state_block_deserialize(c, CALL2(DeSerializeFMUstate), serializedState, size, FMUstate));
}
