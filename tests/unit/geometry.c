/* Norms and gaps from the smallest to the largest sizes, and the conventions of directions. */
#include <float.h>

#include "check.h"
#include "long_vec3.h"
#include "random.h"

enum { CONFIGURATIONS = 20000 };

static const struct vec3 FALLBACK = {0.0, 0.6, -0.8};

/* A contact of size `scale`: radii, either side, any shape, c up to a few radii, along the axis too. */
static struct contact_shape random_shape(struct random *r, double scale)
{
    struct contact_shape shape = {.source_radius = scale * random_power(r, -3.0, 0.0),
                                  .half_length = random_index(r, 2) == 0 ? (double)INFINITY : scale,
                                  .side = random_index(r, 2) == 0 ? 1 : -1,
                                  .destination = (enum shape)random_index(r, 3)};
    shape.other_radius = shape.source_radius + scale * random_power(r, -3.0, 0.0);
    long_complete_shape(&shape, random_direction(r));
    return shape;
}

TEST(the_norm_neither_overflows_nor_underflows)
{
    struct random r = {2};
    for (int i = 0; i < CONFIGURATIONS; ++i) {
        struct vec3 a = random_vector(&r, random_power(&r, -300.0, 300.0));
        a.y *= random_power(&r, -20.0, 0.0);
        const long double expected = long_norm(long_of(a));
        CHECK_CLOSE("|a|", vec3_norm(a), expected, 4.0 * DBL_EPSILON * expected);
    }
    CHECK_CLOSE("|0|", vec3_norm(vec3_make(0.0, -0.0, 0.0)), 0.0, 0.0);
    CHECK_CLOSE("norm of the smallest double", vec3_norm(vec3_make(0.0, -DBL_TRUE_MIN, 0.0)), DBL_TRUE_MIN,
                0.0);
    CHECK(isnan(vec3_norm(vec3_make((double)NAN, 1.0, 1.0))));
}

/* d - r_s - r_d and r_d - d - r_s, not rounded: what is subtracted is within a factor of two (Sterbenz). */
TEST(the_gap_of_bodies_that_almost_touch_has_no_rounding)
{
    struct random r = {4};
    for (int i = 0; i < CONFIGURATIONS; ++i) {
        struct contact_shape shape = {.source_radius = random_between(&r, 0.01, 0.4),
                                      .other_radius = random_between(&r, 1.0, 2.0),
                                      .half_length = (double)INFINITY,
                                      .side = random_index(&r, 2) == 0 ? 1 : -1};
        const double off = 1.0 + random_sign(&r) * random_power(&r, -17.0, -3.0);
        const double d = off * contact_reach(&shape);
        const struct contact_geometry at =
            contact_geometry_at(&shape, vec3_make(0.0, -d, 0.0), vec3_make(0.0, 0.0, 0.0), FALLBACK);
        const long double r_s = shape.source_radius;
        const long double r_d = shape.other_radius;
        CHECK_CLOSE("d", at.distance, d, 0.0);
        CHECK_CLOSE("g", at.gap, shape.side > 0 ? d - r_s - r_d : r_d - r_s - d, 0.0);
    }
}

/* Where c is along the axis to rounding, what the projection leaves must not make a normal along it. */
TEST(near_the_axis_the_normal_still_lies_across)
{
    struct random r = {11};
    int on_the_axis = 0;
    for (int i = 0; i < CONFIGURATIONS; ++i) {
        struct contact_shape shape = random_shape(&r, 1.0);
        shape.destination = SHAPE_CYLINDER;
        shape.axis = random_direction(&r);
        const struct vec3 fallback = contact_default_normal(&shape);
        struct vec3 c = vec3_scale(random_between(&r, -100.0, 100.0), shape.axis);
        c = vec3_axpy(c, random_between(&r, 0.0, 1e-12) * (i % 2), fallback);
        const struct contact_geometry at = contact_geometry_at(&shape, c, c, fallback);
        CHECK_CLOSE("n.e_d", vec3_dot(at.normal, shape.axis), 0.0, 32.0 * DBL_EPSILON);
        CHECK_CLOSE("|n|", vec3_norm(at.normal), 1.0, 4.0 * DBL_EPSILON);
        CHECK(at.distance <= 1.1e-12 + 4.0 * DBL_EPSILON * vec3_norm(c));
        on_the_axis += at.degenerate;
    }
    CHECK(on_the_axis > 0 && on_the_axis < CONFIGURATIONS / 2);
}

TEST(the_default_normal_is_the_documented_one)
{
    struct contact_shape shape = {.destination = SHAPE_SPHERE, .side = 1};
    const struct vec3 down = contact_default_normal(&shape);
    CHECK(down.x == 0.0 && down.y == 0.0 && down.z == -1.0);
    struct random r = {7};
    shape.destination = SHAPE_CYLINDER;
    for (int i = 0; i < CONFIGURATIONS; ++i) {
        shape.axis = random_direction(&r);
        const double e[3] = {shape.axis.x, shape.axis.y, shape.axis.z};
        const struct vec3 n = contact_default_normal(&shape);
        CHECK_CLOSE("|n|", vec3_norm(n), 1.0, 4.0 * DBL_EPSILON);
        CHECK_CLOSE("n.e_d", vec3_dot(n, shape.axis), 0.0, 8.0 * DBL_EPSILON);
        /* A unit vector made perpendicular to e_d keeps the part sqrt(1 - e_i^2) along itself; it is the
         * largest of the three for the least |e_i|. */
        const double least = fmin(fabs(e[0]), fmin(fabs(e[1]), fabs(e[2])));
        const double lowest = fmin(n.x, fmin(n.y, n.z));
        CHECK_CLOSE("along the axis least aligned", lowest, -sqrt(1.0 - least * least), 8.0 * DBL_EPSILON);
    }
}
