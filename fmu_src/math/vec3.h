/* Vectors of the world frame, three doubles, by value. */
#ifndef CONTACT_MATH_VEC3_H
#define CONTACT_MATH_VEC3_H

#include <math.h>
#include <stdbool.h>

#include "math/compiler.h"

struct vec3 {
    double x, y, z;
};

static inline struct vec3 vec3_make(double x, double y, double z)
{
    return (struct vec3){x, y, z};
}

static inline struct vec3 vec3_add(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline struct vec3 vec3_sub(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct vec3 vec3_scale(double s, struct vec3 a)
{
    return (struct vec3){s * a.x, s * a.y, s * a.z};
}

/* a + s b */
static inline struct vec3 vec3_axpy(struct vec3 a, double s, struct vec3 b)
{
    return (struct vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline double vec3_dot(struct vec3 a, struct vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vec3 vec3_cross(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline bool vec3_is_zero(struct vec3 a)
{
    return a.x == 0.0 && a.y == 0.0 && a.z == 0.0;
}

/* Convert three numbers to a vector, and a vector to three numbers; add s a to three numbers. */
static inline struct vec3 vec3_from(const double *data)
{
    return (struct vec3){data[0], data[1], data[2]};
}

static inline void vec3_to(struct vec3 a, double *data)
{
    data[0] = a.x;
    data[1] = a.y;
    data[2] = a.z;
}

static inline void vec3_add_to(double s, struct vec3 a, double *data)
{
    data[0] += s * a.x;
    data[1] += s * a.y;
    data[2] += s * a.z;
}

/* Returns component 0, 1 or 2. */
static inline double vec3_get(struct vec3 a, int index)
{
    return index == 0 ? a.x : index == 1 ? a.y : a.z;
}

static inline double *vec3_part(struct vec3 *a, int index)
{
    return index == 0 ? &a->x : index == 1 ? &a->y : &a->z;
}

static inline double vec3_max_abs(struct vec3 a)
{
    return larger(fabs(a.x), larger(fabs(a.y), fabs(a.z)));
}

/* Length, scaled by the largest component where 1e150 would overflow or 1e-170 underflow when squared. */
static inline double vec3_norm(struct vec3 a)
{
    const double squared = vec3_dot(a, a);
    if (squared > 1e-280 && squared < 1e280) {
        return sqrt(squared);
    }
    const double scale = vec3_max_abs(a);
    if (!(scale > 0.0)) {
        return fabs(a.x) + fabs(a.y) + fabs(a.z); /* zero or NaN */
    }
    const struct vec3 s = {a.x / scale, a.y / scale, a.z / scale};
    return scale * sqrt(vec3_dot(s, s));
}

/* A path is a polynomial of time: the sum of coefficient[i] time^i. */

static inline struct vec3 path_at(const struct vec3 *coefficients, int count, double time)
{
    struct vec3 value = coefficients[count - 1];
    for (int i = count - 2; i >= 0; --i) {
        value = vec3_axpy(coefficients[i], time, value);
    }
    return value;
}

/* Returns the sum of the sizes of the terms, which bounds the path up to `time` >= 0. */
static inline double path_size(const struct vec3 *coefficients, int count, double time)
{
    double size = 0.0;
    for (int i = count - 1; i >= 0; --i) {
        size = size * time + vec3_norm(coefficients[i]);
    }
    return size;
}

/* Returns the derivative of a path of three coefficients. */
static inline struct vec3 path_slope(const struct vec3 path[3], double time)
{
    return vec3_axpy(path[1], 2.0 * time, path[2]);
}

/* Whether all coefficients but the first are zero, as in most paths. */
static inline bool path_is_steady(const struct vec3 *coefficients, int count)
{
    double sum = 0.0;
    for (int i = 1; i < count; ++i) {
        sum += fabs(coefficients[i].x) + fabs(coefficients[i].y) + fabs(coefficients[i].z);
    }
    return sum == 0.0;
}

/* Returns the degree without leading zero coefficients. */
static inline int path_degree(const struct vec3 *coefficients, int count)
{
    int degree = count - 1;
    while (degree > 0 && vec3_is_zero(coefficients[degree])) {
        --degree;
    }
    return degree;
}

/* Whether a path of three coefficients is zero throughout. */
static inline bool path_rests(const struct vec3 path[3])
{
    return path_is_steady(path, 3) && vec3_is_zero(path[0]);
}

/* Changes the coefficients of a path so that its origin moves to `time`. */
static inline void path_shift(struct vec3 *coefficients, int count, double time)
{
    if (path_is_steady(coefficients, count)) {
        return;
    }
    for (int done = 0; done < count - 1; ++done) {
        for (int i = count - 2; i >= done; --i) {
            coefficients[i] = vec3_axpy(coefficients[i], time, coefficients[i + 1]);
        }
    }
}

/* Return coefficient `order` of a product of two series; taylor_multiply (math/series.h) serves for
 * numbers. */
static inline double jet_dot(const struct vec3 *a, const struct vec3 *b, int order)
{
    double sum = 0.0;
    for (int i = 0; i <= order; ++i) {
        sum += vec3_dot(a[i], b[order - i]);
    }
    return sum;
}

static inline struct vec3 jet_cross(const struct vec3 *a, const struct vec3 *b, int order)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i <= order; ++i) {
        sum = vec3_add(sum, vec3_cross(a[i], b[order - i]));
    }
    return sum;
}

static inline struct vec3 jet_scale(const double *a, const struct vec3 *b, int order)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i <= order; ++i) {
        sum = vec3_axpy(sum, a[i], b[order - i]);
    }
    return sum;
}

#endif
