/*
 * A pair that presses, as a power series of time: F_n and n follow from c and w by products, a square root and quotients, so the
 * series of r is had coefficient by coefficient (Jorba and Zou, Experimental Mathematics 14 (2005) 99). Exact to rounding;
 * reaches about two radians of the contact's own oscillation or two of its decay times.
 *
 * Series variable s = time / unit, dimensionless.
 */
#ifndef CONTACT_PRESS_SERIES_H
#define CONTACT_PRESS_SERIES_H

#include "contact/series.h"
#include "dynamics/press.h"

#if SCENE_ANY_FREE

struct press_series {
    const struct press *from;
    struct vec3_series r;       /* deviation of the separation from flight [m] */
    double gap[SERIES_TERMS];   /* g [m] */
    double rate[SERIES_TERMS];  /* g' as the law sees it [m/s] */
    double force[SERIES_TERMS]; /* F_n [N] */
    double unit;                /* [s] */
    double step;                /* the sums are exact to rounding up to this s */
};

void press_series_make(struct press_series *p, const struct press *from);

void press_series_sample(const void *press_series, double s, struct press_sample *sample);

struct press_change press_series_change(const struct press_series *p, double s);

#endif
#endif
