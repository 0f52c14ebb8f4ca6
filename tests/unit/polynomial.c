/* Sign changes of polynomials whose roots are known because they were made from them. */
#include "math/polynomial.h"
#include "math/series.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "check.h"
#include "known_roots.h"
#include "random.h"

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The roots in (0, 1), ascending; returns how many. */
static int roots_inside(const struct factors *f, double *inside)
{
    int count = 0;
    for (int i = 0; i < f->root_count; ++i) {
        if (f->roots[i] > 0.0 && f->roots[i] < 1.0) {
            inside[count++] = f->roots[i];
        }
    }
    qsort(inside, (size_t)count, sizeof *inside, ascending);
    return count;
}

static struct factors random_factors(struct random *r)
{
    struct factors f = {.root_count = random_index(r, 7), .pair_count = random_index(r, 3), .leading = 1.0};
    f.leading = random_sign(r) * random_power(r, -100.0, 100.0);
    for (int i = 0; i < f.root_count; ++i) {
        f.roots[i] = random_between(r, -0.5, 1.5);
    }
    for (int i = 0; i < f.pair_count; ++i) {
        f.re[i] = random_between(r, -0.5, 1.5);
        f.im[i] = random_between(r, 0.1, 1.0);
    }
    return f;
}

/* Whether rounding leaves all roots apart from each other and on their side of 0 and 1. */
static bool roots_are_distinct(const struct factors *f, const struct polynomial *p)
{
    for (int i = 0; i < f->root_count; ++i) {
        const long double reach = 4.0L * root_noise(p, fabs(f->roots[i]));
        if (!(fabsl(f->roots[i]) > reach && fabsl(f->roots[i] - 1.0L) > reach)) {
            return false;
        }
        for (int j = 0; j < f->root_count; ++j) {
            if (j != i && !(fabsl((long double)f->roots[i] - f->roots[j]) > reach)) {
                return false;
            }
        }
    }
    return true;
}

static void check_roots(const struct polynomial *p, const double *expected, int expected_count)
{
    double roots[POLYNOMIAL_MAX_DEGREE];
    const int count = polynomial_add_sign_changes(p, roots, 0);
    CHECK_CLOSE("number of roots", count, expected_count, 0.0);
    for (int i = 0; i < count && i < expected_count; ++i) {
        CHECK_CLOSE("root", roots[i], expected[i], root_noise(p, expected[i]));
    }
}

static void check_factors(const struct factors *f)
{
    double inside[POLYNOMIAL_MAX_DEGREE];
    const int count = roots_inside(f, inside);
    const struct polynomial p = product_of(f);
    check_roots(&p, inside, count);
}

TEST(every_root_of_a_random_product_is_found)
{
    struct random r = {41};
    int tried = 0;
    for (int drawn = 0; drawn < 40000; ++drawn) {
        const struct factors f = random_factors(&r);
        const struct polynomial p = product_of(&f);
        if (roots_are_distinct(&f, &p)) {
            check_factors(&f);
            tried += 1;
        }
    }
    CHECK(tried > 30000);
}

TEST(close_roots_are_told_apart)
{
    for (double apart = 1e-1; apart > 1e-7; apart /= 10.0) {
        const struct factors pair = {.roots = {0.4, 0.4 + apart, 2.0},
                                     .root_count = 3,
                                     .re = {0.4},
                                     .im = {1.0},
                                     .pair_count = 1,
                                     .leading = -3.0};
        check_factors(&pair);
    }
    /* Three roots need the third power of their distance above the rounding. */
    for (double apart = 1e-1; apart > 1e-4; apart /= 10.0) {
        const struct factors three = {
            .roots = {0.7 - apart, 0.7 + apart, 0.7}, .root_count = 3, .leading = 1e6};
        check_factors(&three);
    }
}

TEST(roots_near_zero_keep_their_relative_accuracy)
{
    for (double root = 1e-3; root > 1e-100; root /= 1e3) {
        const struct factors near_zero = {.roots = {0.5, root, 3.0 * root},
                                          .root_count = 3,
                                          .re = {0.5},
                                          .im = {0.5},
                                          .pair_count = 1,
                                          .leading = 1.0};
        double inside[POLYNOMIAL_MAX_DEGREE];
        const struct polynomial p = product_of(&near_zero);
        CHECK_CLOSE("number of roots", polynomial_add_sign_changes(&p, inside, 0), 3, 0.0);
        CHECK_CLOSE("smallest root / its value", inside[0] / root, 1.0, 64.0 * DBL_EPSILON);
        CHECK_CLOSE("next root / its value", inside[1] / (3.0 * root), 1.0, 64.0 * DBL_EPSILON);
    }
}

/* Powers of two, so that the coefficients, and the roots of the derivatives, are exact. */
TEST(touching_roots_are_not_reported)
{
    const struct polynomial touch = {{0.25, -1.0, 1.0}, 2};
    check_roots(&touch, 0, 0);
    const struct factors touch_then_cross = {.roots = {0.25, 0.25, 0.75}, .root_count = 3, .leading = 1.0};
    const struct polynomial p = product_of(&touch_then_cross);
    check_roots(&p, &touch_then_cross.roots[2], 1);
    const struct factors cross_then_touch = {.roots = {0.75, 0.25, 0.75}, .root_count = 3, .leading = -1.0};
    const struct polynomial q = product_of(&cross_then_touch);
    check_roots(&q, &cross_then_touch.roots[1], 1);
    const struct factors fourfold = {.roots = {0.5, 0.5, 0.5, 0.5}, .root_count = 4, .leading = 1.0};
    const struct polynomial flat = product_of(&fourfold);
    check_roots(&flat, 0, 0);
    /* A triple root changes the sign, once. */
    double roots[POLYNOMIAL_MAX_DEGREE];
    const struct polynomial triple = {{-0.125, 0.75, -1.5, 1.0}, 3};
    CHECK_CLOSE("number of roots", polynomial_add_sign_changes(&triple, roots, 0), 1, 0.0);
    CHECK_CLOSE("triple root", roots[0], 0.5, cbrt(8.0 * DBL_EPSILON));
}

/* Rounding may make three roots of a triple one, and zeros of the derivative double; signs change too. */
TEST(a_triple_root_anywhere_is_found_an_odd_number_of_times)
{
    struct random r = {43};
    for (int i = 0; i < 20000; ++i) {
        const double at = random_between(&r, 0.1, 0.9);
        const struct factors triple = {.roots = {at, at, at}, .root_count = 3, .leading = random_sign(&r)};
        const struct polynomial p = product_of(&triple);
        double roots[POLYNOMIAL_MAX_DEGREE];
        const int count = polynomial_add_sign_changes(&p, roots, 0);
        CHECK(count == 1 || count == 3);
        for (int k = 0; k < count; ++k) {
            CHECK_CLOSE("triple root", roots[k], at, cbrtl(2.0L * noise_at(&p, at)));
        }
    }
}

TEST(the_ends_of_the_interval_are_not_inside)
{
    const double half = 0.5;
    const struct polynomial at_zero = {{0.0, -0.5, 1.0}, 2};
    check_roots(&at_zero, &half, 1);
    const struct polynomial at_one = {{0.5, -1.5, 1.0}, 2};
    check_roots(&at_one, &half, 1);
    const struct polynomial at_both = {{0.0, -1.0, 1.0}, 2};
    check_roots(&at_both, 0, 0);
}

TEST(constants_have_no_roots_and_zero_leading_coefficients_are_no_degree)
{
    for (int degree = 0; degree <= POLYNOMIAL_MAX_DEGREE; ++degree) {
        struct polynomial p = {{0.0}, degree};
        check_roots(&p, 0, 0);
        p.a[0] = -7.0;
        check_roots(&p, 0, 0);
        const double root = 0.7;
        if (degree > 0) {
            p.a[1] = 10.0;
            check_roots(&p, &root, 1);
        }
    }
}

/* Chebyshev's polynomial of degree 16 moved to [0, 1]: coefficients below 2^53, sixteen roots, all inside */
TEST(all_sixteen_roots_of_degree_sixteen_are_found)
{
    struct polynomial before = {{1.0}, 0};
    struct polynomial p = {{-1.0, 2.0}, 1};
    while (p.degree < POLYNOMIAL_MAX_DEGREE) { /* T_(k+1) = 2 (2 s - 1) T_k - T_(k-1) */
        struct polynomial next = {{0.0}, p.degree + 1};
        for (int i = 0; i <= p.degree; ++i) {
            next.a[i] -= 2.0 * p.a[i] + (i <= before.degree ? before.a[i] : 0.0);
            next.a[i + 1] += 4.0 * p.a[i];
        }
        before = p;
        p = next;
    }
    const long double pi = 3.14159265358979323846L;
    double expected[POLYNOMIAL_MAX_DEGREE];
    for (int i = 0; i < POLYNOMIAL_MAX_DEGREE; ++i) {
        expected[i] = (double)(0.5L * (1.0L - cosl((2 * i + 1) * pi / 32.0L)));
    }
    CHECK_CLOSE("T16 at 1", taylor_at(p.a, p.degree + 1, 1.0), 1.0, noise_at(&p, 1.0));
    check_roots(&p, expected, POLYNOMIAL_MAX_DEGREE);
}

TEST(a_derivative_evaluates_to_that_of_the_values)
{
    struct random r = {42};
    for (int n = 0; n < 10000; ++n) {
        struct polynomial a = {{0.0}, random_index(&r, 9)};
        for (int i = 0; i <= 8; ++i) {
            a.a[i] = i <= a.degree ? random_between(&r, -1.0, 1.0) : 1e9; /* beyond the degree: not read */
        }
        const double s = random_between(&r, 0.0, 1.0);
        const struct polynomial slope = polynomial_derivative(&a);
        const long double h = 1e-4L;
        const long double near = 8.0L * (long_value(&a, s + h) - long_value(&a, s - h));
        const long double far = long_value(&a, s + 2.0L * h) - long_value(&a, s - 2.0L * h);
        CHECK_CLOSE("a'", taylor_at(slope.a, slope.degree + 1, s), (near - far) / (12.0L * h), 1e-11);
    }
}
