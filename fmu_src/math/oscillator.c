#include <math.h>

#include "math/compiler.h"
#include "math/oscillator.h"
#include "math/vec3.h"

/* Beyond critical damping y has two real decay rates, whose difference may vanish. */
struct oscillator_basis oscillator_basis_at(const struct oscillator *o, double z)
{
    const double decay_rate = 0.5 * o->damping_rate;
    const double omega_d2 = o->omega2 - decay_rate * decay_rate;
    const double spread = sqrt(fabs(omega_d2));
    const bool turns = omega_d2 > 0.0;
    const double faster = turns ? decay_rate : decay_rate + spread;
    const double slower = turns ? decay_rate : o->omega2 / faster;
    const double shrink = exp(-slower * z);
    const double angle = turns ? spread * z : 0.0;
    const double cosine = shrink * cos(angle);
    double sine = spread > 0.0 ? shrink * sin(angle) / spread : 0.0;
    if (!turns) {
        const double rate = 2.0 * spread;
        sine = rate * z > 0.0 ? shrink * -expm1(-rate * z) / rate : shrink * z;
    }
    return (struct oscillator_basis){cosine + slower * sine, sine, -o->omega2 * sine, cosine - faster * sine};
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

void oscillator_particular(const struct oscillator *o, double inertia, const double *load, double *s,
                           int terms)
{
    const double inverse = 1.0 / o->omega2;
    double next = 0.0; /* s[k + 1] */
    double next_but_one = 0.0;
    for (int k = terms - 1; k >= 0; --k) {
        s[k] = (load[k] - (k + 1) * (o->damping_rate * next + inertia * (k + 2) * next_but_one)) * inverse;
        next_but_one = next;
        next = s[k];
    }
}

/* Rates that differ by less than this part of their mean are not summed separately: the two terms would
 * cancel. */
static const double TOGETHER = 0.25;

struct free_oscillation free_oscillation_of(double damping_rate, double y, double y_rate)
{
    struct free_oscillation d = {
        .oscillator = {1.0, damping_rate}, .y = y, .y_rate = y_rate, .slower = 1.0, .faster = 1.0};
    const double mean = 0.5 * damping_rate;
    const double spread_square = (mean - 1.0) * (mean + 1.0);
    d.omega_d = sqrt(fmax(1.0 - mean * mean, 0.0));
    if (spread_square > 0.0) {
        const double spread = sqrt(spread_square);
        d.faster = mean + spread;
        d.slower = 1.0 / d.faster;
        d.distinct = spread > TOGETHER * mean;
        d.by_slower = (y_rate + d.faster * y) / (2.0 * spread);
        d.by_faster = -(y_rate + d.slower * y) / (2.0 * spread);
    }
    return d;
}

struct free_oscillation free_oscillation_of_dashpot(double y, double y_rate, double drift)
{
    return (struct free_oscillation){.oscillator = {0.0, 1.0},
                                     .y = y,
                                     .y_rate = y_rate,
                                     .distinct = true,
                                     .faster = 1.0,
                                     .by_slower = y + (y_rate - drift),
                                     .by_faster = drift - y_rate,
                                     .drift = drift};
}

void free_oscillation_at(const struct free_oscillation *d, double s,
                         double y[1 + FREE_OSCILLATION_DERIVATIVES])
{
    if (!d->distinct) {
        const struct oscillator_basis basis = oscillator_basis_at(&d->oscillator, s);
        y[0] = d->y * basis.y_of_y + d->y_rate * basis.y_of_rate;
        y[1] = d->y * basis.rate_of_y + d->y_rate * basis.rate_of_rate;
        for (int i = 2; i <= FREE_OSCILLATION_DERIVATIVES; ++i) {
            y[i] = -d->oscillator.damping_rate * y[i - 1] - y[i - 2];
        }
        return;
    }
    double slow = d->by_slower * exp(-d->slower * s);
    double fast = d->by_faster * exp(-d->faster * s);
    for (int i = 0; i <= FREE_OSCILLATION_DERIVATIVES; ++i) {
        y[i] = slow + fast;
        slow *= -d->slower;
        fast *= -d->faster;
    }
    y[0] += d->drift * s;
    y[1] += d->drift;
}

CONTACT_NOT_FUSED struct oscillator_increment free_oscillation_since(const struct free_oscillation *d,
                                                                     double s)
{
    const double damping_rate = d->oscillator.damping_rate;
    if (s * (1.0 + damping_rate) <= OSCILLATOR_SERIES_RANGE) {
        return oscillator_increment(&d->oscillator, d->y, d->y_rate, d->drift, s);
    }
    if (d->distinct) {
        const double slow = d->by_slower * expm1(-d->slower * s);
        const double fast = d->by_faster * expm1(-d->faster * s);
        return (struct oscillator_increment){slow + fast + d->drift * s,
                                             -(d->slower * slow + d->faster * fast)};
    }
    double by_rate;     /* e^(-mean s) sin(omega_d s) / omega_d, with the mean rate damping_rate / 2 */
    double cosine_less; /* e^(-mean s) cos(omega_d s) - 1 */
    if (d->omega_d > 0.0) {
        const double half_angle = 0.5 * d->omega_d * s;
        const double sine = sin(half_angle);
        const double shrink_less = damping_rate > 0.0 ? expm1(-0.5 * damping_rate * s) : 0.0;
        by_rate = 2.0 * (1.0 + shrink_less) * sine * cos(half_angle) / d->omega_d;
        cosine_less = shrink_less + (1.0 + shrink_less) * (-2.0 * sine * sine);
    } else {
        by_rate = oscillator_basis_at(&d->oscillator, s).y_of_rate;
        cosine_less = 0.5 * (expm1(-d->slower * s) + expm1(-d->faster * s));
    }
    const double by_y = cosine_less + 0.5 * damping_rate * by_rate;
    return (struct oscillator_increment){d->y * by_y + d->y_rate * by_rate,
                                         d->y_rate * (by_y - damping_rate * by_rate) - d->y * by_rate};
}
