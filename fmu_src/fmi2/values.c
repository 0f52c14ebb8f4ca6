/*
 * Getting and setting values: known reference, right type, right time; every value is checked before any is
 * written.
 */
#include "fmi/variables.h"
#include "fmi2/call_order.h"
#include "math/compiler.h"

/* fmi2SetInteger takes enumerations too. */
enum { TYPES_WHOLE = TYPES_INTEGER | TYPES_ENUMERATION };

/* What every get and set function asks first. */
static inline bool fmi2_ready(struct instance *instance, const struct call *call,
                              const fmi2ValueReference vr[], size_t nvr, const void *value)
{
    return call_allowed(instance, call) && call_array_given(instance, call, "vr", vr, nvr) &&
           call_array_given(instance, call, "value", value, nvr);
}

/* value: nvr values of `size` bytes. */
static inline fmi2Status read_values(struct instance *instance, const struct call *call, unsigned types,
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
    return fmi2_status(status);
}

static fmi2Status fmi2_get_values(struct instance *instance, const struct call *call, unsigned types,
                                  const fmi2ValueReference vr[], size_t nvr, void *value, size_t size)
{
    return fmi2_ready(instance, call, vr, nvr, value)
               ? read_values(instance, call, types, vr, nvr, value, size)
               : fmi2Error;
}

/* Any number, with messages. Apart from fmi2GetReal, so that reading a vector does not save registers for
 * it. */
CONTACT_NOINLINE static fmi2Status get_reals(struct instance *instance, const fmi2ValueReference vr[],
                                             size_t nvr, fmi2Real value[])
{
    if (!fmi2_ready(instance, CALL2(GetReal), vr, nvr, value)) {
        return fmi2Error;
    }
    if (instance->phase == PHASE_STEP && model_get_reals(instance->model, vr, nvr, value) == nvr) {
        return fmi2OK;
    }
    return read_values(instance, CALL2(GetReal), TYPES_REAL, vr, nvr, value, sizeof *value);
}

/* Vectors are mostly read as a whole. Flattened, because calls would be a good part of what that costs. */
CONTACT_FLATTEN fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
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
    return fmi2_get_values(c, CALL2(GetInteger), TYPES_WHOLE, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[])
{
    return fmi2_get_values(c, CALL2(GetBoolean), TYPES_BOOLEAN, vr, nvr, value, sizeof *value);
}

/* There are no string variables, so that every reference is a wrong one. */
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[])
{
    return fmi2_get_values(c, CALL2(GetString), TYPES_NONE, vr, nvr, (void *)value, sizeof *value);
}

static fmi2Status fmi2_set_values(struct instance *instance, const struct call *call, unsigned types,
                                  const fmi2ValueReference vr[], size_t nvr, const void *value, size_t size)
{
    if (!fmi2_ready(instance, call, vr, nvr, value)) {
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
            return fmi2_status(status);
        }
    }
    for (size_t i = 0; i < nvr; ++i) {
        model_set(instance->model, scene_variable(vr[i]), bytes + i * size);
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    return fmi2_set_values(c, CALL2(SetReal), TYPES_REAL, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Integer value[])
{
    return fmi2_set_values(c, CALL2(SetInteger), TYPES_WHOLE, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Boolean value[])
{
    return fmi2_set_values(c, CALL2(SetBoolean), TYPES_BOOLEAN, vr, nvr, value, sizeof *value);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[])
{
    return fmi2_set_values(c, CALL2(SetString), TYPES_NONE, vr, nvr, (const void *)value, sizeof *value);
}
