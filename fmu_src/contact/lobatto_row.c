#include "contact/lobatto_row.h"

enum { BLOCK = 4 }; /* sums that stay in registers */

/* sum[i] = sum over j of matrix[j points + i] values[j], for four i */
static void multiply_block(int points, const double *matrix, const double *values, number_pair sum[2])
{
    number_pair low = {0.0, 0.0};
    number_pair high = {0.0, 0.0};
    for (int j = 0; j < points; j += 2) { /* two, for half the loop's own work */
        const double *by = matrix + j * points;
        const double *then = by + points;
        low += pair_at(by, 0) * values[j];
        high += pair_at(by, 2) * values[j];
        low += pair_at(then, 0) * values[j + 1];
        high += pair_at(then, 2) * values[j + 1];
    }
    sum[0] = low;
    sum[1] = high;
}

/* By the differences from the first value, which keep the digits of a function that hardly changes. */
void row_coefficients(const struct lobatto *nodes, const double *values, double *a)
{
    lobatto_row grown;
    for (int j = 0; j < nodes->points; ++j) {
        grown[j] = values[j] - values[0];
    }
    multiply_block(nodes->points, nodes->monomial, grown, (number_pair *)a);
    for (int k = BLOCK; k < nodes->points; k += BLOCK) {
        multiply_block(nodes->points, nodes->monomial + k, grown, (number_pair *)(a + k));
    }
    a[0] += values[0];
}

void row_at_nodes(const struct lobatto *nodes, const double *a, double *values)
{
    for (int i = 0; i < nodes->points; i += BLOCK) {
        const number_pair *at = (const number_pair *)(nodes->node + i);
        number_pair low = {0.0, 0.0};
        number_pair high = {0.0, 0.0};
        for (int k = nodes->points - 1; k >= 0; --k) {
            low = low * at[0] + a[k];
            high = high * at[1] + a[k];
        }
        number_pair *out = (number_pair *)(values + i);
        out[0] = low;
        out[1] = high;
    }
}

double row_at(const double *a, int terms, double s)
{
    double sum = 0.0;
    for (int k = terms - 1; k >= 0; --k) {
        sum = sum * (s - 1.0) + a[k];
    }
    return sum;
}

double row_slope(const double *a, int terms, double s)
{
    double sum = 0.0;
    for (int k = terms - 1; k >= 1; --k) {
        sum = sum * (s - 1.0) + k * a[k];
    }
    return sum;
}

void row_derivatives(const double *a, int terms, double s, double out[4])
{
    const double sigma = s - 1.0;
    double value = 0.0;
    double first = 0.0;
    double second = 0.0; /* half of it */
    double third = 0.0;  /* a sixth */
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

double row_integrate(const struct lobatto *nodes, const double *rate, double *sum)
{
    double change = 0.0;
    for (int i = 0; i < nodes->points; i += BLOCK) {
        number_pair now[2];
        multiply_block(nodes->points, nodes->integral + i, rate, now);
        for (int k = 0; k < BLOCK; ++k) {
            const double moved = fabs(now[k / 2][k % 2] - sum[i + k]);
            change = moved > change ? moved : change;
        }
        pair_put(sum, i, now[0]);
        pair_put(sum, i + 2, now[1]);
    }
    return change;
}

double row_integral(const double *a, int terms, double s)
{
    double above = 0.0;
    double below = 0.0;
    for (int k = terms - 1; k >= 0; --k) {
        above = above * (s - 1.0) + a[k] / (k + 1);
        below = a[k] / (k + 1) - below;
    }
    return above * (s - 1.0) + below;
}

double row_integral_to(const struct lobatto *nodes, const double *sum, const double *rate, double s)
{
    if (s == 2.0) {
        return sum[nodes->points - 1];
    }
    lobatto_row a;
    row_coefficients(nodes, rate, a);
    return row_integral(a, nodes->points, s);
}

double row_tail(const struct lobatto *nodes, const double *values)
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
