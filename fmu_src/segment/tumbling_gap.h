/*
 * Gap and end planes of a sphere and a destination whose axis turns, at one time, and how they go on at
 * least: each is a function whose second derivative is bounded from below. The separation is a polynomial of
 * time, the gap is not. docs/tumbling.md derives the bounds.
 */
#ifndef CONTACT_SEGMENT_TUMBLING_GAP_H
#define CONTACT_SEGMENT_TUMBLING_GAP_H

#include "contact/geometry.h"
#include "segment/axis_motion.h"

/* Coefficients of the separation: displacements are of degree four at most. */
enum { TUMBLING_TERMS = 5 };

struct tumbling_path {
    struct contact_shape shape;    /* its axis is that of the start; what counts is `axis` */
    struct vec3 c[TUMBLING_TERMS]; /* separation, by powers of the time from the present on [m, m/s, ...] */
    struct axis_motion axis;
    double rounding; /* of c at the start [m] */
};

/* What is looked for: that the bodies come into contact, or that contact ends. */
enum tumbling_change { TUMBLING_TOUCH, TUMBLING_PARTING };

/* Positive before the change, with its slope. The second derivative is at least -bend. */
struct falling {
    double value, slope, bend;
};

/* The gap, and how far the source is beyond either end plane. A touch is where all are negative; the gap of a
 * parting has the other sign, as have its ends, and one that is negative is enough. */
enum { TUMBLING_GAP, TUMBLING_UPPER_END, TUMBLING_LOWER_END, TUMBLING_FUNCTIONS };

struct tumbling_instant {
    struct vec3 c[TUMBLING_TERMS]; /* separation and its derivatives in time */
    struct contact_geometry geometry;
    double axial_rate; /* of c.e_d [m/s] */
    struct falling of[TUMBLING_FUNCTIONS];
    double noise[TUMBLING_FUNCTIONS]; /* what rounding makes of each [m] */
};

/* How many functions there are: one without ends. */
int tumbling_functions(const struct tumbling_path *path);

/* Without bends. */
void tumbling_at(const struct tumbling_path *path, enum tumbling_change change, double time,
                 struct tumbling_instant *at);

/* The bends over `length` seconds from an instant on; INFINITY where there is no bound. */
void tumbling_bend(const struct tumbling_path *path, enum tumbling_change change, double time, double length,
                   struct tumbling_instant *at);

/* Whether bodies touch only where their centres are near; and how far these are beyond the farthest such
 * place, over `length` seconds, whatever the axis does. */
bool tumbling_has_reach(const struct tumbling_path *path);
struct falling tumbling_beyond_reach(const struct tumbling_path *path, const struct tumbling_instant *at,
                                     double length);

/* For how long a function surely stays above -noise. */
double falling_stays_above(const struct falling *f, double noise);

#endif
