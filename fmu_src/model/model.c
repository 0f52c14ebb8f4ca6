#include <math.h>
#include <string.h>

#include "model/model.h"
#include "model/motion.h"
#include "model/report.h"

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
        motion_close(m);
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
    m->state.exchange = m->host.exchange ? EXCHANGE_EVENTS : EXCHANGE_NONE;
    scene_start(&m->state.values);
    m->outputs = OUTPUTS_NONE;
}

enum model_status model_setup(struct model *m, bool tolerance_defined, double tolerance, double start_time)
{
    enum model_status status = MODEL_OK;
    if (!isfinite(start_time)) {
        return model_report(m, MODEL_ERROR, "The start time %s s is refused (allowed: finite times).",
                            shortest_digits(start_time).text);
    }
    if (tolerance_defined && !(tolerance > 0.0 && isfinite(tolerance))) {
        return model_report(m, MODEL_ERROR, "The tolerance %s is refused (allowed: positive finite numbers).",
                            shortest_digits(tolerance).text);
    }
    m->state.importer_tolerance = 0.0;
    for (int i = 0; tolerance_defined && i < scene_variable_count; ++i) {
        const struct variable *row = &scene_variables[i];
        if (row->row == ROW_solver_relative_tolerance) {
            m->state.importer_tolerance = fmin(fmax(tolerance, row->min), row->max);
            if (m->state.importer_tolerance != tolerance) {
                status = model_report(m, MODEL_WARNING,
                                      "The tolerance %s is outside the range %g .. %g of %s; %g is used.",
                                      shortest_digits(tolerance).text, row->min, row->max, row->name,
                                      m->state.importer_tolerance);
            }
        }
    }
    m->state.start_time = start_time;
    m->outputs = OUTPUTS_NONE;
    return status;
}

enum model_status model_exit_initialization(struct model *m)
{
    const enum model_status checked = model_check_consistency(m);
    if (checked > MODEL_WARNING) {
        return checked;
    }
    model_prepare(m);
    if (!m->host.exchange) {
        const enum model_status status = motion_open(m, &m->state.values, "Initialization failed");
        if (status != MODEL_OK) {
            return status;
        }
    }
    model_warn_of_idle(m);
    m->state.initialized = 1;
    m->outputs = OUTPUTS_NONE;
    return checked;
}

double model_time(const struct model *m)
{
    return m->state.initialized ? scene_time(&m->state.motion) : m->state.start_time;
}

/* Whether the motion of the bodies, and the energies that go with it, are still numbers. */
static bool motion_is_finite(const struct model *m)
{
    const struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    double sum = scene_time(q) + motion_size(v, q);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_prescribed(v, i)) {
            const struct body_instant at = scene_body_now(v, q, i);
            sum += vec3_norm(at.displacement) + vec3_norm(at.velocity);
        }
    }
    return isfinite(sum);
}

/* The motion is as before, the integrator restarts. */
static void undo_step(struct model *m, const struct scene_state *before)
{
    scene_state_copy(&m->state.values, before, &m->state.motion);
    scene_rebase(&m->state.values, &m->state.motion);
}

static enum model_status step_refused(struct model *m, const struct scene_state *before, double end_time)
{
    undo_step(m, before);
    return model_report(m, MODEL_DISCARD,
                        "The step to %s s takes the motion beyond the range of numbers; it stays at %s s "
                        "(allowed: steps with finite speeds, displacements and energies).",
                        shortest_digits(end_time).text, shortest_digits(model_time(m)).text);
}

/* The state before is kept for the case that the step ends beyond the range of numbers, or too early. */
static enum model_status take_step(struct model *m, const struct step_request *request)
{
    motion_catch_up(&m->state.values, &m->state.motion);
    struct scene_state before;
    scene_state_copy(&m->state.values, &m->state.motion, &before);
    const enum model_status status = motion_advance(m, request);
    if (!motion_is_finite(m)) {
        return step_refused(m, &before, request->end_time);
    }
    if (status == MODEL_DISCARD && request->whole) {
        undo_step(m, &before);
    }
    return status;
}

bool model_step_deferred(struct model *m, double end_time)
{
    return !m->state.signals_open && motion_defer(m, end_time);
}

void model_forget_outputs(struct model *m)
{
    if (m->outputs > OUTPUTS_FIXED) {
        m->outputs = OUTPUTS_FIXED;
    }
}

/* A request whose asker may read outputs: they are of the instant, and reading changes nothing of the run. */
struct readable_request {
    struct model *model;
    const struct step_request *asked;
};

static double ask_readable(void *context, double end_time)
{
    const struct readable_request *readable = context;
    struct model *m = readable->model;
    const struct scene_state kept = m->state.motion;
    model_forget_outputs(m);
    end_time = readable->asked->at_event(readable->asked->context, end_time);
    m->state.motion = kept;
    return end_time;
}

enum model_status model_step(struct model *m, double end_time)
{
    const struct step_request request = {.end_time = end_time};
    return model_step_requested(m, &request);
}

enum model_status model_step_requested(struct model *m, const struct step_request *request)
{
    if (!m->state.initialized) {
        return model_report(m, MODEL_ERROR, "A step to %s s before the end of the initialization.",
                            shortest_digits(request->end_time).text);
    }
    if (m->state.signals_open) {
        if (!model_apply_inputs(m)) {
            return model_refuse_inputs(m);
        }
        model_close_inputs(m);
        model_warn_of_rates(m);
    }
    if (model_step_deferred(m, request->end_time)) {
        return MODEL_OK;
    }
    model_forget_outputs(m); /* whoever is told of the step may read in the midst of it */
    struct readable_request readable = {m, request};
    struct step_request inner = *request;
    inner.at_event = request->at_event != NULL ? ask_readable : NULL;
    inner.context = &readable;
    const enum model_status status = take_step(m, &inner);
    model_forget_outputs(m);
    return status;
}

/* Checking and reading single variables. */

enum model_status model_check(struct model *m, const struct variable *variable, const void *value)
{
    const double number = variable_number(variable, value);
    if (isfinite(number) && number >= variable->min && number <= variable->max) {
        const bool tunes = m->state.initialized && variable->causality == VARIABLE_PARAMETER;
        return !tunes || model_can_tune(m, variable, value)
                   ? MODEL_OK
                   : model_report(m, MODEL_DISCARD,
                                  "%s = %s refused: a force or an energy would be beyond the range of "
                                  "numbers (allowed: values with finite ones); it stays as it was.",
                                  variable->name, shortest_digits(number).text);
    }
    return model_report(m, MODEL_DISCARD, "%s = %s refused (allowed: %s .. %s); it stays as it was.",
                        variable->name, shortest_digits(number).text, shortest_digits(variable->min).text,
                        shortest_digits(variable->max).text);
}

/* Which outputs have to be computed so that a variable shows the present. */
static enum outputs outputs_for(const struct model *m, const struct variable *variable)
{
    switch (variable->row) {
    case ROW_body_displacement:
    case ROW_body_position:
    case ROW_body_velocity:
        return OUTPUTS_BODIES;
    default:
        break;
    }
    const bool given = variable->causality == VARIABLE_PARAMETER || variable->causality == VARIABLE_INPUT;
    return given && m->state.initialized ? OUTPUTS_NONE : OUTPUTS_ALL;
}

enum model_status model_read(struct model *m, const struct variable *variable, void *value)
{
    if (!model_update_outputs(m, outputs_for(m, variable))) {
        return model_refuse_inputs(m);
    }
    const char *unknown = motion_unknown(m, variable);
    if (unknown) {
        return model_report(m, MODEL_DISCARD, "%s is not known: %s.", variable->name, unknown);
    }
    double local = 0.0;
    const void *at = (const char *)&m->state.values + variable->offset;
    if (variable_is_local(variable)) {
        struct scene_instant now;
        scene_now(&m->state.values, &m->state.motion, &now);
        local = motion_local(&m->state.values, &m->state.motion, &now, variable);
        at = &local;
    }
    if (!isfinite(variable_number(variable, at))) {
        return model_report(m, MODEL_DISCARD,
                            "%s is beyond the range of numbers (allowed: parameters and inputs with finite "
                            "forces and energies).",
                            variable->name);
    }
    memcpy(value, at, variable_size(variable));
    return MODEL_OK;
}

/* Where a Real stands, if it can be read as it stands and its table entry has these marks; else NULL. */
static inline const double *known_real(const struct model *m, uint32_t reference, uint32_t marks)
{
    const uint32_t real = reference < SCENE_REFERENCES ? scene_reals[reference] : 0;
    const bool known = (real & (uint32_t)m->outputs) && (real & marks) == marks;
    return known ? (const double *)&m->state.values + (real & VARIABLE_OFFSET) / sizeof(double) : NULL;
}

bool model_get_vector(const struct model *m, const uint32_t *references, double *values)
{
    if (!references || !values) {
        return false;
    }
    const uint32_t first = references[0];
    const bool in_order = references[1] == first + 1 && references[2] == first + 2;
    const double *from = in_order ? known_real(m, first, VARIABLE_VECTOR) : NULL;
    if (!from) {
        return false;
    }
    /* One by one: what is read in wider portions than it was written in keeps the processor waiting. */
    values[0] = from[0];
    values[1] = from[1];
    values[2] = from[2];
    return true;
}

size_t model_get_reals(const struct model *m, const uint32_t *references, size_t count, double *values)
{
    size_t i = 0;
    const double *from = NULL;
    while (i < count && (from = known_real(m, references[i], 0)) != NULL) {
        values[i++] = *from;
    }
    return i;
}

/* Variables that are vectors. */

const struct variable *vector_variable(uint32_t reference)
{
    const struct variable *variable = scene_variable(reference);
    return variable != NULL && variable->component == 0 ? variable : NULL;
}

size_t vector_length(const struct variable *first)
{
    const struct variable *end = scene_variables + scene_variable_count;
    size_t length = 1;
    while (first + length < end && first[length].row == first->row &&
           first[length].element == first->element && first[length].component == length) {
        ++length;
    }
    return length;
}
