#include "model/input_paths.h"

#include "scene/turning.h"

static double *component(struct vec3 *a, int index)
{
    return index == 0 ? &a->x : index == 1 ? &a->y : &a->z;
}

/* Coefficients 0..2 of one scalar path from a signal that was set at this communication point. A value or
 * a derivative ends the derivatives of higher order that are not set with it; those of lower order go on as
 * they are at present. */
static void put_signal(struct vec3 *path, int k, double value, const struct input_signal *signal,
                       uint8_t marks)
{
    if (marks & SIGNAL_VALUE) {
        *component(&path[0], k) = value;
    }
    if (marks & (SIGNAL_VALUE | SIGNAL_RATE)) {
        *component(&path[1], k) = marks & SIGNAL_RATE ? signal->rate : 0.0;
    }
    if (marks & (SIGNAL_VALUE | SIGNAL_RATE | SIGNAL_CURVATURE)) {
        *component(&path[2], k) = marks & SIGNAL_CURVATURE ? 0.5 * signal->curvature : 0.0;
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

bool inputs_prescribe_all(const struct scene_values *v)
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

void input_path_renew(const struct model *m, int body, const uint8_t *marks, struct body_path *path)
{
    const struct scene_values *v = &m->state.values;
    const struct input_signal *signals = m->state.signals[body];
    const struct vec3 displacement = body_prescribed_displacement(v, body);
    const struct vec3 velocity = body_prescribed_velocity(v, body);
    const struct vec3 force = body_external_force(v, body);
    const bool follows_velocity = !m->host.exchange && !inputs_prescribe_all(v);
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
        input_path_renew(m, i, marks, &m->state.motion.path[i]);
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

bool input_path_is_same(const struct body_path *a, const struct body_path *b)
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

void input_path_shift(const struct model *m, int body, struct body_path *path)
{
    const double clock = m->state.motion.clock;
    path_shift(path->displacement, 4, clock);
    path_shift(path->velocity, 3, clock);
    path_shift(path->force, 3, clock);
#if SCENE_ANY_ROTATION
    path_shift(path->angular_velocity, 3, clock);
    path_shift(path->axis, 3, clock);
    path_shift(path->torque, 3, clock);
    put_turned_axis(m, body, path);
#else
    (void)body;
#endif
}
