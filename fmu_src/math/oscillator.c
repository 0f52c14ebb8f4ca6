#include <math.h>

#include "math/compiler.h"
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

/* Returns the basis for two real decay rates, whose difference may vanish. */
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
    /* y(z) = exp(-decay_rate z) (y cos(omega_d z) + start sin(omega_d z) / omega_d) */
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

/* Up to this z, in units of 1 / (1 + damping_rate), a power series gives the changes of y and y'. */
static const double SHORT_TIME = 0.1;

static struct oscillator_increment increment_by_series(double damping_rate, double y, double y_rate, double z)
{
    double before = y;
    double term = y_rate * z;
    struct oscillator_increment begun = {term, 0.0};
    for (int n = 2; n < 12; ++n) { /* 0.1^12 / 12! is far below rounding */
        const double next = -z * (z * before + damping_rate * term * (n - 1)) / (n * (n - 1));
        before = term;
        term = next;
        begun.y += term;
        begun.y_rate += n * term;
    }
    begun.y_rate = z > 0.0 ? begun.y_rate / z : 0.0;
    return begun;
}

CONTACT_NOT_FUSED struct oscillator_increment oscillator_increment_of(double damping_rate, double y,
                                                                      double y_rate, double z)
{
    if (z * (1.0 + damping_rate) <= SHORT_TIME) {
        return increment_by_series(damping_rate, y, y_rate, z);
    }
    const double omega_d = sqrt(1.0 - 0.25 * damping_rate * damping_rate);
    const double half_angle = 0.5 * omega_d * z;
    const double sine = sin(half_angle);
    const double shrink_less = damping_rate > 0.0 ? expm1(-0.5 * damping_rate * z) : 0.0;
    const double by_rate = 2.0 * (1.0 + shrink_less) * sine * cos(half_angle) / omega_d;
    const double cosine_less = shrink_less + (1.0 + shrink_less) * (-2.0 * sine * sine);
    const double by_y = cosine_less + 0.5 * damping_rate * by_rate;
    return (struct oscillator_increment){y * by_y + y_rate * by_rate,
                                         y_rate * (by_y - damping_rate * by_rate) - y * by_rate};
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
