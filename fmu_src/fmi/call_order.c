#include "fmi/call_order.h"

#include <stdio.h>
#include <string.h>

#include "fmi/log.h"

struct phase_name {
    unsigned phase;
    const char *name;
};

static const struct phase_name phase_names[] = {
    {PHASE_INSTANTIATED, "instantiated"},
    {PHASE_INITIALIZATION, "initialization mode"},
    {PHASE_STEP, "step mode"},
    {PHASE_TERMINATED, "terminated"},
    {PHASE_ERROR, "error"},
    {PHASE_FATAL, "fatal"},
    {PHASE_EVENT, "event mode"},
    {PHASE_INTERMEDIATE, "intermediate update mode"},
    {PHASE_CONTINUOUS, "continuous-time mode"},
};

#define PHASE_NAME_COUNT (sizeof phase_names / sizeof phase_names[0])

/* Names of all phases of a mask, separated by commas. The buffer holds all of them at once. */
static const char *name_phases(unsigned phases, char *text, size_t size)
{
    size_t length = 0;
    text[0] = '\0';
    for (size_t i = 0; i < PHASE_NAME_COUNT; ++i) {
        if ((phases & phase_names[i].phase) != 0 && length < size) {
            const char *separator = length > 0 ? ", " : "";
            length += (size_t)snprintf(text + length, size - length, "%s%s", separator, phase_names[i].name);
        }
    }
    return text;
}

/* Room for the names of all phases, with what separates them. */
enum { PHASE_NAMES_SIZE = 160 };

static void report_call_order(struct instance *instance, const struct call *call)
{
    char now[PHASE_NAMES_SIZE];
    char allowed[PHASE_NAMES_SIZE];
    log_report(instance, MODEL_ERROR, "%s called in phase %s, allowed in: %s", call->name,
               name_phases(instance->phase, now, sizeof now),
               name_phases(call->phases, allowed, sizeof allowed));
}

bool call_allowed(struct instance *instance, const struct call *call)
{
    if (instance == NULL) {
        return false;
    }
    if (((unsigned)instance->phase & ~call->phases) != 0) {
        report_call_order(instance, call);
        return false;
    }
    return true;
}

enum model_status call_refuse(struct instance *instance, const struct call *call, const char *reason)
{
    char now[PHASE_NAMES_SIZE];
    return instance == NULL ? MODEL_ERROR
                            : log_report(instance, MODEL_ERROR, "%s called in phase %s: %s", call->name,
                                         name_phases(instance->phase, now, sizeof now), reason);
}

static bool is_of_kind(struct instance *instance, const struct call *call, bool exchange)
{
    static const char *const interfaces[] = {"Co-Simulation", "Model Exchange"};
    if (instance == NULL) {
        return false;
    }
    if (instance->host.exchange != exchange) {
        log_report(instance, MODEL_ERROR, "%s called on an instance of %s, allowed: of %s", call->name,
                   interfaces[!exchange], interfaces[exchange]);
        return false;
    }
    return true;
}

bool call_allowed_in_exchange(struct instance *instance, const struct call *call)
{
    return is_of_kind(instance, call, true) && call_allowed(instance, call);
}

bool call_allowed_in_steps(struct instance *instance, const struct call *call)
{
    return is_of_kind(instance, call, false) && call_allowed(instance, call);
}

bool call_array_given(struct instance *instance, const struct call *call, const char *argument,
                      const void *array, size_t count)
{
    if (array == NULL && count > 0) {
        log_report(instance, MODEL_ERROR, "%s: %s is a null pointer, expected %lu elements", call->name,
                   argument, (unsigned long)count);
        return false;
    }
    return true;
}
