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

static struct vec3 edges_of(const struct bounding_box *a, const struct bounding_box *b)
{
    return (struct vec3){fmax(a->high.x, b->high.x) - fmin(a->low.x, b->low.x),
                         fmax(a->high.y, b->high.y) - fmin(a->low.y, b->low.y),
                         fmax(a->high.z, b->high.z) - fmin(a->low.z, b->low.z)};
}

double bounding_box_diagonal(const struct bounding_box *a, const struct bounding_box *b)
{
    return vec3_norm(edges_of(a, b));
}

double bounding_box_diagonal_rate(const struct bounding_box *a, const struct bounding_box *b,
                                  struct vec3 rate)
{
    const struct vec3 edges = edges_of(a, b);
    const struct vec3 grows = {((b->high.x > a->high.x) - (b->low.x < a->low.x)) * rate.x,
                               ((b->high.y > a->high.y) - (b->low.y < a->low.y)) * rate.y,
                               ((b->high.z > a->high.z) - (b->low.z < a->low.z)) * rate.z};
    return vec3_dot(vec3_scale(1.0 / vec3_norm(edges), edges), grows);
}
