#include "scene/turning_jet.h"

#include <string.h>

#include "contact/friction_jet.h"

#if SCENE_ANY_TURNING

struct vec3 turning_jet_cross(const struct vec3 *a, const struct vec3 *b, int order)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i <= order; ++i) {
        sum = vec3_add(sum, vec3_cross(a[i], b[order - i]));
    }
    return sum;
}

/* The orientation from the angular velocity: q' = (0, omega) q / 2. */
static void put_orientation(const struct vec3 omega[2], struct quaternion q[JET_TERMS])
{
    q[1] = quaternion_rate(q[0], omega[0]);
    q[2] = quaternion_scale(
        0.5, quaternion_axpy(quaternion_rate(q[0], omega[1]), 1.0, quaternion_rate(q[1], omega[0])));
}

/* e' = omega x e */
static void put_turning_axis(const struct vec3 *omega, struct vec3 e[JET_TERMS])
{
    e[1] = vec3_cross(omega[0], e[0]);
    e[2] = vec3_scale(0.5, turning_jet_cross(omega, e, 1));
}

#if SCENE_ANY_ROTATION
/* A direction that is given as a polynomial of any length. */
static void put_given_axis(const struct body_path *path, double clock, struct vec3 e[JET_TERMS])
{
    struct vec3 a[3];
    double length[JET_TERMS];
    memcpy(a, path->axis, sizeof a);
    path_shift(a, 3, clock);
    jet_length(a, length);
    for (int i = 1; i < JET_TERMS && length[0] > 0.0; ++i) {
        struct vec3 rest = a[i];
        for (int k = 1; k <= i; ++k) {
            rest = vec3_axpy(rest, -length[k], e[i - k]);
        }
        e[i] = vec3_scale(1.0 / length[0], rest);
    }
}

static void put_prescribed(const struct scene_state *q, int body, struct scene_jet *along)
{
    const struct body_path *path = &q->path[body];
    struct vec3 *omega = along->angular_velocity[body];
    struct vec3 *e = along->axis[body];
    omega[2] = path->angular_velocity[2];
    put_turning_axis(omega, e);
    struct vec3 seen[2] = {omega[0], omega[1]};
    if (path->turn_follows != TURN_FOLLOWS_VELOCITY && body_shape(body) != SHAPE_SPHERE) {
        put_given_axis(path, q->clock, e);
        const struct vec3 rate[2] = {e[1], vec3_scale(2.0, e[2])};
        const double spin[2] = {vec3_dot(omega[0], e[0]),
                                vec3_dot(omega[1], e[0]) + vec3_dot(omega[0], e[1])};
        for (int i = 0; i < 2; ++i) { /* as the axis tells it, and about the axis */
            seen[i] = vec3_add(turning_jet_cross(e, rate, i), jet_scale(spin, e, i));
        }
    }
    put_orientation(seen, along->orientation[body]);
}
#endif

void turning_jet_put_bodies(const struct scene_values *v, const struct scene_state *q,
                            const struct scene_instant *at, struct scene_jet *along)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        along->angular_velocity[i][0] = at->turning.body[i].angular_velocity;
        along->orientation[i][0] = at->turning.body[i].orientation;
        along->axis[i][0] = quaternion_third_axis(at->turning.body[i].orientation);
#if SCENE_ANY_ROTATION
        along->angular_velocity[i][1] = turning_acceleration(v, q, q->clock, at, i);
        if (body_turn_is_prescribed(v, i)) {
            put_prescribed(q, i, along);
        } else if (body_turns_freely(v, i)) {
            const struct body_path *path = &q->path[i];
            along->torque[i] = vec3_axpy(path->torque[1], 2.0 * q->clock, path->torque[2]);
            put_turning_axis(along->angular_velocity[i], along->axis[i]);
            put_orientation(along->angular_velocity[i], along->orientation[i]);
        }
#endif
    }
#if SCENE_ANY_ELASTIC_FRICTION
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_rubs_elastically(v, j)) {
            along->spring[j][0] = q->turning.spring[j];
            along->spring[j][1] = turning_spring_rate(v, q, &q->turning, at, j);
        }
    }
#endif
    (void)v, (void)q;
}

#if SCENE_ANY_FREE_ROTATION
/* Half the change of a free body's angular acceleration: of
 * I_1 omega' = tau - (I_3 - I_1) (tau_3 / I_3 e + omega_3 omega x e). */
static struct vec3 half_spin_jerk(const struct scene_values *v, const struct scene_state *q,
                                  const struct scene_instant *at, const struct scene_jet *along, int body)
{
    const struct body_inertia inertia = body_inertia_of(v, body);
    const struct vec3 *e = along->axis[body];
    const struct vec3 *omega = along->angular_velocity[body];
    struct vec3 torque[2] = {turning_torque_on(v, q, q->clock, at, body), along->torque[body]};
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct turning_jet *turning = &along->turning[j];
        if (contact_source(j) == body) {
            torque[1] = vec3_add(torque[1], turning->source_torque[1]);
        }
        if (contact_destination(j) == body) {
            torque[1] = vec3_add(torque[1], turning->destination_torque[1]);
        }
    }
    const double tau[2] = {jet_dot(torque, e, 0), jet_dot(torque, e, 1)};
    const double spin[2] = {jet_dot(omega, e, 0), jet_dot(omega, e, 1)};
    const struct vec3 whirl[2] = {turning_jet_cross(omega, e, 0), turning_jet_cross(omega, e, 1)};
    const struct vec3 axial = vec3_scale(1.0 / inertia.axial, jet_scale(tau, e, 1));
    const struct vec3 gyration = vec3_add(axial, jet_scale(spin, whirl, 1));
    const double more = inertia.axial - inertia.transverse;
    return vec3_scale(0.5 / inertia.transverse, vec3_axpy(torque[1], -more, gyration));
}
#endif

#if SCENE_ANY_ELASTIC_FRICTION
static struct vec3 times(const double m[3][3], struct vec3 a)
{
    return vec3_make(m[0][0] * a.x + m[0][1] * a.y + m[0][2] * a.z,
                     m[1][0] * a.x + m[1][1] * a.y + m[1][2] * a.z,
                     m[2][0] * a.x + m[2][1] * a.y + m[2][2] * a.z);
}

/* Half of xi'' of xi' = f(F_n, v_t, xi) - n (xi.n'). */
static struct vec3 half_spring_change(const struct scene_values *v, const struct scene_state *q,
                                      const struct scene_instant *at, const struct scene_jet *along,
                                      int contact)
{
    const struct turning_laws laws = turning_laws_of(v, q, contact);
    const struct friction_state rubbing = turning_rubbing(&q->turning, at, contact);
    const struct friction_slopes slopes =
        friction_spring_rate_slopes(&laws.friction, laws.friction_regime, rubbing);
    const struct contact_jet *geometry = &along->contact[contact];
    const struct vec3 *spring = along->spring[contact];
    const struct vec3 bend[2] = {geometry->normal[1], vec3_scale(2.0, geometry->normal[2])};
    const double tilted[2] = {vec3_dot(spring[0], bend[0]),
                              vec3_dot(spring[1], bend[0]) + vec3_dot(spring[0], bend[1])};
    struct vec3 sum = vec3_scale(geometry->normal_force[1], slopes.by_normal_force);
    sum = vec3_add(sum, times(slopes.by_slip, along->turning[contact].slip[1]));
    sum = vec3_add(sum, times(slopes.by_spring, spring[1]));
    return vec3_scale(0.5, vec3_sub(sum, jet_scale(tilted, geometry->normal, 1)));
}
#endif

void turning_jet_put_changes(const struct scene_values *v, const struct scene_state *q,
                             const struct scene_instant *at, struct scene_jet *along)
{
#if SCENE_ANY_FREE_ROTATION
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_turns_freely(v, i)) {
            along->angular_velocity[i][2] = half_spin_jerk(v, q, at, along, i);
        }
    }
#endif
#if SCENE_ANY_ELASTIC_FRICTION
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_rubs_elastically(v, j) && q->contact[j].regime != (int32_t)REGIME_APART) {
            along->spring[j][2] = half_spring_change(v, q, at, along, j);
        }
    }
#endif
    (void)v, (void)q, (void)at, (void)along;
}

#if SCENE_ANY_FREE_ROTATION
struct vec3 turning_jet_spin_change(const struct scene_values *v, const struct scene_state *q,
                                    const struct scene_instant *at, const struct scene_jet *along, int body)
{
    return vec3_scale(2.0, half_spin_jerk(v, q, at, along, body));
}
#else
struct vec3 turning_jet_spin_change(const struct scene_values *v, const struct scene_state *q,
                                    const struct scene_instant *at, const struct scene_jet *along, int body)
{
    (void)v, (void)q, (void)at, (void)along, (void)body;
    return vec3_make(0.0, 0.0, 0.0);
}
#endif

void turning_jet_move_axis(const struct scene_values *v, const struct scene_instant *at, int body,
                           int component, double change, struct scene_jet *along)
{
    const double length = vec3_norm(body_prescribed_axis(v, body));
    const struct vec3 e = quaternion_third_axis(at->turning.body[body].orientation);
    struct vec3 by = {0.0, 0.0, 0.0};
    vec3_set(&by, component, change / length);
    by = vec3_axpy(by, -vec3_dot(by, e), e);
    along->axis[body][1] = vec3_add(along->axis[body][1], by);
    const struct quaternion turned = quaternion_rate(at->turning.body[body].orientation, vec3_cross(e, by));
    along->orientation[body][1] = quaternion_axpy(along->orientation[body][1], 1.0, turned);
}

#endif
