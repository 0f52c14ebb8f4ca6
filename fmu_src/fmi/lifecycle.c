#include "fmi/lifecycle.h"

#include <math.h>
#include <string.h>

#include "fmi/log.h"
#include "fmi/state_list.h"
#include "model/shortest.h"

static void forget_experiment(struct instance *instance)
{
    instance->experiment =
        (struct experiment){.start_time = 0.0, .stop_time = (double)INFINITY, .set_up = false};
    instance->phase = PHASE_INSTANTIATED;
    instance->step_status = MODEL_OK;
    instance->log_categories = log_default_categories(instance->logging_on);
}

bool instance_expects(struct instance *nobody, const char *function, bool holds, const char *argument,
                      const char *given, const char *expected)
{
    if (!holds) {
        log_report(nobody, MODEL_ERROR, "%s: %s is \"%.300s\", expected \"%.300s\"", function, argument,
                   given == NULL ? "(null)" : given, expected);
    }
    return holds;
}

struct instance *instance_create(const struct adapter *adapter, const struct model_host *host, size_t size,
                                 const char *name, bool logging_on)
{
    const size_t name_size = strlen(name) + 1;
    struct instance *instance = host->allocate(1, size + name_size);
    if (instance == NULL) {
        return NULL;
    }
    memset(instance, 0, size);
    instance->name = memcpy((char *)instance + size, name, name_size);
    instance->adapter = adapter;
    instance->host = *host;
    instance->host.context = instance;
    instance->host.log = log_from_model;
    instance->host.wants = log_wanted_by_importer;
    instance->logging_on = logging_on;
    instance->tuning_phases = PHASE_STEP | PHASE_EVENT;
    forget_experiment(instance);
    instance->model = model_create(&instance->host);
    if (instance->model == NULL) {
        host->release(instance);
        return NULL;
    }
    return instance;
}

void instance_free(struct instance *instance)
{
    if (instance != NULL && (instance->phase & (PHASE_TELLING | PHASE_INTERMEDIATE)) == 0) {
        void (*release)(void *) = instance->host.release;
        state_list_clear(instance); /* what the importer forgot */
        model_destroy(instance->model);
        release(instance);
    }
}

enum model_status instance_categories(struct instance *instance, const struct call *call, size_t count,
                                      const char *const *categories, unsigned *chosen)
{
    if (!call_allowed(instance, call) ||
        !call_array_given(instance, call, "categories", (const void *)categories, count)) {
        return MODEL_ERROR;
    }
    for (size_t i = 0; i < count; ++i) {
        if (categories[i] == NULL || !log_category_bits(categories[i], chosen)) {
            return log_report(instance, MODEL_ERROR, "%s: unknown category \"%.100s\" (allowed: %s)",
                              call->name, categories[i] == NULL ? "(null)" : categories[i],
                              log_category_names());
        }
    }
    return MODEL_OK;
}

enum model_status instance_set_up(struct instance *instance, const struct call *call, bool tolerance_defined,
                                  double tolerance, double start_time, bool stop_time_defined,
                                  double stop_time)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    if (!isfinite(start_time)) {
        return log_report(instance, MODEL_ERROR, "%s: startTime = %s s, allowed: finite", call->name,
                          shortest_digits(start_time).text);
    }
    if (stop_time_defined && !(stop_time >= start_time && isfinite(stop_time))) {
        return log_report(instance, MODEL_ERROR,
                          "%s: stopTime = %s s, allowed: finite, from startTime = %s s on", call->name,
                          shortest_digits(stop_time).text, shortest_digits(start_time).text);
    }
    const enum model_status status = model_setup(instance->model, tolerance_defined, tolerance, start_time);
    if (status <= MODEL_WARNING) {
        instance->experiment.start_time = start_time;
        instance->experiment.stop_time = stop_time_defined ? stop_time : (double)INFINITY;
        instance->experiment.set_up = true;
    }
    return status;
}

enum model_status instance_exit_initialization(struct instance *instance, const struct call *call,
                                               enum phase next)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    const enum model_status status = model_exit_initialization(instance->model);
    if (status <= MODEL_WARNING) {
        instance->phase = next;
    }
    return status;
}

enum model_status instance_enter(struct instance *instance, const struct call *call, enum phase next)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    instance->phase = next;
    return MODEL_OK;
}

enum model_status instance_reset(struct instance *instance, const struct call *call)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    model_reset(instance->model);
    forget_experiment(instance);
    return MODEL_OK;
}
