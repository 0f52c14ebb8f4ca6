/*
 * How the axis of a destination turns with time, and bounds of how fast: it stands still; goes round a fixed
 * direction steadily (the precession of a torque-free body, a constant angular velocity); turns with a rate
 * that is polynomial in time (a torque, a prescribed angular velocity); or is a polynomial itself, of any
 * length but zero.
 */
#ifndef CONTACT_FLIGHT_TUMBLING_H
#define CONTACT_FLIGHT_TUMBLING_H

#include "contact/shape.h"
#include "math/rotor.h"

enum { AXIS_TERMS = ROTOR_RATES };

enum axis_motion_kind { AXIS_FIXED, AXIS_PRECESSES, AXIS_DRIVEN, AXIS_FOLLOWS };

struct axis_motion {
    enum axis_motion_kind kind;
    struct vec3 axis; /* e_d at time `from`; of AXIS_FIXED always */
    /* the origin of the times below; of AXIS_DRIVEN it moves on with the search */
    double from;
    struct rotor rotor; /* AXIS_PRECESSES */
    /* of time since `from`: the rate lambda of AXIS_DRIVEN, e' = lambda x e; of AXIS_FOLLOWS the direction */
    struct vec3 coefficient[AXIS_TERMS];
};

struct axis_motion axis_motion_fixed(struct vec3 axis);
struct axis_motion axis_motion_of_rotor(const struct rotor *rotor);

/* `count` coefficients, up to AXIS_TERMS. Of a rate that is constant a steady turn. */
struct axis_motion axis_motion_prescribed(struct vec3 axis, const struct vec3 *rate, int count);
struct axis_motion axis_motion_following(const struct vec3 *direction, int count);

/* e_d and its rate, at a time no earlier than `from`. */
struct rotor_axis axis_motion_at(const struct axis_motion *motion, double time);

/* Nothing before `time` will be asked for any more. */
void axis_motion_move_on(struct axis_motion *motion, double time);

/*
 * Bounds over [time, time + length] for the frame that carries the axis along and does not turn about it: its
 * angular velocity is e x e', of size |e'|, and the rate of that is e x e''. INFINITY where there are none.
 */
struct axis_bounds {
    double speed; /* |e'| at most [1/s] */
    double turn;  /* |e x e''| at most [1/s^2] */
};
struct axis_bounds axis_motion_bounds(const struct axis_motion *motion, double time, double length);

/*
 * Gap and end planes of a sphere and a destination whose axis turns, at one time, and how they go on at
 * least: each is a function whose second derivative is bounded from below. The separation is a polynomial of
 * time, the gap is not. docs/tumbling.md derives the bounds.
 */

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

/*
 * The first touch of a sphere with a destination whose axis turns: a cylinder that tumbles, a plane that
 * tilts. No touch deeper than rounding is missed, however long the flight: docs/tumbling.md says why.
 */

struct tumbling_result {
    double after;     /* seconds from the present; INFINITY: not before `searched` */
    double gap;       /* then; zero unless the source passes an end plane [m] */
    double searched;  /* until then nothing else happens [s] */
    long evaluations; /* how often gap and rate were computed */
};

/* The first change within `horizon` seconds that is deeper than rounding, located to rounding. The search
 * ends early, at `searched` < horizon, after `budget` > 0 evaluations. */
struct tumbling_result tumbling_first(const struct tumbling_path *path, enum tumbling_change change,
                                      double horizon, long budget);

#endif
