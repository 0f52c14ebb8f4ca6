#include "contact/decay.h"

#include <math.h>

/* Rates that differ by less than this part of their mean are taken together: apart, either share is large against their sum. */
static const double TOGETHER = 0.25;

static const double STRAIGHT_ANGLE = 3.141592653589793;

struct decay decay_of(double damping, double y, double y_rate)
{
    struct decay d = {.oscillator = {1.0, damping}, .y = y, .y_rate = y_rate, .slower = 1.0, .faster = 1.0};
    const double mean = 0.5 * damping;
    const double spread_square = (mean - 1.0) * (mean + 1.0);
    d.half_turn = spread_square < 0.0 ? STRAIGHT_ANGLE / sqrt(-spread_square) : (double)INFINITY;
    if (spread_square > 0.0) {
        const double spread = sqrt(spread_square);
        d.faster = mean + spread;
        d.slower = 1.0 / d.faster;
        d.apart = spread > TOGETHER * mean;
        d.by_slower = (y_rate + d.faster * y) / (2.0 * spread);
        d.by_faster = -(y_rate + d.slower * y) / (2.0 * spread);
    }
    return d;
}

struct decay decay_of_dashpot(double y, double y_rate, double drift)
{
    return (struct decay){.oscillator = {0.0, 1.0},
                          .y = y,
                          .y_rate = y_rate,
                          .apart = true,
                          .faster = 1.0,
                          .by_slower = y + (y_rate - drift),
                          .by_faster = drift - y_rate,
                          .drift = drift,
                          .half_turn = (double)INFINITY};
}

void decay_at(const struct decay *d, double s, double y[1 + DECAY_DERIVATIVES])
{
    if (!d->apart) {
        const struct oscillator_basis basis = oscillator_basis_at(&d->oscillator, s);
        y[0] = d->y * basis.y_of_y + d->y_rate * basis.y_of_rate;
        y[1] = d->y * basis.rate_of_y + d->y_rate * basis.rate_of_rate;
        for (int i = 2; i <= DECAY_DERIVATIVES; ++i) {
            y[i] = -d->oscillator.damping * y[i - 1] - y[i - 2];
        }
        return;
    }
    double slow = d->by_slower * exp(-d->slower * s);
    double fast = d->by_faster * exp(-d->faster * s);
    for (int i = 0; i <= DECAY_DERIVATIVES; ++i) {
        y[i] = slow + fast;
        slow *= -d->slower;
        fast *= -d->faster;
    }
    y[0] += d->drift * s;
    y[1] += d->drift;
}

/* e^(-mean s) cos(turn s) - 1, the turn real or not. */
static double cosine_less(const struct decay *d, double s)
{
    if (d->half_turn < (double)INFINITY) {
        const double mean = 0.5 * d->oscillator.damping;
        const double sine = sin(0.5 * STRAIGHT_ANGLE * s / d->half_turn);
        return expm1(-mean * s) - 2.0 * exp(-mean * s) * sine * sine;
    }
    return 0.5 * (expm1(-d->slower * s) + expm1(-d->faster * s));
}

struct decay_change decay_since(const struct decay *d, double s)
{
    if (s * (1.0 + d->oscillator.damping) <= OSCILLATOR_BEGINS) {
        const struct oscillator_begun begun = oscillator_begun(&d->oscillator, d->y, d->y_rate, d->drift, s);
        return (struct decay_change){begun.x, begun.x_rate};
    }
    if (d->apart) {
        const double slow = d->by_slower * expm1(-d->slower * s);
        const double fast = d->by_faster * expm1(-d->faster * s);
        return (struct decay_change){slow + fast + d->drift * s, -(d->slower * slow + d->faster * fast)};
    }
    const double damping = d->oscillator.damping;
    const double by_rate = oscillator_basis_at(&d->oscillator, s).y_of_rate;
    const double by_y = cosine_less(d, s) + 0.5 * damping * by_rate;
    return (struct decay_change){d->y * by_y + d->y_rate * by_rate,
                                 d->y_rate * (by_y - damping * by_rate) - d->y * by_rate};
}

/* (-faster)^order by_faster exp(-faster s) + (-slower)^order by_slower exp(-slower s) = 0: from order to order the place moves on by
 * log(faster / slower) / (faster - slower). */
double decay_zero(const struct decay *d, int order)
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
