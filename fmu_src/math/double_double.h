/*
 * Numbers of twice the digits, as the unevaluated sum of two doubles (T. J. Dekker, Numerische Mathematik 18
 * (1971) 224): about 31 decimal digits. The code needs the rounding of IEEE 754 and no contraction of a b +
 * c. Sizes must lie between 1e-130 and 1e290, so that no part of a product underflows or overflows.
 */
#ifndef CONTACT_MATH_DOUBLE_DOUBLE_H
#define CONTACT_MATH_DOUBLE_DOUBLE_H

#include <math.h>

struct double_double {
    double high, low; /* |low| <= half a unit in the last place of high */
};

/* Returns a + b exactly. */
static inline struct double_double double_double_sum(double a, double b)
{
    const double sum = a + b;
    const double of_b = sum - a;
    return (struct double_double){sum, (a - (sum - of_b)) + (b - of_b)};
}

/* Returns a + b exactly, where |a| >= |b|. */
static inline struct double_double double_double_renormalized(double a, double b)
{
    const double sum = a + b;
    return (struct double_double){sum, b - (sum - a)};
}

/* Returns a b exactly: both factors are split into halves of 26 digits by 2^27 + 1. */
static inline struct double_double double_double_product(double a, double b)
{
    const double splitter = 134217729.0;
    const double a_big = splitter * a;
    const double b_big = splitter * b;
    const double a_high = a_big - (a_big - a);
    const double b_high = b_big - (b_big - b);
    const double a_low = a - a_high;
    const double b_low = b - b_high;
    const double product = a * b;
    const double error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    return (struct double_double){product, error};
}

static inline struct double_double double_double_add(struct double_double a, struct double_double b)
{
    const struct double_double high = double_double_sum(a.high, b.high);
    const struct double_double low = double_double_sum(a.low, b.low);
    const struct double_double first = double_double_renormalized(high.high, high.low + low.high);
    return double_double_renormalized(first.high, first.low + low.low);
}

static inline struct double_double double_double_subtract(struct double_double a, struct double_double b)
{
    return double_double_add(a, (struct double_double){-b.high, -b.low});
}

static inline struct double_double double_double_multiply(struct double_double a, struct double_double b)
{
    const struct double_double product = double_double_product(a.high, b.high);
    return double_double_renormalized(product.high, product.low + (a.high * b.low + a.low * b.high));
}

/* Returns a divided by b; b must not be zero. */
static inline struct double_double double_double_divide(struct double_double a, struct double_double b)
{
    const struct double_double first = {a.high / b.high, 0.0};
    const struct double_double rest = double_double_subtract(a, double_double_multiply(b, first));
    return double_double_renormalized(first.high, (rest.high + rest.low) / b.high);
}

/* Returns the square root of a >= 0. */
static inline struct double_double double_double_root(struct double_double a)
{
    const double first = sqrt(a.high);
    const struct double_double rest = double_double_subtract(a, double_double_product(first, first));
    return first > 0.0 ? double_double_renormalized(first, (rest.high + rest.low) / (2.0 * first))
                       : (struct double_double){0.0, 0.0};
}

#endif
