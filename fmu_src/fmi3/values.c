/*
 * Getting and setting values: known reference, right type, right time; every value is checked before any is
 * written. A vector is read and written as a whole.
 */
#include "fmi/log.h"
#include "fmi/variables.h"
#include "fmi3/call_order.h"
#include "fmi3/vectors.h"
#include "math/compiler.h"
#include "model/exchange.h"

/* The independent variable: its reference is 0, which no variable of the model has. */
enum { TIME_REFERENCE = 0 };

/* A value as the model keeps it. */
union model_value {
    double real;
    int32_t integer; /* of everything else */
};

/* Writes a value to its place in the importer's array, whose elements are of the variable's type. */
static void put_value(const struct variable *variable, const union model_value *value, void *values,
                      size_t at)
{
    switch ((enum variable_type)variable->type) {
    case VARIABLE_REAL:
        ((fmi3Float64 *)values)[at] = value->real;
        break;
    case VARIABLE_INTEGER:
        ((fmi3Int32 *)values)[at] = value->integer;
        break;
    case VARIABLE_BOOLEAN:
        ((fmi3Boolean *)values)[at] = value->integer != 0;
        break;
    case VARIABLE_ENUMERATION:
        ((fmi3Int64 *)values)[at] = value->integer;
        break;
    }
}

/* Reads one from there; an enumeration's has been checked to fit. */
static void take_value(const struct variable *variable, const void *values, size_t at,
                       union model_value *value)
{
    switch ((enum variable_type)variable->type) {
    case VARIABLE_REAL:
        value->real = ((const fmi3Float64 *)values)[at];
        break;
    case VARIABLE_INTEGER:
        value->integer = ((const fmi3Int32 *)values)[at];
        break;
    case VARIABLE_BOOLEAN:
        value->integer = ((const fmi3Boolean *)values)[at] ? 1 : 0;
        break;
    case VARIABLE_ENUMERATION:
        value->integer = (int32_t)((const fmi3Int64 *)values)[at];
        break;
    }
}

/* What every get and set function asks first. */
static bool ready(struct instance *instance, const struct call *call, const fmi3ValueReference vr[],
                  size_t nvr, const void *values, size_t count)
{
    return call_allowed(instance, call) && call_array_given(instance, call, "valueReferences", vr, nvr) &&
           call_array_given(instance, call, "values", values, count);
}

static bool is_time(uint32_t reference, unsigned types)
{
    return reference == TIME_REFERENCE && (types & TYPES_REAL) != 0;
}

static enum model_status report_count(struct instance *instance, const struct call *call, size_t given,
                                      size_t expected)
{
    return log_report(instance, MODEL_ERROR, "%s: nValues = %lu, expected %lu for the value references",
                      call->name, (unsigned long)given, (unsigned long)expected);
}

/* In Model Exchange states may be set one by one; in event mode not those that events may make jump (FMI
 * 3.0.2, sections 2.3.5 and 3.2.1). */
static bool is_settable_state(const struct instance *instance, const struct variable *variable,
                              unsigned types)
{
    return variable->causality == VARIABLE_STATE && instance->host.exchange && (types & TYPES_REAL) != 0 &&
           (instance->phase == PHASE_CONTINUOUS || (instance->phase == PHASE_EVENT && !variable->reinit));
}

/* The variable, of a vector its first component, as find_readable and find_settable have it. */
static const struct variable *find_first(struct instance *instance, const struct call *call,
                                         uint32_t reference, unsigned types, bool to_set)
{
    const struct variable *first = vector_variable(reference);
    if (first == NULL) {
        return report_wrong_reference(instance, call, NULL, reference);
    }
    if (to_set && is_settable_state(instance, first, types)) {
        return first;
    }
    return to_set ? find_settable(instance, call, reference, types)
                  : find_readable(instance, call, reference, types);
}

/* How many values the references have, all of which may be read. */
static enum model_status check_readable(struct instance *instance, const struct call *call, unsigned types,
                                        const fmi3ValueReference vr[], size_t nvr, size_t count)
{
    size_t components = 0;
    for (size_t i = 0; i < nvr; ++i) {
        if (is_time(vr[i], types)) {
            components += 1;
            continue;
        }
        const struct variable *first = find_first(instance, call, vr[i], types, false);
        if (first == NULL) {
            return MODEL_ERROR;
        }
        components += vector_length(first);
    }
    return components == count ? MODEL_OK : report_count(instance, call, count, components);
}

CONTACT_NOINLINE static enum model_status fmi3_get_values(struct instance *instance, const struct call *call,
                                                          unsigned types, const fmi3ValueReference vr[],
                                                          size_t nvr, void *values, size_t count)
{
    if (!ready(instance, call, vr, nvr, values, count)) {
        return MODEL_ERROR;
    }
    enum model_status status = check_readable(instance, call, types, vr, nvr, count);
    size_t at = 0;
    for (size_t i = 0; i < nvr && status == MODEL_OK; ++i) {
        if (is_time(vr[i], types)) {
            ((fmi3Float64 *)values)[at++] = model_time(instance->model);
            continue;
        }
        const struct variable *first = vector_variable(vr[i]);
        const size_t length = vector_length(first);
        for (size_t k = 0; k < length && status == MODEL_OK; ++k) {
            union model_value value;
            status = model_read(instance->model, first + k, &value);
            if (status == MODEL_OK) {
                put_value(first, &value, values, at++);
            }
        }
    }
    return status;
}

/* An enumeration's value has 64 bits here and 32 in the model, of which it needs few. */
static enum model_status check_value(struct instance *instance, const struct variable *variable,
                                     const void *values, size_t at)
{
    if (variable->type == VARIABLE_ENUMERATION) {
        const fmi3Int64 given = ((const fmi3Int64 *)values)[at];
        if (given < INT32_MIN || given > INT32_MAX) {
            return log_report(instance, MODEL_DISCARD,
                              "%s = %lld refused (allowed: %.10g .. %.10g); it stays as it was.",
                              variable->name, (long long)given, variable->min, variable->max);
        }
    }
    union model_value value;
    take_value(variable, values, at, &value);
    return model_check(instance->model, variable, &value);
}

static enum model_status check_settable(struct instance *instance, const struct call *call, unsigned types,
                                        const fmi3ValueReference vr[], size_t nvr, const void *values,
                                        size_t count)
{
    size_t components = 0;
    for (size_t i = 0; i < nvr; ++i) {
        if (is_time(vr[i], types)) {
            return log_report(instance, MODEL_ERROR, "%s: time is the independent variable and cannot be set",
                              call->name);
        }
        const struct variable *first = find_first(instance, call, vr[i], types, true);
        if (first == NULL) {
            return MODEL_ERROR;
        }
        const size_t length = vector_length(first);
        for (size_t k = 0; k < length && components + k < count; ++k) {
            const enum model_status status = check_value(instance, first + k, values, components + k);
            if (status > MODEL_WARNING) {
                return status;
            }
        }
        components += length;
    }
    return components == count ? MODEL_OK : report_count(instance, call, count, components);
}

static enum model_status fmi3_set_values(struct instance *instance, const struct call *call, unsigned types,
                                         const fmi3ValueReference vr[], size_t nvr, const void *values,
                                         size_t count)
{
    if (!ready(instance, call, vr, nvr, values, count)) {
        return MODEL_ERROR;
    }
    const enum model_status status = check_settable(instance, call, types, vr, nvr, values, count);
    size_t at = 0;
    for (size_t i = 0; i < nvr && status == MODEL_OK; ++i) {
        const struct variable *first = vector_variable(vr[i]);
        const size_t length = vector_length(first);
        for (size_t k = 0; k < length; ++k) {
            union model_value value;
            take_value(first, values, at++, &value);
            if (first->causality == VARIABLE_STATE) {
                model_exchange_set_state(instance->model, first + k, value.real);
            } else {
                model_set(instance->model, first + k, &value);
            }
        }
    }
    return status;
}

/* One vector, as they are mostly read in a run. Flattened, because calls would be a good part of what that
 * costs. */
CONTACT_FLATTEN fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr,
                                          fmi3Float64 values[], size_t count)
{
    struct instance *instance = c;
    if (instance != NULL && instance->phase == PHASE_STEP && nvr == 1 && count == 3 && vr != NULL) {
        const uint32_t components[3] = {vr[0], vr[0] + 1, vr[0] + 2};
        if (model_get_vector(instance->model, components, values)) {
            return fmi3OK;
        }
    }
    return fmi3_status(fmi3_get_values(instance, CALL3(GetFloat64), TYPES_REAL, vr, nvr, values, count));
}

/* A function for each type that some variable has, ... */
#define GETTER(Type, types)                                                                                  \
    fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3##Type values[], \
                             size_t count)                                                                   \
    {                                                                                                        \
        return fmi3_status(fmi3_get_values(c, CALL3(Get##Type), types, vr, nvr, (void *)values, count));     \
    }
#define SETTER(Type, types)                                                                                  \
    fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr,                      \
                             const fmi3##Type values[], size_t count)                                        \
    {                                                                                                        \
        return fmi3_status(                                                                                  \
            fmi3_set_values(c, CALL3(Set##Type), types, vr, nvr, (const void *)values, count));              \
    }
SETTER(Float64, TYPES_REAL)
GETTER(Int32, TYPES_INTEGER)
SETTER(Int32, TYPES_INTEGER)
GETTER(Int64, TYPES_ENUMERATION)
SETTER(Int64, TYPES_ENUMERATION)
GETTER(Boolean, TYPES_BOOLEAN)
SETTER(Boolean, TYPES_BOOLEAN)

/* ... and for those that none has, so that every reference is a wrong one. */
#define BOTH(Type)                                                                                           \
    GETTER(Type, TYPES_NONE)                                                                                 \
    SETTER(Type, TYPES_NONE)
BOTH(Float32)
BOTH(Int8)
BOTH(UInt8)
BOTH(Int16)
BOTH(UInt16)
BOTH(UInt32)
BOTH(UInt64)
BOTH(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, size_t valueSizes[],
                         fmi3Binary values[], size_t count)
{
    (void)valueSizes;
    return fmi3_status(fmi3_get_values(c, CALL3(GetBinary), TYPES_NONE, vr, nvr, (void *)values, count));
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const size_t valueSizes[],
                         const fmi3Binary values[], size_t count)
{
    (void)valueSizes;
    return fmi3_status(
        fmi3_set_values(c, CALL3(SetBinary), TYPES_NONE, vr, nvr, (const void *)values, count));
}
