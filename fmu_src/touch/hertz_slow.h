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
#include "touch/pair.h"

enum {
    HERTZ_TURNING = 2 * FRAME, /* components of n, then of H */
    SLOW_N = RADAU_POINTS
};

struct slow_turning; /* how n and H turn: in hertz_slow.c */

struct hertz_slow {
    const struct contact_pair *from;
    const struct slow_turning *turns;
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

/* Whether the step [s] is accurate: delta and what it oscillates by to `depth_tolerance`, d n to `tolerance`
 * [m]. */
bool slow_hertz_make(struct hertz_slow *p, const struct contact_pair *from, double step, double tolerance,
                     double depth_tolerance);

void slow_hertz_sample(const void *hertz_slow, double s, struct pair_sample *sample);

struct pair_change slow_hertz_change(const void *hertz_slow, double s);

#endif
