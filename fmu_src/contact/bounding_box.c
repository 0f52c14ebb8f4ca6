#include "contact/bounding_box.h"

static struct bounding_box around(struct vec3 centre, struct vec3 half)
{
    return (struct bounding_box){vec3_sub(centre, half), vec3_add(centre, half)};
}

struct bounding_box bounding_box_sphere(struct vec3 centre, double radius)
{
    return around(centre, vec3_make(radius, radius, radius));
}

static double half_extent(double radius, double e, double half_length)
{
    return half_length * fabs(e) + radius * sqrt(fmax(0.0, (1.0 - e) * (1.0 + e)));
}

struct bounding_box bounding_box_cylinder(struct vec3 centre, double radius, struct vec3 axis,
                                          double half_length)
{
    return around(centre, vec3_make(half_extent(radius, axis.x, half_length),
                                    half_extent(radius, axis.y, half_length),
                                    half_extent(radius, axis.z, half_length)));
}

double bounding_box_diagonal(const struct bounding_box *a, const struct bounding_box *b)
{
    const struct vec3 edges = {fmax(a->high.x, b->high.x) - fmin(a->low.x, b->low.x),
                               fmax(a->high.y, b->high.y) - fmin(a->low.y, b->low.y),
                               fmax(a->high.z, b->high.z) - fmin(a->low.z, b->low.z)};
    return vec3_norm(edges);
}
