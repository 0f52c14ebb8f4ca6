/*
 * The linear oscillator x'' + damping x' + square x = load, solved exactly: load a polynomial, x = s + y with
 *   s   the polynomial that follows the load (no oscillation in it)
 *   y   the free oscillation that makes up for the start
 * Variable z >= 0, dimensionless; damping and square in its units.
 */
#ifndef CONTACT_OSCILLATOR_H
#define CONTACT_OSCILLATOR_H

struct oscillator {
    double square, damping;
};

/* What y and y' are at z for y(0) = 1, y'(0) = 0 and for y(0) = 0, y'(0) = 1. */
struct oscillator_basis {
    double y_of_y, y_of_rate;
    double rate_of_y, rate_of_rate;
};

struct oscillator_basis oscillator_basis_at(const struct oscillator *o, double z);

/* y alone at 1 + offset, for an even count of ascending offsets from -1 to 1, symmetric about zero: at half the cost. */
void oscillator_basis_about_one(const struct oscillator *o, const double *offset, int count, double *y_of_y,
                                double *y_of_rate);

/* The slower and the faster of the two rates at which y decays or turns: both sqrt(square) up to critical damping. */
struct oscillator_rates {
    double slower, faster;
};

struct oscillator_rates oscillator_rates_of(const struct oscillator *o);

/* |y| <= amplitude exp(-decay z) for the free oscillation that starts with y and y'. Holds for y' and any sum of both too, as they
 * solve the same equation. Exact below critical damping, near it and beyond the sum of the parts. */
struct oscillator_envelope {
    double amplitude, decay;
};

struct oscillator_envelope oscillator_envelope_of(const struct oscillator *o, double y, double y_rate);

/* How far x and x' have come since x(0) = x, x'(0) = x_rate, under a steady load: by a power series, so that neither x nor the load takes
 * digits from what has hardly begun. For z up to OSCILLATOR_BEGINS / (1 + damping), square up to 1. */
static const double OSCILLATOR_BEGINS = 0.1;

struct oscillator_begun {
    double x, x_rate;
};

struct oscillator_begun oscillator_begun(const struct oscillator *o, double x, double x_rate, double load,
                                         double z);

/* s for a load of `terms` coefficients. The sum ends with the polynomial; its coefficients are of the load's size where the
 * slower rate exceeds the polynomial's degree, and grow as k! / rate^k below. */
void oscillator_follow(const struct oscillator *o, const double *load, double *s, int terms);

/* The same for x' + rate x = load. */
void relaxation_follow(double rate, const double *load, double *s, int terms);

#endif
