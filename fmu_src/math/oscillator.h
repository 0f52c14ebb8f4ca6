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

/* y and y' at z for y(0) = 1, y'(0) = 0 (of_y) and for y(0) = 0, y'(0) = 1 (of_rate). */
struct oscillator_basis {
    double y_of_y, y_of_rate;
    double rate_of_y, rate_of_rate;
};

struct oscillator_basis oscillator_basis_at(const struct oscillator *o, double z);

/* The two decay rates of y. Up to critical damping both are sqrt(omega2), the rate of oscillation. */
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

/* The changes of the free oscillation y and of y' since y(0) = y, y'(0) = y_rate, which keep the digits of a
 * small change: subtracting the start values from the closed form would lose them. omega2 is one, and the
 * damping is below the critical one. */
struct oscillator_increment {
    double y, y_rate;
};

struct oscillator_increment oscillator_increment_of(double damping_rate, double y, double y_rate, double z);

/* Coefficients of the particular solution s for a polynomial load of `terms` coefficients. The recurrence is
 * finite. The coefficients of s are of the load's size where the slower rate exceeds the degree, and grow as
 * k! / rate^k below. */
void oscillator_particular(const struct oscillator *o, const double *load, double *s, int terms);

/* Writes the coefficients of the particular solution s of x' + rate x = load. */
void relaxation_particular(double rate, const double *load, double *s, int terms);

#endif
