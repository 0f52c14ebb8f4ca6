#include "math/root.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "math/pi.h"

/* Longest step, relative to s, after which convergence is predicted instead of tested. */
static const double SHORT_STEP = 1e-6;

/*
 * Whether `next` is the root to rounding, so that the function need not be evaluated there. Newton's step
 * misses the root by curvature step^2 / (2 slope), and by the error of the slope, estimated from the secant.
 * Both must be below rounding. False while there is no earlier point (NaN).
 */
static bool is_the_last(struct root_bracket_end now, struct root_bracket_end before, double next)
{
    const double step = next - now.s;
    const double length = now.s - before.s;
    const double bend = (now.slope - before.slope) / length;
    const double slope_error = (now.value - before.value) / length - 0.5 * (now.slope + before.slope);
    return fabs(step) <= SHORT_STEP * next &&
           fabs(bend * step * step) + fabs(slope_error * step) <= 0.25 * DBL_EPSILON * fabs(now.slope * next);
}

static double root_from(root_function *f, const void *data, double low, double high, double rising, double s)
{
    struct root_bracket_end before = {(double)NAN, (double)NAN, (double)NAN};
    /* Bisection alone would need about 1100 halvings to reach the smallest double, Newton a handful of
     * steps. */
    for (int i = 0; i < 1200; ++i) {
        struct root_bracket_end now = {.s = s};
        f(data, s, &now.value, &now.slope);
        if (now.value == 0.0) {
            return s;
        }
        if (rising * now.value < 0.0) {
            low = s;
        } else {
            high = s;
        }
        double next = s - now.value / now.slope;
        if (fabs(next - s) <= DBL_EPSILON * s) {
            return s; /* converged; s is now an end of the bracket, so bisection would leave it */
        }
        if (!(next > low && next < high)) {
            next = 0.5 * (low + high);
        } else if (is_the_last(now, before, next)) {
            return next;
        }
        if (next <= low || next >= high) {
            return next;
        }
        before = now;
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

/* Between two extrema, as of an oscillation: half a cosine. */
static double guess_between_extrema(struct root_bracket_end low, struct root_bracket_end high)
{
    const double mean = (low.value + high.value) / (high.value - low.value);
    return low.s + acos(mean) / PI * (high.s - low.s);
}

/* A few steps of Newton's method from the secant, as long as they stay inside. */
static double guess_by_cubic(struct root_bracket_end low, struct root_bracket_end high)
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
    return low.s + x * length;
}

double root_guess(struct root_bracket_end low, struct root_bracket_end high)
{
    const bool extrema = low.slope == 0.0 && high.slope == 0.0;
    const double guess = extrema ? guess_between_extrema(low, high) : guess_by_cubic(low, high);
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

double root_lowest(root_function *f, const void *data, const struct root_place place[3])
{
    enum { SECTIONS = 80 };                   /* each leaves 0.62 of the bracket before: down to rounding */
    const double golden = 0.3819660112501051; /* (3 - sqrt(5)) / 2 */
    struct root_place low = place[1];
    double from = place[0].s;
    double to = place[2].s;
    for (int i = 0; i < SECTIONS && low.value > 0.0; ++i) {
        const bool later = to - low.s > low.s - from;
        struct root_place trial = {.s = low.s + golden * (later ? to - low.s : from - low.s)};
        double slope;
        f(data, trial.s, &trial.value, &slope);
        const bool lower = trial.value < low.value;
        *(lower == later ? &from : &to) = lower ? low.s : trial.s;
        low = lower ? trial : low;
    }
    return low.s;
}
