/*
 * A contact pair in head-on motion: along the normal alone, under a constant relative acceleration along the
 * normal. The gap is a damped oscillator under a constant load, in closed form for any length of time:
 *
 *   g = equilibrium + y,   m_red y'' + p_nv y' + p_n y = 0,   equilibrium = side m_red n.A / p_n
 *
 * Variable s = rate time, in radians of the undamped oscillator. Up to 0.97 of critical damping y oscillates,
 * beyond it decays. Without a spring y = g, m_red y'' + p_nv y' = side m_red n.A, with s in decay times of
 * the dashpot.
 */
#ifndef CONTACT_SEGMENT_PAIR_OSCILLATION_H
#define CONTACT_SEGMENT_PAIR_OSCILLATION_H

#include "math/oscillator.h"
#include "math/overdamped.h"
#include "segment/contact_pair.h"

struct pair_oscillation {
    const struct contact_pair *from;
    double rate;                  /* sqrt(p_n / m_red), or p_nv / m_red [1/s] */
    double stiffness;             /* m_red rate^2: p_n where there is a spring [N/m] */
    double load;                  /* side n.A per s^2 [m] */
    struct oscillator oscillator; /* of y, per s, where there is a spring: omega2 1 */
    double omega_d;               /* radians of y per s: sqrt(1 - damping_rate^2 / 4); 0 where it decays */
    struct overdamped overdamped; /* there */
    double equilibrium;           /* static equilibrium: the load with a spring, 0 without [m] */
    double y, y_rate;             /* at the start, per s [m] */
    double amplitude;             /* |y| stays below it, the drift left out [m] */
};

/* Of a pair that moves head-on (pair->is_head_on). False where it might reach the centre of solid bodies (inside a hollow body contact ends before). */
bool pair_oscillation_make(struct pair_oscillation *p, const struct contact_pair *from);

/* Whether factor quantity + offset stays positive for all s >= 0. */
bool pair_oscillation_stays_above(const struct pair_oscillation *p, enum pair_quantity quantity,
                                  double factor, double offset);

/* Upper bound of s for a segment with events. Where y decays, no quantity has two extrema within it. INFINITY
 * where y oscillates. */
double pair_oscillation_longest(const struct pair_oscillation *p);

/* The first s > 0 at which the gap has an extremum. Further ones follow every half period pi / omega_d, and
 * so do the extrema of the other quantities. */
double pair_oscillation_first_extremum(const struct pair_oscillation *p);

/* Whether the gap decreases until that first extremum. */
bool pair_oscillation_closes(const struct pair_oscillation *p);

/* The sample at an extremum of the oscillation, a minimum of the gap (deepest) or a maximum, without
 * trigonometric functions. */
void pair_oscillation_sample_extremum(const struct pair_oscillation *p, double s, bool deepest,
                                      struct pair_sample *sample);

void pair_oscillation_sample(const void *pair_oscillation, double s, struct pair_sample *sample);

struct pair_change pair_oscillation_change(const void *pair_oscillation, double s);

#endif
