/*
 * What only Hertz's law has, F_n = k_h delta^(3/2) (1 + chi delta'): the depths that speeds and loads lead
 * to, how long bodies at the touch hardly feel each other, and the closed form of an undamped head-on
 * impact.
 */
#ifndef CONTACT_TOUCH_HERTZ_H
#define CONTACT_TOUCH_HERTZ_H

#include "touch/pair.h"

/* Penetration at which the force balances an acceleration [m/s^2] of the reduced mass [m]. */
double hertz_depth_under(const struct contact_pair *from, double acceleration);

/* The depth to which present speed, load and penetration lead before damping makes them creep, its order of
 * magnitude [m]: of an impact delta^(5/2) = 5/4 v^2 / k, with much damping 5/2 v / (k chi), k by mass; of a
 * load a at rest delta^(3/2) = a / k, with much damping where k chi delta^(3/2) is the time in which it has
 * brought that about, delta^4 = a / (2 (k chi)^2). */
double hertz_depth_to_come(const struct contact_pair *from, double opening);

/*
 * A head-on impact by Hertz's law without damping, under a constant relative acceleration L that presses the
 * bodies together (negative: that pulls them apart), in closed form up to one quadrature.
 *
 *   v^2 = e + 2 L delta - (4/5) k delta^(5/2),   k = k_h / m_red,   e: the square of the speed at the touch
 *
 * With delta = delta_max u^2 and u = 1 - w^2 the right side is w^2 P(u), P of degree four, and
 *
 *   delta' = -w sqrt(P),   dt = 4 delta_max u / sqrt(P) dw:
 *
 * the touch is at w = -1, the deepest place at 0, the release at 1, and nothing is singular in between.
 * Variable s = w less that of the start.
 */

struct hertz_elastic {
    const struct contact_pair *from;
    double load;           /* L [m/s^2] */
    double touch, pressed; /* e, and 2 L delta_max [m^2/s^2] */
    double deepest;        /* delta_max [m] */
    double start;          /* w */
    double end;            /* the s of the release, and its time: */
    double end_time;       /* [s] */
};

/* Whether the motion is of this kind and the impact is fast: e is no less than 4 L delta_max. A contact that
 * hardly parts, or does not, is none. */
bool hertz_elastic_make(struct hertz_elastic *p, const struct contact_pair *from);

/* The time at s [s], and the s of a time before the release. */
double hertz_elastic_time(const struct hertz_elastic *p, double s);
double hertz_elastic_place(const struct hertz_elastic *p, double time);

void hertz_elastic_sample(const void *hertz_elastic, double s, struct pair_sample *sample);

struct pair_change hertz_elastic_change(const void *hertz_elastic, double s);

#endif
