/* The torque-free top by what it must conserve and where it stays; turning under a torque by series, against
 * the torque-free closed form and against what is closed form under a torque. */
#include "math/rotor.h"

#include <float.h>

#include "check.h"
#include "flight/conservative_advancement.h"
#include "random.h"

/* Roundings of a rotation that has been put together from three, whatever the number of turns. */
static const long double ALLOWED = 12.0L * DBL_EPSILON;

/* I_1 omega + (I_3 - I_1) (omega.e_3) e_3 */
static struct vec3 momentum_of(const struct body_turn *at, double transverse, double axial)
{
    const struct vec3 axis = quaternion_third_axis(at->orientation);
    const double along = vec3_dot(at->angular_velocity, axis);
    return vec3_axpy(vec3_scale(transverse, at->angular_velocity), (axial - transverse) * along, axis);
}

static struct body_turn random_start(struct random *r)
{
    const struct vec3 turn = random_vector(r, 3.0);
    return (struct body_turn){quaternion_of_rotation(turn), random_vector(r, random_power(r, -6.0, 6.0))};
}

TEST(angular_momentum_and_unit_length_last)
{
    struct random r = {1};
    for (int i = 0; i < 2000; ++i) {
        const struct body_turn start = random_start(&r);
        const double transverse = random_power(&r, -9.0, 9.0);
        const double axial = transverse * random_between(&r, 1e-3, 2.0);
        const struct rotor rotor = rotor_from(start, transverse, axial);
        const double size = vec3_norm(start.angular_velocity);
        const struct body_turn end = rotor_at(&rotor, random_sign(&r) * random_power(&r, -9, 9) / size);
        const struct vec3 momentum = momentum_of(&start, transverse, axial);
        CHECK_VECTOR("momentum", momentum_of(&end, transverse, axial), momentum,
                     32.0L * DBL_EPSILON * transverse * size);
        CHECK_CLOSE("unit", quaternion_dot(end.orientation, end.orientation), 1.0L, 4.0L * DBL_EPSILON);
        CHECK_CLOSE("speed", vec3_norm(end.angular_velocity), size, 16.0L * DBL_EPSILON * size);
    }
}

TEST(the_orientation_is_continuous_in_sign)
{
    struct random r = {2};
    for (int i = 0; i < 50; ++i) {
        const struct body_turn start = random_start(&r);
        const struct rotor rotor = rotor_from(start, 1.0, random_between(&r, 0.01, 2.0));
        struct quaternion before = start.orientation;
        for (int j = 0; j < 1000; ++j) {
            const double time = 0.2 * j / vec3_norm(start.angular_velocity);
            const struct quaternion now = rotor_at(&rotor, time).orientation;
            CHECK(quaternion_dot(now, before) > 0.9);
            before = now;
        }
    }
}

/* omega x e_3 by central differences of the axis. */
TEST(the_rate_of_the_axis_is_its_derivative)
{
    struct random r = {3};
    for (int i = 0; i < 500; ++i) {
        struct body_turn start = random_start(&r);
        start.angular_velocity = random_vector(&r, 1.0);
        const struct rotor rotor = rotor_from(start, 1.0, random_between(&r, 0.01, 2.0));
        const double time = random_between(&r, -10.0, 10.0);
        const double step = 1e-5;
        const struct vec3 after = rotor_axis_at(&rotor, time + step).axis;
        const struct vec3 before = rotor_axis_at(&rotor, time - step).axis;
        const struct rotor_axis now = rotor_axis_at(&rotor, time);
        CHECK_VECTOR("rate", now.rate, vec3_scale(0.5 / step, vec3_sub(after, before)), 1e-9L);
        const struct body_turn at = rotor_at(&rotor, time);
        CHECK_VECTOR("cross", now.rate, vec3_cross(at.angular_velocity, now.axis), ALLOWED);
        CHECK_CLOSE("speed", rotor_axis_speed(&rotor), vec3_norm(now.rate), ALLOWED);
    }
}

TEST(what_does_not_turn_stays)
{
    const struct body_turn start = {quaternion_of_rotation(vec3_make(0.3, -1.0, 2.0)), {0.0, 0.0, 0.0}};
    const struct rotor rotor = rotor_from(start, 1.0, 0.5);
    const struct body_turn end = rotor_at(&rotor, 1e300);
    CHECK_CLOSE("same", quaternion_dot(end.orientation, start.orientation), 1.0L, 4.0L * DBL_EPSILON);
    CHECK(vec3_is_zero(end.angular_velocity) && rotor_precession(&rotor) == 0.0);
    CHECK(vec3_is_zero(rotor_axis_at(&rotor, 1.0).rate));
}

/* Sizes at the ends of the range of numbers leave unit orientations and speeds. */
TEST(extreme_sizes_stay_numbers)
{
    for (int i = -300; i <= 300; i += 50) {
        for (int j = -300; j <= 300; j += 50) {
            const double size = pow(10.0, i);
            const struct body_turn start = {quaternion_identity(), {0.6 * size, 0.0, 0.8 * size}};
            const struct rotor rotor = rotor_from(start, pow(10.0, -j), 0.5 * pow(10.0, -j));
            const struct body_turn end = rotor_at(&rotor, pow(10.0, j));
            CHECK_CLOSE("unit", quaternion_dot(end.orientation, end.orientation), 1.0L, 4.0L * DBL_EPSILON);
            CHECK_CLOSE("speed", vec3_norm(end.angular_velocity), size, 16.0L * DBL_EPSILON * size);
        }
    }
}

static const struct vec3 NO_TORQUE[ROTOR_TORQUES] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};

static void check_states(const struct body_turn *got, const struct body_turn *expected, long double allowed,
                         double speed)
{
    CHECK_CLOSE("same orientation", quaternion_dot(got->orientation, expected->orientation), 1.0L, allowed);
    CHECK_VECTOR("e_3", quaternion_third_axis(got->orientation), quaternion_third_axis(expected->orientation),
                 allowed);
    CHECK_VECTOR("e_1", quaternion_rotate(got->orientation, vec3_make(1.0, 0.0, 0.0)),
                 quaternion_rotate(expected->orientation, vec3_make(1.0, 0.0, 0.0)), allowed);
    CHECK_VECTOR("omega", got->angular_velocity, expected->angular_velocity, allowed * speed);
}

static struct body_turn slow_start(struct random *r)
{
    return (struct body_turn){quaternion_of_rotation(random_vector(r, 3.0)), random_vector(r, 2.0)};
}

/* A hundred radians, each with a rounding or two of the momentum, which the axial inertia divides. */
TEST(without_a_torque_it_is_the_closed_form)
{
    struct random r = {1};
    for (int i = 0; i < 200; ++i) {
        const struct body_turn start = slow_start(&r);
        const double axial = random_between(&r, 0.01, 2.0);
        const double time = random_power(&r, -6.0, 1.5);
        const struct rotor rotor = rotor_from(start, 1.0, axial);
        const struct body_turn expected = rotor_at(&rotor, time);
        const struct body_turn got =
            rotor_of_three_after(&start, vec3_make(1.0, 1.0, axial), NO_TORQUE, time);
        check_states(&got, &expected, 1e-12L, 4.0);
        const double along = vec3_dot(start.angular_velocity, rotor.axis);
        const struct vec3 lambda[ROTOR_TORQUES] = {
            vec3_axpy(start.angular_velocity, (axial - 1.0) * along, rotor.axis)}; /* L / I_1 */
        const struct quaternion turned = rotor_turned_after(lambda, quaternion_identity(), time);
        CHECK_VECTOR("axis alone", quaternion_rotate(turned, rotor.axis), rotor_axis_at(&rotor, time).axis,
                     2e-13L);
    }
}

/* About the axis itself: omega_3 is the integral of the torque over I_3, the angle that of omega_3. */
TEST(a_torque_about_the_axis_spins_it_up)
{
    const struct body_turn start = {quaternion_of_rotation(vec3_make(0.3, -0.2, 0.7)), {0.0, 0.0, 0.0}};
    const struct vec3 axis = quaternion_third_axis(start.orientation);
    const struct vec3 torque[ROTOR_TORQUES] = {vec3_scale(0.4, axis), vec3_scale(-0.3, axis),
                                               vec3_scale(0.9, axis)};
    const double time = 3.0;
    const double inertia = 0.2;
    const struct body_turn got = rotor_of_three_after(&start, vec3_make(1.0, 1.0, inertia), torque, time);
    const double speed = (0.4 * time - 0.15 * time * time + 0.3 * time * time * time) / inertia;
    const double angle = (0.2 - 0.05 * time + 0.075 * time * time) * time * time / inertia;
    struct body_turn expected = {start.orientation, vec3_scale(speed, axis)};
    expected.orientation =
        quaternion_product(quaternion_of_rotation(vec3_scale(angle, axis)), start.orientation);
    if (quaternion_dot(expected.orientation, got.orientation) < 0.0) {
        expected.orientation = quaternion_scale(-1.0, expected.orientation);
    }
    check_states(&got, &expected, 1e-13L, speed);
}

/* In one go or in parts. */
TEST(the_result_does_not_depend_on_how_it_is_cut)
{
    struct random r = {4};
    for (int i = 0; i < 50; ++i) {
        const struct body_turn start = slow_start(&r);
        const struct vec3 torque[ROTOR_TORQUES] = {random_vector(&r, 1.0), random_vector(&r, 2.0),
                                                   random_vector(&r, random_power(&r, 0.0, 1.5))};
        const struct body_turn whole = rotor_of_three_after(&start, vec3_make(1.0, 1.0, 0.3), torque, 2.0);
        struct body_turn now = start;
        struct vec3 rest[ROTOR_TORQUES] = {torque[0], torque[1], torque[2]};
        for (int j = 0; j < 128; ++j) {
            now = rotor_of_three_after(&now, vec3_make(1.0, 1.0, 0.3), rest, 1.0 / 64.0);
            path_shift(rest, ROTOR_TORQUES, 1.0 / 64.0);
        }
        const double speed = 1.0 + vec3_norm(whole.angular_velocity);
        check_states(&now, &whole, (400.0L + 20.0L * speed) * DBL_EPSILON, speed); /* of so many radians */
    }
}

/* A body on which no torque acts keeps its angular momentum and its energy. Each step of the series computes
 * the rotation from the given momentum, which therefore has no error; an error of the rotation shows in
 * the energy. */
TEST(three_moments_keep_momentum_and_energy)
{
    struct random r = {6};
    for (int i = 0; i < 200; ++i) {
        const struct body_turn start = slow_start(&r);
        const struct vec3 inertia = {1.0, random_between(&r, 0.6, 1.0), random_between(&r, 0.45, 0.6)};
        const struct body_turn end = rotor_of_three_after(&start, inertia, NO_TORQUE, 20.0);
        struct vec3 momentum[2];
        double energy[2];
        for (int k = 0; k < 2; ++k) {
            const struct body_turn *at = k == 0 ? &start : &end;
            const struct vec3 w =
                quaternion_rotate(quaternion_inverse(at->orientation), at->angular_velocity);
            const struct vec3 l = {inertia.x * w.x, inertia.y * w.y, inertia.z * w.z};
            momentum[k] = quaternion_rotate(at->orientation, l);
            energy[k] = vec3_dot(l, w);
        }
        CHECK_VECTOR("momentum", momentum[1], momentum[0], 32.0L * DBL_EPSILON * vec3_norm(momentum[0]));
        CHECK_CLOSE("energy", energy[1], energy[0], 2000.0L * DBL_EPSILON * energy[0]);
    }
}

/* A sphere at the end of a slender pin, which tumbles, spins and drifts to a plane. A bound by |L| over the
 * least moment of inertia takes the search a million evaluations. */
TEST(the_touch_of_a_slender_pin_takes_few_evaluations)
{
    struct random r = {7};
    long evaluations = 0;
    for (int i = 0; i < 20; ++i) {
        const struct body_turn pin = {quaternion_of_rotation(random_vector(&r, 3.0)), random_vector(&r, 5.0)};
        struct advancement_path path = {.c = {{0.0, 0.0, -0.2}, {0.0, 0.0, 0.05}}, .degree = 1};
        path.shape = (struct contact_shape){.axis = {0.0, 0.0, 1.0},
                                            .source_radius = 0.01,
                                            .half_length = (double)INFINITY,
                                            .side = 1,
                                            .destination = SHAPE_PLANE};
        path.axis = (struct axis_motion){.kind = AXIS_FIXED, .axis = path.shape.axis};
        path.lever[0] =
            axis_motion_tumbling(vec3_make(0.0, 0.0, 1.0), &pin, vec3_make(1.0, 1.0, 0.003), NO_TORQUE);
        path.lever_length[0] = 0.1;
        const struct advancement_result touch = advancement_first(&path, 10.0, 1000000);
        struct advancement_instant at;
        evaluations += touch.evaluations;
        for (int j = 0; j <= 1000; ++j) {
            advancement_at(&path, 1e-3 * j * touch.after, &at);
            CHECK(at.geometry.gap > -1e-14);
        }
        CHECK_CLOSE("gap", at.geometry.gap, 0.0L, 1e-14L);
    }
    CHECK(evaluations < 600);
}
