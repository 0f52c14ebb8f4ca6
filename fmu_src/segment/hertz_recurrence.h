/* The coefficients of the series of pair_hertz.h, order by order. */
#ifndef CONTACT_SEGMENT_HERTZ_RECURRENCE_H
#define CONTACT_SEGMENT_HERTZ_RECURRENCE_H

#include "segment/pair_hertz.h"

typedef double hertz_row[TAYLOR_TERMS];
typedef double hertz_rows[HERTZ_DIMENSIONS][TAYLOR_TERMS];

/* Everything that the recurrence needs besides the results. */
struct hertz_recurrence {
    hertz_row power[SEPARATION_DEGREE + 1]; /* t^k, k from 2 on */
    hertz_rows w;                           /* rate of the separation as the law sees it [m/s] */
    hertz_rows c_rate;                      /* its derivative, where that is another [m/s] */
    hertz_rows n;
    hertz_row d;                           /* [m] */
    hertz_row opening;                     /* dg/dt [m/s] */
    hertz_row square;                      /* u^2 */
    hertz_row damped;                      /* 1 + chi delta' */
    hertz_row impulse;                     /* u F_n */
    double inverse_distance, side_by_mass; /* 1/d at the start [1/m], side/m_red [1/kg] */
};

/* From order zero of u, t, r and r' all coefficients of p and z. */
void hertz_recurrence_run(struct pair_hertz *p, struct hertz_recurrence *z);

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
