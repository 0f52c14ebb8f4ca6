#include "scene/turning.h"

#include <math.h>

/* Homogeneous solids: sphere 2/5 m r^2; cylinder m r^2/2 and m (3 r^2 + L^2)/12. */
struct body_inertia body_inertia_of(const struct scene_values *v, int body)
{
    const bool is_cylinder = SCENE_ANY_CYLINDER && body_shape(body) == SHAPE_CYLINDER;
    if (body_inertia_control(v, body) == INERTIA_CONTROL_USER_DEFINED) {
        const double axial = body_axial_inertia(v, body);
        return (struct body_inertia){axial, is_cylinder ? body_transverse_inertia(v, body) : axial};
    }
    const double m = body_mass(v, body);
    const double r = body_radius(v, body);
    if (!is_cylinder) {
        return (struct body_inertia){0.4 * m * r * r, 0.4 * m * r * r};
    }
    const double length = body_length(v, body);
    return (struct body_inertia){0.5 * m * r * r, m * (3.0 * r * r + length * length) / 12.0};
}

struct friction_law scene_friction_law(const struct scene_values *v, const struct scene_state *q, int contact)
{
    struct friction_law law = {.kind = (enum friction)contact_friction(v, contact),
                               .coefficient = contact_friction_coefficient(v, contact),
                               .static_coefficient = contact_static_friction_coefficient(v, contact),
                               .largest = contact_maximum_friction_force(v, contact),
                               .stiffness = contact_tangential_stiffness(v, contact),
                               .damping = contact_tangential_damping(v, contact)};
#if SCENE_ANY_FRICTION
    law.slip_velocity = q->contact[contact].parameters.slip_velocity;
#else
    (void)q;
#endif
    return law;
}

#if SCENE_ANY_TURNING

#if SCENE_ANY_ROTATION

static bool has_axis(int body)
{
    return body_shape(body) != SHAPE_SPHERE;
}

static struct vec3 unit(struct vec3 a)
{
    /* By the largest component first: squares of small and large numbers leave the range of a double. */
    const struct vec3 scaled = vec3_scale(1.0 / vec3_max_abs(a), a);
    return vec3_scale(1.0 / vec3_norm(scaled), scaled);
}

/* The smallest rotation on top that takes the body's axis to a direction of any length but zero. */
static struct quaternion turned_to(struct quaternion orientation, struct vec3 axis)
{
    if (!(vec3_max_abs(axis) > 0.0)) {
        return orientation;
    }
    const struct quaternion turn = quaternion_between(quaternion_third_axis(orientation), unit(axis));
    return quaternion_unit(quaternion_product(turn, orientation));
}

struct quaternion turning_start_orientation(const struct scene_values *v, int body)
{
    return has_axis(body) ? quaternion_between(vec3_make(0.0, 0.0, 1.0), unit(body_axis(v, body)))
                          : quaternion_identity();
}

/* Coefficient n of the series in t/step is at most exp(a/2)/8^n, where a is the angle that the sizes of
 * omega's terms would turn by in 8 steps (Cauchy's bound). With a <= 8, for a constant omega a step of one
 * radian, what follows 20 terms is below exp(4)/8^21 = 6e-18. */
enum { SERIES_TERMS = 20 };
static const double SERIES_REACH = 8.0;

/*
 * The rotation by the angular velocity omega(t) = sum omega_i t^i from 0 to `clock`, from q' = (0, omega)
 * q/2:
 * (n + 1) q_(n+1) = sum_i (0, omega_i) q_(n-i) / 2, in steps of at most one radian. A step takes the
 * polynomial along to its own start.
 */
static struct quaternion rotation_over(const struct vec3 omega[3], double clock, struct quaternion q)
{
    struct vec3 rest[3] = {omega[0], omega[1], omega[2]};
    double left = clock;
    double before = (double)INFINITY;
    while (left > 0.0 && left < before) { /* turning_prescribed_steps tells how often */
        const double w[3] = {vec3_norm(rest[0]), vec3_norm(rest[1]), vec3_norm(rest[2])};
        double step = left;
        double far = SERIES_REACH * step;
        while (far * (w[0] + far * (w[1] / 2.0 + far * w[2] / 3.0)) > SERIES_REACH) {
            step *= 0.5;
            far = SERIES_REACH * step;
        }
        struct quaternion term[SERIES_TERMS + 1] = {q};
        for (int n = 0; n < SERIES_TERMS; ++n) {
            struct quaternion sum = {0.0, 0.0, 0.0, 0.0};
            double power = step;
            for (int i = 0; i < 3 && i <= n; ++i) {
                sum = quaternion_axpy(sum, power, quaternion_rate(term[n - i], rest[i]));
                power *= step;
            }
            term[n + 1] = quaternion_scale(1.0 / (n + 1), sum);
            q = quaternion_axpy(q, 1.0, term[n + 1]);
        }
        q = quaternion_unit(q);
        path_shift(rest, 3, step);
        before = left;
        left -= step;
    }
    return q;
}

/* Around one direction the angle is the integral of the speed. */
static bool is_around_one_direction(const struct vec3 omega[3])
{
    return path_is_steady(omega, 3);
}

static struct quaternion turned_by(const struct vec3 omega[3], double clock, struct quaternion q)
{
    if (clock == 0.0) {
        return q;
    }
    if (is_around_one_direction(omega)) {
        return quaternion_unit(quaternion_product(quaternion_of_rotation(vec3_scale(clock, omega[0])), q));
    }
    return rotation_over(omega, clock, q);
}

double turning_prescribed_steps(const struct scene_values *v, const struct scene_state *q, double length)
{
    double steps = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const struct vec3 *omega = q->path[i].angular_velocity;
        if (body_turn_is_prescribed(v, i) && !is_around_one_direction(omega)) {
            steps += length * (vec3_norm(omega[0]) +
                               length * (vec3_norm(omega[1]) / 2.0 + length * vec3_norm(omega[2]) / 3.0));
        }
    }
    return steps;
}

struct body_turn turning_prescribed_at(const struct scene_values *v, const struct scene_state *q,
                                       double clock, int body)
{
    const struct body_path *path = &q->path[body];
    struct body_turn at = {quaternion_identity(), path_at(path->angular_velocity, 3, clock)};
    (void)v;
    if (path->turn_follows != TURN_FOLLOWS_AXIS_ALONE) {
        at.orientation = turned_by(path->angular_velocity, clock, q->turn_origin[body].orientation);
    }
    if (has_axis(body) && path->turn_follows != TURN_FOLLOWS_VELOCITY) {
        at.orientation = turned_to(at.orientation, path_at(path->axis, 3, clock));
    }
    return at;
}

void turning_rebase(const struct scene_values *v, struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_turns_freely(v, i)) {
            q->turn_origin[i] = q->turning.body[i];
        } else if (body_turn_is_prescribed(v, i)) {
            q->turn_origin[i] = turning_prescribed_at(v, q, q->clock, i);
            q->turning.body[i] = q->turn_origin[i];
        }
    }
}

void turning_take_axes(const struct scene_values *v, struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_turn_is_prescribed(v, i)) {
            struct body_turn *origin = &q->turn_origin[i];
            if (has_axis(i)) {
                origin->orientation = turned_to(origin->orientation, q->path[i].axis[0]);
            }
            origin->angular_velocity = q->path[i].angular_velocity[0];
            q->turning.body[i] = *origin;
        }
    }
}

static void place_body(const struct scene_values *v, struct scene_state *q, int body)
{
    q->turn_origin[body] = (struct body_turn){turning_start_orientation(v, body), vec3_make(0.0, 0.0, 0.0)};
    if (body_turns_freely(v, body)) {
        q->turn_origin[body].angular_velocity = body_initial_angular_velocity(v, body);
    }
    if (body_turn_is_prescribed(v, body) && has_axis(body)) {
        q->turn_origin[body].orientation = turned_to(quaternion_identity(), q->path[body].axis[0]);
    }
    q->turning.body[body] = q->turn_origin[body];
}

static struct body_turn turn_at(const struct scene_values *v, const struct scene_state *q, double clock,
                                const struct turning_state *turning, int body)
{
    if (body_turn_is_prescribed(v, body)) {
        return turning_prescribed_at(v, q, clock, body);
    }
    struct body_turn turn = turning->body[body];
    if (!body_turns_freely(v, body)) { /* whatever an integrator outside says */
        turn.angular_velocity = vec3_make(0.0, 0.0, 0.0);
    }
    turn.orientation = quaternion_unit(turn.orientation); /* an integrator outside lets its length drift */
    return turn;
}

#else /* nothing turns, but contacts may rub */

double turning_prescribed_steps(const struct scene_values *v, const struct scene_state *q, double length)
{
    (void)v, (void)q, (void)length;
    return 0.0;
}

static struct body_turn turn_at(const struct scene_values *v, const struct scene_state *q, double clock,
                                const struct turning_state *turning, int body)
{
    (void)v, (void)q, (void)clock, (void)turning, (void)body;
    return (struct body_turn){quaternion_identity(), {0.0, 0.0, 0.0}};
}

void turning_rebase(const struct scene_values *v, struct scene_state *q)
{
    (void)v, (void)q;
}

void turning_take_axes(const struct scene_values *v, struct scene_state *q)
{
    (void)v, (void)q;
}

static void place_body(const struct scene_values *v, struct scene_state *q, int body)
{
    (void)v, (void)q, (void)body;
}

#endif

void turning_place(const struct scene_values *v, struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        place_body(v, q, i);
    }
}

void turning_of_bodies(const struct scene_values *v, const struct scene_state *q, double clock,
                       const struct turning_state *turning, struct scene_instant *at)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        at->turning.body[i] = turn_at(v, q, clock, turning, i);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int destination = contact_destination(j);
        at->turning.axis[j] = vec3_make(0.0, 0.0, 0.0);
#if SCENE_ANY_CYLINDER || SCENE_ANY_PLANE
        at->turning.axis[j] = body_turns(v, destination)
                                  ? quaternion_third_axis(at->turning.body[destination].orientation)
                                  : q->contact[j].parameters.axis;
#else
        (void)destination;
#endif
    }
}

/* Torques from the force on the source. */
static void put_torques(struct scene_instant *at, int contact)
{
    struct turning_instant *turning = &at->turning;
    const struct vec3 force = at->source_force[contact];
    turning->source_torque[contact] = vec3_cross(turning->source_arm[contact], force);
    turning->destination_torque[contact] = vec3_cross(force, turning->destination_arm[contact]);
}

void turning_of_contact(const struct scene_values *v, const struct scene_state *q,
                        const struct turning_state *state, int contact, struct scene_instant *at)
{
    struct turning_instant *turning = &at->turning;
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct vec3 arm = vec3_scale(shape.side * shape.source_radius, g->normal);
    turning->source_arm[contact] = arm;
    turning->destination_arm[contact] = vec3_sub(arm, at->separation[contact]);
    const struct vec3 past =
        vec3_sub(vec3_cross(turning->body[source].angular_velocity, arm),
                 vec3_cross(turning->body[destination].angular_velocity, turning->destination_arm[contact]));
    const struct vec3 slip = vec3_sub(past, at->rate[contact]);
    /* Twice: what the first leaves along n is rounding of speeds, which a small v_0 would make a force. */
    const struct vec3 across = vec3_axpy(slip, -vec3_dot(slip, g->normal), g->normal);
    turning->slip[contact] = vec3_axpy(across, -vec3_dot(across, g->normal), g->normal);
    turning->friction_force[contact] = vec3_make(0.0, 0.0, 0.0);
#if SCENE_ANY_FRICTION
    if (contact_rubs(v, contact) && q->contact[contact].regime != (int32_t)REGIME_APART) {
        const struct friction_law law = scene_friction_law(v, q, contact);
        const struct friction_state rubbing = {at->normal_force[contact], turning->slip[contact],
                                               state->spring[contact]};
        turning->friction_force[contact] =
            friction_force(&law, (enum friction_regime)q->contact[contact].friction_regime, rubbing);
        at->source_force[contact] = vec3_add(at->source_force[contact], turning->friction_force[contact]);
    }
#else
    (void)state;
#endif
    put_torques(at, contact);
}

void turning_complete(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    turning_of_bodies(v, q, q->clock, &q->turning, at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        turning_of_contact(v, q, &q->turning, j, at);
    }
}

#endif
