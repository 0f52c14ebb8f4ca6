/* Where a polynomial, given by its Bernstein coefficients on [0, 1], first falls through zero. */
#ifndef CONTACT_MATH_BERNSTEIN_H
#define CONTACT_MATH_BERNSTEIN_H

enum { BERNSTEIN_MOST = 13 }; /* coefficients */

/* A bracket of that place, in which the polynomial and `offset` have no other change of sign; low =
 * INFINITY: it falls nowhere. */
struct bernstein_fall {
    double low, high, offset;
};

/* What is known of the polynomial is known to `noise`: a dip below zero that is not deeper is none, a deeper
 * one begins where it passes that; unless the end is not above zero. */
struct bernstein_fall bernstein_first_fall(const double *coefficients, int count, double noise);

/* The place itself, to rounding. */
double bernstein_root(const double *coefficients, int count, struct bernstein_fall fall);

/* Makes them those of the polynomial between two places of [0, 1]. */
void bernstein_restrict(double *coefficients, int count, double from, double to);

double bernstein_at(const double *coefficients, int count, double place);

#endif
