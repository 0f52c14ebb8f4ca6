/*
 * Truncated power series in one variable, for Taylor integration (Jorba and Zou, Experimental Mathematics 14 (2005) 99).
 * Coefficients are made one order at a time: each function computes coefficient `order` of its result from coefficients
 * 0..order of its operands.
 */
#ifndef CONTACT_SERIES_H
#define CONTACT_SERIES_H

#include "contact/vec3.h"

/* At order N the step is eps^(1/N) of the radius of convergence and costs N^2; their ratio is best near 20 to 26. */
enum { SERIES_ORDER = 24, SERIES_TERMS = SERIES_ORDER + 1 };

struct vec3_series {
    struct vec3 at[SERIES_TERMS];
};

/* Coefficient of a.b */
double series_dot(const struct vec3_series *a, const struct vec3_series *b, int order);

/* Coefficient of a b */
double series_multiply(const double *a, const double *b, int order);

/* Coefficient of the root r of s > 0, r r = s; coefficients below `order` of r are known. */
double series_root(const double *s, const double *r, int order);

/* Coefficient of the quotient q = a / b, b[0] != 0. */
double series_divide(const double *a, const double *b, const double *q, int order);
struct vec3 series_divide_vec3(const struct vec3_series *a, const double *b, const struct vec3_series *q,
                               int order);

/* Sum of the series at s. */
double series_at(const double *a, int terms, double s);
struct vec3 series_at_vec3(const struct vec3_series *a, int terms, double s);

/* The integral from 0 to s. */
double series_integral(const double *a, int terms, double s);

#endif
