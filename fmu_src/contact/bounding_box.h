/* The axis-aligned box around bodies, whose diagonal scales the automatic penalty factors. World frame,
 * metres. */
#ifndef CONTACT_CONTACT_BOUNDING_BOX_H
#define CONTACT_CONTACT_BOUNDING_BOX_H

#include "math/vec3.h"

struct bounding_box {
    struct vec3 low, high;
};

/* A sphere: the radius in every direction. */
struct bounding_box bounding_box_sphere(struct vec3 centre, double radius);

/* A cylinder around the unit vector `axis`: half_length |e_i| + radius sqrt(1 - e_i^2) in direction i.
 * half_length 0 gives the cross-section alone, which is how an infinite cylinder enters. */
struct bounding_box bounding_box_cylinder(struct vec3 centre, double radius, struct vec3 axis,
                                          double half_length);

/* Diagonal of the smallest box around both [m]. */
double bounding_box_diagonal(const struct bounding_box *a, const struct bounding_box *b);

/* d/dt of that diagonal while b moves with `rate` [m/s]; where edges of both lie on each other, it is a's
 * that counts. */
double bounding_box_diagonal_rate(const struct bounding_box *a, const struct bounding_box *b,
                                  struct vec3 rate);

#endif
