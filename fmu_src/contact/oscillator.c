#include "contact/oscillator.h"

#include "contact/vec3.h"

static struct oscillator_basis turning(double decay, double turn, double square, double z)
{
    const double shrink = exp(-decay * z);
    const double sine = shrink * sin(turn * z) / turn;
    const double cosine = shrink * cos(turn * z);
    return (struct oscillator_basis){cosine + decay * sine, sine, -square * sine, cosine - decay * sine};
}

/* Two real rates, fast and slow; their difference may vanish. */
static struct oscillator_basis decaying(double decay, double spread, double square, double z)
{
    const double fast = -(decay + spread);
    const double slow = -square / (decay + spread);
    const double by_slow = exp(slow * z);
    const double difference = 2.0 * spread;
    const double sine = difference * z > 0.0 ? by_slow * -expm1(-difference * z) / difference : by_slow * z;
    return (struct oscillator_basis){by_slow - slow * sine, sine, -square * sine, by_slow + fast * sine};
}

struct oscillator_basis oscillator_basis_at(const struct oscillator *o, double z)
{
    const double decay = 0.5 * o->damping;
    const double turn_square = o->square - decay * decay;
    return turn_square > 0.0 ? turning(decay, sqrt(turn_square), o->square, z)
                             : decaying(decay, sqrt(-turn_square), o->square, z);
}

/* The sine and cosine of 1 - z and 1 + z from those of 1 and z, and so with the decay. */
static void turning_about_one(double decay, double turn, const double *offset, int count, double *y_of_y,
                              double *y_of_rate)
{
    const double sine_of_one = sin(turn);
    const double cosine_of_one = cos(turn);
    const double shrink_to_one = exp(-decay);
    for (int i = 0; i < count / 2; ++i) {
        const int mirrored = count - 1 - i;
        const double z = offset[mirrored];
        const double sine = sin(turn * z);
        const double cosine = cos(turn * z);
        const double shrink = decay > 0.0 ? exp(-decay * z) : 1.0;
        const double after = shrink_to_one * shrink;
        const double before = shrink_to_one / shrink;
        const double same = sine_of_one * cosine;
        const double other = cosine_of_one * sine;
        const double cosines = cosine_of_one * cosine;
        const double sines = sine_of_one * sine;
        y_of_rate[i] = before * (same - other) / turn;
        y_of_y[i] = before * (cosines + sines) + decay * y_of_rate[i];
        y_of_rate[mirrored] = after * (same + other) / turn;
        y_of_y[mirrored] = after * (cosines - sines) + decay * y_of_rate[mirrored];
    }
    y_of_y[0] = 1.0;
    y_of_rate[0] = 0.0;
}

void oscillator_basis_about_one(const struct oscillator *o, const double *offset, int count, double *y_of_y,
                                double *y_of_rate)
{
    const double decay = 0.5 * o->damping;
    const double turn_square = o->square - decay * decay;
    if (turn_square > 0.0) {
        turning_about_one(decay, sqrt(turn_square), offset, count, y_of_y, y_of_rate);
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
    const double decay = 0.5 * o->damping;
    const double spread_square = decay * decay - o->square;
    if (!(spread_square > 0.0)) {
        return (struct oscillator_rates){sqrt(o->square), sqrt(o->square)};
    }
    const double faster = decay + sqrt(spread_square);
    return (struct oscillator_rates){o->square / faster, faster};
}

struct oscillator_envelope oscillator_envelope_of(const struct oscillator *o, double y, double y_rate)
{
    const double decay = 0.5 * o->damping;
    const double turn_square = o->square - decay * decay;
    const double start = y_rate + decay * y; /* y = exp(-decay z) (y cos + start sin / turn) */
    if (fabs(turn_square) * 16.0 <= decay * decay) {
        /* |sin / turn| <= z cosh(decay z / 4), and z exp(-decay z / 4) <= 4 / (e decay) */
        return (struct oscillator_envelope){fabs(y) + fabs(start) * 4.0 / (2.718281828459045 * decay),
                                            0.5 * decay};
    }
    if (turn_square > 0.0) {
        return (struct oscillator_envelope){vec3_norm(vec3_make(y, start / sqrt(turn_square), 0.0)), decay};
    }
    const double spread = sqrt(-turn_square);
    const double slow = 0.5 * (y + start / spread);
    const double fast = 0.5 * (y - start / spread);
    return (struct oscillator_envelope){fabs(slow) + fabs(fast), o->square / (decay + spread)};
}

struct oscillator_begun oscillator_begun(const struct oscillator *o, double x, double x_rate, double load,
                                         double z)
{
    if (!(z > 0.0)) {
        return (struct oscillator_begun){0.0, 0.0};
    }
    double before = x;
    double term = x_rate * z;
    struct oscillator_begun begun = {term, 0.0};
    for (int n = 2; n < 12; ++n) { /* 0.1^12 / 12! is far below rounding */
        const double pull = n == 2 ? load - o->square * before : -o->square * before;
        const double next = z * (z * pull - o->damping * term * (n - 1)) / (n * (n - 1));
        before = term;
        term = next;
        begun.x += term;
        begun.x_rate += n * term;
    }
    begun.x_rate /= z;
    return begun;
}

void oscillator_follow(const struct oscillator *o, const double *load, double *s, int terms)
{
    const double inverse = 1.0 / o->square;
    double next = 0.0; /* s[k + 1] */
    double next_but_one = 0.0;
    for (int k = terms - 1; k >= 0; --k) {
        s[k] = (load[k] - (k + 1) * (o->damping * next + (k + 2) * next_but_one)) * inverse;
        next_but_one = next;
        next = s[k];
    }
}

void relaxation_follow(double rate, const double *load, double *s, int terms)
{
    const double inverse = 1.0 / rate;
    double next = 0.0;
    for (int k = terms - 1; k >= 0; --k) {
        s[k] = (load[k] - (k + 1) * next) * inverse;
        next = s[k];
    }
}
