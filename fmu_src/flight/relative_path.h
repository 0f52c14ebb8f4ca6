/*
 * The path of one contact's separation as polynomials of time, when no contact force acts or no body is free.
 */
#ifndef CONTACT_FLIGHT_RELATIVE_PATH_H
#define CONTACT_FLIGHT_RELATIVE_PATH_H

#include "flight/conservative_advancement.h"
#include "math/polynomial.h"
#include "scene/evaluate.h"

/* Largest degree of a displacement, which follows from a quadratic force or a prescribed velocity. */
enum { SEPARATION_DEGREE = 4 };

/* This struct holds the coefficients of the separation c and of its rate w as polynomials of the time since
 * the present [m, m/s, ...]. For consistent prescribed motion w = dc/dt; the force law uses the prescribed
 * velocity as it is given. */
struct separation_path {
    struct vec3 c[SEPARATION_DEGREE + 1];
    struct vec3 w[SEPARATION_DEGREE];
    int degree; /* at least one; coefficients of c beyond it are zero, and those of w from it on */
};

/* The separation path over a horizon, with the time s = time / horizon in [0, 1] and lengths divided by
 * `scale`. For a cylinder only the part of c across the axis is stored. For a plane c is (d, 0, 0), and
 * `closing` is d'. */
struct relative_path {
    const struct contact_shape *shape; /* must live as long as the path does */
    struct vec3 c[SEPARATION_DEGREE + 1];
    int degree;   /* degree of c: two for constant forces */
    double start; /* |c| at the start [scale] */
    double gap;   /* gap at the start, with more digits than |c| has [scale] */
    /* c.c', whose changes of sign are the extremes of the distance; between them the distance is monotone */
    struct polynomial closing;
    double scale, horizon; /* unit of length [m], time span [s] */
    double reach;          /* distance d at which the bodies touch [scale] */
};

/* Returns the separation path from the present instant `at`, whose clock is `clock`. */
struct separation_path separation_path_of(const struct scene_instant *at, double clock, int contact);

/* Adds where the path crosses the two planes across a direction at the distance `half` from the origin, as
 * fractions of the horizon, to `count` sorted places. Returns their number. */
int separation_path_planes(const struct separation_path *path, double horizon, struct vec3 direction,
                           double half, double *places, int count);

/* Returns the path for conservative advancement from the instant `at`, whose clock is `clock`. If a body
 * turns freely, `clock` must be the present clock of at->q. */
struct advancement_path advancement_path_of(const struct scene_instant *at, double clock, int contact);

/* `gap` is the gap at the start [m], which may have more digits than the positions. */
struct relative_path relative_path_make(const struct contact_shape *shape,
                                        const struct separation_path *separation, double gap, double horizon);

/* Sets the gap [scale] and its slope in s, as a root_function of a struct relative_path. The gap is computed
 * from the growth of the distance since the start, so that its accuracy is that of the gap at the start. The
 * growth is computed from vectors: a difference of squares would lose all digits where the distance exceeds
 * 1e8 times the bodies' size. */
void relative_path_gap(const void *data, double s, double *gap, double *slope);

#endif
