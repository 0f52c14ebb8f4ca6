/* How n and H turn in a collocated step, and the load on x that comes of it. */
#ifndef CONTACT_SEGMENT_COLLOCATION_TURNING_H
#define CONTACT_SEGMENT_COLLOCATION_TURNING_H

#include "segment/collocation.h"

/* half^2 f [m] at the nodes, and half of its softening, -half^2 df/dx of the centrifugal terms. */
void collocation_load(const struct collocation *p, double *values, double *softening);

/* H by n, then n by that H; returns the largest change [m]. */
double collocation_turn(struct collocation *p);

/* Of a step whose sweeps have converged: n.E; the tilt at a rim. */
void collocation_keep_mismatch(struct collocation *p);
void collocation_keep_tilt(struct collocation *p);

/* A vector of the world in the frame of the start, and back. */
static inline struct vec3 collocation_in_frame(const struct collocation *p, struct vec3 a)
{
    return vec3_make(vec3_dot(p->local.frame[0], a), vec3_dot(p->local.frame[1], a),
                     vec3_dot(p->local.frame[2], a));
}

static inline struct vec3 collocation_in_world(const struct collocation *p, struct vec3 a)
{
    return vec3_axpy(vec3_axpy(vec3_scale(a.x, p->local.frame[0]), a.y, p->local.frame[1]), a.z,
                     p->local.frame[2]);
}

#endif
