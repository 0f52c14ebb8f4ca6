/*
 * The path of one contact's separation when no contact force acts, or when no body is free: polynomials of
 * time.
 */
#ifndef CONTACT_FLIGHT_RELATIVE_PATH_H
#define CONTACT_FLIGHT_RELATIVE_PATH_H

#include "math/polynomial.h"
#include "scene/evaluate.h"

/* Constant, linear or quadratic force and prescribed velocity: displacements of degree four at most. */
enum { SEPARATION_DEGREE = 4 };

/* Coefficients of time from the present: separation c and its rate w [m, m/s, ...]. For consistent prescribed
 * motion w = dc/dt; the law sees the prescribed velocity as it is given. */
struct separation_path {
    struct vec3 c[SEPARATION_DEGREE + 1];
    struct vec3 w[SEPARATION_DEGREE];
    /* c[0] across a cylinder's axis: near the axis c[0] itself cannot hold it */
    struct vec3 offset;
};

/* The separation path over a horizon: s = time / horizon in [0, 1], lengths in units of `scale`, across a
 * cylinder's axis. */
struct relative_path {
    struct vec3 c[SEPARATION_DEGREE + 1];
    int degree;                /* degree of c: two for constant forces */
    double start;              /* |c| at the start [scale] */
    double gap;                /* at the start, with more digits than |c| has [scale] */
    struct polynomial closing; /* c.c', whose roots are the extremes of the distance */
    /* c.w, the rate as the law sees it; equals `closing` for consistent motion */
    struct polynomial half_rate;
    /* the destination is a plane: c is (d, 0, 0), `closing` is d' and `half_rate` is n.w */
    bool flat;
    struct polynomial axial; /* c.e_d where the destination is a cylinder [scale] */
    double scale, horizon;   /* [m], [s] */
    double reach;            /* [scale] */
    double half_length;      /* of a cylinder with ends [scale] */
    bool has_ends;
    bool starts_within; /* the source is between the end planes until s = ends_dead_band (prediction.h) */
    double ends_dead_band;
    int side;
};

/* From the present instant `at`, taken at `clock`. */
struct separation_path separation_path_of(const struct scene_values *v, const struct scene_state *q,
                                          const struct scene_instant *at, double clock, int contact);

/* `gap` is the gap at the start [m], which may have more digits than the positions. */
struct relative_path relative_path_make(const struct contact_shape *shape,
                                        const struct separation_path *separation, double gap, double horizon);

/* |c|^2, and |c|^2 - reach^2 with the digits of the gap [scale^2] */
struct polynomial relative_path_distance_squared(const struct relative_path *path);
struct polynomial relative_path_squared_deviation(const struct relative_path *path);

/* half_rate divided by this is the rate n.w at a gap of `gap` [scale]: d, or 1 for a plane. */
double relative_path_divisor(const struct relative_path *path, double gap);

/* Whether the destination has ends to pass: false at compile time in scenes of spheres. */
bool relative_path_has_ends(const struct contact_shape *shape);

/* Gap [scale] and its slope in s; a root_function of a struct relative_path. It comes from the growth of the
 * distance since the start, so that it is as accurate as the gap there, and from vectors: a difference of
 * squares would lose all digits of bodies farther away than 1e8 times their size. */
void relative_path_gap(const void *data, double s, double *gap, double *slope);

/* Whether the source is between the end planes. */
bool relative_path_within(const struct relative_path *path, double s);

/* Candidate events of a contact in flight: roots of polynomials, one of which is the next change of
 * regime. */

/* Most roots in all: of the touch, the two ends, the end of their rounding, the gap rate and two conditions
 * of the law, of which only the law's have the highest degree. */
enum { MAX_CANDIDATES = 6 * POLYNOMIAL_MAX_DEGREE };

/* Extremes of the distance, between which it is monotone. */
struct extremes {
    double at[POLYNOMIAL_MAX_DEGREE];
    int count;
};

struct extremes extremes_of(const struct relative_path *path);

/* The least gap from now to the end of the path [m]. */
double candidates_least_gap(const struct relative_path *path);

/* The gap and its slope at s. */
struct root_bracket_end flight_gap_bracket_end(const struct relative_path *path, double s);

/* Sorts the passages of a cylinder's ends into the `count` `candidates` (room for MAX_CANDIDATES); returns
 * the new count. */
int candidates_of_ends(const struct relative_path *path, double *candidates, int count);

/* All instants at which the regime may change: a superset, sorted. */
int candidates_of_all(const struct relative_path *path, const struct extremes *extremes,
                      const struct contact_shape *shape, const struct contact_law *law, double *candidates);

#endif
