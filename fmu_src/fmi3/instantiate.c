/* Creating an instance of Co-Simulation or of Model Exchange. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi/lifecycle.h"
#include "fmi/log.h"
#include "fmi3/adapter.h"
#include "fmi3/call_order.h"
#include "fmi3/vectors.h"
#include "scene.h"

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
