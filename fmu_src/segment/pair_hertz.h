/*
 * A contact pair under a force F_n = k_h delta^(3/2) (1 + chi delta') (Hertz; Hunt and Crossley), by power
 * series.
 *
 * In time the force is singular where the bodies touch and where they part: a series cannot begin at the one
 * and converges ever more slowly towards the other. With u = sqrt(delta) and a variable s of its own, dt/ds =
 * unit u, the motion is
 *
 *   u_s = unit delta'/2,   c_s = unit u c',   c'_s = unit u (A + side F_n n / m_red),
 *   u F_n = k_h u^4 (1 + chi delta'),   d = reach - side u^2,   delta' = -side n.c',   n = c / d
 *
 * which is analytic throughout: at the touch and where the bodies part u passes through zero with a slope. So
 * the coefficients follow order by order from products and quotients (as in pair_taylor.h), a step may begin
 * at u = 0, and the release is an ordinary root of u.
 */
#ifndef CONTACT_SEGMENT_PAIR_HERTZ_H
#define CONTACT_SEGMENT_PAIR_HERTZ_H

#include "math/taylor.h"
#include "segment/contact_pair.h"

enum { HERTZ_DIMENSIONS = 3 };

/* The flight of a pair in the frame of its start: coefficients of time, of a cylinder across its axis. */
struct hertz_flight {
    struct vec3 frame[HERTZ_DIMENSIONS]; /* n, the tangential direction of the motion, across both */
    int dimensions;                      /* of these that take part: one head-on, two in a plane */
    int degree;                          /* of C, and of W plus one */
    double c[SEPARATION_DEGREE + 1][HERTZ_DIMENSIONS]; /* C but for C(0) */
    double w[SEPARATION_DEGREE][HERTZ_DIMENSIONS];     /* W */
};

struct hertz_flight hertz_flight_of(const struct contact_pair *from);

struct pair_hertz {
    const struct contact_pair *from;
    struct hertz_flight flight;
    double unit;                                   /* [s/sqrt(m)] */
    double step;                                   /* the sums are that exact up to this s */
    double time[TAYLOR_TERMS];                     /* t since the start [s] */
    double root[TAYLOR_TERMS];                     /* u [sqrt(m)] */
    double rate[TAYLOR_TERMS];                     /* g' as the law sees it [m/s] */
    double drag[TAYLOR_TERMS];                     /* -u times the dashpot's part of F_n; where chi > 0 */
    double r[HERTZ_DIMENSIONS][TAYLOR_TERMS];      /* deviation of the separation from flight [m] */
    double r_rate[HERTZ_DIMENSIONS][TAYLOR_TERMS]; /* r' [m/s] */
};

/* From delta >= 0 on; not from rest at delta = 0, where s stands still. The sums are exact to `accuracy`,
 * a part of their largest terms. */
void pair_hertz_make(struct pair_hertz *p, const struct contact_pair *from, double accuracy);

/* The time at s [s], and the s of a time between those of two places. */
double pair_hertz_time(const struct pair_hertz *p, double s);
double pair_hertz_place(const struct pair_hertz *p, double time, double end);

/* The first s up to `end` at which the bodies part, as u, of which these are the coefficients, passes through
 * zero; INFINITY: none. */
double pair_hertz_parting(const double root[TAYLOR_TERMS], double end);

void pair_hertz_sample(const void *pair_hertz, double s, struct pair_sample *sample);

struct pair_change pair_hertz_change(const void *pair_hertz, double s);

/* Penetration at which the force balances an acceleration [m/s^2] of the reduced mass [m]. */
double pair_hertz_depth_under(const struct contact_pair *from, double acceleration);

/* The depth to which present speed, load and penetration lead before damping makes them creep, its order of
 * magnitude [m]: of an impact delta^(5/2) = 5/4 v^2 / k, with much damping 5/2 v / (k chi), k by mass; of a
 * load a at rest delta^(3/2) = a / k, with much damping where k chi delta^(3/2) is the time in which it has
 * brought that about, delta^4 = a / (2 (k chi)^2). */
double pair_hertz_depth_to_come(const struct contact_pair *from, double opening);

#endif
