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
 * the coefficients follow order by order from products and quotients (as in pair.h), a step may begin
 * at u = 0, and the release is an ordinary root of u.
 */
#ifndef CONTACT_TOUCH_HERTZ_H
#define CONTACT_TOUCH_HERTZ_H

#include "math/compiler.h"
#include "math/nodes.h"
#include "math/series.h"
#include "touch/pair.h"

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

/* The coefficients of the series of hertz.h, order by order. */

typedef double hertz_row[TAYLOR_TERMS];
typedef double hertz_rows[HERTZ_DIMENSIONS][TAYLOR_TERMS];

/* A row backwards, from its coefficient 1 on: coefficient j at [TAYLOR_ORDER - j], and zero in place of
 * coefficient 0. Products then read both of their factors forwards, several terms in one instruction. */
typedef double hertz_back[TAYLOR_TERMS];

/* Everything that the recurrence needs besides the results. */
struct hertz_recurrence {
    hertz_row power[SEPARATION_DEGREE + 1]; /* t^k, k from 2 on */
    hertz_rows w;                           /* rate of the separation as the law sees it [m/s] */
    hertz_rows c_rate;                      /* its derivative, where that is another [m/s] */
    hertz_rows n;
    hertz_row d;              /* [m] */
    hertz_row opening;        /* dg/dt [m/s] */
    hertz_row square, fourth; /* u^2, u^4 */
    hertz_row impulse;        /* u F_n */
    hertz_back time_back, root_back, square_back, rate_back;
    hertz_back n_back[HERTZ_DIMENSIONS], r_rate_back[HERTZ_DIMENSIONS];
    double inverse_distance, side_by_mass; /* 1/d at the start [1/m], side/m_red [1/kg] */
};

/* The orders from `begin` to before `end`: each gives the next coefficients of u, t, r and r', and its
 * own of what else in p takes part in z. The orders before are known; of the first, zero, u, t, r and r'. */
void hertz_recurrence_run(struct pair_hertz *p, struct hertz_recurrence *z, int begin, int end);

/* pair_hertz_make in two parts: the coefficients of u up to HERTZ_FIRST, then the rest. */
enum { HERTZ_FIRST = 7 };
void pair_hertz_begin(struct pair_hertz *p, struct hertz_recurrence *z, const struct contact_pair *from);
void pair_hertz_complete(struct pair_hertz *p, struct hertz_recurrence *z, double accuracy);

static inline double lanes_together(double2 a)
{
#if CONTACT_GNU_C
    return a[0] + a[1];
#else
    return a;
#endif
}

/* Coefficient `order` of a product. */
static inline double series_product(const double *a, const double *b, int order)
{
    double sum[2] = {0.0, 0.0}; /* two, because one would wait for each of its additions */
    int i = 0;
    for (; i < order; i += 2) {
        sum[0] += a[i] * b[order - i];
        sum[1] += a[i + 1] * b[order - i - 1];
    }
    return sum[0] + sum[1] + (i == order ? a[i] * b[0] : 0.0);
}

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
