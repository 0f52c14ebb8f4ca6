#include "fmi2/call_order.h"

#include <stdio.h>
#include <string.h>

#include "fmi2/log.h"

struct call_rule {
    const char *name;
    unsigned phases;
};

#define CALL_RULE(function, phases) {"fmi2" #function, phases},
static const struct call_rule call_rules[] = {CALL_TABLE(CALL_RULE)};
#undef CALL_RULE

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
};

#define PHASE_NAME_COUNT (sizeof phase_names / sizeof phase_names[0])

const char *call_name(enum call call)
{
    return call_rules[call].name;
}

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

static void report_call_order(struct instance *instance, enum call call)
{
    char now[128];
    char allowed[128];
    name_phases(instance->phase, now, sizeof now);
    if (call_rules[call].phases == 0) {
        log_report(instance, fmi2Error, "%s called in phase %s: no step is ever in progress here",
                   call_name(call), now);
        return;
    }
    name_phases(call_rules[call].phases, allowed, sizeof allowed);
    log_report(instance, fmi2Error, "%s called in phase %s, allowed in: %s", call_name(call), now, allowed);
}

bool call_allowed(struct instance *instance, enum call call)
{
    if (instance == NULL) {
        return false;
    }
    if (((unsigned)instance->phase & ~call_rules[call].phases) != 0) {
        report_call_order(instance, call);
        return false;
    }
    return true;
}

bool call_array_given(struct instance *instance, enum call call, const char *argument, const void *array,
                      size_t count)
{
    if (array == NULL && count > 0) {
        log_report(instance, fmi2Error, "%s: %s is a null pointer, expected %lu elements", call_name(call),
                   argument, (unsigned long)count);
        return false;
    }
    return true;
}
