/* Vectors of the world frame, three doubles, by value. */
#ifndef CONTACT_MATH_VEC3_H
#define CONTACT_MATH_VEC3_H

#include <math.h>
#include <stdbool.h>

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

/* Convert three numbers to a vector, and a vector to three numbers. */
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

/* Returns component 0, 1 or 2. */
static inline double vec3_get(struct vec3 a, int index)
{
    return index == 0 ? a.x : index == 1 ? a.y : a.z;
}

static inline double *vec3_part(struct vec3 *a, int index)
{
    return index == 0 ? &a->x : index == 1 ? &a->y : &a->z;
}

static inline void vec3_set(struct vec3 *a, int index, double value)
{
    *vec3_part(a, index) = value;
}

static inline void vec3_add_to(struct vec3 *a, int index, double value)
{
    vec3_set(a, index, vec3_get(*a, index) + value);
}

static inline double vec3_max_abs(struct vec3 a)
{
    const double x = fabs(a.x);
    const double y = fabs(a.y);
    const double z = fabs(a.z);
    const double yz = y > z ? y : z;
    return x > yz ? x : yz;
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

/* 3 x 3 matrices, m[row][column]. */

/* m += factor a b^T */
static inline void matrix3_add_outer(double m[3][3], double factor, struct vec3 a, struct vec3 b)
{
    const double left[3] = {a.x, a.y, a.z};
    const double right[3] = {b.x, b.y, b.z};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            m[i][j] += factor * left[i] * right[j];
        }
    }
}

#endif
