#include "fmi/exchange.h"

#include <float.h>
#include <math.h>

#include "fmi/log.h"

enum model_status exchange_enter(struct instance *instance, const struct call *call, enum phase next)
{
    if (!call_allowed_in_exchange(instance, call)) {
        return MODEL_ERROR;
    }
    instance->phase = next;
    model_exchange_set_continuous(instance->model, next == PHASE_CONTINUOUS);
    return MODEL_OK;
}

enum model_status exchange_update(struct instance *instance, const struct call *call,
                                  struct exchange_news *news)
{
    if (!call_allowed_in_exchange(instance, call)) {
        return MODEL_ERROR;
    }
    const enum model_status status = model_exchange_update(instance->model, &news->again, &news->jumped);
    if (status <= MODEL_WARNING && !news->again) {
        const double touch = model_exchange_next_touch(instance->model);
        news->scheduled = isfinite(touch);
        news->event_time = news->scheduled ? touch : 0.0;
    }
    return status;
}

/* Integrators of variable step look past the stop time and come back; a step that is accepted there is an
 * error. */
enum model_status exchange_accept_step(struct instance *instance, const struct call *call)
{
    if (!call_allowed_in_exchange(instance, call)) {
        return MODEL_ERROR;
    }
    const double time = model_time(instance->model);
    const double stop = instance->experiment.stop_time;
    if (time > stop + 4.0 * DBL_EPSILON * fabs(stop)) { /* importers add up step sizes, which rounds */
        return log_report(instance, MODEL_ERROR, "%s: step to %.17g s goes past stopTime = %.17g s",
                          call->name, time, stop);
    }
    return model_exchange_accept(instance->model);
}

enum model_status exchange_set_time(struct instance *instance, const struct call *call, double time)
{
    return call_allowed_in_exchange(instance, call) ? model_exchange_set_time(instance->model, time)
                                                    : MODEL_ERROR;
}

/* Whether the call is in order and an array of as many numbers as there are was given. */
static bool in_order(struct instance *instance, const struct call *call, const double *values, size_t count,
                     size_t expected)
{
    if (!call_allowed_in_exchange(instance, call)) {
        return false;
    }
    if (count != expected) {
        log_report(instance, MODEL_ERROR, "%s: %lu values, expected %lu", call->name, (unsigned long)count,
                   (unsigned long)expected);
        return false;
    }
    return call_array_given(instance, call, "the array of values", values, count);
}

enum model_status exchange_set_states(struct instance *instance, const struct call *call,
                                      const double *states, size_t count)
{
    return in_order(instance, call, states, count, model_exchange_states())
               ? model_exchange_set_states(instance->model, states)
               : MODEL_ERROR;
}

enum model_status exchange_get(struct instance *instance, const struct call *call, enum exchange_values which,
                               double *values, size_t count)
{
    const size_t expected =
        which == EXCHANGE_INDICATORS ? model_exchange_indicators() : model_exchange_states();
    return in_order(instance, call, values, count, expected)
               ? model_exchange_get(instance->model, which, values)
               : MODEL_ERROR;
}

enum model_status exchange_get_nominals(struct instance *instance, const struct call *call, double *values,
                                        size_t count)
{
    if (!in_order(instance, call, values, count, model_exchange_states())) {
        return MODEL_ERROR;
    }
    model_exchange_get_nominals(values);
    return MODEL_OK;
}
