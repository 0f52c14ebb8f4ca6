/*
 * A lasting contact under Hertz's law whose oscillation has died away: steps as long as the motion along the
 * contact allows, whatever the stiffness.
 *
 *   n' = H x n / d^2,   H' = d n x A,   d = reach - side delta,
 *   delta'' = L - (k_h / m_red) delta^(3/2) (1 + chi delta'),   L = -side (|H|^2 / d^3 + n.A)
 *
 * by Radau IIA collocation with twelve stages (Hairer and Wanner, Solving Ordinary Differential Equations II,
 * IV.5): only the last equation is stiff and takes Newton's method, n and H follow by sweeps. What oscillates
 * or decays faster than the step is damped away, so the step is only taken where that is within tolerance.
 *
 * Variable s in [0, 2] over the step: time = half s. Vectors in the frame of the start (frame_flight).
 */
#ifndef CONTACT_TOUCH_HERTZ_SLOW_H
#define CONTACT_TOUCH_HERTZ_SLOW_H

#include "math/node_tables.h"
#include "math/nodes.h"
#include "touch/series.h"

enum {
    HERTZ_TURNING = 2 * FRAME, /* components of n, then of H */
    SLOW_N = RADAU_POINTS
};

struct hertz_slow {
    const struct contact_pair *from;
    struct frame_flight flight;
    double half;                         /* of the step [s] */
    double k;                            /* k_h / m_red */
    double start[HERTZ_TURNING];         /* n, H at the start */
    double pull[SLOW_N][FRAME];          /* at the nodes: A [m/s^2] */
    nodal_values turned[HERTZ_TURNING];  /* at the nodes: change of n and H since the start */
    nodal_values turning[HERTZ_TURNING]; /* d/ds of these */
    double depth_start, rate_start;      /* delta [m], d delta/ds [m] */
    nodal_values depth;                  /* at the nodes: delta [m] */
    nodal_values rate;                   /* d delta/ds [m] */
    nodal_values bend;                   /* d2 delta/ds2 [m] */
    nodal_values rate_terms;             /* of `rate`, coefficients of s - 1 */
    struct rim_start rim;                /* at a rim */
};

/* n, H, delta and d delta/ds at s. */
struct slow_place {
    double turned[HERTZ_TURNING];
    double depth, rate;
};

/* Whether the step [s] is accurate: delta and what it oscillates by to `depth_tolerance`, d n to `tolerance`
 * [m]. */
bool slow_hertz_make(struct hertz_slow *p, const struct contact_pair *from, double step, double tolerance,
                     double depth_tolerance);

void slow_hertz_sample(const void *hertz_slow, double s, struct pair_sample *sample);

struct pair_change slow_hertz_change(const void *hertz_slow, double s);

/* Below: what the files of this kind share. */

/* factor a x b */
static inline void slow_cross(const double *a, const double *b, double slow_factor, double out[FRAME])
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
    if (contact_is_rim(&p->from->shape)) { /* its third rows are zero */
        return p->flight.dimensions > 1 && row % FRAME < 2;
    }
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

/* One sweep with delta as it is: H by n, then n by that H, so that the error falls by two powers of the
 * radians in the step; returns the largest change of n. */
double slow_sweep_turning(struct hertz_slow *p);

/* p->pull, from p->flight and p->half. */
void slow_note_pull(struct hertz_slow *p);

/* half^2 L [m] at the nodes. */
void slow_load(const struct hertz_slow *p, double load[SLOW_N]);

#endif
