#include "math/bernstein.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Halvings, after which two places are not told apart. */
enum { DEPTH = 40 };

/* The polynomial on one part of [0, 1]. */
struct part {
    double low, width;
    double of[BERNSTEIN_MOST];
};

/* By de Casteljau's scheme: `left` becomes the first half of it, what it returns is the second. */
static struct part split(struct part *left, int count)
{
    struct part right = {left->low + 0.5 * left->width, 0.5 * left->width, {0.0}};
    double row[BERNSTEIN_MOST];
    memcpy(row, left->of, (size_t)count * sizeof *row);
    left->width *= 0.5;
    for (int k = 0; k < count; ++k) {
        left->of[k] = row[0];
        right.of[count - 1 - k] = row[count - 1 - k];
        for (int i = 0; i + 1 < count - k; ++i) {
            row[i] = 0.5 * (row[i] + row[i + 1]);
        }
    }
    return right;
}

/* Changes of sign among the coefficients: as many as there are roots, or more by an even number
 * (Descartes). */
static int changes_of_sign(const double *of, int count)
{
    int changes = 0;
    for (int i = 1; i < count; ++i) {
        changes += (of[i - 1] > 0.0) != (of[i] > 0.0);
    }
    return changes;
}

/* The first fall through zero of the polynomial and an offset. */
static struct bernstein_fall first_fall_of_sum(const double *coefficients, int count, double offset)
{
    struct part open[DEPTH + 1]; /* still to be looked at, the first part last */
    int last = 0;
    open[0] = (struct part){.low = 0.0, .width = 1.0};
    for (int i = 0; i < count; ++i) {
        open[0].of[i] = coefficients[i] + offset;
    }
    while (last >= 0) {
        struct part *now = &open[last];
        const int changes = changes_of_sign(now->of, count);
        const bool falls = now->of[0] > 0.0 && !(now->of[count - 1] > 0.0);
        const bool none = changes == 0 || (changes == 1 && !falls);
        if (!none && (changes == 1 || (last == DEPTH && falls))) {
            return (struct bernstein_fall){now->low, now->low + now->width, offset};
        }
        if (none || last == DEPTH) {
            last -= 1;
        } else {
            const struct part right = split(now, count);
            open[last + 1] = *now;
            open[last] = right;
            last += 1;
        }
    }
    return (struct bernstein_fall){(double)INFINITY, (double)INFINITY, offset};
}

struct bernstein_fall bernstein_first_fall(const double *coefficients, int count, double noise)
{
    const struct bernstein_fall deep = first_fall_of_sum(coefficients, count, noise);
    const bool stays = coefficients[0] > 0.0 && !(coefficients[count - 1] > 0.0);
    return stays && !(deep.low < (double)INFINITY) ? first_fall_of_sum(coefficients, count, 0.0) : deep;
}

double bernstein_at(const double *coefficients, int count, double place)
{
    double row[BERNSTEIN_MOST];
    memcpy(row, coefficients, (size_t)count * sizeof *row);
    for (int k = count - 1; k > 0; --k) {
        for (int i = 0; i < k; ++i) {
            row[i] += place * (row[i + 1] - row[i]);
        }
    }
    return row[0];
}

/* Two places this close, as a part of the farther one, are not told apart. */
static const double CLOSEST = 1e-15;

/* The Illinois method: a false position that stays on one side is halved. Where the secant rounds to an end
 * of the bracket, as that of a straight line does, the next place is one rounding farther in: only that
 * tells on which side of it the root is. */
double bernstein_root(const double *coefficients, int count, struct bernstein_fall fall)
{
    double low = fall.low;
    double high = fall.high;
    double above = bernstein_at(coefficients, count, low) + fall.offset;
    double below = bernstein_at(coefficients, count, high) + fall.offset;
    int side = 0;
    for (int i = 0; i < 100 && high - low > CLOSEST * high && above > 0.0 && below < 0.0; ++i) {
        const double closest = 0.5 * CLOSEST * high;
        const double secant = low + (high - low) * (above / (above - below));
        const double middle = fmin(fmax(secant, low + closest), high - closest);
        const double value = bernstein_at(coefficients, count, middle) + fall.offset;
        if (value > 0.0) {
            low = middle;
            above = value;
            below *= side > 0 ? 0.5 : 1.0;
            side = 1;
        } else {
            high = middle;
            below = value;
            above *= side < 0 ? 0.5 : 1.0;
            side = -1;
        }
    }
    return high;
}

/* By de Casteljau's scheme, first up to `to`, then from `from` on. */
void bernstein_restrict(double *coefficients, int count, double from, double to)
{
    const double start = to > 0.0 ? from / to : 0.0;
    for (int k = 1; k < count; ++k) {
        for (int i = count - 1; i >= k; --i) {
            coefficients[i] = (1.0 - to) * coefficients[i - 1] + to * coefficients[i];
        }
    }
    for (int k = 1; k < count; ++k) {
        for (int i = 0; i + k < count; ++i) {
            coefficients[i] = (1.0 - start) * coefficients[i] + start * coefficients[i + 1];
        }
    }
}
