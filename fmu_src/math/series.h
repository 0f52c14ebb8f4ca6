/*
 * This file has truncated power series in one variable, for Taylor integration (Jorba and Zou, Experimental
 * Mathematics 14 (2005) 99). Coefficients are made one order at a time: each function computes coefficient
 * `order` of its result from coefficients 0..order of its operands.
 */
#ifndef CONTACT_MATH_SERIES_H
#define CONTACT_MATH_SERIES_H

/* At order N the step is eps^(1/N) of the radius of convergence and costs N^2; their ratio is best near 20 to
 * 26. */
enum { TAYLOR_ORDER = 24, TAYLOR_TERMS = TAYLOR_ORDER + 1 };

/* Rows of coefficients end with zeros, because products take four terms at a time. */
typedef double taylor_row[TAYLOR_TERMS + 3];

/* `row` holds the coefficients of a series, and `back` holds them in reversed order: coefficient j is at
 * back[TAYLOR_ORDER - j]. taylor_product reads both rows forwards, two terms in one instruction. */
struct two_way {
    taylor_row row, back;
};

void taylor_put(struct two_way *to, int order, double value);

/* Returns a coefficient of the product of the series a and b. Coefficients not known yet have to be zero. */
double taylor_product(const double *a, const struct two_way *b, int order);

/* Returns the coefficient of a b. */
double taylor_multiply(const double *a, const double *b, int order);

/* Returns the coefficient of the power p = a^exponent, a[0] > 0; coefficients below `order` of p are
 * known. */
double taylor_power(const double *a, double exponent, const double *p, int order);

/* Returns the coefficient of the quotient q = a / b, b[0] != 0. The root r of a is a / r: with b = q = r and
 * r[order] zero, half of the result is the coefficient `order` of r. */
double taylor_divide(const double *a, const double *b, const double *q, int order);

/* Returns the sum of the series at s. */
double taylor_at(const double *a, int terms, double s);

/* Writes the value of the series at s and its first two derivatives. */
void taylor_derivatives(const double *a, int terms, double s, double out[restrict 3]);

/* Returns the first place up to `end` at which the series falls through zero; INFINITY: it does not. */
double taylor_first_fall(const double *a, int terms, double end);

#endif
