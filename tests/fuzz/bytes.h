/* A fuzzer's input as a row of choices. Where the bytes are used up every choice is the first one, so that
 * any input is a whole story and a shorter input is a simpler one. */
#ifndef FUZZ_BYTES_H
#define FUZZ_BYTES_H

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

struct bytes {
    const uint8_t *next;
    size_t left;
};

static inline uint8_t bytes_one(struct bytes *b)
{
    if (b->left == 0) {
        return 0;
    }
    --b->left;
    return *b->next++;
}

/* The next `size` bytes, zeros beyond the end. */
static inline void bytes_copy(struct bytes *b, void *to, size_t size)
{
    uint8_t *at = to;
    for (size_t i = 0; i < size; ++i) {
        at[i] = bytes_one(b);
    }
}

/* 0 .. count - 1 */
static inline unsigned bytes_choice(struct bytes *b, unsigned count)
{
    return bytes_one(b) % count;
}

static inline uint32_t bytes_word(struct bytes *b)
{
    uint32_t word = 0;
    bytes_copy(b, &word, sizeof word);
    return word;
}

/* 0 .. 1, both included */
static inline double bytes_part(struct bytes *b)
{
    uint16_t part = 0;
    bytes_copy(b, &part, sizeof part);
    return part / 65535.0;
}

static inline double bytes_between(struct bytes *b, double low, double high)
{
    return low + (high - low) * bytes_part(b);
}

/* 10^low .. 10^high */
static inline double bytes_power(struct bytes *b, double low, double high)
{
    return pow(10.0, bytes_between(b, low, high));
}

/* Any double at all: everyday numbers, powers of ten, those at the edges, any bits. */
static inline double bytes_real(struct bytes *b)
{
    static const double edges[] = {0.0,     -0.0,    1.0,         -1.0,     (double)NAN, (double)INFINITY,
                                   1e-150,  1e150,   -1e150,      1e300,    1.1e300,     -(double)INFINITY,
                                   DBL_MIN, DBL_MAX, DBL_EPSILON, 4.9e-324, 0.5,         1e-300};
    double value = 0.0;
    switch (bytes_choice(b, 5)) {
    case 0:
        return bytes_between(b, -2.0, 2.0);
    case 1:
        return edges[bytes_choice(b, sizeof edges / sizeof edges[0])];
    case 2:
        value = (int8_t)bytes_one(b);
        return value * pow(10.0, (int8_t)bytes_one(b) % 40);
    case 3:
        bytes_copy(b, &value, sizeof value);
        return value;
    default:
        return (int8_t)bytes_one(b);
    }
}

#endif
