/* Functions known at the Lobatto nodes of a step, s in [0, 2]; as coefficients they are polynomials of s -
 * 1. */
#ifndef CONTACT_MATH_NODAL_VALUES_H
#define CONTACT_MATH_NODAL_VALUES_H

#include "math/compiler.h"
#include "math/lobatto.h"
#include "math/vec3.h"

typedef double nodal_values[LOBATTO_MAX];

static inline double2 double2_at(const double *row, int i)
{
    return *(const double2 *)(row + i);
}

static inline void double2_put(double *row, int i, double2 values)
{
    *(double2 *)(row + i) = values;
}

struct nodal_vec3 {
    nodal_values x, y, z;
};

static inline void nodal_put_vec3(struct nodal_vec3 *row, int node, struct vec3 a)
{
    row->x[node] = a.x;
    row->y[node] = a.y;
    row->z[node] = a.z;
}

/* From values at the nodes to coefficients, and back. */
void nodal_coefficients(const struct lobatto *nodes, const double *values, double *a);
void nodal_values_of(const struct lobatto *nodes, const double *a, double *values);

/* A polynomial of `terms` coefficients at s: its value, its slope, its value with three derivatives. */
double nodal_polynomial_at(const double *a, int terms, double s);
double nodal_slope(const double *a, int terms, double s);
void nodal_derivatives(const double *a, int terms, double s, double out[4]);

/* Of values at the nodes: the integrals from the start to each node; returns the largest change of `sum`. */
double nodal_integrate(const struct lobatto *nodes, const double *rate, double *sum);

/* The integral to s, where `sum` at the nodes is known: exact at the step's end to the order of the nodes'
 * quadrature. */
double nodal_integral_to(const struct lobatto *nodes, const double *sum, const double *rate, double s);

/* The integral from 0 to s of the polynomial with coefficients a. */
double nodal_integral(const double *a, int terms, double s);

/* The larger of the last two Chebyshev coefficients: an estimate of the truncation error where the
 * coefficients decrease. */
double nodal_tail(const struct lobatto *nodes, const double *values);

#endif
