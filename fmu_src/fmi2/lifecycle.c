/* Creating, setting up, starting, ending and resetting an instance. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2/call_order.h"
#include "fmi2/log.h"
#include "fmi2/state_list.h"
#include "scene.h"

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

static void forget_experiment(struct instance *instance)
{
    instance->experiment =
        (struct experiment){.start_time = 0.0, .stop_time = (double)INFINITY, .set_up = false};
    instance->phase = PHASE_INSTANTIATED;
    instance->step_status = fmi2OK;
    instance->log_categories = log_default_categories(instance->logging_on);
}

/* The importer's memory functions where it gives both; one without the other would mix two heaps. */
static struct model_host host_of(const fmi2CallbackFunctions *callbacks)
{
    const bool given = callbacks->allocateMemory != NULL && callbacks->freeMemory != NULL;
    return (struct model_host){.context = NULL,
                               .log = log_from_model,
                               .wants = log_wanted_by_importer,
                               .allocate = given ? callbacks->allocateMemory : calloc,
                               .release = given ? callbacks->freeMemory : free};
}

/* Tells why there is no instance, through one that lives only for the message. */
static fmi2Component refuse_instance(const char *name, const fmi2CallbackFunctions *callbacks,
                                     const char *argument, const char *given, const char *expected)
{
    struct instance nobody = {
        .name = name == NULL ? "" : name, .callbacks = *callbacks, .log_categories = LOG_STATUS_ALL};
    log_report(&nobody, fmi2Error, "fmi2Instantiate: %s is \"%.300s\", expected \"%.300s\"", argument,
               given == NULL ? "(null)" : given, expected);
    return NULL;
}

static struct instance *create_instance(const char *name, const fmi2CallbackFunctions *callbacks,
                                        bool logging_on)
{
    const struct model_host host = host_of(callbacks);
    const size_t name_size = strlen(name) + 1;
    const size_t size = sizeof(struct instance) + name_size;
    struct instance *instance = host.allocate(1, size);
    if (instance == NULL) {
        return NULL;
    }
    memset(instance, 0, size);
    instance->name = memcpy(instance + 1, name, name_size);
    instance->callbacks = *callbacks;
    instance->host = host;
    instance->host.context = instance;
    instance->logging_on = logging_on;
    forget_experiment(instance);
    instance->model = model_create(&instance->host);
    if (instance->model == NULL) {
        host.release(instance);
        return NULL;
    }
    return instance;
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
    if (instanceName == NULL || instanceName[0] == '\0') {
        return refuse_instance(instanceName, functions, "instanceName", instanceName, "any name");
    }
    if (fmuType != fmi2CoSimulation) {
        return refuse_instance(instanceName, functions, "fmuType",
                               fmuType == fmi2ModelExchange ? "fmi2ModelExchange" : "(unknown)",
                               "fmi2CoSimulation");
    }
    if (fmuGUID == NULL || strcmp(fmuGUID, SCENE_GUID) != 0) {
        return refuse_instance(instanceName, functions, "fmuGUID", fmuGUID, SCENE_GUID);
    }
    struct instance *instance = create_instance(instanceName, functions, loggingOn != fmi2False);
    return instance != NULL
               ? instance
               : refuse_instance(instanceName, functions, "memory", "exhausted", "room for an instance");
}

void fmi2FreeInstance(fmi2Component c)
{
    struct instance *instance = c;
    if (instance != NULL && (instance->phase & PHASE_TELLING) == 0) {
        void (*release)(void *) = instance->host.release;
        state_list_clear(instance); /* what the importer forgot */
        model_destroy(instance->model);
        release(instance);
    }
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_SetDebugLogging) ||
        !call_array_given(instance, CALL_SetDebugLogging, "categories", categories, nCategories)) {
        return fmi2Error;
    }
    unsigned chosen = 0;
    for (size_t i = 0; i < nCategories; ++i) {
        if (categories[i] == NULL || !log_category_bits(categories[i], &chosen)) {
            return log_report(instance, fmi2Error,
                              "fmi2SetDebugLogging: unknown category \"%.100s\" (allowed: %s)",
                              categories[i] == NULL ? "(null)" : categories[i], log_category_names());
        }
    }
    /* Switching off means: no more than what everybody gets, never silence by accident. */
    const bool all = loggingOn == fmi2False || nCategories == 0;
    instance->log_categories = all ? log_default_categories(loggingOn != fmi2False) : chosen;
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_SetupExperiment)) {
        return fmi2Error;
    }
    if (!isfinite(startTime)) {
        return log_report(instance, fmi2Error, "fmi2SetupExperiment: startTime = %g s, allowed: finite",
                          startTime);
    }
    if (stopTimeDefined != fmi2False && !(stopTime >= startTime && isfinite(stopTime))) {
        return log_report(
            instance, fmi2Error,
            "fmi2SetupExperiment: stopTime = %.17g s, allowed: finite, from startTime = %.17g s on", stopTime,
            startTime);
    }
    const fmi2Status status =
        status_of(model_setup(instance->model, toleranceDefined != fmi2False, tolerance, startTime));
    if (status <= fmi2Warning) {
        instance->experiment.start_time = startTime;
        instance->experiment.stop_time = stopTimeDefined != fmi2False ? stopTime : (double)INFINITY;
        instance->experiment.set_up = true;
    }
    return status;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_EnterInitializationMode)) {
        return fmi2Error;
    }
    if (!instance->experiment.set_up) {
        return log_report(instance, fmi2Error,
                          "fmi2EnterInitializationMode called before fmi2SetupExperiment");
    }
    instance->phase = PHASE_INITIALIZATION;
    return fmi2OK;
}

/*
 * What is refused here (contradictory parameters) leaves the phase, so that the importer can set better
 * values.
 */
fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_ExitInitializationMode)) {
        return fmi2Error;
    }
    const fmi2Status status = status_of(model_exit_initialization(instance->model));
    if (status <= fmi2Warning) {
        instance->phase = PHASE_STEP;
    }
    return status;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_Terminate)) {
        return fmi2Error;
    }
    instance->phase = PHASE_TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_Reset)) {
        return fmi2Error;
    }
    model_reset(instance->model);
    forget_experiment(instance);
    return fmi2OK;
}
