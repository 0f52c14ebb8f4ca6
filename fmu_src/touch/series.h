/*
 * A contact pair by power series, under either law and at any place (Jorba and Zou, Experimental
 * Mathematics 14 (2005) 99). The force follows from c and c' by products and quotients, so the
 * coefficients are found order by order. A series is exact to its accuracy over a few radians of the
 * contact's oscillation.
 *
 *   g_t = side n.c',   c_t = c',   c'_t = A + side F_n n / m_red,   d = reach + side g,   n = f / d
 *
 * f points from the source's centre to the axis or the centre of the destination, so f = c, or at a rim to
 * the nearest point of the circle of radius R at the height h: with e the axis, rho and a the length and
 * the direction of the part of c across it,
 *
 *   f = c - R a + h e,   rho - R and -(c.e + h): how far the centre is beyond side and cap.
 *
 * Linear law: the variable is s = t / unit, and g is integrated.
 *
 * Hertz's law, F_n = k_h delta^(3/2) (1 + chi delta') (Hunt and Crossley): in time the force is singular
 * where the bodies touch and where they part. A series cannot begin at the touch, and it converges ever
 * more slowly towards the release. So u = sqrt(delta) is integrated, and dt/ds = unit u:
 *
 *   u_s = -unit g_t / 2,   c_s = unit u c',   u F_n = k_h u^4 (1 + chi delta'),   g = -u^2
 *
 * is analytic throughout. At the touch and at the release u passes through zero with a slope. A series may
 * begin at u = 0, and the release is an ordinary root of u.
 */
#ifndef CONTACT_TOUCH_SERIES_H
#define CONTACT_TOUCH_SERIES_H

#include "math/series.h"
#include "touch/pair.h"

typedef double series_row[TAYLOR_TERMS];

struct pair_series {
    const struct contact_pair *from;
    struct frame_flight flight;
    bool by_root;             /* whether u is integrated; else the law is linear */
    double unit;              /* [s], or [s/sqrt(m)] */
    double step;              /* the sums are as exact as asked for up to this s */
    series_row time;          /* t since the start [s] */
    series_row opened;        /* g [m], or u [sqrt(m)] */
    series_row rate;          /* g' as the law sees it [m/s] */
    series_row drag;          /* -dt/ds / unit times the dashpot's part of F_n [N], or [N sqrt(m)] */
    series_row r[FRAME];      /* deviation of the separation from flight [m] */
    series_row r_rate[FRAME]; /* r' [m/s] */
    series_row radial, axial; /* at a rim: how far beyond side and cap [m] */
};

/* A row backwards, from its coefficient 1 on: coefficient j at [TAYLOR_ORDER - j], and zero in place of
 * coefficient 0. Products then read both of their factors forwards, several terms in one instruction. */
typedef double series_back[TAYLOR_TERMS];

/* Everything that the recurrence needs besides the results. */
struct series_work {
    series_row power[SEPARATION_DEGREE + 1];  /* t^k, k from 2 on; by_root */
    double unit_power[SEPARATION_DEGREE + 1]; /* the only coefficient of t^k, else */
    series_row w[FRAME];                      /* rate of the separation as the law sees it [m/s] */
    series_row c_rate[FRAME];                 /* its derivative, where that is another [m/s] */
    series_row n[FRAME];
    series_row d;              /* [m] */
    series_row opening;        /* dg/dt [m/s] */
    series_row square, fourth; /* u^2, u^4 */
    series_row impulse;        /* F_n dt/ds / unit */
    series_back time_back, opened_back, square_back, rate_back;
    series_back n_back[FRAME], r_rate_back[FRAME];
    series_row across[2], rho_squared, rho, a[2]; /* c across the axis; a */
    double normal[FRAME];                         /* n at the start */
    double inverse_distance, side_by_mass;        /* 1/d at the start [1/m], side/m_red [1/kg] */
};

/* The coefficients up to SERIES_FIRST, then the rest; the sums are exact to `accuracy`, a part of their
 * largest terms. `by_root` only under Hertz's law, from g <= 0 on, and not from rest at g = 0, where s
 * stands still. */
enum { SERIES_FIRST = 7 };
void pair_series_begin(struct pair_series *p, struct series_work *z, const struct contact_pair *from,
                       bool by_root);
void pair_series_complete(struct pair_series *p, struct series_work *z, double accuracy);

/* Both parts. */
void pair_series_make(struct pair_series *p, const struct contact_pair *from, bool by_root, double accuracy);

/* The time at s [s], and the s up to `end` of a time. */
double pair_series_time(const struct pair_series *p, double s);
double pair_series_place(const struct pair_series *p, double time, double end);

/* By u: the first s up to `end` at which the bodies part, as u passes through zero; INFINITY: none. */
double pair_series_parting(const struct pair_series *p, double end);

void pair_series_sample(const void *pair_series, double s, struct pair_sample *sample);

struct pair_change pair_series_change(const void *pair_series, double s);

#endif
