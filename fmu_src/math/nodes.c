#include "math/nodes.h"
#include "math/compiler.h"

enum { BLOCK = 2 * LANES }; /* sums that stay in registers */

/* sum[i] = sum over j of matrix[j points + i] values[j], for i of one block */
static void multiply_block(int points, const double *matrix, const double *values, double2 sum[2])
{
    double2 low = {0.0};
    double2 high = {0.0};
    for (int j = 0; j < points; j += 2) { /* two at a time: half the loop's overhead */
        const double *by = matrix + j * points;
        const double *then = by + points;
        low += double2_at(by, 0) * values[j];
        high += double2_at(by, LANES) * values[j];
        low += double2_at(then, 0) * values[j + 1];
        high += double2_at(then, LANES) * values[j + 1];
    }
    sum[0] = low;
    sum[1] = high;
}

/* Uses differences from the first value, so that a function that hardly changes loses no digits. */
void nodal_coefficients(const struct lobatto *nodes, const double *values, double *a)
{
    nodal_values grown;
    for (int j = 0; j < nodes->points; ++j) {
        grown[j] = values[j] - values[0];
    }
    multiply_block(nodes->points, nodes->monomial, grown, (double2 *)a);
    for (int k = BLOCK; k < nodes->points; k += BLOCK) {
        multiply_block(nodes->points, nodes->monomial + k, grown, (double2 *)(a + k));
    }
    a[0] += values[0];
}

void nodal_values_of(const struct lobatto *nodes, const double *a, double *values)
{
    for (int i = 0; i < nodes->points; i += BLOCK) {
        const double2 *at = (const double2 *)(nodes->node + i);
        double2 low = {0.0};
        double2 high = {0.0};
        for (int k = nodes->points - 1; k >= 0; --k) {
            low = low * at[0] + a[k];
            high = high * at[1] + a[k];
        }
        double2 *out = (double2 *)(values + i);
        out[0] = low;
        out[1] = high;
    }
}

double nodal_slope(const double *a, int terms, double s)
{
    double sum = 0.0;
    for (int k = terms - 1; k >= 1; --k) {
        sum = sum * (s - 1.0) + k * a[k];
    }
    return sum;
}

void nodal_derivatives(const double *a, int terms, double s, double out[4])
{
    const double sigma = s - 1.0;
    double value = 0.0;
    double first = 0.0;
    double second = 0.0; /* half the second derivative */
    double third = 0.0;  /* a sixth of the third derivative */
    for (int k = terms - 1; k >= 0; --k) {
        third = third * sigma + second;
        second = second * sigma + first;
        first = first * sigma + value;
        value = value * sigma + a[k];
    }
    out[0] = value;
    out[1] = first;
    out[2] = 2.0 * second;
    out[3] = 6.0 * third;
}

double nodal_integrate(const struct lobatto *nodes, const double *rate, double *sum)
{
    double change = 0.0;
    for (int i = 0; i < nodes->points; i += BLOCK) {
        double now[BLOCK];
        multiply_block(nodes->points, nodes->integral + i, rate, (double2 *)now);
        for (int k = 0; k < BLOCK; ++k) {
            change = larger(fabs(now[k] - sum[i + k]), change);
        }
        double2_put(sum, i, double2_at(now, 0));
        double2_put(sum, i + LANES, double2_at(now, LANES));
    }
    return change;
}

double nodal_integral(const double *a, int terms, double s)
{
    double above = 0.0;
    double below = 0.0;
    for (int k = terms - 1; k >= 0; --k) {
        above = above * (s - 1.0) + a[k] / (k + 1);
        below = a[k] / (k + 1) - below;
    }
    return above * (s - 1.0) + below;
}

double nodal_integral_to(const struct lobatto *nodes, const double *sum, const double *rate, double s)
{
    if (s == 2.0) {
        return sum[nodes->points - 1];
    }
    nodal_values a;
    nodal_coefficients(nodes, rate, a);
    return nodal_integral(a, nodes->points, s);
}

double nodal_tail(const struct lobatto *nodes, const double *values)
{
    const int points = nodes->points;
    double last[2] = {0.0, 0.0};
    for (int j = 0; j < points; ++j) {
        const double *of = nodes->monomial + j * points + points - 2;
        last[0] += of[0] * values[j];
        last[1] += of[1] * values[j];
    }
    /* sigma^k = 2^(1-k) T_k + ... */
    return ldexp(fmax(fabs(last[0]), fabs(last[1])), 2 - points);
}
