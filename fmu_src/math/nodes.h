/* Functions that are known at the nodes of a Lobatto rule. */
#ifndef CONTACT_MATH_NODES_H
#define CONTACT_MATH_NODES_H

#include "math/compiler.h"
#include "math/node_tables.h"
#include "math/vec3.h"

/* The functions of this file are known at the twelve Lobatto nodes of a step, s in [0, 2]. Their coefficients
 * are those of polynomials of s - 1. */

typedef double nodal_values[LOBATTO_MAX];

#define NODAL_RULE (&lobatto[LOBATTO_TWELVE])

/* Returns the s of a node. */
static inline double nodal_place(int i)
{
    return 1.0 + NODAL_RULE->node[i];
}

/* Returns the weight of a node in the integral over the step. */
static inline double nodal_weight(int i)
{
    return NODAL_RULE->integral[i * LOBATTO_MAX + LOBATTO_MAX - 1];
}

/* Convert nodal values to coefficients, and coefficients to nodal values. */
void nodal_coefficients(const double *values, double *a);
void nodal_values_of(const double *a, double *values);

/* Return the slope of a polynomial at s, and its value with three derivatives. Where the value alone is
 * needed, taylor_at (math/series.h) returns it. It takes s - 1 as its argument. */
double nodal_slope(const double *a, double s);
void nodal_derivatives(const double *a, double s, double out[4]);

/* Integrals of values at the nodes from the start to each node, into `sum`; returns the largest change of
 * `sum`. */
double nodal_integrate(const double *rate, double *sum);

/* Returns the integral of `rate` to s, where `sum` holds the integrals to the nodes. At the step's end it has
 * the order of the nodes' quadrature. */
double nodal_integral_to(const double *sum, const double *rate, double s);

/* Returns the integral from 0 to s of the polynomial with coefficients a. */
double nodal_integral(const double *a, double s);

/* The larger of the last two Chebyshev coefficients: an estimate of the truncation error where the
 * coefficients decrease. */
double nodal_tail(const double *values);

#endif
