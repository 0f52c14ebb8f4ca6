#include "scene/turning_ode.h"

#if SCENE_ANY_TURNING

double turning_inertia(const struct scene_values *v, int body)
{
    return body_inertia_of(v, body).transverse;
}

double turning_flatness(const struct scene_values *v, int body)
{
    const struct body_inertia inertia = body_inertia_of(v, body);
    return (inertia.transverse - inertia.axial) / inertia.axial;
}

struct quaternion turning_orientation_from(const double *data)
{
    return quaternion_unit((struct quaternion){data[0], data[1], data[2], data[3]});
}

static void three_to(struct vec3 a, double *data)
{
    data[0] = a.x;
    data[1] = a.y;
    data[2] = a.z;
}

static struct vec3 three_from(const double *data)
{
    return vec3_make(data[0], data[1], data[2]);
}

static void four_to(struct quaternion a, double *data)
{
    data[0] = a.w;
    data[1] = a.x;
    data[2] = a.y;
    data[3] = a.z;
}

#if SCENE_ANY_ROTATION
/* L / I_1 = omega + (I_3/I_1 - 1) (omega.e) e, and back. */
static struct vec3 spin_of(const struct scene_values *v, const struct body_turn *turn, int body)
{
    const struct body_inertia inertia = body_inertia_of(v, body);
    const struct vec3 e = quaternion_third_axis(turn->orientation);
    const double more = (inertia.axial - inertia.transverse) / inertia.transverse;
    return vec3_axpy(turn->angular_velocity, more * vec3_dot(turn->angular_velocity, e), e);
}

static struct vec3 angular_velocity_of(const struct scene_values *v, struct quaternion orientation,
                                       struct vec3 spin, int body)
{
    const struct vec3 e = quaternion_third_axis(orientation);
    return vec3_axpy(spin, turning_flatness(v, body) * vec3_dot(spin, e), e);
}
#endif

void turning_pack(const struct scene_ode *ode, double *y)
{
    const struct turning_layout layout = turning_layout_of(ode->values);
#if SCENE_ANY_ROTATION
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (layout.spin[i] >= 0) {
            const struct body_turn *turn = &ode->state->turning.body[i];
            three_to(spin_of(ode->values, turn, i), y + layout.spin[i]);
            four_to(turn->orientation, y + layout.orientation[i]);
        }
    }
#endif
#if SCENE_ANY_FRICTION
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (layout.spring[j] >= 0) {
            three_to(ode->state->turning.spring[j], y + layout.spring[j]);
        }
    }
#endif
}

void turning_unpack(const struct scene_values *v, const double *y, struct turning_state *turning)
{
    const struct turning_layout layout = turning_layout_of(v);
#if SCENE_ANY_ROTATION
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (layout.spin[i] >= 0) {
            struct body_turn *turn = &turning->body[i];
            turn->orientation = turning_orientation_from(y + layout.orientation[i]);
            turn->angular_velocity =
                angular_velocity_of(v, turn->orientation, three_from(y + layout.spin[i]), i);
        }
    }
#endif
#if SCENE_ANY_FRICTION
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (layout.spring[j] >= 0) {
            turning->spring[j] = three_from(y + layout.spring[j]);
        }
    }
#endif
}

void turning_pack_integrals(const struct scene_ode *ode, double *y)
{
    const struct scene_values *v = ode->values;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_torques *torques = &ode->state->contact[j].torques;
        three_to(torques->source_impulse, y + ode_impulse(v, j) + 3);
        three_to(torques->destination_impulse, y + ode_impulse(v, j) + 6);
    }
    y[ode_dissipated(v) + 2] = ode->state->friction_energy;
}

void turning_unpack_integrals(const struct scene_values *v, struct scene_state *q, const double *y)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].torques.source_impulse = three_from(y + ode_impulse(v, j) + 3);
        q->contact[j].torques.destination_impulse = three_from(y + ode_impulse(v, j) + 6);
    }
    q->friction_energy = y[ode_dissipated(v) + 2];
}

void turning_rates(const struct scene_ode *ode, double clock, const double *y, const struct scene_instant *at,
                   double *rates)
{
    const struct scene_values *v = ode->values;
    const struct turning_layout layout = turning_layout_of(v);
    struct turning_state turning = ode->state->turning;
    turning_unpack(v, y, &turning);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (layout.spin[i] >= 0) {
            const struct vec3 torque = turning_torque_on(v, ode->state, clock, at, i);
            const double *o = y + layout.orientation[i];
            const struct quaternion orientation = {o[0], o[1], o[2], o[3]};
            three_to(vec3_scale(1.0 / turning_inertia(v, i), torque), rates + layout.spin[i]);
            four_to(quaternion_rate(orientation, at->turning.body[i].angular_velocity),
                    rates + layout.orientation[i]);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (layout.spring[j] >= 0) {
            three_to(turning_spring_rate(v, ode->state, &turning, at, j), rates + layout.spring[j]);
        }
        three_to(at->turning.source_torque[j], rates + ode_impulse(v, j) + 3);
        three_to(at->turning.destination_torque[j], rates + ode_impulse(v, j) + 6);
    }
    rates[ode_dissipated(v) + 2] = turning_friction_power(v, at);
}

/* An orientation is as large as a unit quaternion. */
void turning_nominal(const struct scene_ode *ode, const double *y, double *sizes)
{
    const struct scene_values *v = ode->values;
    const struct turning_layout layout = turning_layout_of(v);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (layout.spin[i] >= 0) {
            const double spin = vec3_norm(three_from(y + layout.spin[i]));
            three_to(vec3_make(spin, spin, spin), sizes + layout.spin[i]);
            four_to((struct quaternion){1.0, 1.0, 1.0, 1.0}, sizes + layout.orientation[i]);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (layout.spring[j] >= 0) {
            const double length = vec3_norm(three_from(y + layout.spring[j]));
            three_to(vec3_make(length, length, length), sizes + layout.spring[j]);
        }
        const double lever = body_radius(v, contact_source(j));
        for (int k = 3; k < TURNING_IMPULSES; k += 3) {
            double *size = sizes + ode_impulse(v, j) + k;
            const double impulse =
                fmax(vec3_norm(three_from(y + ode_impulse(v, j) + k)), lever * ode->momentum_scale);
            three_to(vec3_make(impulse, impulse, impulse), size);
        }
    }
}

#endif
