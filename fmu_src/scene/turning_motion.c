#include "scene/turning_motion.h"

#if SCENE_ANY_TURNING

struct vec3 turning_torque_on(const struct scene_values *v, const struct scene_state *q, double clock,
                              const struct scene_instant *at, int body)
{
    struct vec3 torque = {0.0, 0.0, 0.0};
#if SCENE_ANY_ROTATION
    if (body_turns_freely(v, body)) {
        torque = path_at(q->path[body].torque, 3, clock);
    }
#else
    (void)v, (void)q, (void)clock;
#endif
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_source(j) == body) {
            torque = vec3_add(torque, at->turning.source_torque[j]);
        }
        if (contact_destination(j) == body) {
            torque = vec3_add(torque, at->turning.destination_torque[j]);
        }
    }
    return torque;
}

#if SCENE_ANY_ROTATION
static struct vec3 free_acceleration_of(const struct scene_values *v, const struct body_turn *turn, int body,
                                        struct vec3 torque)
{
    const struct body_inertia inertia = body_inertia_of(v, body);
    const struct vec3 e = quaternion_third_axis(turn->orientation);
    const struct vec3 omega = turn->angular_velocity;
    const double more = inertia.axial - inertia.transverse;
    const struct vec3 gyration = vec3_scale(vec3_dot(omega, e), vec3_cross(omega, e));
    const struct vec3 axial = vec3_axpy(gyration, vec3_dot(torque, e) / inertia.axial, e);
    return vec3_scale(1.0 / inertia.transverse, vec3_axpy(torque, -more, axial));
}
#endif

struct vec3 turning_acceleration(const struct scene_values *v, const struct scene_state *q, double clock,
                                 const struct scene_instant *at, int body)
{
#if SCENE_ANY_ROTATION
    if (body_turns_freely(v, body)) {
        return free_acceleration_of(v, &at->turning.body[body], body,
                                    turning_torque_on(v, q, clock, at, body));
    }
    if (body_turn_is_prescribed(v, body)) {
        const struct vec3 *path = q->path[body].angular_velocity;
        return vec3_axpy(path[1], 2.0 * clock, path[2]);
    }
#else
    (void)v, (void)q, (void)clock, (void)at, (void)body;
#endif
    return vec3_make(0.0, 0.0, 0.0);
}

struct turning_motion turning_motion_of(const struct turning_state *turning, const struct scene_instant *at,
                                        int contact)
{
    struct turning_motion motion = {
        .separation = at->separation[contact],
        .rate = at->rate[contact],
        .source_rotation = at->turning.body[contact_source(contact)].angular_velocity,
        .destination_rotation = at->turning.body[contact_destination(contact)].angular_velocity,
        .axis = at->turning.axis[contact]};
#if SCENE_ANY_FRICTION
    motion.spring = turning->spring[contact];
#else
    (void)turning;
#endif
    return motion;
}

struct turning_laws turning_laws_of(const struct scene_values *v, const struct scene_state *q, int contact)
{
    struct turning_laws laws = {.normal = scene_contact_law(v, q, contact),
                                .friction = scene_friction_law(v, q, contact),
                                .regime = (enum contact_regime)q->contact[contact].regime,
                                .friction_regime = FRICTION_LIFTED};
#if SCENE_ANY_FRICTION
    laws.friction_regime = (enum friction_regime)q->contact[contact].friction_regime;
#endif
    return laws;
}

struct friction_state turning_rubbing(const struct turning_state *turning, const struct scene_instant *at,
                                      int contact)
{
    struct friction_state rubbing = {at->normal_force[contact], at->turning.slip[contact], {0.0, 0.0, 0.0}};
#if SCENE_ANY_FRICTION
    rubbing.spring = turning->spring[contact];
#else
    (void)turning;
#endif
    return rubbing;
}

/* w as the destination's frame sees it. */
static struct vec3 seen_rate(const struct scene_instant *at, int contact)
{
    const struct vec3 omega = at->turning.body[contact_destination(contact)].angular_velocity;
    return vec3_sub(at->rate[contact], vec3_cross(omega, at->separation[contact]));
}

struct vec3 turning_normal_rate(const struct scene_values *v, const struct scene_state *q,
                                const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct vec3 omega = at->turning.body[contact_destination(contact)].angular_velocity;
    const struct vec3 turned = vec3_cross(omega, g->normal);
    if (!contact_turns(&shape, g)) {
        return turned;
    }
    const struct vec3 across = contact_turning_part(&shape, g, seen_rate(at, contact));
    return vec3_axpy(turned, 1.0 / g->distance, across);
}

struct vec3 turning_spring_rate(const struct scene_values *v, const struct scene_state *q,
                                const struct turning_state *turning, const struct scene_instant *at,
                                int contact)
{
    const struct friction_law law = scene_friction_law(v, q, contact);
    const struct turning_laws laws = turning_laws_of(v, q, contact);
    const struct friction_state rubbing = turning_rubbing(turning, at, contact);
    if (laws.regime == REGIME_APART) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    const struct vec3 own = friction_spring_rate(&law, laws.friction_regime, rubbing);
    const double tilted = vec3_dot(rubbing.spring, turning_normal_rate(v, q, at, contact));
    return vec3_axpy(own, -tilted, at->geometry[contact].normal);
}

/* g'' = side (n'.w_g + n.w_g'),   w_g' = a_dst - a_src - omega_d' x c - omega_d x w */
static double gap_acceleration(const struct scene_values *v, const struct scene_state *q, double clock,
                               const struct scene_instant *at, int contact)
{
    const int destination = contact_destination(contact);
    const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
    const struct vec3 omega = at->turning.body[destination].angular_velocity;
    const struct vec3 turned = turning_acceleration(v, q, clock, at, destination);
    const struct vec3 linear =
        vec3_sub(at->acceleration[destination], at->acceleration[contact_source(contact)]);
    const struct vec3 rotary =
        vec3_add(vec3_cross(turned, at->separation[contact]), vec3_cross(omega, at->rate[contact]));
    return shape.side * (vec3_dot(turning_normal_rate(v, q, at, contact), seen_rate(at, contact)) +
                         vec3_dot(at->geometry[contact].normal, vec3_sub(linear, rotary)));
}

double turning_normal_force_rate(const struct scene_values *v, const struct scene_state *q, double clock,
                                 const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_slopes slopes =
        contact_force_slopes(&law, (enum contact_regime)q->contact[contact].regime, g->gap, g->gap_rate);
    const double by_rate =
        slopes.by_rate == 0.0 ? 0.0 : slopes.by_rate * gap_acceleration(v, q, clock, at, contact);
    return slopes.by_gap * g->gap_rate + by_rate;
}

double turning_friction_power(const struct scene_values *v, const struct scene_instant *at)
{
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_rubs(v, j)) {
            sum -= vec3_dot(at->turning.friction_force[j], at->turning.slip[j]);
        }
    }
    return sum;
}

#endif
