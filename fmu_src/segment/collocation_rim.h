/*
 * Collocation at the rim of a capped cylinder, in the coordinates of rim_local.h. The rows of the result are
 * those of n and H elsewhere: n.x and n.y are the changes of azimuth and tilt, h.x and h.y those of their
 * momenta; n.z and h.z are zero.
 */
#ifndef CONTACT_SEGMENT_COLLOCATION_RIM_H
#define CONTACT_SEGMENT_COLLOCATION_RIM_H

#include "segment/collocation.h"

#ifndef CONTACT_NO_CAPS

/* Whether the step is at a rim, and turns. */
static inline bool collocation_at_rim(const struct collocation *p)
{
    return p->from.at_rim && !p->local.head_on;
}

/* Frame and what acts; f; the first guess. */
void collocation_rim_begin(struct collocation *p);
double collocation_rim_load_at_start(const struct collocation *p);
void collocation_rim_guess(struct collocation *p, double half);

/* half^2 f [m] at the nodes, and half of its softening, -half^2 df/dx. */
void collocation_rim_load(const struct collocation *p, double *values, double *softening);

/* The momenta, then the angles by them; returns the largest change [m]. */
double collocation_rim_turn(struct collocation *p);

/* Of a step whose sweeps have converged: result.tilt_rate. */
void collocation_rim_keep_tilt(struct collocation *p);

/* half n.E at the nodes [m]. */
void collocation_rim_mismatch(const struct collocation *p, double *values);

/* c - c(0) and n at a node, in the world, the oscillation left out. */
void collocation_rim_at_node(const struct collocation *p, int node, struct vec3 *moved, struct vec3 *normal);

struct collocation_change collocation_rim_change_at(const struct collocation *p, double s);

/* Below: what the files of the rim share. */

/* From rows of n and H, or at a node, the oscillation left out. */
struct rim_state collocation_rim_state(const struct collocation *p, struct vec3 n, struct vec3 h, double x);
struct rim_state collocation_rim_state_at_node(const struct collocation *p, int i);

/* What y adds to the rows. */
struct collocation_correction collocation_rim_correction(const struct collocation *p,
                                                         const struct rim_state *at, struct vec3 acceleration,
                                                         double y, double y_rate);

#else /* never, and none of these is called */

static inline bool collocation_at_rim(const struct collocation *p)
{
    (void)p;
    return false;
}

static inline void collocation_rim_begin(struct collocation *p)
{
    (void)p;
}

static inline double collocation_rim_load_at_start(const struct collocation *p)
{
    (void)p;
    return 0.0;
}

static inline void collocation_rim_guess(struct collocation *p, double half)
{
    (void)p, (void)half;
}

static inline void collocation_rim_load(const struct collocation *p, double *values, double *softening)
{
    (void)p, (void)values, (void)softening;
}

static inline double collocation_rim_turn(struct collocation *p)
{
    (void)p;
    return 0.0;
}

static inline void collocation_rim_keep_tilt(struct collocation *p)
{
    (void)p;
}

static inline void collocation_rim_mismatch(const struct collocation *p, double *values)
{
    (void)p, (void)values;
}

static inline void collocation_rim_at_node(const struct collocation *p, int node, struct vec3 *moved,
                                           struct vec3 *normal)
{
    (void)p, (void)node;
    *moved = *normal = vec3_make(0.0, 0.0, 0.0);
}

static inline struct collocation_change collocation_rim_change_at(const struct collocation *p, double s)
{
    (void)p, (void)s;
    return (struct collocation_change){.deviation = 0.0};
}

#endif
#endif
