#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "math/compiler.h"
#include "math/polynomial.h"

struct polynomial polynomial_derivative(const struct polynomial *p)
{
    struct polynomial d = {{0.0}, p->degree > 0 ? p->degree - 1 : 0};
    for (int i = 1; i <= p->degree; ++i) {
        d.a[i - 1] = i * p->a[i];
    }
    return d;
}

void power_sum_and_slope(const void *sum, double s, double *restrict value, double *restrict slope)
{
    const struct power_sum *of = sum;
    *value = of->a[of->terms - 1];
    *slope = 0.0;
    for (int i = of->terms - 2; i >= 0; --i) {
        *slope = *slope * s + *value;
        *value = *value * s + of->a[i];
    }
}

/* The roots of p between neighbouring extrema (roots of the derivative) and the ends of the interval. */
static int roots_between(const struct polynomial *p, const double *extrema, int extremum_count, double *roots)
{
    int count = 0;
    const struct power_sum sum = {p->a, p->degree + 1};
    struct root_bracket_end low = {0.0, p->a[0], p->a[1]};
    for (int i = 0; i <= extremum_count; ++i) {
        struct root_bracket_end high = {.s = i < extremum_count ? extrema[i] : 1.0};
        power_sum_and_slope(&sum, high.s, &high.value, &high.slope);
        if ((low.value < 0.0 && high.value > 0.0) || (low.value > 0.0 && high.value < 0.0)) {
            roots[count++] = root_between(power_sum_and_slope, &sum, low, high);
        } else if (high.value == 0.0 && i < extremum_count) {
            /* p = 0 at an extremum: keep the sign from the left; the next interval decides. */
            continue;
        }
        low = high;
    }
    return count;
}

/* Writes the changes of sign, which are between those of the derivative, and returns their number. */
static int put_sign_changes(const struct polynomial *p, double roots[POLYNOMIAL_MAX_DEGREE])
{
    double extrema[POLYNOMIAL_MAX_DEGREE];
    const struct polynomial slope = polynomial_derivative(p);
    return p->degree > 0 ? roots_between(p, extrema, put_sign_changes(&slope, extrema), roots) : 0;
}

int polynomial_add_sign_changes(const struct polynomial *p, double *sorted, int count)
{
    double roots[POLYNOMIAL_MAX_DEGREE];
    const int found = put_sign_changes(p, roots);
    for (int i = 0; i < found; ++i) {
        int at = count + i;
        for (; at > 0 && sorted[at - 1] > roots[i]; --at) {
            sorted[at] = sorted[at - 1];
        }
        sorted[at] = roots[i];
    }
    return count + found;
}

/* Longest step, relative to s, after which convergence is predicted instead of tested. */
static const double SHORT_STEP = 1e-8;

/* Where a step of Newton's method leaves the bracket, the root is often close to the end that the step
 * passes. The step is then reflected there, to the middle of the bracket at most. Unless the bracket has
 * become half as wide since the last step that left it, it is halved instead. */
static double root_from(root_function *f, const void *data, double low, double high, double rising, double s)
{
    double last = 0.0;               /* length of the last step of Newton's method, 0: there was none */
    double width = (double)INFINITY; /* of the bracket when a step last left it */
    /* About 1100 halvings lead to the smallest double, and between two of them there may be two steps of
     * Newton's method, which usually needs a handful in all. */
    for (int i = 0; i < 3600; ++i) {
        double value;
        double slope;
        f(data, s, &value, &slope);
        if (value == 0.0) {
            return s;
        }
        if (rising * value < 0.0) {
            low = s;
        } else {
            high = s;
        }
        double next = s - value / slope;
        const double step = fabs(next - s);
        if (step <= DBL_EPSILON * s) {
            return s; /* converged; s is now an end of the bracket, so bisection would leave it */
        }
        const bool inside = next > low && next < high;
        if (inside && step <= SHORT_STEP * next &&
            step * step * step <= 0.25 * DBL_EPSILON * next * last * last) {
            return next; /* each step squares the error: the following one would be step^3 / last^2 */
        }
        last = inside ? step : 0.0;
        if (!inside) {
            const double middle = 0.5 * (low + high);
            const bool above = next >= high;
            const double end = above ? high : low;
            const double most = end * (above ? 1.0 - DBL_EPSILON : 1.0 + DBL_EPSILON);
            next = 2.0 * end - next;
            next = (next < most) != above ? most : next;
            next = high - low <= 0.5 * width && (next > middle) == above && next > low ? next : middle;
            width = high - low;
        }
        if (next <= low || next >= high) {
            return next;
        }
        s = next;
    }
    return s;
}

double root_in_bracket(root_function *f, const void *data, double low, double high)
{
    double value;
    double slope;
    f(data, low, &value, &slope);
    return root_from(f, data, low, high, value < 0.0 ? 1.0 : -1.0, 0.5 * (low + high));
}

/* Between two extrema, as of an oscillation, the guess is that of half a cosine. Else Newton's method solves
 * the cubic to LEAST_MOVE, as long as it stays inside. It begins at the secant, or at the far end if the
 * function leaves zero at first; from there it may halve x many times. */
enum { MOST_MOVES_OF_GUESS = 12 };
static const double LEAST_MOVE = 1e-3;

double root_guess(struct root_bracket_end low, struct root_bracket_end high)
{
    const double length = high.s - low.s;
    const double slope = length * low.slope;
    const double rise = high.value - low.value;
    const double third = length * (low.slope + high.slope) - 2.0 * rise;
    const double second = rise - slope - third;
    const bool extrema = low.slope == 0.0 && high.slope == 0.0;
    double x = extrema              ? acos((low.value + high.value) / rise) / PI
               : slope * rise > 0.0 ? -low.value / rise
                                    : 1.0;
    bool moves = !extrema;
    for (int i = 0; moves && i < MOST_MOVES_OF_GUESS; ++i) {
        const double value = low.value + x * (slope + x * (second + x * third));
        const double next = x - value / (slope + x * (2.0 * second + 3.0 * x * third));
        const bool inside = next > 0.0 && next < 1.0;
        moves = inside && fabs(next - x) > LEAST_MOVE * x;
        x = inside ? next : x;
    }
    const double guess = low.s + x * length;
    return guess > low.s && guess < high.s ? guess : 0.5 * (low.s + high.s);
}

double root_between(root_function *f, const void *data, struct root_bracket_end low,
                    struct root_bracket_end high)
{
    return root_from(f, data, low.s, high.s, low.value < 0.0 ? 1.0 : -1.0, root_guess(low, high));
}

bool root_may_dip(const struct root_place place[3])
{
    const double left = place[1].s - place[0].s;
    const double right = place[2].s - place[1].s;
    const double value = place[1].value;
    const double fall = (value - place[0].value) / left;
    const double rise = (place[2].value - value) / right;
    if (!(value > 0.0 && fall < 0.0 && rise > 0.0)) {
        return false;
    }
    const double bend = (rise - fall) / (left + right);
    const double slope = (fall * right + rise * left) / (left + right);
    return 0.25 * slope * slope / bend > 0.5 * value;
}

/* This is the largest number of bisections: afterwards an interval of [0, 1] is 1e-12 long. */
enum { DEPTH = 40 };

/* This struct holds the Bernstein coefficients `of` of the polynomial on [low, low + width]. */
struct part {
    double low, width;
    double of[BERNSTEIN_MOST];
};

/* Halves a part: `left` becomes its first half; the second half is returned. */
static struct part split(struct part *left, int count)
{
    struct part right = *left;
    left->width *= 0.5;
    right.width = left->width;
    right.low += right.width;
    bernstein_restrict(left->of, count, 0.0, 0.5);
    bernstein_restrict(right.of, count, 0.5, 1.0);
    return right;
}

/* Returns the changes of sign among the coefficients. Their number exceeds that of the roots by an even
 * number or zero (Descartes). */
static int changes_of_sign(const double *of, int count)
{
    int changes = 0;
    for (int i = 1; i < count; ++i) {
        changes += (of[i - 1] > 0.0) != (of[i] > 0.0);
    }
    return changes;
}

/* Returns the first fall through zero of the polynomial plus an offset. */
static struct bernstein_fall first_fall_of_sum(const double *coefficients, int count, double offset)
{
    struct part open[DEPTH + 1]; /* parts still to be searched; the first part stands last */
    int last = 0;
    open[0] = (struct part){.low = 0.0, .width = 1.0};
    for (int i = 0; i < count; ++i) {
        open[0].of[i] = coefficients[i] + offset;
    }
    while (last >= 0) {
        struct part *now = &open[last];
        const int changes = changes_of_sign(now->of, count);
        const bool falls = now->of[0] > 0.0 && !(now->of[count - 1] > 0.0);
        const bool none = changes == 0 || (changes == 1 && !falls);
        if (!none && (changes == 1 || (last == DEPTH && falls))) {
            return (struct bernstein_fall){now->low, now->low + now->width, offset};
        }
        if (none || last == DEPTH) {
            last -= 1;
        } else {
            const struct part right = split(now, count);
            open[last + 1] = *now;
            open[last] = right;
            last += 1;
        }
    }
    return (struct bernstein_fall){(double)INFINITY, (double)INFINITY, offset};
}

struct bernstein_fall bernstein_first_fall(const double *coefficients, int count, double noise)
{
    const struct bernstein_fall deep = first_fall_of_sum(coefficients, count, noise);
    const bool stays = coefficients[0] > 0.0 && !(coefficients[count - 1] > 0.0);
    return stays && !(deep.low < (double)INFINITY) ? first_fall_of_sum(coefficients, count, 0.0) : deep;
}

/* This struct holds a polynomial's Bernstein coefficients and an offset, as the context of a
 * root_function. */
struct bernstein_sum {
    const double *coefficients;
    int count;
    double offset;
};

/* This function uses de Casteljau's scheme. All weights are positive, so that no digits are lost but those of
 * the sum itself. */
static void bernstein_and_slope(const void *data, double s, double *value, double *slope)
{
    const struct bernstein_sum *sum = data;
    double row[BERNSTEIN_MOST];
    memcpy(row, sum->coefficients, (size_t)sum->count * sizeof *row);
    *slope = 0.0;
    for (int left = sum->count - 1; left > 0; --left) {
        *slope = (sum->count - 1) * (row[1] - row[0]); /* right in the last round */
        for (int i = 0; i < left; ++i) {
            row[i] = (1.0 - s) * row[i] + s * row[i + 1];
        }
    }
    *value = row[0] + sum->offset;
}

double bernstein_root(const double *coefficients, int count, struct bernstein_fall fall)
{
    const struct bernstein_sum sum = {coefficients, count, fall.offset};
    return root_from(bernstein_and_slope, &sum, fall.low, fall.high, -1.0, 0.5 * (fall.low + fall.high));
}

/* This function uses de Casteljau's scheme, first up to `to`, then from `from` on. */
void bernstein_restrict(double *coefficients, int count, double from, double to)
{
    const double start = to > 0.0 ? from / to : 0.0;
    for (int k = 1; k < count && to < 1.0; ++k) {
        for (int i = count - 1; i >= k; --i) {
            coefficients[i] = (1.0 - to) * coefficients[i - 1] + to * coefficients[i];
        }
    }
    for (int k = 1; k < count && start > 0.0; ++k) {
        for (int i = 0; i + k < count; ++i) {
            coefficients[i] = (1.0 - start) * coefficients[i] + start * coefficients[i + 1];
        }
    }
}

/* a[k] divided by binomial(n, k) is summed as in Pascal's triangle. */
void bernstein_from_powers(double *coefficients, int count)
{
    const int n = count - 1;
    double scale = 1.0;
    for (int k = 1; k < count; ++k) {
        scale *= (double)k / (n - k + 1);
        coefficients[k] *= scale;
    }
    for (int k = 1; k < count; ++k) {
        for (int i = n; i >= k; --i) {
            coefficients[i] += coefficients[i - 1];
        }
    }
}
