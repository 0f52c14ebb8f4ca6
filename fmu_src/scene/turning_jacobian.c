/* The Jacobian of a scene that turns or rubs: exact, by directional derivatives of each contact. */
#include "scene/turning_ode.h"

#if SCENE_ANY_TURNING

#include <string.h>

/* The leading rows and columns of the Jacobian, dense, by columns. What falls outside is not wanted. */
struct turning_matrix {
    double *at;
    int size;
};

static void add_entry(struct turning_matrix m, int row, int column, double value)
{
    if (row < m.size && column < m.size) {
        m.at[column * m.size + row] += value;
    }
}

static void add_three(struct turning_matrix m, int row, int column, double factor, struct vec3 a)
{
    for (int k = 0; k < 3; ++k) {
        add_entry(m, row + k, column, factor * vec3_get(a, k));
    }
}

static void add_four(struct turning_matrix m, int row, int column, struct quaternion a)
{
    add_entry(m, row, column, a.w);
    add_three(m, row + 1, column, 1.0, quaternion_vector(a));
}

/* What all parts of it need. */
struct turning_linearization {
    const struct scene_ode *ode;
    const double *y;
    struct scene_instant at;
    struct turning_state turning;
    struct turning_layout layout;
    struct turning_matrix matrix;
    double *of_forces; /* [coupled][3 contacts]: only the forces by the states are wanted; else NULL */
};

static struct vec3 along_axis(int component)
{
    struct vec3 a = {0.0, 0.0, 0.0};
    vec3_set(&a, component, 1.0);
    return a;
}

static struct quaternion along_component(int component)
{
    return (struct quaternion){component == 0, component == 1, component == 2, component == 3};
}

/* d omega of a body by component k of its spin: e_k + (I_1/I_3 - 1) e (e.e_k). */
static struct vec3 rotation_by_spin(const struct turning_linearization *l, int body, int k)
{
    const struct vec3 e = quaternion_third_axis(l->at.turning.body[body].orientation);
    return vec3_axpy(along_axis(k), turning_flatness(l->ode->values, body) * vec3_get(e, k), e);
}

/* d e by component k of the orientation in y, of any length: e is that of the unit one. */
static struct vec3 axis_by_orientation(const struct turning_linearization *l, int body, int k)
{
    const double *data = l->y + l->layout.orientation[body];
    const struct quaternion q = {data[0], data[1], data[2], data[3]};
    const struct vec3 slopes[4] = {
        {q.y, -q.x, q.w}, {q.z, -q.w, -q.x}, {q.w, q.z, -q.y}, {q.x, q.y, q.z}}; /* halves */
    const struct vec3 e = quaternion_third_axis(l->at.turning.body[body].orientation);
    return vec3_scale(2.0 / quaternion_dot(q, q), vec3_axpy(slopes[k], -data[k], e));
}

/* d omega by that change of the axis, under the same spin. */
static struct vec3 rotation_by_axis(const struct turning_linearization *l, int body, struct vec3 change)
{
    const double *data = l->y + l->layout.spin[body];
    const struct vec3 spin = vec3_make(data[0], data[1], data[2]);
    const struct vec3 e = quaternion_third_axis(l->at.turning.body[body].orientation);
    const struct vec3 both = vec3_axpy(vec3_scale(vec3_dot(spin, change), e), vec3_dot(spin, e), change);
    return vec3_scale(turning_flatness(l->ode->values, body), both);
}

/* A change of what acts on a body, times a sign. */
static void add_to_body(const struct turning_linearization *l, int column, int body, double sign,
                        struct vec3 force, struct vec3 torque)
{
    const struct scene_values *v = l->ode->values;
    const int work = ode_dissipated(v) + 1;
    if (body_is_free(v, body)) {
        add_three(l->matrix, ode_body(v, body) + 3, column, sign / body_mass(v, body), force);
    } else if (body_is_prescribed(v, body)) {
        add_entry(l->matrix, work, column, -sign * vec3_dot(force, l->at.velocity[body]));
    }
    if (l->layout.spin[body] >= 0) {
        add_three(l->matrix, l->layout.spin[body], column, 1.0 / turning_inertia(v, body), torque);
    } else if (body_turn_is_prescribed(v, body)) {
        add_entry(l->matrix, work, column, -vec3_dot(torque, l->at.turning.body[body].angular_velocity));
    }
}

/* All that a change of a contact's motion changes, into one column. */
static void add_change(const struct turning_linearization *l, const struct turning_slopes *slopes,
                       int contact, int column, const struct turning_motion *motion)
{
    const struct scene_values *v = l->ode->values;
    const struct turning_change change = turning_slopes_along(slopes, motion);
    if (l->of_forces) {
        double *to = l->of_forces + 3 * (column * SCENE_CONTACTS + contact);
        for (int k = 0; k < 3; ++k) {
            to[k] += vec3_get(change.force, k);
        }
        return;
    }
    add_to_body(l, column, contact_source(contact), 1.0, change.force, change.source_torque);
    add_to_body(l, column, contact_destination(contact), -1.0, change.force, change.destination_torque);
    if (l->layout.spring[contact] >= 0) {
        add_three(l->matrix, l->layout.spring[contact], column, 1.0, change.spring_rate);
    }
    const int impulse = ode_impulse(v, contact);
    add_three(l->matrix, impulse, column, 1.0, change.force);
    add_three(l->matrix, impulse + 3, column, 1.0, change.source_torque);
    add_three(l->matrix, impulse + 6, column, 1.0, change.destination_torque);
    add_entry(l->matrix, ode_dissipated(v), column, change.dissipated_power);
    add_entry(l->matrix, ode_dissipated(v) + 2, column, change.friction_power);
}

/* The columns of the states of a body at one end of a contact (sign -1: source, +1: destination). */
static void add_body_columns(const struct turning_linearization *l, const struct turning_slopes *slopes,
                             int contact, int body, double sign)
{
    const struct turning_motion none = {.separation = {0.0, 0.0, 0.0}};
    for (int k = 0; k < 3 && body_is_free(l->ode->values, body); ++k) {
        const int column = ode_body(l->ode->values, body) + k;
        struct turning_motion motion = none;
        motion.separation = vec3_scale(sign, along_axis(k));
        add_change(l, slopes, contact, column, &motion);
        motion = none;
        motion.rate = vec3_scale(sign, along_axis(k));
        add_change(l, slopes, contact, column + 3, &motion);
    }
    for (int k = 0; k < 3 && l->layout.spin[body] >= 0; ++k) {
        struct turning_motion motion = none;
        *(sign < 0.0 ? &motion.source_rotation : &motion.destination_rotation) = rotation_by_spin(l, body, k);
        add_change(l, slopes, contact, l->layout.spin[body] + k, &motion);
    }
    const bool tips = l->layout.orientation[body] >= 0 && l->layout.orientation[body] < l->layout.coupled;
    for (int k = 0; k < 4 && tips; ++k) { /* of a destination only: a source is a sphere */
        struct turning_motion motion = none;
        motion.axis = axis_by_orientation(l, body, k);
        motion.destination_rotation = rotation_by_axis(l, body, motion.axis);
        add_change(l, slopes, contact, l->layout.orientation[body] + k, &motion);
    }
}

static void add_contact(const struct turning_linearization *l, int contact)
{
    const struct contact_shape shape = scene_contact_shape_at(l->ode->values, l->ode->state, &l->at, contact);
    const struct turning_motion motion = turning_motion_of(&l->turning, &l->at, contact);
    const struct turning_laws laws = turning_laws_of(l->ode->values, l->ode->state, contact);
    if (laws.regime == REGIME_APART) {
        return;
    }
    const struct turning_slopes slopes = turning_slopes_at(&shape, &l->at.geometry[contact], &motion, &laws);
    add_body_columns(l, &slopes, contact, contact_source(contact), -1.0);
    add_body_columns(l, &slopes, contact, contact_destination(contact), 1.0);
    for (int k = 0; k < 3 && l->layout.spring[contact] >= 0; ++k) {
        struct turning_motion stretched = {.spring = along_axis(k)};
        add_change(l, &slopes, contact, l->layout.spring[contact] + k, &stretched);
    }
}

/* A body's own: its displacement by its velocity, its orientation by its angular velocity, the work of the
 * external force and torque. */
static void add_motion(const struct turning_linearization *l, double clock, int body)
{
    const struct scene_values *v = l->ode->values;
    const int index = ode_body(v, body);
    for (int k = 0; k < 3 && body_is_free(v, body); ++k) {
        const struct vec3 force = path_at(l->ode->state->path[body].force, 3, clock);
        add_entry(l->matrix, index + k, index + 3 + k, 1.0);
        add_entry(l->matrix, ode_dissipated(v) + 1, index + 3 + k, vec3_get(force, k));
    }
}

#if SCENE_ANY_ROTATION
static void add_rotation(const struct turning_linearization *l, double clock, int body)
{
    const int spin = l->layout.spin[body];
    const int orientation = l->layout.orientation[body];
    const int work = ode_dissipated(l->ode->values) + 1;
    const double *data = l->y + orientation;
    const struct quaternion q = {data[0], data[1], data[2], data[3]};
    const struct vec3 torque = path_at(l->ode->state->path[body].torque, 3, clock);
    for (int k = 0; k < 3; ++k) {
        const struct vec3 change = rotation_by_spin(l, body, k);
        add_four(l->matrix, orientation, spin + k, quaternion_rate(q, change));
        add_entry(l->matrix, work, spin + k, vec3_dot(torque, change));
    }
    for (int k = 0; k < 4; ++k) {
        const struct vec3 change = rotation_by_axis(l, body, axis_by_orientation(l, body, k));
        const struct vec3 omega = l->at.turning.body[body].angular_velocity;
        add_four(
            l->matrix, orientation, orientation + k,
            quaternion_axpy(quaternion_rate(along_component(k), omega), 1.0, quaternion_rate(q, change)));
        add_entry(l->matrix, work, orientation + k, vec3_dot(torque, change));
    }
}
#endif

static void linearize(struct turning_linearization *l, double clock)
{
    const struct scene_ode *ode = l->ode;
    memset(l->matrix.at, 0, (size_t)l->matrix.size * (size_t)l->matrix.size * sizeof *l->matrix.at);
    l->layout = turning_layout_of(ode->values);
    l->turning = ode->state->turning;
    turning_unpack(ode->values, l->y, &l->turning);
    ode_instant(ode, clock, l->y, &l->at);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        add_motion(l, clock, i);
#if SCENE_ANY_ROTATION
        if (l->layout.spin[i] >= 0) {
            add_rotation(l, clock, i);
        }
#endif
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        add_contact(l, j);
    }
}

void turning_jacobian(const struct scene_ode *ode, double clock, const double *y, int size, double *columns)
{
    struct turning_linearization l = {.ode = ode, .y = y, .matrix = {columns, size}};
    linearize(&l, clock);
}

void turning_split_jacobian(const struct scene_ode *ode, double clock, const double *y, double *columns,
                            double *by_forces, double *of_forces)
{
    const int coupled = ode_coupled(ode->values);
    const size_t count = 3 * SCENE_CONTACTS * (size_t)coupled;
    struct turning_linearization l = {
        .ode = ode, .y = y, .matrix = {columns, coupled}, .of_forces = of_forces};
    memset(of_forces, 0, count * sizeof *of_forces);
    memset(by_forces, 0, count * sizeof *by_forces);
    linearize(&l, clock);
    struct turning_matrix by = {by_forces, coupled};
    for (int j = 0; j < 3 * SCENE_CONTACTS; ++j) {
        const int contact = j / 3;
        const struct vec3 force = along_axis(j % 3);
        const struct vec3 on_source = vec3_cross(l.at.turning.source_arm[contact], force);
        const struct vec3 on_destination = vec3_cross(force, l.at.turning.destination_arm[contact]);
        l.matrix = by;
        add_to_body(&l, j, contact_source(contact), 1.0, force, on_source);
        add_to_body(&l, j, contact_destination(contact), -1.0, force, on_destination);
    }
}

#endif
