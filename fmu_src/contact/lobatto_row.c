#include "contact/lobatto_row.h"

void row_put_vec3(struct vec3_row *row, int node, struct vec3 a)
{
    row->x[node] = a.x;
    row->y[node] = a.y;
    row->z[node] = a.z;
}

/* By the differences from the first value, which keep the digits of a function that hardly changes. */
void row_coefficients(const double *values, double *a)
{
    for (int k = 0; k < LOBATTO_POINTS; ++k) {
        a[k] = 0.0;
    }
    for (int j = 1; j < LOBATTO_POINTS; ++j) {
        const double value = values[j] - values[0];
        for (int k = 0; k < LOBATTO_POINTS; ++k) {
            a[k] += lobatto_monomial[j][k] * value;
        }
    }
    a[0] += values[0];
}

void row_at_nodes(const double *a, double *values)
{
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        values[i] = 0.0;
    }
    for (int k = LOBATTO_POINTS - 1; k >= 0; --k) {
        for (int i = 0; i < LOBATTO_POINTS; ++i) {
            values[i] = values[i] * lobatto_node[i] + a[k];
        }
    }
}

double row_at(const double *a, double s)
{
    double sum = 0.0;
    for (int k = LOBATTO_POINTS - 1; k >= 0; --k) {
        sum = sum * (s - 1.0) + a[k];
    }
    return sum;
}

double row_slope(const double *a, double s)
{
    double sum = 0.0;
    for (int k = LOBATTO_POINTS - 1; k >= 1; --k) {
        sum = sum * (s - 1.0) + k * a[k];
    }
    return sum;
}

void row_derivatives(const double *a, int terms, double s, double out[4])
{
    out[0] = out[1] = out[2] = out[3] = 0.0;
    for (int k = terms - 1; k >= 0; --k) {
        for (int i = 3; i >= 1; --i) {
            out[i] = out[i] * (s - 1.0) + i * out[i - 1];
        }
        out[0] = out[0] * (s - 1.0) + a[k];
    }
}

enum { BLOCK = 4 }; /* sums that stay in registers */

/* Four nodes' integrals; returns the larger of `change` and theirs. */
static double integrate_block(const double *rate, double *sum, int first, double change)
{
    double now[BLOCK] = {0.0, 0.0, 0.0, 0.0};
    for (int j = 0; j < LOBATTO_POINTS; ++j) {
        const double *by = &lobatto_integral[j][first];
        now[0] += by[0] * rate[j];
        now[1] += by[1] * rate[j];
        now[2] += by[2] * rate[j];
        now[3] += by[3] * rate[j];
    }
    for (int i = 0; i < BLOCK; ++i) {
        const double moved = fabs(now[i] - sum[first + i]);
        change = moved > change ? moved : change;
        sum[first + i] = now[i];
    }
    return change;
}

double row_integrate_one(const double *rate, double *sum)
{
    double change = 0.0;
    for (int first = 0; first < LOBATTO_POINTS; first += BLOCK) {
        change = integrate_block(rate, sum, first, change);
    }
    return change;
}

/* In a plane, n and H have components that stay zero. */
static double integrate_component(const double *rate, double *sum)
{
    for (int j = 0; j < LOBATTO_POINTS; ++j) {
        if (rate[j] != 0.0 || sum[j] != 0.0) {
            return row_integrate_one(rate, sum);
        }
    }
    return 0.0;
}

double row_integrate(const struct vec3_row *rate, struct vec3_row *sum)
{
    const double x = integrate_component(rate->x, sum->x);
    const double y = integrate_component(rate->y, sum->y);
    return fmax(fmax(x, y), integrate_component(rate->z, sum->z));
}

double row_integral(const double *a, double s)
{
    double above = 0.0;
    double below = 0.0;
    for (int k = LOBATTO_POINTS - 1; k >= 0; --k) {
        above = above * (s - 1.0) + a[k] / (k + 1);
        below = a[k] / (k + 1) - below;
    }
    return above * (s - 1.0) + below;
}

static double integral_of(const double *sum, const double *rate, double s)
{
    if (s == 2.0) {
        return sum[LOBATTO_POINTS - 1];
    }
    lobatto_row a;
    row_coefficients(rate, a);
    return row_integral(a, s);
}

struct vec3 row_integral3(const struct vec3_row *sum, const struct vec3_row *rate, double s)
{
    return vec3_make(integral_of(sum->x, rate->x, s), integral_of(sum->y, rate->y, s),
                     integral_of(sum->z, rate->z, s));
}

static double tail(const double *values)
{
    double last[2] = {0.0, 0.0};
    for (int j = 0; j < LOBATTO_POINTS; ++j) {
        last[0] += lobatto_monomial[j][LOBATTO_POINTS - 1] * values[j];
        last[1] += lobatto_monomial[j][LOBATTO_POINTS - 2] * values[j];
    }
    /* sigma^k = 2^(1-k) T_k + ... */
    return ldexp(fmax(fabs(last[0]), fabs(last[1])), 2 - LOBATTO_POINTS);
}

double row_tail3(const struct vec3_row *values)
{
    return fmax(tail(values->x), fmax(tail(values->y), tail(values->z)));
}
