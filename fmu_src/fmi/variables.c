#include "fmi/variables.h"

#include "fmi/log.h"

const struct variable *report_wrong_reference(struct instance *instance, const struct call *call,
                                              const struct variable *variable, uint32_t reference)
{
    if (variable == NULL) {
        log_report(instance, MODEL_ERROR, "%s: unknown value reference %u", call->name, (unsigned)reference);
    } else {
        log_report(instance, MODEL_ERROR, "%s: value reference %u is %s, which is of type %s", call->name,
                   (unsigned)reference, variable->name, instance->adapter->type_names[variable->type]);
    }
    return NULL;
}

const struct variable *report_no_value(struct instance *instance, const struct call *call,
                                       const struct variable *variable)
{
    log_report(instance, MODEL_ERROR, "%s: %s has no value before initialization mode", call->name,
               variable->name);
    return NULL;
}

const struct variable *report_not_settable(struct instance *instance, const struct call *call,
                                           const struct variable *variable)
{
    const char *reason = variable->causality != VARIABLE_PARAMETER ? "is calculated and cannot be set"
                         : !variable->tunable ? "is a parameter, fixed after initialization"
                                              : "is a tunable parameter, to be set in event mode";
    log_report(instance, MODEL_ERROR, "%s: %s %s", call->name, variable->name, reason);
    return NULL;
}
