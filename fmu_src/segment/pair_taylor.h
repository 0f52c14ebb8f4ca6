/*
 * A contact pair by Taylor series of time: F_n and n follow from c and w by products, a square root and
 * quotients, so the coefficients of r are found order by order (Jorba and Zou, Experimental Mathematics 14
 * (2005) 99). Exact to rounding; a step covers about two radians of the contact's oscillation or two decay
 * times.
 *
 * Series variable s = time / unit, dimensionless.
 */
#ifndef CONTACT_SEGMENT_PAIR_TAYLOR_H
#define CONTACT_SEGMENT_PAIR_TAYLOR_H

#include "math/taylor.h"
#include "segment/contact_pair.h"

struct pair_taylor {
    const struct contact_pair *from;
    struct taylor_vec3 r;       /* deviation of the separation from flight [m] */
    double gap[TAYLOR_TERMS];   /* g [m] */
    double rate[TAYLOR_TERMS];  /* g' as the law sees it [m/s] */
    double force[TAYLOR_TERMS]; /* F_n [N] */
    double unit;                /* [s] */
    double step;                /* the sums are exact to rounding up to this s */
};

void pair_taylor_make(struct pair_taylor *p, const struct contact_pair *from);

void pair_taylor_sample(const void *pair_taylor, double s, struct pair_sample *sample);

struct pair_change pair_taylor_change(const void *pair_taylor, double s);

#endif
