#include "model/model.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "model/state.h"
#include "segment/flight.h"

static const char *category_of(enum model_status status)
{
    switch (status) {
    case MODEL_WARNING:
        return "logStatusWarning";
    case MODEL_DISCARD:
        return "logStatusDiscard";
    case MODEL_ERROR:
        return "logStatusError";
    case MODEL_FATAL:
        return "logStatusFatal";
    case MODEL_OK:
    default:
        return "logEvents";
    }
}

enum model_status model_report(const struct model *m, enum model_status status, const char *format, ...)
{
    const char *category = category_of(status);
    if (m->host.log && (!m->host.wants || m->host.wants(m->host.context, category))) {
        char message[512];
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(message, sizeof message, format, arguments);
        va_end(arguments);
        m->host.log(m->host.context, status, category, message);
    }
    return status;
}

struct model *model_create(const struct model_host *host)
{
    struct model *m = host->allocate(1, sizeof *m);
    if (m) {
        m->host = *host;
        model_reset(m);
    }
    return m;
}

void model_destroy(struct model *m)
{
    if (m) {
#if SCENE_ANY_FREE
        integrator_close(&m->integrator);
#endif
        m->host.release(m);
    }
}

void model_reset(struct model *m)
{
    memset(&m->state, 0, sizeof m->state);
    m->state.magic = MODEL_STATE_MAGIC;
    m->state.version = MODEL_STATE_VERSION;
    m->state.scene = SCENE_HASH;
    m->state.size = (uint32_t)sizeof m->state;
    scene_start(&m->state.values);
    m->outputs = OUTPUTS_NONE;
}

enum model_status model_setup(struct model *m, bool tolerance_defined, double tolerance, double start_time)
{
    enum model_status status = MODEL_OK;
    if (!isfinite(start_time)) {
        return model_report(m, MODEL_ERROR, "The start time %g s is refused (allowed: finite times).",
                            start_time);
    }
    if (tolerance_defined && !(tolerance > 0.0 && isfinite(tolerance))) {
        return model_report(m, MODEL_ERROR, "The tolerance %g is refused (allowed: positive finite numbers).",
                            tolerance);
    }
    m->state.importer_tolerance = 0.0;
    for (int i = 0; tolerance_defined && i < scene_variable_count; ++i) {
        const struct variable *row = &scene_variables[i];
        if (row->row == ROW_solver_relative_tolerance) {
            m->state.importer_tolerance = fmin(fmax(tolerance, row->min), row->max);
            if (m->state.importer_tolerance != tolerance) {
                status = model_report(m, MODEL_WARNING,
                                      "The tolerance %g is outside the range %g .. %g of %s; %g is used.",
                                      tolerance, row->min, row->max, row->name, m->state.importer_tolerance);
            }
        }
    }
    m->state.start_time = start_time;
    m->outputs = OUTPUTS_NONE;
    return status;
}

#if SCENE_ANY_FREE
bool model_open_integrator(struct model *m, const struct scene_values *v)
{
    const struct integrator_memory memory = {m->host.allocate, m->host.release};
    return integrator_open(&m->integrator, v, &memory);
}
#endif

enum model_status model_exit_initialization(struct model *m)
{
    const enum model_status status = model_check_consistency(m);
    if (status != MODEL_OK) {
        return status;
    }
    model_prepare(m);
#if SCENE_ANY_FREE
    if (!model_open_integrator(m, &m->state.values)) {
        return model_report(m, MODEL_ERROR, "Initialization failed: %s.", m->integrator.message);
    }
#endif
    m->state.initialized = 1;
    m->outputs = OUTPUTS_NONE;
    return MODEL_OK;
}

double model_time(const struct model *m)
{
    return m->state.initialized ? scene_time(&m->state.motion) : m->state.start_time;
}

#if SCENE_ANY_FREE
static enum model_status advance_motion(struct model *m, double end_time)
{
    const struct scene_values *v = &m->state.values;
    const int32_t events = m->state.motion.counters.events;
    switch (integrator_run(&m->integrator, v, &m->state.motion, end_time)) {
    case INTEGRATOR_DONE:
        break;
    case INTEGRATOR_STEP_LIMIT:
        return model_report(
            m, MODEL_DISCARD,
            "The step to %.17g s stopped at %.17g s: solver.max_internal_steps = %d are used up "
            "(allowed: 1 .. 2147483647). Go on from there, if need be in smaller steps, or start with a "
            "larger limit.",
            end_time, model_time(m), (int)solver_max_internal_steps(v));
    case INTEGRATOR_FAILED:
    default:
        return model_report(m, MODEL_ERROR, "The step to %.17g s failed at %.17g s: %s", end_time,
                            model_time(m), m->integrator.message);
    }
    if (m->state.motion.counters.events != events) {
        model_report(m, MODEL_OK, "Changes of contact up to %.17g s: %d; since initialization: %d.", end_time,
                     (int)(m->state.motion.counters.events - events), (int)m->state.motion.counters.events);
    }
    return MODEL_OK;
}
#else
static enum model_status advance_motion(struct model *m, double end_time)
{
    struct scene_state *q = &m->state.motion;
    q->clock += scene_remaining(q, end_time);
    scene_rebase(&m->state.values, q);
    return MODEL_OK;
}
#endif

#if SCENE_ANY_FREE
/* A measure of a free body's motion that is infinite or NaN where any part of it is. */
static double size_of_motion(const struct scene_values *v, const struct scene_state *q, int body)
{
    const struct vec3 speed = q->body[body].velocity;
    return body_mass(v, body) * vec3_dot(speed, speed) + vec3_norm(q->body[body].moved);
}
#endif

/* Whether the motion of the bodies, and the energies that go with it, are still numbers. */
static bool motion_is_finite(const struct model *m)
{
    const struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    double sum = scene_time(q);
#if SCENE_ANY_FREE
    if (!scene_is_force_element(v)) {
        sum += q->dissipated + q->external_work;
    }
#endif
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_prescribed(v, i)) {
            const struct body_instant at = scene_body_now(v, q, i);
            sum += vec3_norm(at.displacement) + vec3_norm(at.velocity);
        }
#if SCENE_ANY_FREE
        sum += body_is_free(v, i) ? size_of_motion(v, q, i) : 0.0;
#endif
    }
    return isfinite(sum);
}

/* Undoes the step: the motion is as before, the integrator restarts. */
static enum model_status step_refused(struct model *m, const struct scene_state *before, double end_time)
{
    m->state.motion = *before;
    scene_rebase(&m->state.values, &m->state.motion);
    return model_report(
        m, MODEL_DISCARD,
        "The step to %.17g s takes the motion beyond the range of numbers; it stays at %.17g s "
        "(allowed: steps with finite speeds, displacements and energies).",
        end_time, model_time(m));
}

/* The state before is kept for the case that the step ends beyond the range of numbers. */
static enum model_status take_step(struct model *m, double end_time)
{
#if SCENE_ANY_FREE
    flight_catch_up(&m->state.values, &m->state.motion);
#endif
    const struct scene_state before = m->state.motion;
    const enum model_status status = advance_motion(m, end_time);
    return motion_is_finite(m) ? status : step_refused(m, &before, end_time);
}

bool model_step_deferred(struct model *m, double end_time)
{
#if SCENE_ANY_FREE
    if (!m->state.signals_open && flight_defer(&m->state.motion, end_time)) {
        if (m->outputs > OUTPUTS_FIXED) {
            model_foresee_reading(m, m->state.motion.clock);
        }
        return true;
    }
#else
    (void)m, (void)end_time;
#endif
    return false;
}

static void forget_outputs(struct model *m)
{
    if (m->outputs > OUTPUTS_FIXED) {
        m->outputs = OUTPUTS_FIXED;
    }
}

enum model_status model_step(struct model *m, double end_time)
{
    if (!m->state.initialized) {
        return model_report(m, MODEL_ERROR, "A step to %.17g s before the end of the initialization.",
                            end_time);
    }
    if (m->state.signals_open) {
        if (!model_apply_inputs(m)) {
            return model_refuse_inputs(m);
        }
        model_close_inputs(m);
        model_warn_of_rates(m);
    }
    if (model_step_deferred(m, end_time)) {
        return MODEL_OK;
    }
    forget_outputs(m); /* whoever is told of the step may read in the midst of it */
    const enum model_status status = take_step(m, end_time);
    forget_outputs(m);
    return status;
}
