#include "contact/bracket.h"

#include <float.h>
#include <math.h>

static double root_from(bracket_function *f, const void *data, double low, double high, double rising,
                        double s)
{
    /* Bisection alone would need about 1100 halvings to reach the smallest double, Newton a handful of steps. */
    for (int i = 0; i < 1200; ++i) {
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
        if (fabs(next - s) <= DBL_EPSILON * s) {
            return s; /* and not on to the other end of the bracket, where s is its new end */
        }
        if (!(next > low && next < high)) {
            next = 0.5 * (low + high);
        }
        if (next <= low || next >= high) {
            return next;
        }
        s = next;
    }
    return s;
}

double bracket_root(bracket_function *f, const void *data, double low, double high)
{
    double value;
    double slope;
    f(data, low, &value, &slope);
    return root_from(f, data, low, high, value < 0.0 ? 1.0 : -1.0, 0.5 * (low + high));
}

/* A few steps of Newton's method from the secant, as long as they stay inside. */
double bracket_guess(struct bracket_end low, struct bracket_end high)
{
    const double length = high.s - low.s;
    const double slope = length * low.slope;
    const double rise = high.value - low.value;
    const double third = length * (low.slope + high.slope) - 2.0 * rise;
    const double second = rise - slope - third;
    double x = -low.value / rise;
    for (int i = 0; i < 3; ++i) {
        const double value = low.value + x * (slope + x * (second + x * third));
        const double next = x - value / (slope + x * (2.0 * second + 3.0 * x * third));
        if (!(next > 0.0 && next < 1.0)) {
            break;
        }
        x = next;
    }
    const double guess = low.s + x * length;
    return guess > low.s && guess < high.s ? guess : 0.5 * (low.s + high.s);
}

double bracket_root_between(bracket_function *f, const void *data, struct bracket_end low,
                            struct bracket_end high)
{
    return root_from(f, data, low.s, high.s, low.value < 0.0 ? 1.0 : -1.0, bracket_guess(low, high));
}
