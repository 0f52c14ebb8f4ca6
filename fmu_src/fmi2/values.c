/*
 * Getting and setting values: known reference, right type, right time; every value is checked before any is
 * written.
 */
#include "fmi2/call_order.h"
#include "fmi2/log.h"

/* Variable types as bits, so that fmi2SetInteger can take enumerations too. */
enum type_bits {
    TYPES_NONE = 0,
    TYPES_REAL = 1 << VARIABLE_REAL,
    TYPES_INTEGER = (1 << VARIABLE_INTEGER) | (1 << VARIABLE_ENUMERATION),
    TYPES_BOOLEAN = 1 << VARIABLE_BOOLEAN
};

static const char *type_name(const struct variable *variable)
{
    static const char *const names[] = {
        [VARIABLE_REAL] = "Real",
        [VARIABLE_INTEGER] = "Integer",
        [VARIABLE_BOOLEAN] = "Boolean",
        [VARIABLE_ENUMERATION] = "Enumeration (fmi2Integer)",
    };
    return names[variable->type];
}

static bool has_start(const struct variable *variable)
{
    return variable->causality == VARIABLE_PARAMETER || variable->causality == VARIABLE_INPUT;
}

static const struct variable *report_wrong_reference(struct instance *instance, enum call call,
                                                     const struct variable *variable,
                                                     fmi2ValueReference reference)
{
    if (variable == NULL) {
        log_report(instance, fmi2Error, "%s: unknown value reference %u", call_name(call), reference);
    } else {
        log_report(instance, fmi2Error, "%s: value reference %u is %s, which is of type %s", call_name(call),
                   reference, variable->name, type_name(variable));
    }
    return NULL;
}

/* The variable of a reference, or NULL after a message. */
static inline const struct variable *find_variable(struct instance *instance, enum call call,
                                                   fmi2ValueReference reference, enum type_bits types)
{
    const struct variable *variable = scene_variable(reference);
    if (variable == NULL || ((unsigned)types & (1u << variable->type)) == 0) {
        return report_wrong_reference(instance, call, variable, reference);
    }
    return variable;
}

/* As find_variable, for reading: what has no start value is not computed before initialization mode. */
static inline const struct variable *find_readable(struct instance *instance, enum call call,
                                                   fmi2ValueReference reference, enum type_bits types)
{
    const struct variable *variable = find_variable(instance, call, reference, types);
    if (variable != NULL && (instance->phase & PHASE_INSTANTIATED) != 0 && !has_start(variable)) {
        log_report(instance, fmi2Error, "%s: %s has no value before initialization mode", call_name(call),
                   variable->name);
        return NULL;
    }
    return variable;
}

/*
 * As find_variable, for writing: parameters until the end of initialization, inputs always, the rest never.
 */
static inline const struct variable *find_settable(struct instance *instance, enum call call,
                                                   fmi2ValueReference reference, enum type_bits types)
{
    const struct variable *variable = find_variable(instance, call, reference, types);
    if (variable == NULL || variable->causality == VARIABLE_INPUT) {
        return variable;
    }
    if (variable->causality != VARIABLE_PARAMETER) {
        log_report(instance, fmi2Error, "%s: %s is calculated and cannot be set", call_name(call),
                   variable->name);
        return NULL;
    }
    if (instance->phase == PHASE_STEP) {
        log_report(instance, fmi2Error, "%s: %s is a parameter, fixed after initialization", call_name(call),
                   variable->name);
        return NULL;
    }
    return variable;
}

/* What every get and set function asks first. */
static inline bool ready(struct instance *instance, enum call call, const fmi2ValueReference vr[], size_t nvr,
                         const void *value)
{
    return call_allowed(instance, call) && call_array_given(instance, call, "vr", vr, nvr) &&
           call_array_given(instance, call, "value", value, nvr);
}

/* value: nvr values of `size` bytes. */
static inline fmi2Status read_values(struct instance *instance, enum call call, enum type_bits types,
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
    return status_of(status);
}

static fmi2Status get_values(struct instance *instance, enum call call, enum type_bits types,
                             const fmi2ValueReference vr[], size_t nvr, void *value, size_t size)
{
    return ready(instance, call, vr, nvr, value) ? read_values(instance, call, types, vr, nvr, value, size)
                                                 : fmi2Error;
}

/* Any number, with messages. Apart from fmi2GetReal, so that reading a vector does not save registers for
 * it. */
__attribute__((noinline)) static fmi2Status
get_reals(struct instance *instance, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    if (!ready(instance, CALL_GetReal, vr, nvr, value)) {
        return fmi2Error;
    }
    if (instance->phase == PHASE_STEP && model_get_reals(instance->model, vr, nvr, value) == nvr) {
        return fmi2OK;
    }
    return read_values(instance, CALL_GetReal, TYPES_REAL, vr, nvr, value, sizeof *value);
}

/* Vectors are mostly read as a whole. Flattened, because calls would be a good part of what that costs. */
__attribute__((flatten)) fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
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
    return get_values(c, CALL_GetInteger, TYPES_INTEGER, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[])
{
    return get_values(c, CALL_GetBoolean, TYPES_BOOLEAN, vr, nvr, value, sizeof *value);
}

/* There are no string variables, so that every reference is a wrong one. */
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[])
{
    return get_values(c, CALL_GetString, TYPES_NONE, vr, nvr, (void *)value, sizeof *value);
}

static fmi2Status set_values(struct instance *instance, enum call call, enum type_bits types,
                             const fmi2ValueReference vr[], size_t nvr, const void *value, size_t size)
{
    if (!ready(instance, call, vr, nvr, value)) {
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
            return status_of(status);
        }
    }
    for (size_t i = 0; i < nvr; ++i) {
        model_set(instance->model, scene_variable(vr[i]), bytes + i * size);
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    return set_values(c, CALL_SetReal, TYPES_REAL, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Integer value[])
{
    return set_values(c, CALL_SetInteger, TYPES_INTEGER, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Boolean value[])
{
    return set_values(c, CALL_SetBoolean, TYPES_BOOLEAN, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[])
{
    return set_values(c, CALL_SetString, TYPES_NONE, vr, nvr, (const void *)value, sizeof *value);
}
