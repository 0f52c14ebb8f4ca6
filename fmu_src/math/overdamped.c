#include "math/overdamped.h"

#include <math.h>

#include "math/compiler.h"
#include "math/pi.h"

/* Rates that differ by less than this part of their mean are not summed separately: the two terms would
 * cancel. */
static const double TOGETHER = 0.25;

struct overdamped overdamped_of(double damping_rate, double y, double y_rate)
{
    struct overdamped d = {
        .oscillator = {1.0, damping_rate}, .y = y, .y_rate = y_rate, .slower = 1.0, .faster = 1.0};
    const double mean = 0.5 * damping_rate;
    const double spread_square = (mean - 1.0) * (mean + 1.0);
    d.half_period = spread_square < 0.0 ? PI / sqrt(-spread_square) : (double)INFINITY;
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

struct overdamped overdamped_of_dashpot(double y, double y_rate, double drift)
{
    return (struct overdamped){.oscillator = {0.0, 1.0},
                               .y = y,
                               .y_rate = y_rate,
                               .distinct = true,
                               .faster = 1.0,
                               .by_slower = y + (y_rate - drift),
                               .by_faster = drift - y_rate,
                               .drift = drift,
                               .half_period = (double)INFINITY};
}

void overdamped_at(const struct overdamped *d, double s, double y[1 + OVERDAMPED_DERIVATIVES])
{
    if (!d->distinct) {
        const struct oscillator_basis basis = oscillator_basis_at(&d->oscillator, s);
        y[0] = d->y * basis.y_of_y + d->y_rate * basis.y_of_rate;
        y[1] = d->y * basis.rate_of_y + d->y_rate * basis.rate_of_rate;
        for (int i = 2; i <= OVERDAMPED_DERIVATIVES; ++i) {
            y[i] = -d->oscillator.damping_rate * y[i - 1] - y[i - 2];
        }
        return;
    }
    double slow = d->by_slower * exp(-d->slower * s);
    double fast = d->by_faster * exp(-d->faster * s);
    for (int i = 0; i <= OVERDAMPED_DERIVATIVES; ++i) {
        y[i] = slow + fast;
        slow *= -d->slower;
        fast *= -d->faster;
    }
    y[0] += d->drift * s;
    y[1] += d->drift;
}

/* e^(-mean s) cos(omega_d s) - 1, omega_d real or not. */
static double cosine_less(const struct overdamped *d, double s)
{
    if (d->half_period < (double)INFINITY) {
        const double mean = 0.5 * d->oscillator.damping_rate;
        const double sine = sin(0.5 * PI * s / d->half_period);
        return expm1(-mean * s) - 2.0 * exp(-mean * s) * sine * sine;
    }
    return 0.5 * (expm1(-d->slower * s) + expm1(-d->faster * s));
}

CONTACT_NOT_FUSED struct overdamped_change overdamped_since(const struct overdamped *d, double s)
{
    if (s * (1.0 + d->oscillator.damping_rate) <= OSCILLATOR_SERIES_RANGE) {
        const struct oscillator_increment begun =
            oscillator_increment(&d->oscillator, d->y, d->y_rate, d->drift, s);
        return (struct overdamped_change){begun.x, begun.x_rate};
    }
    if (d->distinct) {
        const double slow = d->by_slower * expm1(-d->slower * s);
        const double fast = d->by_faster * expm1(-d->faster * s);
        return (struct overdamped_change){slow + fast + d->drift * s, -(d->slower * slow + d->faster * fast)};
    }
    const double damping_rate = d->oscillator.damping_rate;
    const double by_rate = oscillator_basis_at(&d->oscillator, s).y_of_rate;
    const double by_y = cosine_less(d, s) + 0.5 * damping_rate * by_rate;
    return (struct overdamped_change){d->y * by_y + d->y_rate * by_rate,
                                      d->y_rate * (by_y - damping_rate * by_rate) - d->y * by_rate};
}

/* (-faster)^order by_faster exp(-faster s) + (-slower)^order by_slower exp(-slower s) = 0: with each order
 * the zero moves on by log(faster / slower) / (faster - slower). */
double overdamped_zero(const struct overdamped *d, int order)
{
    if (!(d->slower > 0.0)) { /* by_faster exp(-s) = drift */
        const double left = d->drift / d->by_faster;
        return order == 1 && left > 0.0 ? -log(left) : (double)INFINITY;
    }
    const double spread = d->faster - d->slower;
    const double part = d->y_rate / (d->y + d->slower * d->y_rate);
    if (!(spread * part > -1.0)) {
        return (double)INFINITY;
    }
    const double first = spread > 0.0 ? log1p(spread * part) / spread : part;
    const double further = spread > 0.0 ? log1p(spread / d->slower) / spread : 1.0;
    return first + (order - 1) * further;
}
