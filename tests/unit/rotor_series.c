/* Turning under a torque by series: against the torque-free closed form, against what is closed form under a
 * torque, and against Euler's equations by many small steps of Runge and Kutta's method. */
#include "math/rotor.h"

#include <float.h>

#include "check.h"
#include "random.h"

static const struct vec3 NO_TORQUE[ROTOR_TORQUES] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};

static void check_states(const struct rotor_state *got, const struct rotor_state *expected,
                         long double allowed, double speed)
{
    CHECK_CLOSE("same orientation", quaternion_dot(got->orientation, expected->orientation), 1.0L, allowed);
    CHECK_VECTOR("e_3", quaternion_third_axis(got->orientation), quaternion_third_axis(expected->orientation),
                 allowed);
    CHECK_VECTOR("e_1", quaternion_rotate(got->orientation, vec3_make(1.0, 0.0, 0.0)),
                 quaternion_rotate(expected->orientation, vec3_make(1.0, 0.0, 0.0)), allowed);
    CHECK_VECTOR("omega", got->angular_velocity, expected->angular_velocity, allowed * speed);
}

static struct rotor_state random_start(struct random *r)
{
    const struct vec3 turn = random_vector(r, 3.0);
    return (struct rotor_state){quaternion_of_rotation(turn), random_vector(r, 2.0)};
}

/* A hundred radians, each with a rounding or two. */
TEST(without_a_torque_it_is_the_closed_form)
{
    struct random r = {1};
    for (int i = 0; i < 200; ++i) {
        const struct rotor_state start = random_start(&r);
        const double axial = random_between(&r, 0.01, 2.0);
        const double time = random_power(&r, -6.0, 1.5);
        const struct rotor rotor = rotor_from(start, 1.0, axial);
        const struct rotor_state expected = rotor_at(&rotor, time);
        const struct rotor_state got = rotor_under_torque(&start, 1.0, axial, NO_TORQUE, time);
        check_states(&got, &expected, 2e-13L, 4.0);
        struct vec3 lambda[ROTOR_RATES];
        rotor_rates_under_torque(&start, 1.0, axial, NO_TORQUE, lambda);
        CHECK_VECTOR("axis alone", rotor_axis_after(lambda, rotor.axis, time),
                     rotor_axis_at(&rotor, time).axis, 2e-13L);
    }
}

/* About the axis itself: omega_3 is the integral of the torque over I_3, the angle that of omega_3. */
TEST(a_torque_about_the_axis_spins_it_up)
{
    const struct rotor_state start = {quaternion_of_rotation(vec3_make(0.3, -0.2, 0.7)), {0.0, 0.0, 0.0}};
    const struct vec3 axis = quaternion_third_axis(start.orientation);
    const struct vec3 torque[ROTOR_TORQUES] = {vec3_scale(0.4, axis), vec3_scale(-0.3, axis),
                                               vec3_scale(0.9, axis)};
    const double time = 3.0;
    const double inertia = 0.2;
    const struct rotor_state got = rotor_under_torque(&start, 1.0, inertia, torque, time);
    const double speed = (0.4 * time - 0.15 * time * time + 0.3 * time * time * time) / inertia;
    const double angle = (0.2 - 0.05 * time + 0.075 * time * time) * time * time / inertia;
    struct rotor_state expected = {start.orientation, vec3_scale(speed, axis)};
    expected.orientation =
        quaternion_product(quaternion_of_rotation(vec3_scale(angle, axis)), start.orientation);
    if (quaternion_dot(expected.orientation, got.orientation) < 0.0) {
        expected.orientation = quaternion_scale(-1.0, expected.orientation);
    }
    check_states(&got, &expected, 1e-13L, speed);
}

/* q and L, with omega from L: q' = (0, omega) q / 2, L' = tau. */
struct motion {
    struct quaternion q;
    struct vec3 momentum;
};

static struct vec3 torque_at(const struct vec3 torque[ROTOR_TORQUES], double time)
{
    return vec3_axpy(torque[0], time, vec3_axpy(torque[1], time, torque[2]));
}

static struct vec3 omega_of(struct motion m, double transverse, double axial)
{
    const struct vec3 e = quaternion_third_axis(m.q);
    const double along = vec3_dot(m.momentum, e);
    return vec3_axpy(vec3_scale(1.0 / transverse, m.momentum), along * (1.0 / axial - 1.0 / transverse), e);
}

static struct motion moved(struct motion m, double step, struct quaternion q_rate, struct vec3 torque)
{
    return (struct motion){quaternion_axpy(m.q, step, q_rate), vec3_axpy(m.momentum, step, torque)};
}

static struct motion runge_kutta(struct motion m, double transverse, double axial,
                                 const struct vec3 torque[ROTOR_TORQUES], double time, double step)
{
    const double half = 0.5 * step;
    const struct vec3 t1 = torque_at(torque, time);
    const struct vec3 t2 = torque_at(torque, time + half);
    const struct vec3 t4 = torque_at(torque, time + step);
    const struct quaternion k1 = quaternion_rate(m.q, omega_of(m, transverse, axial));
    const struct motion m2 = moved(m, half, k1, t1);
    const struct quaternion k2 = quaternion_rate(m2.q, omega_of(m2, transverse, axial));
    const struct motion m3 = moved(m, half, k2, t2);
    const struct quaternion k3 = quaternion_rate(m3.q, omega_of(m3, transverse, axial));
    const struct motion m4 = moved(m, step, k3, t2);
    const struct quaternion k4 = quaternion_rate(m4.q, omega_of(m4, transverse, axial));
    const struct quaternion sum =
        quaternion_axpy(quaternion_axpy(quaternion_axpy(k1, 2.0, k2), 2.0, k3), 1.0, k4);
    const struct vec3 torques = vec3_add(vec3_axpy(t1, 4.0, t2), t4);
    return (struct motion){quaternion_unit(quaternion_axpy(m.q, step / 6.0, sum)),
                           vec3_axpy(m.momentum, step / 6.0, torques)};
}

TEST(under_any_torque_it_obeys_eulers_equations)
{
    struct random r = {3};
    for (int i = 0; i < 20; ++i) {
        const struct rotor_state start = random_start(&r);
        const double axial = random_between(&r, 0.1, 2.0);
        const struct vec3 torque[ROTOR_TORQUES] = {random_vector(&r, 2.0), random_vector(&r, 1.0),
                                                   random_vector(&r, 0.5)};
        const struct vec3 e = quaternion_third_axis(start.orientation);
        const double along = vec3_dot(start.angular_velocity, e);
        struct motion m = {start.orientation, vec3_axpy(start.angular_velocity, (axial - 1.0) * along, e)};
        const int steps = 4000;
        const double step = 2.0 / steps;
        for (int j = 0; j < steps; ++j) {
            m = runge_kutta(m, 1.0, axial, torque, j * step, step);
        }
        const struct rotor_state expected = {m.q, omega_of(m, 1.0, axial)};
        const struct rotor_state got = rotor_under_torque(&start, 1.0, axial, torque, 2.0);
        check_states(&got, &expected, 1e-9L, 1.0); /* what the fourth order leaves */
    }
}

/* In one go or in parts. */
TEST(the_result_does_not_depend_on_how_it_is_cut)
{
    struct random r = {4};
    for (int i = 0; i < 50; ++i) {
        const struct rotor_state start = random_start(&r);
        const struct vec3 torque[ROTOR_TORQUES] = {random_vector(&r, 1.0), random_vector(&r, 2.0),
                                                   random_vector(&r, random_power(&r, 0.0, 1.5))};
        const struct rotor_state whole = rotor_under_torque(&start, 1.0, 0.3, torque, 2.0);
        struct rotor_state now = start;
        struct vec3 rest[ROTOR_TORQUES] = {torque[0], torque[1], torque[2]};
        for (int j = 0; j < 128; ++j) {
            now = rotor_under_torque(&now, 1.0, 0.3, rest, 1.0 / 64.0);
            rotor_rates_shift(rest, ROTOR_TORQUES, 1.0 / 64.0);
        }
        const double speed = 1.0 + vec3_norm(whole.angular_velocity);
        check_states(&now, &whole, (200.0L + 10.0L * speed) * DBL_EPSILON, speed); /* of so many radians */
    }
}
