#include "segment/flight_turning.h"

#include <string.h>

#include "scene/turning.h"

#if SCENE_ANY_ROTATION

static bool is_under_torque(const struct scene_state *q, int body)
{
    const struct vec3 *torque = q->path[body].torque;
    return !(vec3_is_zero(torque[0]) && vec3_is_zero(torque[1]) && vec3_is_zero(torque[2]));
}

static struct rotor rotor_of(const struct scene_values *v, const struct scene_state *q, int body)
{
    const struct body_inertia inertia = body_inertia_of(v, body);
    const struct body_turn *origin = &q->turn_origin[body];
    const struct rotor_state start = {origin->orientation, origin->angular_velocity};
    return rotor_from(start, inertia.transverse, inertia.axial);
}

/* The external torque from the present on. */
static void torque_from_now(const struct scene_state *q, int body, struct vec3 torque[ROTOR_TORQUES])
{
    memcpy(torque, q->path[body].torque, sizeof q->path[body].torque);
    path_shift(torque, ROTOR_TORQUES, q->clock);
}

struct body_turn flight_turn_at(const struct scene_values *v, const struct scene_state *q, int body,
                                double clock)
{
    struct rotor_state then;
    if (is_under_torque(q, body)) {
        const struct body_inertia inertia = body_inertia_of(v, body);
        const struct body_turn *turn = &q->turning.body[body];
        const struct rotor_state now = {turn->orientation, turn->angular_velocity};
        struct vec3 torque[ROTOR_TORQUES];
        torque_from_now(q, body, torque);
        then = rotor_under_torque(&now, inertia.transverse, inertia.axial, torque, clock - q->clock);
    } else {
        const struct rotor rotor = rotor_of(v, q, body);
        then = rotor_at(&rotor, clock);
    }
    return (struct body_turn){then.orientation, then.angular_velocity};
}

/* I_1 omega^2/2 + (I_3 - I_1) omega_3^2/2 */
static double energy_of(const struct body_inertia *inertia, const struct body_turn *turn)
{
    const double axial = vec3_dot(turn->angular_velocity, quaternion_third_axis(turn->orientation));
    return 0.5 * inertia->transverse * vec3_dot(turn->angular_velocity, turn->angular_velocity) +
           0.5 * (inertia->axial - inertia->transverse) * axial * axial;
}

double flight_torque_work(const struct scene_values *v, const struct scene_state *q, int body,
                          const struct body_turn *then)
{
    if (!is_under_torque(q, body)) {
        return 0.0;
    }
    const struct body_inertia inertia = body_inertia_of(v, body);
    return energy_of(&inertia, then) - energy_of(&inertia, &q->turning.body[body]);
}

void flight_turn_all(const struct scene_values *v, struct scene_state *q, double clock)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_turns_freely(v, i)) {
            const struct body_turn then = flight_turn_at(v, q, i, clock);
            q->external_work += flight_torque_work(v, q, i, &then);
            q->turning.body[i] = then;
        }
    }
}

static struct axis_motion prescribed_axis(const struct scene_state *q, struct vec3 axis, int body)
{
    struct body_path path = q->path[body];
    path_shift(path.angular_velocity, 3, q->clock);
    path_shift(path.axis, 3, q->clock);
    const bool by_axis = path.turn_follows != TURN_FOLLOWS_VELOCITY && !vec3_is_zero(path.axis[0]);
    return by_axis ? axis_motion_following(path.axis, 3) : axis_motion_driven(axis, path.angular_velocity, 3);
}

struct axis_motion flight_axis_motion(const struct scene_values *v, const struct scene_state *q,
                                      const struct body_turn *at, int body)
{
    const struct vec3 axis = quaternion_third_axis(at->orientation);
    if (body_turn_is_prescribed(v, body)) {
        return prescribed_axis(q, axis, body);
    }
    if (!is_under_torque(q, body)) {
        const struct rotor rotor = rotor_of(v, q, body);
        struct axis_motion motion = axis_motion_of_rotor(&rotor);
        motion.from = -q->clock; /* the rotor's time is the clock */
        return motion;
    }
    const struct body_inertia inertia = body_inertia_of(v, body);
    const struct rotor_state now = {at->orientation, at->angular_velocity};
    struct vec3 torque[ROTOR_TORQUES];
    struct vec3 lambda[ROTOR_RATES];
    torque_from_now(q, body, torque);
    rotor_rates_under_torque(&now, inertia.transverse, inertia.axial, torque, lambda);
    return axis_motion_driven(axis, lambda, ROTOR_RATES);
}

#endif
