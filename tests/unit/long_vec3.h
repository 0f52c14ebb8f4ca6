/* Vectors in long double, for recomputing what the code computes in double; its exponents need no scaling. */
#ifndef LONG_VEC3_H
#define LONG_VEC3_H

#include <math.h>

#include "check.h"
#include "contact/shape.h"

struct long_vec3 {
    long double x, y, z;
};

static inline struct long_vec3 long_of(struct vec3 a)
{
    return (struct long_vec3){a.x, a.y, a.z};
}

/* a + s b */
static inline struct long_vec3 long_axpy(struct long_vec3 a, long double s, struct long_vec3 b)
{
    return (struct long_vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline long double long_dot(struct long_vec3 a, struct long_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline long double long_norm(struct long_vec3 a)
{
    return sqrtl(long_dot(a, a));
}

/* Makes a plane with a random normal of a shape that is to be one, an axis of one that is a cylinder. */
static inline void long_complete_shape(struct contact_shape *shape, struct vec3 direction)
{
    if (shape->destination != SHAPE_SPHERE) {
        shape->axis = direction;
    }
    if (shape->destination == SHAPE_PLANE) {
        shape->side = 1;
        shape->other_radius = 0.0;
    }
}

#endif
