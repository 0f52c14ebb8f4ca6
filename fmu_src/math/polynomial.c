#include "math/polynomial.h"

#include <math.h>
#include <stdbool.h>

#include "math/root.h"

double polynomial_at(const struct polynomial *p, double s)
{
    double value = p->a[p->degree];
    for (int i = p->degree - 1; i >= 0; --i) {
        value = value * s + p->a[i];
    }
    return value;
}

struct polynomial polynomial_derivative(const struct polynomial *p)
{
    struct polynomial d = {{0.0}, p->degree > 0 ? p->degree - 1 : 0};
    for (int i = 1; i <= p->degree; ++i) {
        d.a[i - 1] = i * p->a[i];
    }
    return d;
}

struct polynomial polynomial_add(const struct polynomial *a, double factor, const struct polynomial *b)
{
    struct polynomial sum = {{0.0}, a->degree > b->degree ? a->degree : b->degree};
    for (int i = 0; i <= sum.degree; ++i) {
        sum.a[i] = (i <= a->degree ? a->a[i] : 0.0) + factor * (i <= b->degree ? b->a[i] : 0.0);
    }
    return sum;
}

struct polynomial polynomial_multiply(const struct polynomial *a, const struct polynomial *b)
{
    struct polynomial product = {{0.0}, a->degree + b->degree};
    for (int i = 0; i <= a->degree; ++i) {
        for (int j = 0; j <= b->degree; ++j) {
            product.a[i + j] += a->a[i] * b->a[j];
        }
    }
    return product;
}

static void value_and_slope(const void *data, double s, double *value, double *slope)
{
    const struct polynomial *p = data;
    *value = p->a[p->degree];
    *slope = 0.0;
    for (int i = p->degree - 1; i >= 0; --i) {
        *slope = *slope * s + *value;
        *value = *value * s + p->a[i];
    }
}

/* Degree one or two. Without cancellation: one root from b + sign(b) sqrt(b^2 - 4ac), the other one from
 * their product c/a. The extreme must lie beyond zero, else rounding would let a parabola that touches zero
 * cross it. */
static int quadratic_sign_changes(const struct polynomial *p, double *roots)
{
    const double unit = fmax(fabs(p->a[0]), fmax(fabs(p->a[1]), p->degree > 1 ? fabs(p->a[2]) : 0.0));
    const double a = p->degree > 1 ? p->a[2] / unit : 0.0;
    const double b = p->a[1] / unit;
    const double c = p->a[0] / unit;
    if (a != 0.0 && !(a * polynomial_at(p, -0.5 * b / a) < 0.0)) {
        return 0;
    }
    const double q = -0.5 * (b + copysign(sqrt(b * b - 4.0 * a * c), b));
    const double by_a = q / a;
    const double by_c = c / q;
    const double both[2] = {by_a < by_c ? by_a : by_c, by_a < by_c ? by_c : by_a};
    int count = 0;
    for (int i = 0; i < 2; ++i) {
        if (both[i] > 0.0 && both[i] < 1.0) {
            roots[count++] = both[i];
        }
    }
    return count;
}

static int trimmed_degree(const struct polynomial *p)
{
    int degree = p->degree;
    while (degree > 0 && p->a[degree] == 0.0) {
        --degree;
    }
    return degree;
}

/* The roots of p between neighbouring extrema (roots of the derivative) and the ends of the interval. */
static int roots_between(const struct polynomial *p, const double *extrema, int extremum_count, double *roots)
{
    int count = 0;
    struct root_bracket_end low = {0.0, p->a[0], p->a[1]};
    for (int i = 0; i <= extremum_count; ++i) {
        struct root_bracket_end high = {.s = i < extremum_count ? extrema[i] : 1.0};
        value_and_slope(p, high.s, &high.value, &high.slope);
        if ((low.value < 0.0 && high.value > 0.0) || (low.value > 0.0 && high.value < 0.0)) {
            roots[count++] = root_between(value_and_slope, p, low, high);
        } else if (high.value == 0.0 && i < extremum_count) {
            /* p = 0 at an extremum: keep the sign from the left; the next interval decides. */
            continue;
        }
        low = high;
    }
    return count;
}

/* Whether the slope keeps the sign it has at zero, by the size of its terms. */
static bool is_monotone(const struct polynomial *p)
{
    double rest = 0.0;
    for (int i = 2; i <= p->degree; ++i) {
        rest += i * fabs(p->a[i]);
    }
    return fabs(p->a[1]) > (1.0 + 1e-12) * rest; /* whatever the sum's rounding */
}

int polynomial_sign_changes(const struct polynomial *p, double roots[POLYNOMIAL_MAX_DEGREE])
{
    struct polynomial chain[POLYNOMIAL_MAX_DEGREE + 1];
    const int degree = trimmed_degree(p);
    if (degree < 1) {
        return 0;
    }
    int lowest = degree;
    chain[degree] = *p;
    chain[degree].degree = degree;
    while (lowest > 2 && !is_monotone(&chain[lowest])) {
        chain[lowest - 1] = polynomial_derivative(&chain[lowest]);
        --lowest;
    }
    double extrema[POLYNOMIAL_MAX_DEGREE] = {0.0};
    int count = lowest > 2 ? roots_between(&chain[lowest], extrema, 0, roots)
                           : quadratic_sign_changes(&chain[lowest], roots);
    for (int i = lowest + 1; i <= degree; ++i) {
        for (int j = 0; j < count; ++j) {
            extrema[j] = roots[j];
        }
        count = roots_between(&chain[i], extrema, count, roots);
    }
    return count;
}
