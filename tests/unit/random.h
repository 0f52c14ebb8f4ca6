/* A seeded generator for configurations, the same on every machine: splitmix64 (Steele, Lea, Flood 2014). */
#ifndef RANDOM_H
#define RANDOM_H

#include <math.h>
#include <stdint.h>

#include "math/vec3.h"

struct random {
    uint64_t state;
};

static inline uint64_t random_bits(struct random *r)
{
    r->state += 0x9e3779b97f4a7c15u;
    uint64_t z = r->state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Uniform in [low, high). */
static inline double random_between(struct random *r, double low, double high)
{
    return low + (high - low) * ((double)(random_bits(r) >> 11) * 0x1p-53);
}

/* 0 .. count - 1 */
static inline int random_index(struct random *r, int count)
{
    return (int)(random_bits(r) % (uint64_t)count);
}

static inline double random_sign(struct random *r)
{
    return random_index(r, 2) == 0 ? -1.0 : 1.0;
}

/* Powers of ten, uniform in the exponent. */
static inline double random_power(struct random *r, double lowest, double highest)
{
    return pow(10.0, random_between(r, lowest, highest));
}

/* Components uniform in [-size, size). */
static inline struct vec3 random_vector(struct random *r, double size)
{
    const double x = random_between(r, -size, size);
    const double y = random_between(r, -size, size);
    return vec3_make(x, y, random_between(r, -size, size));
}

/* A direction; every seventh is a coordinate axis, where formulas have their corners. */
static inline struct vec3 random_direction(struct random *r)
{
    if (random_index(r, 7) == 0) {
        const double sign = random_sign(r);
        const int axis = random_index(r, 3);
        return vec3_make(axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0);
    }
    for (;;) {
        const struct vec3 a = random_vector(r, 1.0);
        const double length = sqrt(a.x * a.x + a.y * a.y + a.z * a.z);
        if (length > 0.1 && length < 1.0) {
            return vec3_make(a.x / length, a.y / length, a.z / length);
        }
    }
}

#endif
