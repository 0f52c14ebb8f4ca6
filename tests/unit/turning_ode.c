/* The scene's differential equations where bodies turn and rub: layout, Jacobian, balances of energy and
 * momentum. */
#include "scene/ode.h"

#include "check.h"
#include "random.h"
#include "scene/present.h"
#include "scene_model.h"

/* A sphere in, on or off a cylinder that both turn, overlapping by 1 cm; of all motions and rotations. */
static struct model rubbing(struct random *r, int i)
{
    static const enum rotation ROTATIONS[] = {ROTATION_FREE, ROTATION_FREE, ROTATION_PRESCRIBED,
                                              ROTATION_NONE};
    struct model m = scene_model();
    struct scene_values *v = &m.state.values;
    v->body[SOURCE].radius = 0.1;
    v->body[DESTINATION].radius = 0.5;
    v->body[DESTINATION].finite_length = true;
    v->body[DESTINATION].length = 4.0;
    v->contact[0].method = METHOD_PENALTY_DYNAMIC;
    v->contact[0].penalty_factor = 1e3;
    v->contact[0].viscous_penalty_factor = 1.0;
    v->contact[0].dashpot = DASHPOT_UNCLAMPED;
    v->contact[0].friction = i % 2 == 0 ? FRICTION_ELASTIC : FRICTION_REGULARIZED;
    v->contact[0].friction_coefficient = 0.3;
    v->contact[0].static_friction_coefficient = 0.4;
    v->contact[0].tangential_stiffness = 300.0;
    v->contact[0].tangential_damping = i % 4 == 0 ? 0.0 : 2.0;
    v->contact[0].slip_velocity_control = SLIP_VELOCITY_CONTROL_USER_DEFINED;
    v->contact[0].characteristic_slip_velocity = 0.5;
    const double distance = random_index(r, 2) == 0 ? 0.41 : 0.59;
    const struct vec3 across = random_vector(r, 1.0);
    const struct vec3 axis = random_vector(r, 1.0);
    const struct vec3 normal = vec3_cross(axis, across);
    scene_put_vector(v->body[DESTINATION].axis, axis);
    scene_put_vector(v->body[DESTINATION].prescribed_axis, axis);
    v->contact[0].location = distance < 0.5 ? LOCATION_INSIDE : LOCATION_OUTSIDE;
    const struct vec3 place = vec3_axpy(vec3_scale(distance / vec3_norm(normal), normal),
                                        random_between(r, -1.0, 1.0) / vec3_norm(axis), axis);
    scene_start_free(&m, SOURCE, place, random_vector(r, 1.0));
    scene_start_free(&m, DESTINATION, vec3_make(0.0, 0.0, 0.0), random_vector(r, 1.0));
    if (i % 3 == 0) {
        v->body[DESTINATION].motion = MOTION_PRESCRIBED;
        scene_put_vector(v->body[DESTINATION].prescribed_velocity, random_vector(r, 1.0));
    }
    for (int body = 0; body < 2; ++body) {
        v->body[body].rotation = ROTATIONS[random_index(r, 4)];
        scene_put_vector(v->body[body].initial_angular_velocity, random_vector(r, 3.0));
        scene_put_vector(v->body[body].prescribed_angular_velocity, random_vector(r, 3.0));
        scene_put_vector(v->body[body].external_torque, random_vector(r, 1.0));
        scene_put_vector(v->body[body].external_force, random_vector(r, 1.0));
    }
    model_prepare(&m);
    return m;
}

/* In the regime asked for, the spring stretched. */
static struct scene_ode begin(struct model *m, struct random *r, int i)
{
    struct scene_state *q = &m->state.motion;
    const bool elastic = m->state.values.contact[0].friction == FRICTION_ELASTIC;
    q->contact[0].friction_regime = (int32_t)(elastic && i % 8 < 4 ? FRICTION_STICKING : FRICTION_SLIDING);
    q->turning.spring[0] = elastic ? random_vector(r, 0.05) : vec3_make(0.0, 0.0, 0.0);
    struct scene_ode ode = {.values = &m->state.values, .state = q};
    struct scene_instant at;
    scene_now(ode.values, ode.state, &at);
    const struct vec3 n = at.geometry[0].normal;
    q->turning.spring[0] = vec3_axpy(q->turning.spring[0], -vec3_dot(n, q->turning.spring[0]), n);
    scene_now(ode.values, ode.state, &at);
    ode_begin(&ode, &at, 1e-9, 1e-12);
    return ode;
}

static void rates_beside(const struct scene_ode *ode, const double *y, int column, double step, double *rates)
{
    double moved[ODE_MOST_STATES];
    memcpy(moved, y, sizeof moved);
    moved[column] += step;
    ode_rates(ode, 0.0, moved, rates);
}

static void the_jacobian_is_the_slope_of_the_rates(void)
{
    struct random r = {61};
    const double h = 2e-5;
    static double columns[ODE_MOST_STATES * ODE_MOST_STATES], coupled[ODE_MOST_STATES * ODE_MOST_STATES];
    for (int i = 0; i < 240; ++i) {
        struct model m = rubbing(&r, i);
        const struct scene_ode ode = begin(&m, &r, i);
        const int size = ode_size(ode.values);
        const int leading = ode_coupled(ode.values);
        double y[ODE_MOST_STATES] = {0.0}, rates[4][ODE_MOST_STATES];
        CHECK(size <= ODE_MOST_STATES && m.state.motion.contact[0].regime == REGIME_COMPRESSION);
        ode_pack(&ode, y);
        ode_jacobian(&ode, 0.0, y, columns);
        ode_coupled_jacobian(&ode, 0.0, y, coupled);
        for (int j = 0; j < size; ++j) {
            for (int k = 0; k < 4; ++k) {
                rates_beside(&ode, y, j, (k < 2 ? k - 2 : k - 1) * h, rates[k]);
            }
            for (int k = 0; k < size; ++k) {
                const double slope =
                    (8.0 * (rates[2][k] - rates[1][k]) - (rates[3][k] - rates[0][k])) / (12.0 * h);
                CHECK_CLOSE("slope", columns[j * size + k], slope, 1e-6 * (10.0 + fabs(slope)));
                const bool none = j >= ode_integrals(ode.values) || (k < leading && j >= leading);
                CHECK(!none || columns[j * size + k] == 0.0);
                CHECK(j >= leading || k >= leading || coupled[j * leading + k] == columns[j * size + k]);
            }
        }
    }
}

static void unpacking_gives_back_what_was_packed(void)
{
    struct random r = {62};
    for (int i = 0; i < 100; ++i) {
        struct model m = rubbing(&r, i);
        const struct scene_ode ode = begin(&m, &r, i);
        const struct scene_state before = m.state.motion;
        double y[ODE_MOST_STATES];
        ode_pack(&ode, y);
        ode_unpack(ode.values, &m.state.motion, y);
        for (int body = 0; body < 2; ++body) {
            const struct vec3 was = before.turning.body[body].angular_velocity;
            const struct vec3 is = m.state.motion.turning.body[body].angular_velocity;
            CHECK_CLOSE("omega", vec3_norm(vec3_sub(is, was)), 0.0, 1e-14 * (1.0 + vec3_norm(was)));
        }
        CHECK_CLOSE("xi", vec3_norm(vec3_sub(m.state.motion.turning.spring[0], before.turning.spring[0])),
                    0.0, 0.0);
    }
}

/* kinetic + rotational + potential + stored + dissipated + work of friction - external work */
static double total_energy(const struct scene_ode *ode, const double *y, double clock)
{
    struct scene_state q = *ode->state;
    struct scene_instant at;
    ode_unpack(ode->values, &q, y);
    ode_instant(ode, clock, y, &at);
    return energy_kinetic_of(ode->values, &at) + energy_rotational_of(ode->values, &at) +
           energy_potential_of(ode->values, &at) + energy_stored(ode->values, &q, &at) + q.dissipated +
           q.friction_energy - q.external_work;
}

/* Its change along the rates is zero, by a difference of order four. */
static void energy_is_balanced(void)
{
    struct random r = {63};
    const double h = 1e-4;
    for (int i = 0; i < 240; ++i) {
        struct model m = rubbing(&r, i);
        const struct scene_ode ode = begin(&m, &r, i);
        double y[ODE_MOST_STATES], rates[ODE_MOST_STATES], energy[4];
        ode_pack(&ode, y);
        ode_rates(&ode, 0.0, y, rates);
        for (int k = 0; k < 4; ++k) {
            double moved[ODE_MOST_STATES];
            const double step = (k < 2 ? k - 2 : k - 1) * h;
            for (int j = 0; j < ode_size(ode.values); ++j) {
                moved[j] = y[j] + step * rates[j];
            }
            energy[k] = total_energy(&ode, moved, step);
        }
        const double power = (8.0 * (energy[2] - energy[1]) - (energy[3] - energy[0])) / (12.0 * h);
        CHECK_CLOSE("power", power, 0.0, 1e-8);
    }
}

/* Of two free bodies that turn freely, without external forces. */
static void angular_momentum_is_kept(void)
{
    struct random r = {64};
    for (int i = 0; i < 240; ++i) {
        struct model m = rubbing(&r, i);
        struct scene_values *v = &m.state.values;
        for (int body = 0; body < 2; ++body) {
            v->body[body].motion = MOTION_FREE;
            v->body[body].rotation = ROTATION_FREE;
            scene_put(v->body[body].external_force, 0.0, 0.0, 0.0);
            scene_put(v->body[body].external_torque, 0.0, 0.0, 0.0);
        }
        model_prepare(&m);
        const struct scene_ode ode = begin(&m, &r, i);
        struct scene_instant at;
        scene_now(v, ode.state, &at);
        const struct vec3 orbital = vec3_cross(at.separation[0], vec3_scale(-1.0, at.source_force[0]));
        const struct vec3 torque = vec3_add(at.turning.source_torque[0], at.turning.destination_torque[0]);
        CHECK_CLOSE("torque", vec3_norm(vec3_add(orbital, torque)), 0.0,
                    1e-14 * vec3_norm(at.source_force[0]));
    }
}

int main(void)
{
    CHECK_TEST(the_jacobian_is_the_slope_of_the_rates);
    CHECK_TEST(unpacking_gives_back_what_was_packed);
    CHECK_TEST(energy_is_balanced);
    CHECK_TEST(angular_momentum_is_kept);
    return check_summary("turning_ode");
}
