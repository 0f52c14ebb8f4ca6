#include "math/series.h"

double taylor_dot(const struct taylor_vec3 *a, const struct taylor_vec3 *b, int order)
{
    double sum = 0.0;
    for (int i = 0; i <= order; ++i) {
        sum += vec3_dot(a->at[i], b->at[order - i]);
    }
    return sum;
}

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

struct vec3 taylor_divide_vec3(const struct taylor_vec3 *a, const double *b, const struct taylor_vec3 *q,
                               int order)
{
    struct vec3 sum = a->at[order];
    for (int i = 1; i <= order; ++i) {
        sum = vec3_axpy(sum, -b[i], q->at[order - i]);
    }
    return vec3_scale(1.0 / b[0], sum);
}

double taylor_at(const double *a, int terms, double s)
{
    double sum = 0.0;
    for (int i = terms - 1; i >= 0; --i) {
        sum = sum * s + a[i];
    }
    return sum;
}

struct vec3 taylor_at_vec3(const struct taylor_vec3 *a, int terms, double s)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int i = terms - 1; i >= 0; --i) {
        sum = vec3_axpy(a->at[i], s, sum);
    }
    return sum;
}

double taylor_integral(const double *a, int terms, double s)
{
    double sum = 0.0;
    for (int i = terms - 1; i >= 0; --i) {
        sum = sum * s + a[i] / (i + 1);
    }
    return sum * s;
}
