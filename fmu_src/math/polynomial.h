/* Real polynomials on the unit interval: p(s) = a[0] + a[1] s + ... + a[degree] s^degree. */
#ifndef CONTACT_MATH_POLYNOMIAL_H
#define CONTACT_MATH_POLYNOMIAL_H

/* |c(t)|^2 has degree 8 for motion of degree 4; the law's zero-force condition squares it once more. */
enum { POLYNOMIAL_MAX_DEGREE = 16 };

struct polynomial {
    double a[POLYNOMIAL_MAX_DEGREE + 1];
    int degree; /* 0..POLYNOMIAL_MAX_DEGREE */
};

double polynomial_at(const struct polynomial *p, double s);

struct polynomial polynomial_derivative(const struct polynomial *p);

/* a + factor b */
struct polynomial polynomial_add(const struct polynomial *a, double factor, const struct polynomial *b);

/* a b; the degrees together must not exceed POLYNOMIAL_MAX_DEGREE. */
struct polynomial polynomial_multiply(const struct polynomial *a, const struct polynomial *b);

/*
 * Every s in (0, 1) where p changes sign, ascending; returns how many (at most the degree). Between the roots
 * of its derivative p is monotone and has one root at most, so none is missed. Roots where p touches zero
 * without a change of sign are not reported. Each root is exact to the rounding of p.
 */
int polynomial_sign_changes(const struct polynomial *p, double roots[POLYNOMIAL_MAX_DEGREE]);

#endif
