/* Creating, setting up, starting, ending and resetting an instance. */
#include "fmi/lifecycle.h"

#include <stdlib.h>
#include <string.h>

#include "fmi/log.h"
#include "fmi2/adapter.h"
#include "fmi2/call_order.h"
#include "scene.h"

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
