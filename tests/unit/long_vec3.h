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

/* What a contact's geometry is by DESIGN, written without the code's common form g = side (d - reach). */
struct long_geometry {
    struct long_vec3 normal, offset;
    long double distance, gap, gap_rate, axial;
};

static inline struct long_geometry long_geometry_at(const struct contact_shape *shape, struct long_vec3 c,
                                                    struct long_vec3 w)
{
    struct long_geometry at = {.offset = c};
    if (shape->destination == SHAPE_CYLINDER) {
        const struct long_vec3 e = long_of(shape->axis);
        at.axial = long_dot(c, e);
        at.offset = long_axpy(c, -at.axial, e);
    }
    at.distance = long_norm(at.offset);
    at.normal = long_axpy((struct long_vec3){0.0L, 0.0L, 0.0L}, 1.0L / at.distance, at.offset);
    if (shape->destination == SHAPE_PLANE) {
        at.normal = long_axpy((struct long_vec3){0.0L, 0.0L, 0.0L}, -1.0L, long_of(shape->axis));
        at.distance = long_dot(at.normal, c);
    }
    const long double opening = long_dot(at.normal, w);
    const long double r_s = shape->source_radius;
    const long double r_d = shape->other_radius;
    at.gap = shape->side > 0 ? at.distance - r_s - r_d : r_d - r_s - at.distance;
    at.gap_rate = shape->side > 0 ? opening : -opening;
    return at;
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
