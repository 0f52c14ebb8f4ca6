/*
 * A contact pair at the rim of a capped cylinder, by power series (Jorba and Zou, as in pair.h and
 * hertz.h). The geometry is that of a circle: with the axis e of the cap, the centre's distance rho from
 * it, which changes along the unit vector a, and the place beyond rim and cap
 *
 *   c = C + r,   dr = rho - r_d,   dz = -c.e - h,   d = sqrt(dr^2 + dz^2),   n = (dr a - dz e) / d
 *
 * all of which follow order by order from products, roots and quotients. The variable s is time / unit; under
 * Hertz's law dt/ds = unit u with u = sqrt(delta), in which touch and release are regular.
 */
#ifndef CONTACT_TOUCH_RIM_H
#define CONTACT_TOUCH_RIM_H

#include "math/series.h"
#include "touch/pair.h"

struct rim_series {
    const struct contact_pair *from;
    bool by_root;                /* whether dt/ds = unit u; else it is the unit, and the force is linear */
    bool damps;                  /* whether the law has a dashpot */
    int terms;                   /* of all series; none beyond is defined */
    double unit;                 /* [s], or [s/sqrt(m)] */
    double step;                 /* the sums are exact to rounding up to this s */
    double time[TAYLOR_TERMS];   /* t since the start [s] */
    double root[TAYLOR_TERMS];   /* u [sqrt(m)] */
    double gap[TAYLOR_TERMS];    /* g [m] */
    double rate[TAYLOR_TERMS];   /* g' as the law sees it [m/s] */
    double force[TAYLOR_TERMS];  /* F_n [N] */
    double cube[TAYLOR_TERMS];   /* u^3 */
    double lost[TAYLOR_TERMS];   /* dissipated power by s over the unit */
    double radial[TAYLOR_TERMS]; /* dr [m] */
    double axial[TAYLOR_TERMS];  /* dz [m] */
    struct taylor_vec3 r;        /* deviation of the separation from flight [m] */
    struct taylor_vec3 r_rate;   /* r' [m/s] */
};

/* From the start of the pair over at most `longest` seconds; `by_root` not from rest at delta = 0, where s
 * stands still. */
void rim_series_make(struct rim_series *p, const struct contact_pair *from, bool by_root, double longest);

/* The time at s [s], and the s up to `end` of a time. */
double rim_series_time(const struct rim_series *p, double s);
double rim_series_place(const struct rim_series *p, double time, double end);

void rim_series_sample(const void *rim_series, double s, struct pair_sample *sample);

struct pair_change rim_series_change(const void *rim_series, double s);

#endif
