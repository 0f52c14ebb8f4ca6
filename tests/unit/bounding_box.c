/* Bounding boxes against points of the surfaces: none lies outside, and each face of a box is touched. */
#include "contact/shape.h"

#include <float.h>

#include "check.h"
#include "random.h"

enum { BODIES = 2000, POINTS = 200 };

struct cylinder {
    struct vec3 centre, axis;
    double radius, half_length, size; /* size: of all lengths together, for roundings */
};

/* How far the point is outside the box in direction i; negative inside. */
static double outside(const struct bounding_box *box, struct vec3 point, int i)
{
    return fmax(vec3_get(box->low, i) - vec3_get(point, i), vec3_get(point, i) - vec3_get(box->high, i));
}

static void check_contains(const struct bounding_box *box, struct vec3 point, double noise)
{
    for (int i = 0; i < 3; ++i) {
        CHECK(outside(box, point, i) <= noise);
    }
}

static struct vec3 unit(int i)
{
    return vec3_make(i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0);
}

/* The unit vector along a without its part along e; zero where nothing is left. */
static struct vec3 direction_across(struct vec3 a, struct vec3 e)
{
    struct vec3 across = vec3_axpy(a, -vec3_dot(a, e), e);
    across = vec3_axpy(across, -vec3_dot(across, e), e); /* once more for what rounding left */
    const double length = vec3_norm(across);
    return length > 1e-12 ? vec3_scale(1.0 / length, across) : vec3_make(0.0, 0.0, 0.0);
}

static struct cylinder random_cylinder(struct random *r)
{
    const double scale = random_power(r, -140.0, 140.0);
    struct cylinder body = {.centre = random_vector(r, scale * random_power(r, -2.0, 2.0)),
                            .axis = random_direction(r),
                            .radius = scale * random_between(r, 0.01, 1.0),
                            .half_length =
                                random_index(r, 4) == 0 ? 0.0 : scale * random_power(r, -2.0, 1.0)};
    body.size = vec3_norm(body.centre) + body.radius + body.half_length;
    return body;
}

static void a_spheres_box_holds_its_surface_and_is_touched_on_every_face(void)
{
    struct random r = {31};
    for (int body = 0; body < BODIES; ++body) {
        const double scale = random_power(&r, -140.0, 140.0);
        const double radius = scale * random_between(&r, 0.01, 1.0);
        const struct vec3 centre = random_vector(&r, 10.0 * scale);
        const struct bounding_box box = bounding_box_sphere(centre, radius);
        const double noise = 4.0 * DBL_EPSILON * (vec3_norm(centre) + radius);
        for (int point = 0; point < POINTS; ++point) {
            check_contains(&box, vec3_axpy(centre, radius, random_direction(&r)), noise);
        }
        for (int i = 0; i < 3; ++i) {
            CHECK_CLOSE("upper face", outside(&box, vec3_axpy(centre, radius, unit(i)), i), 0.0, noise);
            CHECK_CLOSE("lower face", outside(&box, vec3_axpy(centre, -radius, unit(i)), i), 0.0, noise);
        }
    }
}

static void a_cylinders_box_holds_its_surface(void)
{
    struct random r = {32};
    for (int n = 0; n < BODIES; ++n) {
        const struct cylinder body = random_cylinder(&r);
        const struct bounding_box box =
            bounding_box_cylinder(body.centre, body.radius, body.axis, body.half_length);
        for (int point = 0; point < POINTS; ++point) {
            const double along = random_between(&r, -body.half_length, body.half_length);
            const struct vec3 across = direction_across(random_direction(&r), body.axis);
            const struct vec3 middle = vec3_axpy(body.centre, along, body.axis);
            check_contains(&box, vec3_axpy(middle, body.radius, across), 16.0 * DBL_EPSILON * body.size);
        }
    }
}

/* The rim's highest point in direction i: up the axis, then across it as far up as a perpendicular goes. */
static void a_cylinders_box_is_touched_on_every_face(void)
{
    struct random r = {33};
    for (int n = 0; n < BODIES; ++n) {
        const struct cylinder body = random_cylinder(&r);
        const struct bounding_box box =
            bounding_box_cylinder(body.centre, body.radius, body.axis, body.half_length);
        for (int i = 0; i < 3; ++i) {
            const double up = copysign(body.half_length, vec3_get(body.axis, i));
            const struct vec3 across = direction_across(unit(i), body.axis);
            const struct vec3 arm = vec3_axpy(vec3_scale(up, body.axis), body.radius, across);
            const double noise = 32.0 * DBL_EPSILON * body.size;
            CHECK_CLOSE("upper face", outside(&box, vec3_add(body.centre, arm), i), 0.0, noise);
            CHECK_CLOSE("lower face", outside(&box, vec3_sub(body.centre, arm), i), 0.0, noise);
        }
    }
}

static void a_cylinder_along_a_coordinate_axis_has_the_obvious_box(void)
{
    const struct vec3 centre = {1.0, 2.0, 4.0};
    const struct bounding_box box = bounding_box_cylinder(centre, 0.5, vec3_make(0.0, -1.0, 0.0), 3.0);
    CHECK(box.low.x == 0.5 && box.high.x == 1.5);
    CHECK(box.low.y == -1.0 && box.high.y == 5.0);
    CHECK(box.low.z == 3.5 && box.high.z == 4.5);
    /* An infinite one enters with its cross-section alone. */
    const struct bounding_box disc = bounding_box_cylinder(centre, 0.5, vec3_make(0.0, -1.0, 0.0), 0.0);
    CHECK(disc.low.y == 2.0 && disc.high.y == 2.0);
    CHECK_CLOSE("diagonal of a disc", bounding_box_diagonal(&disc, &disc), sqrtl(2.0L), 4.0 * DBL_EPSILON);
}

static void the_diagonal_spans_both_boxes_in_either_order(void)
{
    struct random r = {34};
    for (int n = 0; n < BODIES; ++n) {
        const double scale = random_power(&r, -140.0, 140.0);
        const double r_a = scale * random_between(&r, 0.01, 1.0);
        const double r_b = scale * random_power(&r, -3.0, 3.0);
        const struct vec3 a = random_vector(&r, scale);
        const struct vec3 b = random_vector(&r, 3.0 * scale);
        const struct bounding_box box_a = bounding_box_sphere(a, r_a);
        const struct bounding_box box_b = bounding_box_sphere(b, r_b);
        long double square = 0.0L;
        for (int i = 0; i < 3; ++i) {
            /* Both intervals together: their centres' distance and radii, or the larger when it holds the
             * other. */
            const long double apart = fabsl((long double)vec3_get(a, i) - vec3_get(b, i));
            const long double edge = fmaxl(apart + r_a + r_b, 2.0L * fmaxl(r_a, r_b));
            square += edge * edge;
        }
        const long double expected = sqrtl(square);
        const long double noise = 16.0L * DBL_EPSILON * expected;
        CHECK_CLOSE("diagonal", bounding_box_diagonal(&box_a, &box_b), expected, noise);
        CHECK_CLOSE("the other order", bounding_box_diagonal(&box_b, &box_a), expected, noise);
    }
}

int main(void)
{
    CHECK_TEST(a_spheres_box_holds_its_surface_and_is_touched_on_every_face);
    CHECK_TEST(a_cylinders_box_holds_its_surface);
    CHECK_TEST(a_cylinders_box_is_touched_on_every_face);
    CHECK_TEST(a_cylinder_along_a_coordinate_axis_has_the_obvious_box);
    CHECK_TEST(the_diagonal_spans_both_boxes_in_either_order);
    return check_summary("bounding_box");
}
