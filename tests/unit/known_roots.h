/* Polynomials made from their roots, and how far rounding moves these. */
#ifndef KNOWN_ROOTS_H
#define KNOWN_ROOTS_H

#include <float.h>
#include <math.h>

#include "check.h"
#include "math/polynomial.h"

/* Factors of a polynomial: real roots, and pairs re +- i im off the real axis. */
struct factors {
    double roots[POLYNOMIAL_MAX_DEGREE];
    double re[POLYNOMIAL_MAX_DEGREE], im[POLYNOMIAL_MAX_DEGREE];
    int root_count, pair_count;
    double leading;
};

struct long_polynomial {
    long double a[POLYNOMIAL_MAX_DEGREE + 1];
    int degree;
};

/* p (c0 + c1 s + c2 s^2) */
static inline void multiply_by(struct long_polynomial *p, long double c0, long double c1, long double c2,
                               int degree)
{
    const struct long_polynomial q = *p;
    const long double factor[3] = {c0, c1, c2};
    *p = (struct long_polynomial){{0.0L}, q.degree + degree};
    for (int i = 0; i <= q.degree; ++i) {
        for (int j = 0; j <= degree; ++j) {
            p->a[i + j] += q.a[i] * factor[j];
        }
    }
}

static inline struct polynomial product_of(const struct factors *f)
{
    struct long_polynomial p = {{f->leading}, 0};
    for (int i = 0; i < f->root_count; ++i) {
        multiply_by(&p, -f->roots[i], 1.0L, 0.0L, 1);
    }
    for (int i = 0; i < f->pair_count; ++i) {
        const long double re = f->re[i];
        multiply_by(&p, re * re + (long double)f->im[i] * f->im[i], -2.0L * re, 1.0L, 2);
    }
    struct polynomial rounded = {{0.0}, p.degree};
    for (int i = 0; i <= p.degree; ++i) {
        rounded.a[i] = (double)p.a[i];
    }
    return rounded;
}

static inline long double long_value(const struct polynomial *p, long double s)
{
    long double value = 0.0L;
    for (int i = p->degree; i >= 0; --i) {
        value = value * s + p->a[i];
    }
    return value;
}

/* Rounding of p at s: each coefficient once, and Horner's rule, which rounds twice a step. */
static inline long double noise_at(const struct polynomial *p, double s)
{
    long double sum = 0.0L;
    for (int i = p->degree; i >= 0; --i) {
        sum = sum * s + fabs(p->a[i]);
    }
    return (2.0L * p->degree + 2.0L) * DBL_EPSILON * sum;
}

/* How far rounding moves a simple root, to first order. */
static inline long double root_noise(const struct polynomial *p, double root)
{
    const struct polynomial slope = polynomial_derivative(p);
    return noise_at(p, root) / fabsl(long_value(&slope, root)) + 4.0L * DBL_EPSILON * root;
}

#endif
