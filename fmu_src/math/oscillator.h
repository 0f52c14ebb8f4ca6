/*
 * The linear oscillator x'' + damping_rate x' + omega2 x = load, solved exactly for a polynomial load: x = s
 * + y with
 *   s   the particular solution, a polynomial of the load's degree
 *   y   the free oscillation from the start values
 * Variable z >= 0, dimensionless; damping_rate and omega2 in its units.
 */
#ifndef CONTACT_MATH_OSCILLATOR_H
#define CONTACT_MATH_OSCILLATOR_H

#include <stdbool.h>

struct oscillator {
    double omega2, damping_rate;
};

/* This struct holds y and y' at z for y(0) = 1, y'(0) = 0 (of_y) and for y(0) = 0, y'(0) = 1 (of_rate). */
struct oscillator_basis {
    double y_of_y, y_of_rate;
    double rate_of_y, rate_of_rate;
};

struct oscillator_basis oscillator_basis_at(const struct oscillator *o, double z);

/* This struct holds the two decay rates of y. Up to critical damping both are sqrt(omega2), the rate of
 * oscillation. */
struct oscillator_rates {
    double slower, faster;
};

struct oscillator_rates oscillator_rates_of(const struct oscillator *o);

/* |y| <= amplitude exp(-decay_rate z) for the free oscillation that starts with y and y'. The bound also
 * serves for sums of y and y', which solve the same equation. Well below critical damping the amplitude is
 * the least possible one, well beyond it is the sum of both decays, and in between the bound is coarser. */
struct oscillator_envelope {
    double amplitude, decay_rate;
};

struct oscillator_envelope oscillator_envelope_of(const struct oscillator *o, double y, double y_rate);

/* Returns the increments of x and x' since x(0) = x, x'(0) = x_rate under a constant load, by a power series.
 * The closed form less the start values would lose the digits of a small increment. The series holds for z up
 * to OSCILLATOR_SERIES_RANGE / (1 + damping_rate), and for omega2 up to 1. */
static const double OSCILLATOR_SERIES_RANGE = 0.1;

struct oscillator_increment {
    double x, x_rate;
};

struct oscillator_increment oscillator_increment(const struct oscillator *o, double x, double x_rate,
                                                 double load, double z);

/* Coefficients of the particular solution s for a polynomial load of `terms` coefficients. The recurrence is
 * finite. The coefficients of s are of the load's size where the slower rate exceeds the degree, and grow as
 * k! / rate^k below. The factor of x'' is `inertia`, 1 or 0: without inertia x' + rate x = load is an
 * oscillator with omega2 = rate and damping_rate = 1. */
void oscillator_particular(const struct oscillator *o, double inertia, const double *load, double *s,
                           int terms);

/*
 * The free oscillation y'' + damping_rate y' + y = 0 for any damping. Beyond critical damping y decays:
 *
 *   y = by_slower exp(-slower s) + by_faster exp(-faster s)
 *   slower faster = 1,   slower + faster = damping_rate
 *
 * A dashpot without a spring has y'' + y' = drift. Then slower = 0 and faster = 1, and drift s is added to y.
 *
 * y and each derivative keep full relative accuracy however far they have decayed, except near their zeros.
 * The variable s >= 0 counts radians of the undamped oscillator, or decay times of the dashpot.
 */

enum { FREE_OSCILLATION_DERIVATIVES = 4 };

struct free_oscillation {
    struct oscillator oscillator; /* omega2 is 1, or 0 without a spring */
    double y, y_rate;             /* at the start */
    bool distinct;                /* whether the two rates differ enough to be summed separately */
    double slower, faster;
    double by_slower, by_faster;
    double drift;
    double omega_d; /* frequency of y, sqrt(1 - damping_rate^2 / 4); 0 from critical damping on */
};

struct free_oscillation free_oscillation_of(double damping_rate, double y, double y_rate);
struct free_oscillation free_oscillation_of_dashpot(double y, double y_rate, double drift);

/* Writes y and its first four derivatives at s. */
void free_oscillation_at(const struct free_oscillation *d, double s,
                         double y[1 + FREE_OSCILLATION_DERIVATIVES]);

/* Returns the changes of y and y' from s = 0 to s. */
struct oscillator_increment free_oscillation_since(const struct free_oscillation *d, double s);

#endif
