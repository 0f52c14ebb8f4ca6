/*
 * Truncated power series in one variable, for Taylor integration (Jorba and Zou, Experimental Mathematics 14
 * (2005) 99). Coefficients are made one order at a time: each function computes coefficient `order` of its
 * result from coefficients 0..order of its operands.
 */
#ifndef CONTACT_MATH_SERIES_H
#define CONTACT_MATH_SERIES_H

#include "math/vec3.h"

/* At order N the step is eps^(1/N) of the radius of convergence and costs N^2; their ratio is best near 20 to
 * 26. */
enum { TAYLOR_ORDER = 24, TAYLOR_TERMS = TAYLOR_ORDER + 1 };

struct taylor_vec3 {
    struct vec3 at[TAYLOR_TERMS];
};

/* Coefficient of a.b */
double taylor_dot(const struct taylor_vec3 *a, const struct taylor_vec3 *b, int order);

/* Coefficient of a b */
double taylor_multiply(const double *a, const double *b, int order);

/* Coefficient of the root r of s > 0, r r = s; coefficients below `order` of r are known. */
double taylor_root(const double *s, const double *r, int order);

/* Coefficient of the power p = a^exponent, a[0] > 0; coefficients below `order` of p are known. */
double taylor_power(const double *a, double exponent, const double *p, int order);

/* Coefficient of the quotient q = a / b, b[0] != 0. */
double taylor_divide(const double *a, const double *b, const double *q, int order);
struct vec3 taylor_divide_vec3(const struct taylor_vec3 *a, const double *b, const struct taylor_vec3 *q,
                               int order);

/* Sum of the series at s. */
double taylor_at(const double *a, int terms, double s);
struct vec3 taylor_at_vec3(const struct taylor_vec3 *a, int terms, double s);

/* The integral from 0 to s. */
double taylor_integral(const double *a, int terms, double s);

#endif
