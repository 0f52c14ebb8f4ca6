/* The coefficients of the series of pair_hertz.h, order by order. */
#ifndef CONTACT_SEGMENT_HERTZ_RECURRENCE_H
#define CONTACT_SEGMENT_HERTZ_RECURRENCE_H

#include "math/compiler.h"
#include "math/nodal_values.h"
#include "segment/pair_hertz.h"

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

#endif
