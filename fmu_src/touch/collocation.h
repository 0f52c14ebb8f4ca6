/*
 * This file computes motion in contact in local coordinates, by exponential collocation.
 *
 *   c = d n across a cylinder's axis,   d = reach + x,
 *   x'' + damping_rate x' + omega2 x = f
 *
 * rim.h has the equations of f and of the normal n, in two angles and their momenta H. They hold at a rim,
 * and about a centre or an axis, which is a rim of radius zero whose axis lies across the plane in which n
 * begins to turn: the tilt then stays zero in a plane motion. x is the radial deviation from `reach`, the
 * distance at which the bodies touch. A is the relative acceleration without the contact force. omega2 is the
 * contact stiffness p_n divided by the reduced mass m_red, and damping_rate is the dashpot coefficient p_nv
 * divided by m_red. The left side is solved exactly (oscillator.h), whatever its stiffness. f, n and H are
 * polynomials collocated at the Lobatto nodes (exponential collocation: Hochbruck and Ostermann, Acta
 * Numerica 19 (2010) 209; Lobatto IIIA: Hairer and Wanner, Solving Ordinary Differential Equations II, IV.5).
 *
 * x = s + y: s is the particular solution for f, y the free oscillation from the start values. Two kinds of
 * step:
 *   averaged     many small oscillations; f, n and H depend on y to first order, and this dependence is
 *                integrated in closed form
 *   overdamped   far beyond critical damping, or without a spring: x = X + y, where y is the fast decay alone
 *                and enters n and H as in an averaged step; X' = u - slower X, where slower and faster are
 *                the decay rates and u is the particular solution at the faster rate
 * Under Hertz's law (hertz.c) only steps whose y is negligible are of use. In an averaged step omega2 and
 * damping_rate are then the mean slopes of the force, and f contains the force less the part that these
 * slopes make. In an overdamped step x' follows from f, x and x'', and there is neither u nor X.
 *
 * Variable s in [0, 2] over the step: time = half s. Derivatives of x are taken with respect to s.
 */
#ifndef CONTACT_TOUCH_COLLOCATION_H
#define CONTACT_TOUCH_COLLOCATION_H

#include <stdbool.h>

#include "math/nodes.h"
#include "math/oscillator.h"
#include "math/vec3.h"
#include "touch/rim.h"

enum collocation_kind { COLLOCATION_AVERAGED, COLLOCATION_OVERDAMPED };

enum { COLLOCATION_ACCELERATION_TERMS = 3 };

/* The start of a step. A is a polynomial of the time from the start, given by its coefficients, in rim.frame.
 * About a centre the frame is n, across both, and the direction in which n begins to turn. */
struct collocation_problem {
    struct rim_start rim;
    bool head_on;        /* c' and A are along n, which is constant */
    double radial;       /* x' = n.c' [m/s] */
    double reach;        /* [m] */
    double deviation;    /* x [m] */
    double omega2;       /* stiffness divided by m_red, > 0 [1/s^2] */
    double damping_rate; /* [1/s] */
    /* Hertz's law (contact_pair): k_h divided by m_red, or 0 under the linear law, and chi */
    double hertz, chi, side;
    struct vec3 acceleration[COLLOCATION_ACCELERATION_TERMS]; /* A [m/s^2, ...] */
    /* C, the separation by A alone, from the first coefficient on [m/s, ...] */
    struct vec3 flown[COLLOCATION_ACCELERATION_TERMS + 1];
};

/* n and H by the four changes of rim_state_of: of azimuth and tilt, then of their momenta. */
enum { COLLOCATION_ANGLES = 2, COLLOCATION_CHANGES = 4 };

/* This is the result of the iteration. */
struct collocation_result {
    double correction[COLLOCATION_CHANGES];   /* the part of the changes at the start that is due to y */
    nodal_values change[COLLOCATION_CHANGES]; /* of n and H since the start, without y */
    nodal_values rate[COLLOCATION_CHANGES];   /* d/ds of them */
    nodal_values x;                           /* x at the nodes, without y [m] */
    nodal_values load;                        /* half^2 f, coefficients in s - 1 [m] */
    nodal_values slow;                        /* x without y, coefficients of s - 1 [m] */
    nodal_values tilt_rate; /* rate of the tilt at a rim, coefficients of s - 1 [rad]; else zero */
    /* the oscillator of y, with rates per unit of s; an averaged step adds the mean of -half^2 df/dx to its
     * omega2 */
    struct oscillator oscillator;
    double y, y_rate;       /* y and dy/ds at the start [m] */
    double deviation_error; /* estimated truncation error of x between the ends [m] */
    double interior_error;  /* that of c [m]; in an overdamped step x counts as if it were as large as d */
};

struct collocation {
    struct collocation_problem from;
    enum collocation_kind kind;
    double half;                              /* half the step [s] */
    struct vec3 acceleration_at[LOBATTO_MAX]; /* A at the nodes */
    struct rim_angles angles[LOBATTO_MAX];    /* of the present n at the nodes */
    struct collocation_result result;
};

/* Makes a step at twelve Lobatto nodes and returns whether the iteration converged to `tolerance` [m]. The
 * product of the step [s] and the oscillator's rates (oscillator_rates_of) [1/s] must be
 *   averaged   the slower 3 or more (oscillator_particular)
 *   overdamped   the faster 3 or more and four times the slower or more, the slower not much more than 3 */
bool collocation_make(struct collocation *p, const struct collocation_problem *from, double step,
                      enum collocation_kind kind, double tolerance);

/* Sets the two parts of x [m] with their first three derivatives with respect to s: the averaged deviation,
 * which is x without y, and y. */
void collocation_deviation(const struct collocation *p, double s, double averaged[4], double y[4]);

/* Gives the contact force of an overdamped step, divided by m_red and times half^2 [m], and its first two
 * derivatives. It is x'' - half^2 f = -half^2 omega2 x - half damping_rate x'. It is computed
 * from x'' and f, because the spring force and the dashpot force nearly cancel. */
void collocation_overdamped_push(const struct collocation *p, double s, double push[3]);

struct collocation_change {
    struct vec3 moved;  /* c(s) - c(0) [m] */
    struct vec3 gained; /* c'(s) - c'(0) [m/s] */
    double deviation;   /* x(s) [m] */
    double rate;        /* dx/ds [m] */
};

/* Returns the change from the start to s, in rim.frame. Its error at s = 2 is of the order that the
 * collocation has at its ends; before s = 2 it is the interior error. */
struct collocation_change collocation_change_at(const struct collocation *p, double s);

/* Returns the energy that the dashpot dissipates divided by m_red: the integral from 0 to s of damping_rate
 * x'^2 dt [m^2/s^2]. */
double collocation_dissipated(const struct collocation *p, double s);

/* Sets reach cos(tilt) and reach sin(tilt) [m] at s in a step at a rim, event functions that are zero where
 * the zone of the rim ends, and their first two derivatives. The caller passes the parts of x; y may be
 * zero. */
void collocation_edges(const struct collocation *p, double s, const double averaged[4], const double y[4],
                       double radial[3], double axial[3]);

/* Returns the moment of c - c(0): the integral of t^power (c - c(0)) dt from 0 to s [m s^(power+1)], in
 * rim.frame. */
struct vec3 collocation_moment(const struct collocation *p, int power, double s);

#endif
