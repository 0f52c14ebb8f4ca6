/* Functions known at the Lobatto nodes of a step, s in [0, 2]; as coefficients they are polynomials of s - 1. */
#ifndef CONTACT_LOBATTO_ROW_H
#define CONTACT_LOBATTO_ROW_H

#include "contact/lobatto.h"
#include "contact/vec3.h"

typedef double lobatto_row[LOBATTO_POINTS];

struct vec3_row {
    lobatto_row x, y, z;
};

void row_put_vec3(struct vec3_row *row, int node, struct vec3 a);

/* From values at the nodes to coefficients, and back. */
void row_coefficients(const double *values, double *a);
void row_at_nodes(const double *a, double *values);

/* A polynomial at s, its slope, and with its first three derivatives of the first `terms` coefficients. */
double row_at(const double *a, double s);
double row_slope(const double *a, double s);
void row_derivatives(const double *a, int terms, double s, double out[4]);

/* Of values at the nodes: the integrals from the start to each node; returns the largest change of `sum`. */
double row_integrate_one(const double *rate, double *sum);
double row_integrate(const struct vec3_row *rate, struct vec3_row *sum);

/* The integral to s, where `sum` at the nodes is known: exact at the step's end to the order of the nodes' quadrature. */
struct vec3 row_integral3(const struct vec3_row *sum, const struct vec3_row *rate, double s);

/* The integral from 0 to s of the polynomial with coefficients a. */
double row_integral(const double *a, double s);

/* The largest of the last two coefficients, as those of Chebyshev polynomials: what is left out is of this size at most where
 * the coefficients fall. */
double row_tail3(const struct vec3_row *values);

#endif
