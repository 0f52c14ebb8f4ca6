/* Creating, setting up, starting, ending and resetting an instance. */
#include "fmi/lifecycle.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi/log.h"
#include "fmi3/adapter.h"
#include "fmi3/call_order.h"
#include "fmi3/vectors.h"
#include "scene.h"

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

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
    const struct model_host host = {.allocate = calloc, .release = free};
    struct instance *instance =
        instance_create(&adapter_of_fmi3, &host, sizeof(struct fmi3_instance), instanceName, loggingOn);
    if (instance == NULL) {
        instance_expects(&nobody.shared, function, false, "memory", "exhausted", "room for an instance");
        return NULL;
    }
    struct fmi3_instance *own = (struct fmi3_instance *)instance;
    own->environment = instanceEnvironment;
    own->log_message = logMessage;
    own->intermediate_update = intermediateUpdate;
    own->event_mode_used = eventModeUsed;
    own->early_return_allowed = earlyReturnAllowed;
    instance->logger_given = logMessage != NULL;
    return instance;
}

static fmi3Instance refuse_interface(const char *function, const char *name, const char *given,
                                     fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message)
{
    struct fmi3_instance nobody = make_nobody(name, environment, log_message);
    (void)instance_expects(&nobody.shared, function, false, "interface type", given, "Co-Simulation");
    return NULL;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment,
                                          fmi3LogMessageCallback logMessage)
{
    (void)instantiationToken, (void)resourcePath, (void)visible, (void)loggingOn;
    return refuse_interface("fmi3InstantiateModelExchange", instanceName, "Model Exchange",
                            instanceEnvironment, logMessage);
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
    fmi3UnlockPreemptionCallback unlockPreemption)
{
    (void)instantiationToken, (void)resourcePath, (void)visible, (void)loggingOn;
    (void)clockUpdate, (void)lockPreemption, (void)unlockPreemption;
    return refuse_interface("fmi3InstantiateScheduledExecution", instanceName, "Scheduled Execution",
                            instanceEnvironment, logMessage);
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
        instance_categories(instance, CALL(SetDebugLogging), nCategories, categories, &chosen);
    if (status == MODEL_OK) {
        const unsigned bits = nCategories == 0 ? (unsigned)LOG_ALL : chosen;
        instance->log_categories =
            loggingOn ? instance->log_categories | bits : instance->log_categories & ~bits;
    }
    return status_of(status);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined,
                                       fmi3Float64 stopTime)
{
    struct instance *instance = c;
    const enum model_status status =
        instance_set_up(instance, CALL(EnterInitializationMode), toleranceDefined, tolerance, startTime,
                        stopTimeDefined, stopTime);
    if (status <= MODEL_WARNING) {
        instance->phase = PHASE_INITIALIZATION;
    }
    return status_of(status);
}

/* With event mode the run begins there. */
fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    const struct fmi3_instance *own = c;
    const enum phase next = own != NULL && own->event_mode_used ? PHASE_EVENT : PHASE_STEP;
    return status_of(instance_exit_initialization(c, CALL(ExitInitializationMode), next));
}

fmi3Status fmi3Terminate(fmi3Instance c)
{
    return status_of(instance_enter(c, CALL(Terminate), PHASE_TERMINATED));
}

fmi3Status fmi3Reset(fmi3Instance c)
{
    return status_of(instance_reset(c, CALL(Reset)));
}
