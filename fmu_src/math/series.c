#include <math.h>

#include "math/series.h"

double taylor_multiply(const double *a, const double *b, int order)
{
    double sum = 0.0;
    for (int i = 0; i <= order; ++i) {
        sum += a[i] * b[order - i];
    }
    return sum;
}

double taylor_root(const double *s, const double *r, int order)
{
    if (order == 0) {
        return sqrt(s[0]);
    }
    double sum = s[order];
    for (int i = 1; i < order; ++i) {
        sum -= r[i] * r[order - i];
    }
    return sum / (2.0 * r[0]);
}

/* a p' = exponent a' p, order by order. */
double taylor_power(const double *a, double exponent, const double *p, int order)
{
    if (order == 0) {
        return pow(a[0], exponent);
    }
    double sum = 0.0;
    for (int i = 1; i <= order; ++i) {
        sum += (exponent * i - (order - i)) * a[i] * p[order - i];
    }
    return sum / (order * a[0]);
}

double taylor_divide(const double *a, const double *b, const double *q, int order)
{
    double sum = a[order];
    for (int i = 1; i <= order; ++i) {
        sum -= b[i] * q[order - i];
    }
    return sum / b[0];
}

/* The even and the odd coefficients make two sums, so that one need not wait for the other. */
double taylor_at(const double *a, int terms, double s)
{
    const double square = s * s;
    double even = 0.0;
    double odd = terms % 2 == 0 ? a[terms - 1] : 0.0;
    for (int i = (terms - 1) / 2 * 2; i > 0; i -= 2) {
        even = even * square + a[i];
        odd = odd * square + a[i - 1];
    }
    return even * square + a[0] + odd * s;
}

void taylor_derivatives(const double *a, int terms, double s, double out[3])
{
    out[0] = out[1] = out[2] = 0.0;
    for (int i = terms - 1; i >= 0; --i) {
        out[2] = out[2] * s + 2.0 * out[1];
        out[1] = out[1] * s + out[0];
        out[0] = out[0] * s + a[i];
    }
}

void taylor_root_function(const void *a, double s, double *value, double *slope)
{
    double of[3];
    taylor_derivatives(a, TAYLOR_TERMS, s, of);
    *value = of[0];
    *slope = of[1];
}

double taylor_integral(const double *a, int terms, double s)
{
    double sum = 0.0;
    for (int i = terms - 1; i >= 0; --i) {
        sum = sum * s + a[i] / (i + 1);
    }
    return sum * s;
}
