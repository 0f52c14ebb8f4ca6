/*
 * A pressing contact in local coordinates: exponential collocation.
 *
 *   c = d n across a cylinder's axis,   d = reach + x,   H = c x c'
 *   n' = H x n / d^2,   H' = d n x A(t),
 *   x'' + damping x' + square x = f = |H|^2 / d^3 + n.A(t) - damping n.E(t)
 *
 * A is the acceleration of the separation without the contact, E the part of its rate that the law sees beside c',
 * square = p_n / m_red, damping = p_nv / m_red. The left side is solved exactly (oscillator.h), whatever its stiffness; f, n
 * and H are polynomials collocated at the Lobatto nodes (exponential collocation: Hochbruck and Ostermann, Acta Numerica 19
 * (2010) 209; Lobatto IIIA: Hairer and Wanner, Solving Ordinary Differential Equations II, IV.5).
 *
 * x = s + y: s follows f, y is the free oscillation that makes up for the start. Three kinds of step:
 *   resolved   so short that the nodes see y; f, n and H feel all of it
 *   spanning   many oscillations, so small that f, n and H feel them to first order only, which is integrated in closed form
 *   creeping   far beyond critical damping: x = X + y with y the fast decay alone, felt like a small oscillation, and X slow,
 *              X' = -slower X + u where u follows f against the faster rate; also without any spring
 *
 * Variable s in [0, 2] over the step: time = half s. Derivatives of x are taken with respect to s.
 */
#ifndef CONTACT_COLLOCATION_H
#define CONTACT_COLLOCATION_H

#include <stdbool.h>

#include "contact/lobatto_row.h"
#include "contact/oscillator.h"
#include "contact/vec3.h"

enum collocation_kind { COLLOCATION_RESOLVED, COLLOCATION_SPANNING, COLLOCATION_CREEPING };

enum { COLLOCATION_PULL_TERMS = 3, COLLOCATION_LEAD_TERMS = 4 };

/* Polynomials: coefficients of time from the start. */
struct collocation_problem {
    struct vec3 normal;                       /* n, unit */
    struct vec3 rate;                         /* c' [m/s] */
    double radial;                            /* x', the part of c' along n, or finer than that tells [m/s] */
    double reach;                             /* [m] */
    double excess;                            /* x [m] */
    double square;                            /* > 0 [1/s^2] */
    double damping;                           /* [1/s] */
    struct vec3 pull[COLLOCATION_PULL_TERMS]; /* A [m/s^2, ...] */
    struct vec3 lead[COLLOCATION_LEAD_TERMS]; /* E [m/s, ...] */
    bool leads;                               /* whether E is other than zero */
};

/* Vectors are in the frame of the start: n there, the direction of the motion along the contact, and across both. A motion in
 * a plane, as most are, keeps n in the first two and H in the third. */
struct collocation {
    struct collocation_problem from;
    const struct lobatto *nodes;
    enum collocation_kind kind;
    double half;                              /* half the step [s] */
    double distance;                          /* d at the start [m] */
    struct vec3 frame[3];                     /* in the world; of a straight motion n alone */
    struct vec3 pull[COLLOCATION_PULL_TERMS]; /* A */
    struct vec3 lead[COLLOCATION_LEAD_TERMS]; /* E */
    struct vec3 rate, momentum;               /* c' [m/s] and H at the start [m^2/s] */
    bool planar;                              /* but for rounding */
    bool straight;                            /* nothing turns n: head-on along a straight pull */
    struct vec3_row pull_at, drive_at;        /* at the nodes: A, A - damping E */
    struct vec3_row lead_at;                  /* half E, if there is any */
    struct vec3 turned, spun;                 /* what of n and H at the start is y; zero if resolved */
    struct vec3_row n, h;           /* at the nodes: what has been added to n and H, oscillation apart */
    struct vec3_row n_rate, h_rate; /* d/ds of these */
    lobatto_row x;                  /* at the nodes; with y only if resolved */
    lobatto_row load;               /* half^2 f, coefficients of s - 1 [m] */
    lobatto_row slow;               /* what of x follows the load, likewise [m] */
    lobatto_row led;                /* half n.E, likewise [m] */
    lobatto_row y_of_y, y_of_rate;  /* the oscillation's basis at the nodes, if resolved */
    int terms;                      /* coefficients of `slow` that matter */
    struct oscillator oscillator;   /* of y, per s; spanning: softened by the load's answer to y */
    double y, y_rate;               /* at the start [m] */
    double interior_error;          /* estimate of what the polynomials leave out between the ends [m] */
    int sweeps;                     /* of the iteration so far */
};

/* Whether the iteration converged to `tolerance` [m]. Of the step > 0 [s] times the oscillator's rates (oscillator_rates_of) must be
 *   resolved   3 or more (oscillator_follow), not much more than 4 (the nodes), below critical damping
 *   spanning   the slower 3 or more
 *   creeping   the faster 3 or more and four times the slower or more, the slower not much more than 3 */
bool collocation_make(struct collocation *p, const struct collocation_problem *from, double step,
                      enum collocation_kind kind, const struct lobatto *nodes, double tolerance);

/* The same in parts, for a step that is to end where something happens.
 *   begin   the load stays as it begins: x alone, for collocation_excess and collocation_lead
 *   size    the length of the step; of one that has been swept, only by a little
 *   sweep   returns how far it moved anything [m]
 *   finish  sweeps until converged, with what a sweep before has moved; 0: none has */
void collocation_begin(struct collocation *p, const struct collocation_problem *from, double step,
                       enum collocation_kind kind, const struct lobatto *nodes);
void collocation_size(struct collocation *p, double step);
double collocation_sweep(struct collocation *p);
bool collocation_finish(struct collocation *p, double before, double tolerance);

/* Of a resolved step: its error at s close to its end, where the order of the nodes' quadrature counts [m]. */
double collocation_error_near_end(const struct collocation *p, double s);

/* x and its first three derivatives; n.E half and its first two. */
void collocation_excess(const struct collocation *p, double s, double x[4]);
void collocation_excess_at_node(const struct collocation *p, int node, double x[4]);
void collocation_lead(const struct collocation *p, double s, double led[3]);

/* x'' - f + what the dashpot makes of E, the push of the contact: -(square x + damping (x' + n.E)) without its cancellation where a
 * contact creeps, and its first two derivatives. For creeping steps. */
void collocation_creeping_push(const struct collocation *p, double s, double push[3]);

/* x without y, and its derivatives. */
void collocation_slow_excess(const struct collocation *p, double s, double x[4]);

/* What an oscillation (y, its rate) adds, in the frame, to n and H for which the load, pull and distance stay as they are: the integral of P y,
 * P slow, is -P (y' + damping y) / square but for a part smaller by the slow rate over the oscillation's. */
struct collocation_wave {
    struct vec3 turned, spun;
};

struct collocation_wave collocation_wave_of(const struct collocation *p, double y, double y_rate,
                                            struct vec3 n, struct vec3 h, struct vec3 pull, double d);

struct collocation_change {
    struct vec3 moved;  /* c(s) - c(0) [m] */
    struct vec3 gained; /* c'(s) - c'(0) [m/s] */
    double excess;      /* x(s) [m] */
};

/* In the world. Exact at s = 2 to the collocation's order at its ends, before that to its interior error. */
struct collocation_change collocation_change_at(const struct collocation *p, double s);

/* The integral from 0 to s of damping (x' + n.E)^2 dt: the energy the dashpot has taken, per unit of mass [m^2/s^2]. */
double collocation_dissipated(const struct collocation *p, double s);

/* The integral from 0 to s of weight(t).(c - c(0)) dt, weight = weight[0] + weight[1] t. */
double collocation_moment(const struct collocation *p, const struct vec3 weight[2], double s);

#endif
