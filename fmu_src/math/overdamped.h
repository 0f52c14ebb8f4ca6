/*
 * The oscillator y'' + damping_rate y' + y = 0 near critical damping and beyond, where y has one extremum at
 * most:
 *
 *   y = by_slower exp(-slower s) + by_faster exp(-faster s)
 *   slower faster = 1,   slower + faster = damping_rate
 *
 * or a dashpot without a spring, y'' + y' = drift: slower = 0, faster = 1, and drift s added.
 *
 * y and each derivative keep full relative accuracy however far they have decayed, except near their zeros.
 * Variable s >= 0: radians of the undamped oscillator, or decay times of the dashpot.
 */
#ifndef CONTACT_MATH_OVERDAMPED_H
#define CONTACT_MATH_OVERDAMPED_H

#include <stdbool.h>

#include "math/oscillator.h"

enum { OVERDAMPED_DERIVATIVES = 4 };

struct overdamped {
    struct oscillator oscillator; /* omega2 1, or 0 by a dashpot alone */
    double y, y_rate;             /* at the start */
    bool distinct;                /* whether the two rates differ enough to be summed separately */
    double slower, faster;
    double by_slower, by_faster;
    double drift;
    /* no quantity has two extrema within it; INFINITY from critical damping on */
    double half_period;
};

struct overdamped overdamped_of(double damping_rate, double y, double y_rate);
struct overdamped overdamped_of_dashpot(double y, double y_rate, double drift);

/* y and its derivatives. */
void overdamped_at(const struct overdamped *d, double s, double y[1 + OVERDAMPED_DERIVATIVES]);

/* How much y and y' have changed since the start. */
struct overdamped_change {
    double y, y_rate;
};

struct overdamped_change overdamped_since(const struct overdamped *d, double s);

/* The s at which the derivative of an order is zero, as each is once at most: negative before the start,
 * INFINITY nowhere. Approximate where it is so close to critical damping that y oscillates. */
double overdamped_zero(const struct overdamped *d, int order);

#endif
