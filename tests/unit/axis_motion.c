/* Axes that turn: their rates against differences, and that their bounds hold wherever they are looked at. */
#include "flight/tumbling.h"

#include "check.h"
#include "random.h"

enum { CASES = 300, KINDS = 4, LOOKS = 20 };

/* Steady, of a top, driven, and along a polynomial. */
static struct axis_motion random_motion(struct random *r, int kind)
{
    struct vec3 coefficient[AXIS_TERMS];
    for (int i = 0; i < AXIS_TERMS; ++i) {
        coefficient[i] = random_vector(r, 1.0);
    }
    if (kind == 0) {
        return axis_motion_driven(random_direction(r), coefficient, 1);
    }
    if (kind == 1) {
        const struct rotor_state start = {quaternion_of_rotation(random_vector(r, 3.0)),
                                          random_vector(r, 3.0)};
        const struct rotor rotor = rotor_from(start, 1.0, random_between(r, 0.01, 2.0));
        return axis_motion_of_rotor(&rotor);
    }
    if (kind == 2) {
        return axis_motion_driven(random_direction(r), coefficient, AXIS_TERMS);
    }
    coefficient[0] = vec3_scale(random_between(r, 0.5, 5.0), random_direction(r));
    return axis_motion_following(coefficient, 3);
}

static struct vec3 cross_of_second(const struct axis_motion *motion, double time, double step)
{
    const struct vec3 before = axis_motion_at(motion, time - step).rate;
    const struct vec3 after = axis_motion_at(motion, time + step).rate;
    const struct vec3 second = vec3_scale(0.5 / step, vec3_sub(after, before));
    return vec3_cross(axis_motion_at(motion, time).axis, second);
}

static void check_look(const struct axis_motion *motion, const struct axis_bounds *bounds, double time)
{
    const double step = 1e-5;
    const struct rotor_axis now = axis_motion_at(motion, time);
    CHECK_CLOSE("unit", vec3_norm(now.axis), 1.0L, 1e-15L);
    CHECK_CLOSE("across", vec3_dot(now.rate, now.axis), 0.0L, 1e-14L * (1.0L + bounds->speed));
    const struct vec3 before = axis_motion_at(motion, time - step).axis;
    const struct vec3 after = axis_motion_at(motion, time + step).axis;
    const struct vec3 rate = vec3_scale(0.5 / step, vec3_sub(after, before));
    const long double left_out = 1e-9L * (1.0L + bounds->speed) * (1.0L + bounds->speed + bounds->turn);
    CHECK_CLOSE("rate", vec3_norm(vec3_sub(rate, now.rate)), 0.0L, left_out);
    CHECK(vec3_norm(now.rate) <= bounds->speed * (1.0 + 1e-14));
    CHECK((long double)vec3_norm(cross_of_second(motion, time, step)) <= bounds->turn + left_out);
}

static void bounds_hold_and_rates_are_derivatives(void)
{
    struct random r = {1};
    int bounded = 0;
    for (int i = 0; i < CASES; ++i) {
        const struct axis_motion motion = random_motion(&r, i % KINDS);
        const double start = random_between(&r, 0.1, 1.0);
        const double length = random_power(&r, -4.0, 0.0);
        const struct axis_bounds bounds = axis_motion_bounds(&motion, start, length);
        if (!(bounds.speed < 100.0)) {
            continue; /* the direction comes near zero: differences say little */
        }
        ++bounded;
        for (int j = 0; j < LOOKS; ++j) {
            check_look(&motion, &bounds, start + random_between(&r, 0.0, length));
        }
    }
    CHECK(bounded > CASES / 2);
}

static void an_axis_that_moved_on_is_the_same(void)
{
    struct random r = {2};
    for (int i = 0; i < CASES; ++i) {
        const struct axis_motion motion = random_motion(&r, i % KINDS);
        struct axis_motion later = motion;
        axis_motion_move_on(&later, 0.4);
        axis_motion_move_on(&later, 1.1);
        const struct rotor_axis expected = axis_motion_at(&motion, 2.0);
        const struct rotor_axis got = axis_motion_at(&later, 2.0);
        const long double allowed = 1e-14L * (1.0L + vec3_norm(expected.rate));
        CHECK_CLOSE("axis", vec3_norm(vec3_sub(got.axis, expected.axis)), 0.0L, allowed);
        CHECK_CLOSE("rate", vec3_norm(vec3_sub(got.rate, expected.rate)), 0.0L, 20.0L * allowed);
    }
}

static void a_direction_that_vanishes_has_no_bound(void)
{
    const struct vec3 direction[2] = {{1.0, 0.0, 0.0}, {-2.0, 0.0, 0.1}};
    const struct axis_motion motion = axis_motion_following(direction, 2);
    CHECK(isinf(axis_motion_bounds(&motion, 0.0, 1.0).speed));
    CHECK(axis_motion_bounds(&motion, 0.0, 0.1).speed < 3.0);
}

int main(void)
{
    CHECK_TEST(bounds_hold_and_rates_are_derivatives);
    CHECK_TEST(an_axis_that_moved_on_is_the_same);
    CHECK_TEST(a_direction_that_vanishes_has_no_bound);
    return check_summary("axis_motion");
}
