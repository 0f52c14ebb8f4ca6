/*
 * Inputs between communication points: each continues from its last value as a polynomial with the given
 * derivatives. A prescribed body follows its prescribed velocity unless its displacement has derivatives of
 * its own. A force element (all bodies prescribed) moves by given derivatives only. An integrator outside
 * sets inputs at each instant; they are constants until it sets them again.
 */
#include <math.h>
#include <string.h>

#include "model/motion.h"
#include "model/shortest.h"
#include "scene/turning.h"

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
    struct input_signal *signal = &m->state.signals[variable->element][index];
    /* A new value without derivatives at the same communication point ends earlier derivatives. */
    if (!(*marks & (SIGNAL_RATE | SIGNAL_CURVATURE))) {
        *signal = (struct input_signal){0.0, 0.0};
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
        signal->curvature = *marks & SIGNAL_CURVATURE ? signal->curvature : 0.0;
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

static double *component(struct vec3 *a, int index)
{
    return index == 0 ? &a->x : index == 1 ? &a->y : &a->z;
}

/* Coefficients 0..2 of one scalar path from a signal that was set at this communication point. */
static void put_signal(struct vec3 *path, int k, double value, const struct input_signal *signal,
                       uint8_t marks)
{
    if (marks & SIGNAL_VALUE) {
        *component(&path[0], k) = value;
    }
    if (marks & (SIGNAL_VALUE | SIGNAL_RATE | SIGNAL_CURVATURE)) {
        *component(&path[1], k) = signal->rate;
        *component(&path[2], k) = 0.5 * signal->curvature;
    }
}

static void put_displacement(struct body_path *path, int k, double value, const struct input_signal *signal,
                             uint8_t marks, bool follows_velocity)
{
    put_signal(path->displacement, k, value, signal, marks);
    if (marks & (SIGNAL_VALUE | SIGNAL_RATE | SIGNAL_CURVATURE)) {
        *component(&path->displacement[3], k) = 0.0;
    }
    if (follows_velocity && !(marks & SIGNAL_EXPLICIT)) {
        *component(&path->displacement[1], k) = vec3_get(path->velocity[0], k);
        *component(&path->displacement[2], k) = vec3_get(path->velocity[1], k) / 2.0;
        *component(&path->displacement[3], k) = vec3_get(path->velocity[2], k) / 3.0;
    }
}

static bool all_prescribed(const struct scene_values *v)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (!body_is_prescribed(v, i)) {
            return false;
        }
    }
    return true;
}

#if SCENE_ANY_ROTATION
/* The axis goes on by derivatives of its own, or with the angular velocity. */
static void renew_turn(const struct model *m, int body, const uint8_t *marks, struct body_path *path)
{
    const struct scene_values *v = &m->state.values;
    const struct input_signal *signals = m->state.signals[body];
    const struct vec3 omega = body_prescribed_angular_velocity(v, body);
    const struct vec3 axis = body_prescribed_axis(v, body);
    const struct vec3 torque = body_external_torque(v, body);
    const bool prescribed = body_turn_is_prescribed(v, body);
    for (int k = 0; k < 3; ++k) {
        if (prescribed) {
            put_signal(path->angular_velocity, k, vec3_get(omega, k), &signals[9 + k], marks[9 + k]);
            put_signal(path->axis, k, vec3_get(axis, k), &signals[12 + k], marks[12 + k]);
        }
        if (body_turns_freely(v, body)) {
            put_signal(path->torque, k, vec3_get(torque, k), &signals[15 + k], marks[15 + k]);
        }
    }
    const bool has_rate = ((marks[12] | marks[13] | marks[14]) & SIGNAL_EXPLICIT) != 0;
    path->turn_follows = m->host.exchange ? TURN_FOLLOWS_AXIS_ALONE
                         : has_rate       ? TURN_FOLLOWS_AXIS
                                          : TURN_FOLLOWS_VELOCITY;
}
#endif

/* The body's paths from now on; `path` comes with its origin at the present. */
static void renew_path(const struct model *m, int body, const uint8_t *marks, struct body_path *path)
{
    const struct scene_values *v = &m->state.values;
    const struct input_signal *signals = m->state.signals[body];
    const struct vec3 displacement = body_prescribed_displacement(v, body);
    const struct vec3 velocity = body_prescribed_velocity(v, body);
    const struct vec3 force = body_external_force(v, body);
    const bool follows_velocity = !m->host.exchange && !all_prescribed(v);
    for (int k = 0; k < 3; ++k) {
        if (body_is_prescribed(v, body)) {
            put_signal(path->velocity, k, vec3_get(velocity, k), &signals[3 + k], marks[3 + k]);
            put_displacement(path, k, vec3_get(displacement, k), &signals[k], marks[k], follows_velocity);
        }
        if (body_is_free(v, body)) {
            put_signal(path->force, k, vec3_get(force, k), &signals[6 + k], marks[6 + k]);
        }
    }
#if SCENE_ANY_ROTATION
    renew_turn(m, body, marks, path);
#endif
}

#if SCENE_ANY_ROTATION
static bool is_set(const uint8_t *marks)
{
    return (marks[0] | marks[1] | marks[2]) != 0;
}

/* Until it is set, a prescribed axis is the parameter's. */
static void start_axis(struct model *m, int body)
{
    if (body_shape(body) != SHAPE_SPHERE && !is_set(&m->state.marks[body][12])) {
        m->state.motion.path[body].axis[0] = body_axis(&m->state.values, body);
    }
}
#endif

void model_start_paths(struct model *m)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        uint8_t marks[SIGNALS_EACH];
        for (int k = 0; k < SIGNALS_EACH; ++k) {
            marks[k] = m->state.marks[i][k] | SIGNAL_VALUE;
        }
        renew_path(m, i, marks, &m->state.motion.path[i]);
#if SCENE_ANY_ROTATION
        start_axis(m, i);
#endif
    }
}

static bool same_coefficients(const struct vec3 *a, const struct vec3 *b, int count)
{
    for (int i = 0; i < count; ++i) {
        if (a[i].x != b[i].x || a[i].y != b[i].y || a[i].z != b[i].z) {
            return false;
        }
    }
    return true;
}

static bool same_path(const struct body_path *a, const struct body_path *b)
{
#if SCENE_ANY_ROTATION
    if (!same_coefficients(a->angular_velocity, b->angular_velocity, 3) ||
        !same_coefficients(a->axis, b->axis, 3) || !same_coefficients(a->torque, b->torque, 3) ||
        a->turn_follows != b->turn_follows) {
        return false;
    }
#endif
    return same_coefficients(a->displacement, b->displacement, 4) &&
           same_coefficients(a->velocity, b->velocity, 3) && same_coefficients(a->force, b->force, 3);
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

#if SCENE_ANY_ROTATION
/* An axis that has turned with its body goes on from there, whatever of it is not set. */
static void put_turned_axis(const struct model *m, int body, struct body_path *path)
{
    if (path->turn_follows == TURN_FOLLOWS_VELOCITY && body_shape(body) != SHAPE_SPHERE &&
        body_turn_is_prescribed(&m->state.values, body)) {
        const struct scene_state *q = &m->state.motion;
        const struct body_turn now = turning_prescribed_at(&m->state.values, q, q->clock, body);
        path->axis[0] = quaternion_third_axis(now.orientation);
    }
}
#endif

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
        path_shift(next[i].displacement, 4, q->clock);
        path_shift(next[i].velocity, 3, q->clock);
        path_shift(next[i].force, 3, q->clock);
#if SCENE_ANY_ROTATION
        path_shift(next[i].angular_velocity, 3, q->clock);
        path_shift(next[i].axis, 3, q->clock);
        path_shift(next[i].torque, 3, q->clock);
        put_turned_axis(m, i, &next[i]);
#endif
        const struct body_path before = next[i];
        renew_path(m, i, m->state.marks[i], &next[i]);
#if SCENE_ANY_ROTATION
        if (has_no_axis(&m->state.values, i)) {
            return false;
        }
#endif
        same = same && same_path(&before, &next[i]);
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
    return given && !(all_prescribed(&m->state.values) && vec3_is_zero(rate));
}

void model_warn_of_rates(struct model *m)
{
    const struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (!body_is_prescribed(v, i) || m->state.warned_of_rate[i]) {
            continue;
        }
        struct vec3 path[4];
        memcpy(path, q->path[i].displacement, sizeof path);
        path_shift(path, 4, q->clock);
        const struct vec3 rate = path[1];
        const struct vec3 velocity = path_at(q->path[i].velocity, 3, q->clock);
        const double size = fmax(vec3_norm(rate), vec3_norm(velocity));
        if (has_rate_of_its_own(m, i, rate) &&
            vec3_norm(vec3_sub(rate, velocity)) > RATE_AGREEMENT * size + motion_least_speed(v)) {
            m->state.warned_of_rate[i] = 1;
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
