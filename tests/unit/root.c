/* The root inside a bracket, of functions that mislead Newton's method: flat, steep, with useless slopes. */
#include "math/polynomial.h"

#include <float.h>
#include <math.h>

#include "check.h"
#include "random.h"

/* One of the shapes below, through zero at `root`. */
struct curve {
    double root, sign, steepness;
    int power;
};

static void line(const void *data, double s, double *value, double *slope)
{
    const struct curve *c = data;
    *value = c->sign * c->steepness * (s - c->root);
    *slope = c->sign * c->steepness;
}

/* Flat away from the root: a Newton step from there leaves the bracket. */
static void arctangent(const void *data, double s, double *value, double *slope)
{
    const struct curve *c = data;
    const double x = c->steepness * (s - c->root);
    *value = c->sign * atan(x);
    *slope = c->sign * c->steepness / (1.0 + x * x);
}

/* Steeper and steeper: Newton comes down from above by a small part of the way each time. */
static void power(const void *data, double s, double *value, double *slope)
{
    const struct curve *c = data;
    *value = c->sign * (pow(s, c->power) - pow(c->root, c->power));
    *slope = c->sign * c->power * pow(s, c->power - 1);
}

/* Infinite slope at the root: Newton steps to the other side, twice as far. */
static void square_root(const void *data, double s, double *value, double *slope)
{
    const struct curve *c = data;
    const double x = s - c->root;
    *value = c->sign * copysign(sqrt(fabs(x)), x);
    *slope = c->sign * 0.5 / sqrt(fabs(x));
}

/* Slopes that are zero or not a number leave bisection. */
static void without_slope(const void *data, double s, double *value, double *slope)
{
    line(data, s, value, slope);
    *slope = s > 0.5 ? 0.0 : (double)NAN;
}

static struct curve random_curve(struct random *r, double root)
{
    return (struct curve){root, random_sign(r), random_power(r, -3.0, 9.0), 2 + random_index(r, 15)};
}

static root_function *const FUNCTIONS[] = {line, arctangent, square_root, without_slope};

TEST(the_root_is_found_to_rounding_whatever_the_slope)
{
    struct random r = {51};
    for (int i = 0; i < 20000; ++i) {
        const double low = random_index(&r, 2) == 0 ? 0.0 : random_between(&r, 0.0, 0.3);
        const double high = random_between(&r, 0.6, 1.0);
        const struct curve curve = random_curve(&r, random_between(&r, low, high));
        if (curve.root > low) {
            const double got = root_in_bracket(FUNCTIONS[i % 4], &curve, low, high);
            CHECK_CLOSE("root", got, curve.root, 2.0 * DBL_EPSILON * curve.root);
        }
    }
}

TEST(powers_are_solved_to_the_rounding_of_their_value)
{
    struct random r = {52};
    for (int i = 0; i < 20000; ++i) {
        const struct curve curve = random_curve(&r, random_between(&r, 0.05, 0.99));
        /* One rounding of the value is 1 / power roundings of the root; pow itself adds about one. */
        CHECK_CLOSE("root", root_in_bracket(power, &curve, 0.0, 1.0), curve.root,
                    4.0 * DBL_EPSILON * curve.root);
    }
}

TEST(tiny_roots_keep_their_relative_accuracy)
{
    struct random r = {53};
    for (int i = 0; i < 2000; ++i) {
        const struct curve curve = random_curve(&r, random_power(&r, -290.0, -3.0));
        const double got = root_in_bracket(FUNCTIONS[i % 4], &curve, 0.0, 1.0);
        CHECK_CLOSE("root / its value", got / curve.root, 1.0, 4.0 * DBL_EPSILON);
    }
    /* The power of a root near the smallest double. */
    const struct curve sixteenth = {1e-18, 1.0, 1.0, 16};
    CHECK_CLOSE("root", root_in_bracket(power, &sixteenth, 0.0, 1.0) / 1e-18, 1.0, 4.0 * DBL_EPSILON);
}

TEST(the_root_lies_inside_even_the_smallest_bracket)
{
    struct random r = {54};
    for (int i = 0; i < 20000; ++i) {
        const double low = random_power(&r, -300.0, 0.0);
        const double high = low * (1.0 + DBL_EPSILON * (1.0 + random_index(&r, 5)));
        const struct curve curve = random_curve(&r, nextafter(low, 2.0));
        const double got = root_in_bracket(arctangent, &curve, low, high);
        CHECK(got >= low && got <= high);
        CHECK_CLOSE("root", got, curve.root, DBL_EPSILON * curve.root);
    }
}

static int evaluations; /* of the parabola */

/* (s - place)^2 - depth */
static void parabola(const void *data, double s, double *value, double *slope)
{
    const struct root_place *lowest = data;
    evaluations += 1;
    *value = (s - lowest->s) * (s - lowest->s) + lowest->value;
    *slope = 2.0 * (s - lowest->s);
}

static struct root_place on_parabola(const struct root_place *lowest, double s)
{
    double value;
    double slope;
    parabola(lowest, s, &value, &slope);
    return (struct root_place){s, value};
}

/* A body that leaves a surface by rounding falls back onto it at the end of the bracket, or far before it. */
TEST(a_fall_back_is_found_in_few_evaluations)
{
    struct random r = {56};
    for (int i = 0; i < 2000; ++i) {
        const double middle = random_power(&r, -3.0, 0.0);
        const struct root_place lowest = {middle, -middle * middle * (1.0 + 1e-15)};
        const bool at_end = i % 2 == 0;
        const double factor = at_end ? 1.0 + 1e-14 : random_power(&r, 0.0, 3.0);
        struct root_bracket_end low = {.s = 0.0};
        struct root_bracket_end high = {.s = 2.0 * middle * factor};
        parabola(&lowest, low.s, &low.value, &low.slope);
        parabola(&lowest, high.s, &high.value, &high.slope);
        evaluations = 0;
        const double root = at_end ? root_in_bracket(parabola, &lowest, low.s, high.s)
                                   : root_between(parabola, &lowest, low, high);
        CHECK_CLOSE("root", root, 2.0 * middle, 1e-14 * middle);
        CHECK(evaluations <= (at_end ? 12 : 4));
    }
}

/* Three places about a dip, positive at each: it is found if the parabola goes below zero. */
TEST(a_dip_between_places_is_found)
{
    struct random r = {55};
    for (int i = 0; i < 2000; ++i) {
        const double middle = random_between(&r, -0.2, 0.2);
        const struct root_place lowest = {1.0 + middle, random_between(&r, -0.04, 0.04)};
        const struct root_place place[3] = {on_parabola(&lowest, 0.7), on_parabola(&lowest, 1.0),
                                            on_parabola(&lowest, 1.4)};
        if (!(place[1].value > 0.0 && place[1].value < place[0].value && place[1].value < place[2].value)) {
            continue;
        }
        CHECK(lowest.value >= 0.0 || root_may_dip(place));
    }
}
