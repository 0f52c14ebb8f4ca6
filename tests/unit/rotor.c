/* The torque-free top by what it must conserve and where it stays. */
#include "math/rotor.h"

#include <float.h>

#include "check.h"
#include "random.h"

/* Roundings of a rotation that has been put together from three, whatever the number of turns. */
static const long double ALLOWED = 12.0L * DBL_EPSILON;

/* I_1 omega + (I_3 - I_1) (omega.e_3) e_3 */
static struct vec3 momentum_of(const struct rotor_state *at, double transverse, double axial)
{
    const struct vec3 axis = quaternion_third_axis(at->orientation);
    const double along = vec3_dot(at->angular_velocity, axis);
    return vec3_axpy(vec3_scale(transverse, at->angular_velocity), (axial - transverse) * along, axis);
}

static struct rotor_state random_start(struct random *r)
{
    const struct vec3 turn = random_vector(r, 3.0);
    return (struct rotor_state){quaternion_of_rotation(turn), random_vector(r, random_power(r, -6.0, 6.0))};
}

TEST(angular_momentum_and_unit_length_last)
{
    struct random r = {1};
    for (int i = 0; i < 2000; ++i) {
        const struct rotor_state start = random_start(&r);
        const double transverse = random_power(&r, -9.0, 9.0);
        const double axial = transverse * random_between(&r, 1e-3, 2.0);
        const struct rotor rotor = rotor_from(start, transverse, axial);
        const double size = vec3_norm(start.angular_velocity);
        const struct rotor_state end = rotor_at(&rotor, random_sign(&r) * random_power(&r, -9, 9) / size);
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
        const struct rotor_state start = random_start(&r);
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

TEST(one_turn_of_a_sphere_changes_the_sign)
{
    const struct rotor_state start = {quaternion_identity(), {0.0, 0.0, 2.0}};
    const struct rotor rotor = rotor_from(start, 0.4, 0.4);
    const double turn = 3.141592653589793;
    CHECK_CLOSE("once round", rotor_at(&rotor, turn).orientation.w, -1.0L, DBL_EPSILON);
    CHECK_CLOSE("twice round", rotor_at(&rotor, 2.0 * turn).orientation.w, 1.0L, DBL_EPSILON);
}

/* omega x e_3 by central differences of the axis. */
TEST(the_rate_of_the_axis_is_its_derivative)
{
    struct random r = {3};
    for (int i = 0; i < 500; ++i) {
        struct rotor_state start = random_start(&r);
        start.angular_velocity = random_vector(&r, 1.0);
        const struct rotor rotor = rotor_from(start, 1.0, random_between(&r, 0.01, 2.0));
        const double time = random_between(&r, -10.0, 10.0);
        const double step = 1e-5;
        const struct vec3 after = rotor_axis_at(&rotor, time + step).axis;
        const struct vec3 before = rotor_axis_at(&rotor, time - step).axis;
        const struct rotor_axis now = rotor_axis_at(&rotor, time);
        CHECK_VECTOR("rate", now.rate, vec3_scale(0.5 / step, vec3_sub(after, before)), 1e-9L);
        const struct rotor_state at = rotor_at(&rotor, time);
        CHECK_VECTOR("cross", now.rate, vec3_cross(at.angular_velocity, now.axis), ALLOWED);
        CHECK_CLOSE("speed", rotor_axis_speed(&rotor), vec3_norm(now.rate), ALLOWED);
    }
}

TEST(what_does_not_turn_stays)
{
    const struct rotor_state start = {quaternion_of_rotation(vec3_make(0.3, -1.0, 2.0)), {0.0, 0.0, 0.0}};
    const struct rotor rotor = rotor_from(start, 1.0, 0.5);
    const struct rotor_state end = rotor_at(&rotor, 1e300);
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
            const struct rotor_state start = {quaternion_identity(), {0.6 * size, 0.0, 0.8 * size}};
            const struct rotor rotor = rotor_from(start, pow(10.0, -j), 0.5 * pow(10.0, -j));
            const struct rotor_state end = rotor_at(&rotor, pow(10.0, j));
            CHECK_CLOSE("unit", quaternion_dot(end.orientation, end.orientation), 1.0L, 4.0L * DBL_EPSILON);
            CHECK_CLOSE("speed", vec3_norm(end.angular_velocity), size, 16.0L * DBL_EPSILON * size);
        }
    }
}
