/* The path of a separation as polynomials, against what it is made of in long double. */
#include "flight/relative_path.h"

#include <float.h>

#include "check.h"
#include "long_vec3.h"
#include "random.h"

/* A polynomial path c of the given degree, its w the derivative. */
static struct separation_path random_path(struct random *r, int degree)
{
    struct separation_path path = {.w = {{0.0, 0.0, 0.0}}};
    for (int i = 0; i <= degree; ++i) {
        path.c[i] = random_vector(r, 1.0);
        if (i > 0) {
            path.w[i - 1] = vec3_scale(i, path.c[i]);
        }
    }
    return path;
}

static struct long_vec3 across_axis(const struct separation_path *path, const struct contact_shape *shape,
                                    long double t)
{
    struct long_vec3 c = {0.0L, 0.0L, 0.0L};
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) {
        c = long_axpy(c, powl(t, i), long_of(path->c[i]));
    }
    if (shape->destination == SHAPE_CYLINDER) {
        c = long_axpy(c, -long_dot(c, long_of(shape->axis)), long_of(shape->axis));
    }
    return c;
}

static void check_path(struct random *r, const struct contact_shape *shape, int degree)
{
    struct separation_path separation = random_path(r, degree);
    separation.offset = separation.c[0];
    if (shape->destination == SHAPE_CYLINDER) {
        separation.offset = vec3_axpy(separation.c[0], -vec3_dot(separation.c[0], shape->axis), shape->axis);
    }
    const double horizon = random_between(r, 0.1, 2.0);
    const long double reach = contact_reach(shape);
    const long double start = long_norm(across_axis(&separation, shape, 0.0L));
    const double gap = (double)(shape->side * (start - reach));
    const struct relative_path path = relative_path_make(shape, &separation, gap, horizon);
    const struct polynomial deviation = relative_path_squared_deviation(&path);
    const struct polynomial squared = relative_path_distance_squared(&path);
    for (double s = 0.0; s <= 1.0; s += 0.125) {
        const long double d = long_norm(across_axis(&separation, shape, (long double)s * horizon));
        const long double scale = path.scale;
        /* |c| is below 31 of its coefficients, and its square a sum of 25 products in 3 components. */
        const long double noise = 1e4L * DBL_EPSILON;
        CHECK_CLOSE("d^2", polynomial_at(&squared, s), d * d / (scale * scale), noise);
        CHECK_CLOSE("d^2 - reach^2", polynomial_at(&deviation, s),
                    (d - reach) * (d + reach) / (scale * scale), noise);
    }
}

static void the_squares_are_those_of_the_separation(void)
{
    struct random r = {11};
    for (int i = 0; i < 2000; ++i) {
        struct contact_shape shape = {
            .side = i % 2 == 0 ? 1 : -1, .half_length = INFINITY, .destination = SHAPE_SPHERE};
        shape.source_radius = random_between(&r, 0.1, 0.4);
        shape.other_radius = random_between(&r, 0.5, 1.0);
        if (i % 3 == 0) {
            shape.destination = SHAPE_CYLINDER;
            shape.axis = random_direction(&r);
        }
        check_path(&r, &shape, i % (SEPARATION_DEGREE + 1));
    }
}

/* A step may have any length: powers of time overflow, coefficients that are zero do not count. */
static void a_path_of_any_length_has_finite_numbers(void)
{
    const struct contact_shape shape = {
        .source_radius = 0.1, .other_radius = 0.5, .half_length = INFINITY, .side = 1};
    struct separation_path separation = {.c = {{2.0, 0.3, 0.0}}, .offset = {2.0, 0.3, 0.0}};
    for (int moves = 0; moves < 2; ++moves) {
        separation.c[1] = separation.w[0] = vec3_make(-moves, 0.0, 0.0);
        for (double horizon = 1e-300; horizon < 1e301; horizon *= 1e50) {
            const struct relative_path path = relative_path_make(&shape, &separation, 1.4, horizon);
            double gap;
            double slope;
            relative_path_gap(&path, 1.0, &gap, &slope);
            const double distance = hypot(2.0 - moves * horizon, 0.3);
            CHECK_CLOSE("gap", path.scale * gap / fmax(distance, 1.0), (distance - 0.6) / fmax(distance, 1.0),
                        0.1);
            CHECK(isfinite(slope) && path.degree == moves);
            for (int i = 0; i <= path.half_rate.degree; ++i) {
                CHECK(isfinite(path.half_rate.a[i]));
            }
        }
    }
}

int main(void)
{
    CHECK_TEST(the_squares_are_those_of_the_separation);
    CHECK_TEST(a_path_of_any_length_has_finite_numbers);
    return check_summary("relative_path");
}
