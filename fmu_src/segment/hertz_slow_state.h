/* What the iteration of a slow step and its dense output share. */
#ifndef CONTACT_SEGMENT_HERTZ_SLOW_STATE_H
#define CONTACT_SEGMENT_HERTZ_SLOW_STATE_H

#include "math/radau.h"
#include "segment/hertz_slow.h"

enum { SLOW_N = RADAU_POINTS };

/* factor a x b */
static inline void slow_cross(const double *a, const double *b, double slow_factor,
                              double out[HERTZ_DIMENSIONS])
{
    out[0] = slow_factor * (a[1] * b[2] - a[2] * b[1]);
    out[1] = slow_factor * (a[2] * b[0] - a[0] * b[2]);
    out[2] = slow_factor * (a[0] * b[1] - a[1] * b[0]);
}

static inline double slow_distance(const struct hertz_slow *p, double depth)
{
    return p->from->distance - p->from->shape.side * (depth - p->depth_start);
}

/* Whether a component of n or H changes. */
static inline bool is_turning(const struct hertz_slow *p, int row)
{
    const bool in_plane = row == 0 || row == 1 || row == HERTZ_TURNING - 1;
    return p->flight.dimensions == 3 || (p->flight.dimensions == 2 && in_plane);
}

/* The bend by the law, and its derivatives with respect to delta and d delta/ds. */
static inline void slow_law(const struct hertz_slow *p, double depth, double rate, double out[3])
{
    const double root = sqrt(depth);
    const double scale = p->half * p->half * p->k;
    const double damping = 1.0 + p->from->chi * rate / p->half;
    out[0] = scale * depth * root * damping;
    out[1] = 1.5 * scale * root * damping;
    out[2] = scale * depth * root * p->from->chi / p->half;
}

#endif
