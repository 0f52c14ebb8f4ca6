#include "math/oscillator.h"

#include "math/vec3.h"

static struct oscillator_basis underdamped(double decay_rate, double omega_d, double omega2, double z)
{
    const double shrink = exp(-decay_rate * z);
    const double sine = shrink * sin(omega_d * z) / omega_d;
    const double cosine = shrink * cos(omega_d * z);
    return (struct oscillator_basis){cosine + decay_rate * sine, sine, -omega2 * sine,
                                     cosine - decay_rate * sine};
}

/* Two real rates; their difference may vanish. */
static struct oscillator_basis overdamped(double decay_rate, double spread, double omega2, double z)
{
    const double fast = -(decay_rate + spread);
    const double slow = -omega2 / (decay_rate + spread);
    const double by_slow = exp(slow * z);
    const double difference = 2.0 * spread;
    const double sine = difference * z > 0.0 ? by_slow * -expm1(-difference * z) / difference : by_slow * z;
    return (struct oscillator_basis){by_slow - slow * sine, sine, -omega2 * sine, by_slow + fast * sine};
}

struct oscillator_basis oscillator_basis_at(const struct oscillator *o, double z)
{
    const double decay_rate = 0.5 * o->damping_rate;
    const double omega_d2 = o->omega2 - decay_rate * decay_rate;
    return omega_d2 > 0.0 ? underdamped(decay_rate, sqrt(omega_d2), o->omega2, z)
                          : overdamped(decay_rate, sqrt(-omega_d2), o->omega2, z);
}

/* The sine and cosine of 1 - z and 1 + z from those of 1 and z, and so with the decay. */
static void underdamped_about_one(double decay_rate, double omega_d, const double *offset, int count,
                                  double *y_of_y, double *y_of_rate)
{
    const double sine_of_one = sin(omega_d);
    const double cosine_of_one = cos(omega_d);
    const double shrink_to_one = exp(-decay_rate);
    for (int i = 0; i < count / 2; ++i) {
        const int mirrored = count - 1 - i;
        const double z = offset[mirrored];
        const double sine = sin(omega_d * z);
        const double cosine = cos(omega_d * z);
        const double shrink = decay_rate > 0.0 ? exp(-decay_rate * z) : 1.0;
        const double after = shrink_to_one * shrink;
        const double before = shrink_to_one / shrink;
        const double same = sine_of_one * cosine;
        const double other = cosine_of_one * sine;
        const double cosines = cosine_of_one * cosine;
        const double sines = sine_of_one * sine;
        y_of_rate[i] = before * (same - other) / omega_d;
        y_of_y[i] = before * (cosines + sines) + decay_rate * y_of_rate[i];
        y_of_rate[mirrored] = after * (same + other) / omega_d;
        y_of_y[mirrored] = after * (cosines - sines) + decay_rate * y_of_rate[mirrored];
    }
    y_of_y[0] = 1.0;
    y_of_rate[0] = 0.0;
}

void oscillator_basis_about_one(const struct oscillator *o, const double *offset, int count, double *y_of_y,
                                double *y_of_rate)
{
    const double decay_rate = 0.5 * o->damping_rate;
    const double omega_d2 = o->omega2 - decay_rate * decay_rate;
    if (omega_d2 > 0.0) {
        underdamped_about_one(decay_rate, sqrt(omega_d2), offset, count, y_of_y, y_of_rate);
        return;
    }
    for (int i = 0; i < count; ++i) {
        const struct oscillator_basis basis = oscillator_basis_at(o, 1.0 + offset[i]);
        y_of_y[i] = basis.y_of_y;
        y_of_rate[i] = basis.y_of_rate;
    }
}

struct oscillator_rates oscillator_rates_of(const struct oscillator *o)
{
    const double decay_rate = 0.5 * o->damping_rate;
    const double spread_square = decay_rate * decay_rate - o->omega2;
    if (!(spread_square > 0.0)) {
        return (struct oscillator_rates){sqrt(o->omega2), sqrt(o->omega2)};
    }
    const double faster = decay_rate + sqrt(spread_square);
    return (struct oscillator_rates){o->omega2 / faster, faster};
}

struct oscillator_envelope oscillator_envelope_of(const struct oscillator *o, double y, double y_rate)
{
    const double decay_rate = 0.5 * o->damping_rate;
    const double omega_d2 = o->omega2 - decay_rate * decay_rate;
    /* y = exp(-decay_rate z) (y cos + start sin / omega_d) */
    const double start = y_rate + decay_rate * y;
    if (fabs(omega_d2) * 16.0 <= decay_rate * decay_rate) {
        /* |sin / omega_d| <= z cosh(decay_rate z / 4), and z exp(-decay_rate z / 4) <= 4 / (e decay_rate) */
        return (struct oscillator_envelope){fabs(y) + fabs(start) * 4.0 / (2.718281828459045 * decay_rate),
                                            0.5 * decay_rate};
    }
    if (omega_d2 > 0.0) {
        return (struct oscillator_envelope){vec3_norm(vec3_make(y, start / sqrt(omega_d2), 0.0)), decay_rate};
    }
    const double spread = sqrt(-omega_d2);
    const double slow = 0.5 * (y + start / spread);
    const double fast = 0.5 * (y - start / spread);
    return (struct oscillator_envelope){fabs(slow) + fabs(fast), o->omega2 / (decay_rate + spread)};
}

struct oscillator_increment oscillator_increment(const struct oscillator *o, double x, double x_rate,
                                                 double load, double z)
{
    if (!(z > 0.0)) {
        return (struct oscillator_increment){0.0, 0.0};
    }
    double before = x;
    double term = x_rate * z;
    struct oscillator_increment begun = {term, 0.0};
    for (int n = 2; n < 12; ++n) { /* 0.1^12 / 12! is far below rounding */
        const double force = n == 2 ? load - o->omega2 * before : -o->omega2 * before;
        const double next = z * (z * force - o->damping_rate * term * (n - 1)) / (n * (n - 1));
        before = term;
        term = next;
        begun.x += term;
        begun.x_rate += n * term;
    }
    begun.x_rate /= z;
    return begun;
}

void oscillator_particular(const struct oscillator *o, const double *load, double *s, int terms)
{
    const double inverse = 1.0 / o->omega2;
    double next = 0.0; /* s[k + 1] */
    double next_but_one = 0.0;
    for (int k = terms - 1; k >= 0; --k) {
        s[k] = (load[k] - (k + 1) * (o->damping_rate * next + (k + 2) * next_but_one)) * inverse;
        next_but_one = next;
        next = s[k];
    }
}

void relaxation_particular(double rate, const double *load, double *s, int terms)
{
    const double inverse = 1.0 / rate;
    double next = 0.0;
    for (int k = terms - 1; k >= 0; --k) {
        s[k] = (load[k] - (k + 1) * next) * inverse;
        next = s[k];
    }
}
