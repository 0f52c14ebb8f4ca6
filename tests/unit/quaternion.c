/* Quaternions against rotation matrices by Rodrigues' formula in long double. */
#include "math/quaternion.h"

#include <float.h>

#include "check.h"
#include "long_vec3.h"
#include "random.h"

enum { CASES = 2000 };

static struct quaternion random_orientation(struct random *r)
{
    const struct vec3 v = random_vector(r, 1.0);
    return quaternion_unit(quaternion_make(random_between(r, -1.0, 1.0), v));
}

/* a turned about r by |r|: a + sin u x a + (1 - cos) u x (u x a). */
static struct long_vec3 rodrigues(struct vec3 r, struct vec3 a)
{
    const long double angle = sqrtl((long double)r.x * r.x + (long double)r.y * r.y + (long double)r.z * r.z);
    if (angle == 0.0L) {
        return (struct long_vec3){a.x, a.y, a.z};
    }
    const struct long_vec3 u = {r.x / angle, r.y / angle, r.z / angle};
    const struct long_vec3 once = {u.y * a.z - u.z * a.y, u.z * a.x - u.x * a.z, u.x * a.y - u.y * a.x};
    const struct long_vec3 twice = {u.y * once.z - u.z * once.y, u.z * once.x - u.x * once.z,
                                    u.x * once.y - u.y * once.x};
    const long double s = sinl(angle);
    const long double half = sinl(0.5L * angle);
    const long double versine = 2.0L * half * half;
    return (struct long_vec3){a.x + s * once.x + versine * twice.x, a.y + s * once.y + versine * twice.y,
                              a.z + s * once.z + versine * twice.z};
}

TEST(a_rotation_vector_turns_as_rodrigues_says)
{
    struct random r = {1};
    for (int i = 0; i < CASES; ++i) {
        const struct vec3 by = vec3_scale(random_power(&r, -20.0, 0.7), random_direction(&r));
        const struct vec3 a = random_vector(&r, 1.0);
        const struct quaternion q = quaternion_of_rotation(by);
        CHECK_CLOSE("length", quaternion_dot(q, q), 1.0L, 4.0L * DBL_EPSILON);
        CHECK_VECTOR("turned", quaternion_rotate(q, a), rodrigues(by, a), 16.0L * DBL_EPSILON);
        CHECK_VECTOR("and back", quaternion_rotate(quaternion_inverse(q), quaternion_rotate(q, a)),
                     long_of(a), 16.0L * DBL_EPSILON);
    }
    const struct quaternion none = quaternion_of_rotation(vec3_make(0.0, 0.0, 0.0));
    CHECK(none.w == 1.0 && none.x == 0.0 && none.y == 0.0 && none.z == 0.0);
}

TEST(any_length_but_zero_is_made_unit)
{
    struct random r = {4};
    for (int i = 0; i < CASES; ++i) {
        const struct quaternion q = random_orientation(&r);
        const struct quaternion unit = quaternion_unit(quaternion_scale(random_power(&r, -300.0, 300.0), q));
        CHECK_CLOSE("length", quaternion_dot(unit, unit), 1.0L, 4.0L * DBL_EPSILON);
        CHECK_CLOSE("direction", quaternion_dot(unit, q), 1.0L, 4.0L * DBL_EPSILON);
    }
    CHECK(quaternion_unit((struct quaternion){0.0, 0.0, 0.0, 0.0}).w == 1.0);
    CHECK(quaternion_unit((struct quaternion){(double)INFINITY, 0.0, 0.0, 0.0}).w == 1.0);
    CHECK(quaternion_unit((struct quaternion){(double)NAN, 0.0, 0.0, 0.0}).w == 1.0);
}

/* It takes a to b, about an axis across both, by no more than half a turn. */
static void check_smallest(struct vec3 a, struct vec3 b)
{
    const struct quaternion q = quaternion_between(a, b);
    CHECK_CLOSE("length", quaternion_dot(q, q), 1.0L, 4.0L * DBL_EPSILON);
    CHECK(q.w >= 0.0);
    CHECK_VECTOR("a becomes b", quaternion_rotate(q, a), long_of(b), 16.0L * DBL_EPSILON);
    CHECK_CLOSE("across a", vec3_dot(quaternion_vector(q), a), 0.0L, 8.0L * DBL_EPSILON);
}

TEST(the_smallest_rotation_takes_one_vector_to_the_other)
{
    struct random r = {5};
    for (int i = 0; i < CASES; ++i) {
        const struct vec3 a = random_direction(&r);
        check_smallest(a, random_direction(&r));
        /* nearly parallel and nearly antiparallel */
        const struct vec3 near = vec3_axpy(a, random_power(&r, -18.0, -1.0), random_direction(&r));
        const struct vec3 unit = vec3_scale(1.0 / vec3_norm(near), near);
        check_smallest(a, unit);
        check_smallest(a, vec3_scale(-1.0, unit));
    }
}

TEST(antiparallel_vectors_turn_about_x)
{
    const struct vec3 up = {0.0, 0.0, 1.0};
    const struct quaternion q = quaternion_between(up, vec3_make(0.0, 0.0, -1.0));
    CHECK(q.w == 0.0 && q.x == 1.0 && q.y == 0.0 && q.z == 0.0);
    const struct quaternion none = quaternion_between(up, up);
    CHECK(none.w == 1.0 && none.x == 0.0 && none.y == 0.0 && none.z == 0.0);
    check_smallest(vec3_make(1.0, 0.0, 0.0), vec3_make(-1.0, 0.0, 0.0));
}
