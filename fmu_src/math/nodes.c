#include "math/nodes.h"
#include "math/compiler.h"

enum { BLOCK = 2 * LANES }; /* values that stay in registers */

/* Uses differences from the first value, so that a function that hardly changes loses no digits. */
void nodal_coefficients(const double *values, double *a)
{
    nodal_values grown;
    for (int j = 0; j < LOBATTO_MAX; ++j) {
        grown[j] = values[j] - values[0];
    }
    combine_rows(a, grown, LOBATTO_MAX, NODAL_RULE->monomial, LOBATTO_MAX, LOBATTO_MAX);
    a[0] += values[0];
}

void nodal_values_of(const double *a, double *values)
{
    for (int i = 0; i < LOBATTO_MAX; i += BLOCK) {
        const double2 *at = (const double2 *)(NODAL_RULE->node + i);
        double2 low = {0.0};
        double2 high = {0.0};
        for (int k = LOBATTO_MAX - 1; k >= 0; --k) {
            low = low * at[0] + a[k];
            high = high * at[1] + a[k];
        }
        double2 *out = (double2 *)(values + i);
        out[0] = low;
        out[1] = high;
    }
}

double nodal_slope(const double *a, double s)
{
    double sum = 0.0;
    for (int k = LOBATTO_MAX - 1; k >= 1; --k) {
        sum = sum * (s - 1.0) + k * a[k];
    }
    return sum;
}

void nodal_derivatives(const double *a, double s, double out[4])
{
    const double sigma = s - 1.0;
    double value = 0.0;
    double first = 0.0;
    double second = 0.0; /* half the second derivative */
    double third = 0.0;  /* a sixth of the third derivative */
    for (int k = LOBATTO_MAX - 1; k >= 0; --k) {
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

double nodal_integrate(const double *rate, double *sum)
{
    nodal_values now;
    double change = 0.0;
    combine_rows(now, rate, LOBATTO_MAX, NODAL_RULE->integral, LOBATTO_MAX, LOBATTO_MAX);
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        change = larger(fabs(now[i] - sum[i]), change);
        sum[i] = now[i];
    }
    return change;
}

double nodal_integral(const double *a, double s)
{
    double above = 0.0;
    double below = 0.0;
    for (int k = LOBATTO_MAX - 1; k >= 0; --k) {
        above = above * (s - 1.0) + a[k] / (k + 1);
        below = a[k] / (k + 1) - below;
    }
    return above * (s - 1.0) + below;
}

double nodal_integral_to(const double *sum, const double *rate, double s)
{
    if (s == 2.0) {
        return sum[LOBATTO_MAX - 1];
    }
    nodal_values a;
    nodal_coefficients(rate, a);
    return nodal_integral(a, s);
}

double nodal_tail(const double *values)
{
    double last[2] = {0.0, 0.0};
    for (int j = 0; j < LOBATTO_MAX; ++j) {
        const double *of = NODAL_RULE->monomial + j * LOBATTO_MAX + LOBATTO_MAX - 2;
        last[0] += of[0] * values[j];
        last[1] += of[1] * values[j];
    }
    /* sigma^k = 2^(1-k) T_k + ... */
    return ldexp(fmax(fabs(last[0]), fabs(last[1])), 2 - LOBATTO_MAX);
}
