/* Which variables a call may read and write, and when. */
#ifndef CONTACT_FMI_VARIABLES_H
#define CONTACT_FMI_VARIABLES_H

#include "fmi/call_order.h"

/* Variable types as bits, so that a function can take more than one. */
enum type_bits {
    TYPES_NONE = 0,
    TYPES_REAL = 1 << VARIABLE_REAL,
    TYPES_INTEGER = 1 << VARIABLE_INTEGER,
    TYPES_BOOLEAN = 1 << VARIABLE_BOOLEAN,
    TYPES_ENUMERATION = 1 << VARIABLE_ENUMERATION
};

/* The variable of a reference, or NULL after a message. */
const struct variable *report_wrong_reference(struct instance *instance, const struct call *call,
                                              const struct variable *variable, uint32_t reference);
const struct variable *report_no_value(struct instance *instance, const struct call *call,
                                       const struct variable *variable);
const struct variable *report_not_settable(struct instance *instance, const struct call *call,
                                           const struct variable *variable);

static inline const struct variable *find_variable(struct instance *instance, const struct call *call,
                                                   uint32_t reference, unsigned types)
{
    const struct variable *variable = scene_variable(reference);
    return variable == NULL || (types & (1u << variable->type)) == 0
               ? report_wrong_reference(instance, call, variable, reference)
               : variable;
}

/* Whether a variable that was found may be read: what has no start value is not computed before
 * initialization mode. */
static inline const struct variable *find_readable(struct instance *instance, const struct call *call,
                                                   uint32_t reference, unsigned types)
{
    const struct variable *variable = find_variable(instance, call, reference, types);
    const bool early = variable != NULL && (instance->phase & PHASE_INSTANTIATED) != 0;
    return early && variable->causality != VARIABLE_PARAMETER && variable->causality != VARIABLE_INPUT
               ? report_no_value(instance, call, variable)
               : variable;
}

/*
 * As find_variable, for writing: parameters until the end of initialization, tunable ones at communication
 * points or events too, inputs always, the rest never.
 */
static inline const struct variable *find_settable(struct instance *instance, const struct call *call,
                                                   uint32_t reference, unsigned types)
{
    const struct variable *variable = find_variable(instance, call, reference, types);
    if (variable == NULL || variable->causality == VARIABLE_INPUT) {
        return variable;
    }
    const unsigned before = PHASE_INSTANTIATED | PHASE_INITIALIZATION;
    const unsigned phases = variable->tunable ? before | instance->tuning_phases : before;
    return variable->causality == VARIABLE_PARAMETER && (instance->phase & phases) != 0
               ? variable
               : report_not_settable(instance, call, variable);
}

#endif
