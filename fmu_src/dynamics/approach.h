/*
 * The path of one contact's separation when no contact force acts, or when no body is free: polynomials of time.
 */
#ifndef CONTACT_APPROACH_H
#define CONTACT_APPROACH_H

#include "contact/polynomial.h"
#include "dynamics/system.h"

#if SCENE_ANY_FREE

/* Constant, linear or quadratic force and prescribed velocity: displacements of degree four at most. */
enum { SEPARATION_DEGREE = 4 };

/* Coefficients of time from the present: separation c and its rate w [m, m/s, ...]. For consistent prescribed motion
 * w = dc/dt; the law sees the prescribed velocity as it is given. */
struct separation {
    struct vec3 c[SEPARATION_DEGREE + 1];
    struct vec3 w[SEPARATION_DEGREE];
    struct vec3 offset; /* c[0] across a cylinder's axis: near the axis c[0] itself cannot hold it */
};

/* The same over a horizon, s = time / horizon in [0, 1], lengths in units of `scale`; of a cylinder the part across its
 * axis. */
struct approach {
    struct vec3 c[SEPARATION_DEGREE + 1];
    int degree;                  /* of c: two for constant forces */
    double start;                /* |c| at the start [scale] */
    double gap;                  /* at the start, as it is known, which may be finer than |c| tells [scale] */
    struct polynomial closing;   /* c.c': its roots are the extremes of the distance */
    struct polynomial half_rate; /* c.w, what the law sees; equal to `closing` for consistent motion */
    struct polynomial axial;     /* c.e_d of a cylinder */
    double scale, horizon;       /* [m], [s] */
    double reach;                /* [scale] */
    double half_length;          /* [scale], where it has ends */
    bool has_ends;
    int side;
};

/* From the present instant `at`, taken at `clock`. */
struct separation separation_of(const struct scene_values *v, const struct motion *q,
                                const struct system_instant *at, double clock, int contact);

/* `gap` as it is known at the start [m]. */
struct approach approach_make(const struct contact_shape *shape, const struct separation *separation,
                              double gap, double horizon);

/* |c|^2 and |c|^2 - reach^2, the latter as fine as the gap [scale^2] */
struct polynomial approach_offset2(const struct approach *path);
struct polynomial approach_surplus2(const struct approach *path);

/* Whether the destination has ends to pass: false at compile time in scenes of spheres. */
bool approach_has_ends(const struct contact_shape *shape);

/* Gap [scale] and its slope in s; a bracket_function of a struct approach. By what the distance has grown since the start, so that
 * it is as fine as the gap there; from the vectors: the difference of squares would lose all digits where bodies come from
 * further away than 1e8 times their size. */
void approach_gap(const void *data, double s, double *gap, double *slope);

/* Whether the source is between the end planes. */
bool approach_within(const struct approach *path, double s);

#endif
#endif
