/* This file has real polynomials on the unit interval: p(s) = a[0] + a[1] s + ... + a[degree] s^degree. */
#ifndef CONTACT_MATH_POLYNOMIAL_H
#define CONTACT_MATH_POLYNOMIAL_H

#include <stdbool.h>

/* |c(t)|^2 has degree 8 for motion of degree 4; the law's zero-force condition squares it once more. */
enum { POLYNOMIAL_MAX_DEGREE = 16 };

struct polynomial {
    double a[POLYNOMIAL_MAX_DEGREE + 1];
    int degree; /* 0..POLYNOMIAL_MAX_DEGREE */
};

struct polynomial polynomial_derivative(const struct polynomial *p);

/*
 * Adds every s in (0, 1) at which p changes sign to the `count` numbers of `sorted`, and keeps these in
 * ascending order. There are at most as many changes as the degree of p. Returns the new count. Between the
 * roots of its derivative p is monotone and has one root at most, so none is missed. Roots where p touches
 * zero without a change of sign are not reported. Each root is exact to the rounding of p.
 */
int polynomial_add_sign_changes(const struct polynomial *p, double *sorted, int count);

/* A sum of a[i] s^i, and a root_function of it (below). */
struct power_sum {
    const double *a;
    int terms;
};
void power_sum_and_slope(const void *sum, double s, double *value, double *slope);

/* One root of a smooth function inside a bracket on which it is monotone and changes sign. */

/* Writes f(s) and f'(s) for the function that `data` describes. */
typedef void root_function(const void *data, double s, double *value, double *slope);

/* Returns a root by Newton's method, which bisection keeps inside [low, high] with 0 <= low < high; exact to
 * the rounding of f or of s. */
double root_in_bracket(root_function *f, const void *data, double low, double high);

/* An end of a bracket, with value and slope there. */
struct root_bracket_end {
    double s, value, slope;
};

/* Returns a first guess of the root: that of the cubic through both ends. */
double root_guess(struct root_bracket_end low, struct root_bracket_end high);

/* Returns the root in a bracket whose ends hold value and slope of f; f is not zero at `low`. */
double root_between(root_function *f, const void *data, struct root_bracket_end low,
                    struct root_bracket_end high);

/* A place s and the function's value there. */
struct root_place {
    double s, value;
};

/* Whether a function that is positive at three ascending places and lowest at the second may fall below zero
 * about it: the parabola through the three falls below the second value by at least half of it. */
bool root_may_dip(const struct root_place place[3]);

/* Returns where a polynomial, given by its Bernstein coefficients on [0, 1], first falls through zero. */

enum { BERNSTEIN_MOST = 25 }; /* coefficients */

/* A bracket of the place where the polynomial plus `offset` falls through zero, with no other change of sign
 * in it; low = INFINITY: no such place. */
struct bernstein_fall {
    double low, high, offset;
};

/* The coefficients are accurate to `noise`. A dip below zero that is not deeper than `noise` does not count,
 * and a deeper one begins where it passes -noise, unless the polynomial ends at or below zero. */
struct bernstein_fall bernstein_first_fall(const double *coefficients, int count, double noise);

/* Returns the place of the fall in the bracket, accurate to rounding. */
double bernstein_root(const double *coefficients, int count, struct bernstein_fall fall);

/* Restricts Bernstein coefficients to the polynomial between two places of [0, 1]. */
void bernstein_restrict(double *coefficients, int count, double from, double to);

/* Replaces the coefficients a[k] of the polynomial's sum of a[k] s^k by its Bernstein coefficients. */
void bernstein_from_powers(double *coefficients, int count);

#endif
