/*
 * Here each function of FMI 2.0 works on an instance of fmi/instance.h.
 */
#include <fmi2Functions.h>
#include <stdlib.h>
#include <string.h>

#include "fmi/instance.h"
#include "math/compiler.h"
#include "scene.h"

/* This struct is an instance of FMI 2.0. An fmi2Component is the address of such a struct. */
struct fmi2_instance {
    struct instance shared; /* is the first member, so that both have one address */
    fmi2CallbackFunctions callbacks;
};

/* The model's statuses are fmi2Status values by another name. */
_Static_assert((int)MODEL_OK == (int)fmi2OK && (int)MODEL_WARNING == (int)fmi2Warning, "status order");
_Static_assert((int)MODEL_DISCARD == (int)fmi2Discard && (int)MODEL_ERROR == (int)fmi2Error, "status order");
_Static_assert((int)MODEL_FATAL == (int)fmi2Fatal, "status order");

/*
 * Each function of the standard that takes an instance names the kind of instance and the phases in which it
 * may be called (struct call), after the tables "calling sequence" of FMI 2.0.5, sections 3.2.3 and 4.2.4.
 * Two extensions do no harm: variables that have a start value may be read while instantiated, and the status
 * functions answer after a failed step too. Model Exchange is never in step mode, Co-Simulation never in
 * event mode or continuous-time mode.
 */
#define CALL2(function, kind, phases, parameters, result)                                                    \
    CALL_OF(2, function, kind, phases, NULL, parameters, result)

static void fmi2_send(struct instance *instance, enum model_status status, const char *category,
                      const char *text)
{
    const fmi2CallbackFunctions *callbacks = &((const struct fmi2_instance *)instance)->callbacks;
    callbacks->logger(callbacks->componentEnvironment, instance->name, (fmi2Status)status, category, text);
}

static const struct adapter adapter_of_fmi2 = {
    .version = 2,
    .token_name = "fmuGUID",
    .token = SCENE_GUID,
    .send = fmi2_send,
    /* The logger takes a printf format in which '#' marks value references (FMI 2.0.5). */
    .doubled = "%#",
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

CONTACT_EXPORTED const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

CONTACT_EXPORTED const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

/* The FMU reads no resources, so any string or none is accepted as their location. */
CONTACT_EXPORTED fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                                               fmi2String fmuResourceLocation,
                                               const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                                               fmi2Boolean loggingOn)
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
    return instance_expects(&nobody.shared, fmuType == fmi2CoSimulation || fmuType == fmi2ModelExchange,
                            "fmuType", "(unknown)", "fmi2CoSimulation or fmi2ModelExchange")
               ? instance_create(&nobody.shared, sizeof nobody, fmuGUID, loggingOn != fmi2False)
               : NULL;
}

CONTACT_EXPORTED void fmi2FreeInstance(fmi2Component c)
{
    instance_free(c);
}

CALLS_OF_BOTH(2, state, DeSerialize)
CALL2(EnterInitializationMode, ANY, PHASE_INSTANTIATED, (fmi2Component c),
      instance->experiment.set_up ? instance_enter(instance, MODEL_OK, PHASE_INITIALIZATION)
                                  : log_report(instance, MODEL_ERROR, " called before fmi2SetupExperiment"))
CALL2(SetupExperiment, ANY, PHASE_INSTANTIATED,
      (fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start_time,
       fmi2Boolean stop_time_defined, fmi2Real stop_time),
      instance_set_up(instance, tolerance_defined != fmi2False, tolerance, start_time,
                      stop_time_defined != fmi2False, stop_time))
CALL2(ExitInitializationMode, ANY, PHASE_INITIALIZATION, (fmi2Component c),
      instance_enter(instance, model_exit_initialization(instance->model),
                     instance->host.exchange ? PHASE_EVENT : PHASE_STEP))

/* This part gets and sets values. Enumerations are of type fmi2Integer too. There are no string variables, so
 * that fmi2GetString refuses every reference. */

/* Defines the getter and the setter of the standard for one type of its own. Both serve the variables of the
 * `types`, bits 1 << enum variable_type; the setter may be called in the phases `phases_to_set`. */
#define VALUES2(Type, types, phases_to_set)                                                                  \
    CALL2(Get##Type, ANY, PHASES_READ(PHASES_ALL),                                                           \
          (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2##Type value[]),                  \
          instance_get_values(instance, types, vr, nvr, (void *)value, nvr))                                 \
    CALL2(Set##Type, ANY, phases_to_set,                                                                     \
          (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2##Type value[]),            \
          instance_set_values(instance, types, vr, nvr, (const void *)value, nvr))
VALUES2(Real, 1 << VARIABLE_REAL, PHASES_SETTABLE | PHASE_CONTINUOUS)
VALUES2(Integer, 1 << VARIABLE_INTEGER | 1 << VARIABLE_ENUMERATION, PHASES_SETTABLE)
VALUES2(Boolean, 1 << VARIABLE_BOOLEAN, PHASES_SETTABLE)
VALUES2(String, 0, PHASES_SETTABLE)

static enum model_status set_input_derivatives(struct instance *instance, const fmi2ValueReference *vr,
                                               size_t nvr, const fmi2Integer *order, const fmi2Real *value)
{
    if (!array_given(instance, "valueReferences", vr, nvr) || !array_given(instance, "orders", order, nvr) ||
        !array_given(instance, "values", value, nvr)) {
        return MODEL_ERROR;
    }
    enum model_status status = MODEL_OK;
    for (size_t i = 0; i < nvr && status == MODEL_OK; ++i) {
        const struct variable *variable = find_real(instance, vr[i], VARIABLE_INPUT);
        status = variable == NULL ? MODEL_ERROR : check_order(instance, variable, order[i]);
        if (status == MODEL_OK && !(value[i] >= variable->min && value[i] <= variable->max)) {
            status = log_report(instance, MODEL_DISCARD,
                                ": derivative of order %d of %s = %g refused, allowed: %g .. %g", order[i],
                                variable->name, value[i], variable->min, variable->max);
        }
    }
    for (size_t i = 0; i < nvr && status == MODEL_OK; ++i) {
        model_set_input_derivative(instance->model, scene_variable(vr[i]), order[i], value[i]);
    }
    return status;
}

CALL2(SetRealInputDerivatives, STEPS, PHASE_INSTANTIATED | PHASE_INITIALIZATION | PHASE_STEP,
      (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
       const fmi2Real value[]),
      set_input_derivatives(instance, vr, nvr, order, value))
CALL2(GetRealOutputDerivatives, STEPS, PHASES_READ(PHASES_STEPPED),
      (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
       fmi2Real value[]),
      instance_output_derivatives(instance, vr, order, nvr, value, nvr))

CALL2(GetDirectionalDerivative, ANY, PHASES_READ(PHASES_INITIALIZED),
      (fmi2Component c, const fmi2ValueReference unknowns[], size_t unknown_count,
       const fmi2ValueReference knowns[], size_t known_count, const fmi2Real seed[], fmi2Real sensitivity[]),
      instance_product(instance,
                       &(const struct product){.unknowns = {unknowns, unknown_count, false},
                                               .knowns = {knowns, known_count, false},
                                               .seed = seed,
                                               .sensitivity = sensitivity},
                       known_count, unknown_count))

/* Takes any step and sends messages. It is not inlined into fmi2DoStep, so that a deferred flight saves no
 * registers for it. */
CONTACT_NOINLINE static fmi2Status fmi2_do_step(struct instance *instance, double point, double size)
{
    static const struct call call = {"fmi2DoStep", CALL_STEPS, PHASE_STEP, NULL};
    const struct step_request request = {.end_time = point + size};
    return (fmi2Status)(call_begin(instance, &call) ? instance_step(instance, point, size, &request)
                                                    : MODEL_ERROR);
}

/*
 * noSetFMUStatePriorToCurrentPoint has no effect, because states are saved only on request. The function is
 * flattened, because calls would be a good part of the time of a deferred flight.
 */
CONTACT_EXPORTED CONTACT_FLATTEN fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
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

/* This function is never allowed. */
CONTACT_EXPORTED fmi2Status fmi2CancelStep(fmi2Component c)
{
    static const struct call call = {"fmi2CancelStep", CALL_ANY, 0, "no step is ever in progress here"};
    (void)call_begin(c, &call);
    return fmi2Error;
}

static const char *status_kind_name(fmi2StatusKind kind)
{
    static const char *const names[] = {[fmi2DoStepStatus] = "fmi2DoStepStatus",
                                        [fmi2PendingStatus] = "fmi2PendingStatus",
                                        [fmi2LastSuccessfulTime] = "fmi2LastSuccessfulTime",
                                        [fmi2Terminated] = "fmi2Terminated"};
    return (unsigned)kind < sizeof names / sizeof names[0] ? names[kind] : "(unknown)";
}

/* Answers a status function that knows only the kind named `answered`. No call ever returns fmi2Pending, so
 * fmi2PendingStatus is refused. */
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

/* A status function for values of one type, which answers to one kind of status or to none. */
#define STATUS2(function, Type, answered, known, answer)                                                     \
    CALL2(function, STEPS, PHASES_READ(PHASES_STEPPED),                                                      \
          (fmi2Component c, const fmi2StatusKind s, fmi2##Type *value),                                      \
          tell_status(instance, s, answered, known, (void *)value, &(const fmi2##Type){answer},              \
                      sizeof *value))
STATUS2(GetStatus, Status, "fmi2DoStepStatus", s == fmi2DoStepStatus, (fmi2Status)instance->step_status)
STATUS2(GetRealStatus, Real, "fmi2LastSuccessfulTime", s == fmi2LastSuccessfulTime,
        instance_time_reached(instance))
/* The model never ends a run by itself. */
STATUS2(GetBooleanStatus, Boolean, "fmi2Terminated", s == fmi2Terminated, fmi2False)
STATUS2(GetIntegerStatus, Integer, "none", false, 0)
STATUS2(GetStringStatus, String, "none", false, NULL)

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

CALL2(NewDiscreteStates, EXCHANGE, PHASE_EVENT, (fmi2Component c, fmi2EventInfo *eventInfo),
      new_discrete_states(instance, eventInfo))
CALL2(EnterEventMode, EXCHANGE, PHASES_EXCHANGED, (fmi2Component c),
      instance_enter(instance, MODEL_OK, PHASE_EVENT))
CALL2(SetTime, EXCHANGE, PHASES_EXCHANGED, (fmi2Component c, fmi2Real time),
      model_exchange_set_time(instance->model, time))
NUMBERS_OF(2, GetDerivatives, EXCHANGE_RATES, SCENE_STATES, PHASES_OF_STATES)
NUMBERS_OF(2, GetNominalsOfContinuousStates, EXCHANGE_NOMINALS, SCENE_STATES,
           PHASE_INSTANTIATED | PHASES_OF_STATES)
CALL2(SetFMUstate, ANY, PHASES_ALL, (fmi2Component c, fmi2FMUstate state), state_block_set(instance, state))
