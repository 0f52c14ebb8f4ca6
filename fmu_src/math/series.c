#include <math.h>
#include <string.h>

#include "math/compiler.h"
#include "math/nodes.h"
#include "math/polynomial.h"
#include "math/series.h"

double taylor_multiply(const double *a, const double *b, int order)
{
    double sum = 0.0;
    for (int i = 0; i <= order; ++i) {
        sum += a[i] * b[order - i];
    }
    return sum;
}

void taylor_put(struct two_way *to, int order, double value)
{
    to->row[order] = value;
    to->back[TAYLOR_ORDER - order] = value;
}

/* Four sums, of every fourth term each, need not wait for each other. */
double taylor_product(const double *a, const struct two_way *b, int order)
{
    const double *back = b->back + (TAYLOR_ORDER - order);
    double2 sum[2 * PARTS];
    memset(sum, 0, sizeof sum);
    for (int k = 0; k <= order; k += 2 * PARTS * LANES) {
        for (int l = 0; l < 2 * PARTS; ++l) {
            sum[l] += double2_at(a, k + l * LANES) * double2_at(back, k + l * LANES);
        }
    }
    for (int l = 0; l < PARTS; ++l) {
        sum[l] += sum[l + PARTS];
    }
    return parts_together(sum);
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

void taylor_derivatives(const double *a, int terms, double s, double out[restrict 3])
{
    out[0] = out[1] = out[2] = 0.0;
    for (int i = terms - 1; i >= 0; --i) {
        out[2] = out[2] * s + out[1];
        out[1] = out[1] * s + out[0];
        out[0] = out[0] * s + a[i];
    }
    out[2] *= 2.0;
}

/* Horner's scheme with each product at its worst bounds the series from below, and its slope from above. By
 * these bounds most series either stay above zero or fall all the way, and no further search is needed. */
double taylor_first_fall(const double *a, int terms, double end)
{
    const struct power_sum series = {a, terms};
    double least = 0.0;
    for (int i = terms - 1; i >= 0; --i) {
        least = a[i] + end * (least > 0.0 ? 0.0 : least);
    }
    if (least >= 0.0) {
        return (double)INFINITY;
    }
    double steepest = 0.0;
    for (int i = terms - 1; i > 0; --i) {
        steepest = i * a[i] + end * (steepest < 0.0 ? 0.0 : steepest);
    }
    if (a[0] > 0.0 && steepest < 0.0) {
        struct root_bracket_end high = {.s = end};
        power_sum_and_slope(&series, end, &high.value, &high.slope);
        return high.value > 0.0 ? (double)INFINITY
                                : root_between(power_sum_and_slope, &series,
                                               (struct root_bracket_end){0.0, a[0], a[1]}, high);
    }
    double of[TAYLOR_TERMS];
    double power = 1.0;
    for (int i = 0; i < terms; ++i) {
        of[i] = a[i] * power;
        power *= end;
    }
    bernstein_from_powers(of, terms);
    const struct bernstein_fall fall = bernstein_first_fall(of, terms, 0.0);
    return fall.low < (double)INFINITY
               ? root_in_bracket(power_sum_and_slope, &series, fall.low * end, fall.high * end)
               : (double)INFINITY;
}
