/* Inputs as the importer sets them, and when they come into force. */
#include <math.h>
#include <string.h>

#include "model/input_paths.h"
#include "model/motion.h"
#include "model/shortest.h"

/* Which of a body's input signals a variable is; -1 when it is no input. */
static int signal_of(const struct variable *variable)
{
    switch (variable->row) {
    case ROW_body_prescribed_displacement:
        return variable->component;
    case ROW_body_prescribed_velocity:
        return 3 + variable->component;
    case ROW_body_external_force:
        return 6 + variable->component;
    case ROW_body_prescribed_angular_velocity:
        return 9 + variable->component;
    case ROW_body_prescribed_axis:
        return 12 + variable->component;
    case ROW_body_external_torque:
        return 15 + variable->component;
    default:
        return -1;
    }
}

static void note_value(struct model *m, const struct variable *variable)
{
    const int index = signal_of(variable);
    if (index < 0) {
        return;
    }
    uint8_t *marks = &m->state.marks[variable->element][index];
    /* A new value without derivatives at the same communication point ends earlier derivatives. */
    if (!(*marks & (SIGNAL_RATE | SIGNAL_CURVATURE))) {
        *marks = 0;
    }
    *marks |= SIGNAL_VALUE;
    m->state.signals_changed = 1;
    m->state.signals_open = 1;
}

void model_set(struct model *m, const struct variable *variable, const void *value)
{
    if (m->state.initialized && variable->causality == VARIABLE_PARAMETER) {
        model_begin_tuning(m);
    }
    memcpy((char *)&m->state.values + variable->offset, value, variable_size(variable));
    note_value(m, variable);
    m->outputs = OUTPUTS_NONE;
}

enum model_status model_set_input_derivative(struct model *m, const struct variable *variable, int order,
                                             double value)
{
    const int index = signal_of(variable);
    if (index < 0 || order < 1 || order > 2) {
        return model_report(m, MODEL_ERROR,
                            "Derivative %d of %s cannot be set (allowed: orders 1 and 2 of inputs).", order,
                            variable->name);
    }
    if (!(value >= variable->min && value <= variable->max)) {
        return model_report(m, MODEL_DISCARD, "Derivative %d of %s = %s refused (allowed: %g .. %g).", order,
                            variable->name, shortest_digits(value).text, variable->min, variable->max);
    }
    uint8_t *marks = &m->state.marks[variable->element][index];
    struct input_signal *signal = &m->state.signals[variable->element][index];
    if (order == 1) {
        signal->rate = value;
        *marks |= SIGNAL_RATE | SIGNAL_EXPLICIT;
    } else {
        signal->curvature = value;
        *marks |= SIGNAL_CURVATURE | SIGNAL_EXPLICIT;
    }
    m->state.signals_changed = 1;
    m->state.signals_open = 1;
    m->outputs = OUTPUTS_NONE;
    return MODEL_OK;
}

#if SCENE_ANY_ROTATION
/* Whether an axis is prescribed that has no direction. */
static bool has_no_axis(const struct scene_values *v, int body)
{
    return body_shape(body) != SHAPE_SPHERE && body_turn_is_prescribed(v, body) &&
           vec3_is_zero(body_prescribed_axis(v, body));
}
#endif

enum model_status model_refuse_inputs(const struct model *m)
{
#if SCENE_ANY_ROTATION
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const char *name = scene_body_name(i);
        if (has_no_axis(&m->state.values, i)) {
            return model_report(m, MODEL_DISCARD,
                                "%s.prescribed_axis[1], %s.prescribed_axis[2], %s.prescribed_axis[3] = 0, 0, "
                                "0 has no direction "
                                "and is not in force (allowed: at least one component other than zero).",
                                name, name, name);
        }
    }
#endif
    return model_report(
        m, MODEL_DISCARD,
        "The %s set last would take an energy beyond the range of numbers and are not in force "
        "(allowed: %s with finite energies).",
        m->state.tuned ? "parameters or inputs" : "inputs", m->state.tuned ? "values" : "inputs");
}

bool model_apply_inputs(struct model *m)
{
    struct scene_state *q = &m->state.motion;
    if (!m->state.signals_changed || !m->state.initialized) {
        return true;
    }
    motion_catch_up(&m->state.values, q);
    if (!model_tune(m)) {
        return false;
    }
    struct body_path next[SCENE_BODIES];
    bool same = true;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        next[i] = q->path[i];
        input_path_shift(m, i, &next[i]);
        const struct body_path before = next[i];
        input_path_renew(m, i, m->state.marks[i], &next[i]);
#if SCENE_ANY_ROTATION
        if (has_no_axis(&m->state.values, i)) {
            return false;
        }
#endif
        same = same && input_path_is_same(&before, &next[i]);
    }
    bool applied = true;
    if (m->state.exchange == EXCHANGE_CONTINUOUS) {
        memcpy(q->path, next, sizeof q->path); /* its power is integrated */
    } else {
        applied = same || motion_follow(&m->state.values, q, next);
    }
    m->state.signals_changed = !applied;
    return applied;
}

/* Derivative and velocity may be rounded apart by this part of the larger: difference quotients of
 * displacements keep no more digits. */
static const double RATE_AGREEMENT = 1e-6;

/* Without derivatives of its own a displacement goes on with the velocity, or stays in a force element:
 * neither contradicts. In a force element derivatives of zero say the same as none. */
static bool has_rate_of_its_own(const struct model *m, int body, struct vec3 rate)
{
    const uint8_t *marks = m->state.marks[body];
    const bool given = ((marks[0] | marks[1] | marks[2]) & SIGNAL_EXPLICIT) != 0;
    return given && !(inputs_prescribe_all(&m->state.values) && vec3_is_zero(rate));
}

/* Two rates of the same quantity differ by more than rounding, or `least`, explains. */
static bool contradict(struct vec3 a, struct vec3 b, double least)
{
    const double size = fmax(vec3_norm(a), vec3_norm(b));
    return vec3_norm(vec3_sub(a, b)) > RATE_AGREEMENT * size + least;
}

/* Bits of model_state.warned_of_rate. */
enum { WARNED_OF_DISPLACEMENT = 1, WARNED_OF_AXIS = 2 };

#if SCENE_ANY_ROTATION
/* Rates of unit axes that are no further apart agree [1/s]: what rounding leaves of an axis, over a
 * microsecond. */
static const double AXIS_AGREEMENT = 1e-9;

/* An axis with derivatives of its own follows them, its body the angular velocity. */
static void warn_of_axis(struct model *m, int body)
{
    const struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    const struct body_path *path = &q->path[body];
    if (path->turn_follows != TURN_FOLLOWS_AXIS || (m->state.warned_of_rate[body] & WARNED_OF_AXIS) ||
        body_shape(body) == SHAPE_SPHERE || !body_turn_is_prescribed(v, body)) {
        return;
    }
    struct vec3 given[3];
    memcpy(given, path->axis, sizeof given);
    path_shift(given, 3, q->clock);
    const double length = vec3_norm(given[0]);
    const struct vec3 axis = vec3_scale(1.0 / length, given[0]);
    const struct vec3 raw = vec3_scale(1.0 / length, given[1]);
    const struct vec3 rate = vec3_axpy(raw, -vec3_dot(raw, axis), axis);
    const struct vec3 turning = vec3_cross(path_at(path->angular_velocity, 3, q->clock), axis);
    if (contradict(rate, turning, AXIS_AGREEMENT)) {
        m->state.warned_of_rate[body] |= WARNED_OF_AXIS;
        const char *name = scene_body_name(body);
        model_report(m, MODEL_WARNING,
                     "%s.prescribed_axis, as a unit vector, has the derivative (%g, %g, %g) 1/s at %s s, but "
                     "%s.prescribed_angular_velocity turns it by (%g, %g, %g) 1/s: the gap follows the axis, "
                     "slip and work the angular velocity, and energies need not balance (allowed: equal "
                     "ones). Given once.",
                     name, rate.x, rate.y, rate.z, shortest_digits(scene_time(q)).text, name, turning.x,
                     turning.y, turning.z);
    }
}
#endif

void model_warn_of_rates(struct model *m)
{
    const struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    for (int i = 0; i < SCENE_BODIES; ++i) {
#if SCENE_ANY_ROTATION
        warn_of_axis(m, i);
#endif
        if (!body_is_prescribed(v, i) || (m->state.warned_of_rate[i] & WARNED_OF_DISPLACEMENT)) {
            continue;
        }
        struct vec3 path[4];
        memcpy(path, q->path[i].displacement, sizeof path);
        path_shift(path, 4, q->clock);
        const struct vec3 rate = path[1];
        const struct vec3 velocity = path_at(q->path[i].velocity, 3, q->clock);
        if (has_rate_of_its_own(m, i, rate) && contradict(rate, velocity, motion_least_speed(v))) {
            m->state.warned_of_rate[i] |= WARNED_OF_DISPLACEMENT;
            const char *name = scene_body_name(i);
            model_report(
                m, MODEL_WARNING,
                "%s.prescribed_displacement has the derivative (%g, %g, %g) m/s at %s s, but "
                "%s.prescribed_velocity is (%g, %g, %g) m/s: the gap follows the displacement, the gap "
                "rate and the work the velocity, and energies need not balance (allowed: equal ones). "
                "Given once.",
                name, rate.x, rate.y, rate.z, shortest_digits(scene_time(q)).text, name, velocity.x,
                velocity.y, velocity.z);
        }
    }
}

void model_close_inputs(struct model *m)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        for (int k = 0; k < SIGNALS_EACH; ++k) {
            m->state.marks[i][k] &= SIGNAL_EXPLICIT;
        }
    }
    m->state.signals_changed = 0;
    m->state.signals_open = 0;
}
