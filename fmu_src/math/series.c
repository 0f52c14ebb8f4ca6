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

/* The even coefficients make a series by t = s^2 and the odd ones another, E + s O. Part l of a sum belongs
 * to one of them, or to both. */
double taylor_at(const double *a, int terms, double s)
{
    double2 sum[PARTS];
    for (int l = 0; l < PARTS; ++l) {
        sum[l] = part_of_pair(terms % 2 != 0 ? a[terms - 1] : 0.0, 0.0, l);
        for (int i = terms / 2 * 2 - 2; i >= 0; i -= 2) {
            sum[l] = sum[l] * (s * s) + double2_at(a, i + l);
        }
        sum[l] *= part_of_pair(1.0, s, l);
    }
    return parts_together(sum);
}

void taylor_derivatives(const double *a, int terms, double s, double out[restrict 3])
{
    const double t = s * s;
    double2 value[PARTS], slope[PARTS], bend[PARTS];
    for (int l = 0; l < PARTS; ++l) {
        double2 sum = part_of_pair(terms % 2 != 0 ? a[terms - 1] : 0.0, 0.0, l);
        double2 first = part_of_pair(0.0, 0.0, l); /* dE/dt and dO/dt */
        double2 second = first;                    /* half of their derivatives */
        for (int i = terms / 2 * 2 - 2; i >= 0; i -= 2) {
            second = second * t + first;
            first = first * t + sum;
            sum = sum * t + double2_at(a, i + l);
        }
        value[l] = sum * part_of_pair(1.0, s, l);
        slope[l] = first * part_of_pair(2.0 * s, 2.0 * t, l) + sum * part_of_pair(0.0, 1.0, l);
        bend[l] = first * part_of_pair(2.0, 6.0 * s, l) + second * part_of_pair(8.0 * t, 8.0 * s * t, l);
    }
    out[0] = parts_together(value);
    out[1] = parts_together(slope);
    out[2] = parts_together(bend);
}

/* A series that falls by so many times its first coefficient falls like a power of s, such as the gap of a
 * body that its neighbour begins to push. The tangent of its fall against s, both by their logarithms, then
 * leads to the root, where the cubic of root_between would need a dozen steps of Newton's method. */
static const double AS_A_POWER = 0.01;

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
    if (a[0] > 0.0 && steepest <= 0.0) {
        struct root_bracket_end low = {0.0, a[0], a[1]};
        struct root_bracket_end high = {.s = end};
        power_sum_and_slope(&series, end, &high.value, &high.slope);
        if (high.value > 0.0) {
            return (double)INFINITY;
        }
        const double fallen = a[0] - high.value;
        if (a[0] < AS_A_POWER * fallen && high.slope < 0.0) {
            struct root_bracket_end near = {.s = end * pow(a[0] / fallen, fallen / (-end * high.slope))};
            power_sum_and_slope(&series, near.s, &near.value, &near.slope);
            *(near.value > 0.0 ? &low : &high) = near;
        }
        return root_between(power_sum_and_slope, &series, low, high);
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
