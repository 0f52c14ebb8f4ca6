/*
 * A slow segment under Hertz's law at the rim of a capped cylinder, in the coordinates of rim_local.h: the
 * rows of n hold the changes of azimuth and tilt, those of H the changes of their momenta; the third ones are
 * zero.
 */
#ifndef CONTACT_SEGMENT_HERTZ_SLOW_RIM_H
#define CONTACT_SEGMENT_HERTZ_SLOW_RIM_H

#include "segment/hertz_slow.h"

#if SCENE_ANY_CAPS

/* Whether it is at a rim, and n turns. */
static inline bool slow_at_rim(const struct hertz_slow *p)
{
    return contact_is_rim(&p->from->shape) && p->flight.dimensions > 1;
}

/* The frame, and the flight in it. */
void slow_rim_begin(struct hertz_slow *p);

/* As slow_sweep_turning and slow_load. */
double slow_rim_sweep(struct hertz_slow *p);
void slow_rim_load(const struct hertz_slow *p, double load[SLOW_N]);

/* In the frame at a place: n; r and r'. */
void slow_rim_normal(const struct hertz_slow *p, const struct slow_place *at, double n[HERTZ_DIMENSIONS]);
void slow_rim_deviation(const struct hertz_slow *p, const struct slow_place *at, double s,
                        double r[HERTZ_DIMENSIONS], double r_rate[HERTZ_DIMENSIONS]);

/* PAIR_RADIAL and PAIR_AXIAL at a place; of a head-on motion too. */
void slow_rim_edges(const struct hertz_slow *p, const struct slow_place *at, double s,
                    struct pair_sample *sample);

#else /* never, and none of these is called */

static inline bool slow_at_rim(const struct hertz_slow *p)
{
    (void)p;
    return false;
}

static inline void slow_rim_begin(struct hertz_slow *p)
{
    (void)p;
}

static inline double slow_rim_sweep(struct hertz_slow *p)
{
    (void)p;
    return 0.0;
}

static inline void slow_rim_load(const struct hertz_slow *p, double load[SLOW_N])
{
    (void)p, (void)load;
}

static inline void slow_rim_normal(const struct hertz_slow *p, const struct slow_place *at,
                                   double n[HERTZ_DIMENSIONS])
{
    (void)p, (void)at, (void)n;
}

static inline void slow_rim_deviation(const struct hertz_slow *p, const struct slow_place *at, double s,
                                      double r[HERTZ_DIMENSIONS], double r_rate[HERTZ_DIMENSIONS])
{
    (void)p, (void)at, (void)s, (void)r, (void)r_rate;
}

#endif
#endif
