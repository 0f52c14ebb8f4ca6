/*
 * This file has unit quaternions as orientations, w + x i + y j + z k: q turns a vector a of the body's frame
 * into q a q* of the world's. q and -q are the same orientation.
 */
#ifndef CONTACT_MATH_QUATERNION_H
#define CONTACT_MATH_QUATERNION_H

#include <float.h>

#include "math/compiler.h"
#include "math/vec3.h"

struct quaternion {
    double w, x, y, z;
};

static inline struct quaternion quaternion_make(double w, struct vec3 v)
{
    return (struct quaternion){w, v.x, v.y, v.z};
}

static inline struct quaternion quaternion_identity(void)
{
    return (struct quaternion){1.0, 0.0, 0.0, 0.0};
}

/* x, y, z */
static inline struct vec3 quaternion_vector(struct quaternion q)
{
    return vec3_make(q.x, q.y, q.z);
}

/* Convert four numbers w, x, y, z to a quaternion, and a quaternion to four numbers. */
static inline struct quaternion quaternion_from(const double *data)
{
    return quaternion_make(data[0], vec3_from(data + 1));
}

static inline void quaternion_to(struct quaternion q, double *data)
{
    data[0] = q.w;
    vec3_to(quaternion_vector(q), data + 1);
}

static inline bool quaternion_is_zero(struct quaternion q)
{
    return q.w == 0.0 && vec3_is_zero(quaternion_vector(q));
}

/* Returns the place of a part of q: of w, x, y or z by the index 0 to 3. */
static inline double *quaternion_part(struct quaternion *q, int index)
{
    double *const parts[] = {&q->w, &q->x, &q->y, &q->z};
    return parts[index];
}

/* Returns a b: first b's rotation, then a's. */
CONTACT_NOT_FUSED static inline struct quaternion quaternion_product(struct quaternion a, struct quaternion b)
{
    return (struct quaternion){
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

/* Returns the opposite rotation of a unit quaternion. */
static inline struct quaternion quaternion_inverse(struct quaternion q)
{
    return (struct quaternion){q.w, -q.x, -q.y, -q.z};
}

static inline double quaternion_dot(struct quaternion a, struct quaternion b)
{
    return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct quaternion quaternion_scale(double s, struct quaternion q)
{
    return (struct quaternion){s * q.w, s * q.x, s * q.y, s * q.z};
}

/* a + s b */
static inline struct quaternion quaternion_axpy(struct quaternion a, double s, struct quaternion b)
{
    return (struct quaternion){a.w + s * b.w, a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

/* Returns q divided by its length. Returns the identity if q is zero, infinite or NaN throughout. */
static inline struct quaternion quaternion_unit(struct quaternion q)
{
    const double largest = fmax(fmax(fabs(q.w), fabs(q.x)), fmax(fabs(q.y), fabs(q.z)));
    if (!(largest > 0.0 && largest < (double)INFINITY)) {
        return quaternion_identity();
    }
    const struct quaternion s = {q.w / largest, q.x / largest, q.y / largest, q.z / largest};
    return quaternion_scale(1.0 / sqrt(quaternion_dot(s, s)), s);
}

/* Returns q a q*: a + 2 w v x a + 2 v x (v x a) for q = (w, v). */
static inline struct vec3 quaternion_rotate(struct quaternion q, struct vec3 a)
{
    const struct vec3 v = quaternion_vector(q);
    const struct vec3 twice = vec3_scale(2.0, vec3_cross(v, a));
    return vec3_add(vec3_axpy(a, q.w, twice), vec3_cross(v, twice));
}

/* The third axis of the body's frame in the world's, q e_z q*. */
CONTACT_NOT_FUSED static inline struct vec3 quaternion_third_axis(struct quaternion q)
{
    return vec3_make(2.0 * (q.x * q.z + q.w * q.y), 2.0 * (q.y * q.z - q.w * q.x),
                     (q.w * q.w - q.x * q.x) + (q.z * q.z - q.y * q.y));
}

/* Returns the rotation by |r| radians about r, right-handed. */
static inline struct quaternion quaternion_of_rotation(struct vec3 r)
{
    const double angle = vec3_norm(r);
    if (!(angle > 0.0)) {
        return quaternion_identity();
    }
    return quaternion_make(cos(0.5 * angle), vec3_scale(sin(0.5 * angle) / angle, r));
}

/* dq/dt = (0, omega) q / 2 for the angular velocity omega in the world's frame. */
static inline struct quaternion quaternion_rate(struct quaternion q, struct vec3 omega)
{
    return quaternion_product(quaternion_make(0.0, vec3_scale(0.5, omega)), q);
}

/*
 * The smallest rotation that takes the unit vector a to the unit vector b: about a x b = a x h with
 * h = a + b, |h| = 2 cos(angle/2). Near antiparallel vectors h is exact and small, so that a x h keeps its
 * digits, which a x b loses. Antiparallel to rounding: half a turn about x, or about y where x is nearly
 * along a, made perpendicular to a.
 */
static inline struct quaternion quaternion_between(struct vec3 a, struct vec3 b)
{
    const struct vec3 h = vec3_add(a, b);
    const double length = vec3_norm(h);
    if (!(length > 4.0 * DBL_EPSILON)) {
        const struct vec3 start = fabs(a.x) < 0.9 ? vec3_make(1.0, 0.0, 0.0) : vec3_make(0.0, 1.0, 0.0);
        const struct vec3 across = vec3_axpy(start, -vec3_dot(start, a), a);
        return quaternion_make(0.0, vec3_scale(1.0 / vec3_norm(across), across));
    }
    const struct vec3 across = vec3_cross(a, h);
    return quaternion_unit(quaternion_make(0.5 * length, vec3_scale(1.0 / length, across)));
}

#endif
