/*
 * y'' + damping y' + y = 0 close to critical damping and beyond, where y turns once at most:
 *
 *   y = by_slower exp(-slower s) + by_faster exp(-faster s),   slower faster = 1,   slower + faster = damping
 *
 * or by a dashpot alone, y'' + y' = drift: slower = 0, faster = 1, and drift s besides.
 *
 * Each quantity comes to digits of its own, however far it has died away: none is a small difference of large ones but where it
 * passes zero. Variable s >= 0, in radians of the undamped oscillator, or decay times of the dashpot.
 */
#ifndef CONTACT_DECAY_H
#define CONTACT_DECAY_H

#include <stdbool.h>

#include "contact/oscillator.h"

enum { DECAY_DERIVATIVES = 4 };

struct decay {
    struct oscillator oscillator; /* square 1, or 0 by a dashpot alone */
    double y, y_rate;             /* at the start */
    bool apart;                   /* the two rates, as they are but close to critical damping */
    double slower, faster;
    double by_slower, by_faster;
    double drift;
    double half_turn; /* no quantity turns twice within it; INFINITY from critical damping on */
};

struct decay decay_of(double damping, double y, double y_rate);
struct decay decay_of_dashpot(double y, double y_rate, double drift);

/* y and its derivatives. */
void decay_at(const struct decay *d, double s, double y[1 + DECAY_DERIVATIVES]);

/* How much y and y' have changed since the start. */
struct decay_change {
    double y, y_rate;
};

struct decay_change decay_since(const struct decay *d, double s);

/* Where its derivative of an order passes zero, as each does once or none; before the start: below zero; INFINITY: nowhere. So close to
 * critical damping that it oscillates, about there. */
double decay_zero(const struct decay *d, int order);

#endif
