/* Functions known at the Lobatto nodes of a step, s in [0, 2]; as coefficients they are polynomials of s - 1. */
#ifndef CONTACT_LOBATTO_ROW_H
#define CONTACT_LOBATTO_ROW_H

#include "contact/lobatto.h"
#include "contact/vec3.h"

typedef double lobatto_row[LOBATTO_MOST];

/* Two numbers that a processor treats at once, each as if it were alone: the digits do not depend on it. */
typedef double number_pair __attribute__((vector_size(16), aligned(8), may_alias));

static inline number_pair pair_at(const double *row, int i)
{
    return *(const number_pair *)(row + i);
}

static inline void pair_put(double *row, int i, number_pair values)
{
    *(number_pair *)(row + i) = values;
}

struct vec3_row {
    lobatto_row x, y, z;
};

static inline void row_put_vec3(struct vec3_row *row, int node, struct vec3 a)
{
    row->x[node] = a.x;
    row->y[node] = a.y;
    row->z[node] = a.z;
}

/* From values at the nodes to coefficients, and back. */
void row_coefficients(const struct lobatto *nodes, const double *values, double *a);
void row_at_nodes(const struct lobatto *nodes, const double *a, double *values);

/* A polynomial of so many coefficients at s, its slope, and with its first three derivatives. */
double row_at(const double *a, int terms, double s);
double row_slope(const double *a, int terms, double s);
void row_derivatives(const double *a, int terms, double s, double out[4]);

/* Of values at the nodes: the integrals from the start to each node; returns the largest change of `sum`. */
double row_integrate(const struct lobatto *nodes, const double *rate, double *sum);

/* The integral to s, where `sum` at the nodes is known: exact at the step's end to the order of the nodes' quadrature. */
double row_integral_to(const struct lobatto *nodes, const double *sum, const double *rate, double s);

/* The integral from 0 to s of the polynomial with coefficients a. */
double row_integral(const double *a, int terms, double s);

/* The larger of the last two coefficients, as those of Chebyshev polynomials: what is left out is of this size at most where
 * the coefficients fall. */
double row_tail(const struct lobatto *nodes, const double *values);

#endif
