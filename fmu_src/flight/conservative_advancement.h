/*
 * Conservative advancement to the first touch of a sphere with a destination whose axis turns: a cylinder
 * that tumbles, a plane that tilts. No touch deeper than rounding is missed, however long the flight
 * (docs/conservative_advancement.md).
 *
 * The axis stands still; or turns steadily about a fixed direction (the precession of a torque-free body, a
 * constant angular velocity); or turns with a rate that is polynomial in time (a torque, a prescribed angular
 * velocity); or is a polynomial itself, of any length but zero.
 */
#ifndef CONTACT_FLIGHT_CONSERVATIVE_ADVANCEMENT_H
#define CONTACT_FLIGHT_CONSERVATIVE_ADVANCEMENT_H

#include "contact/shape.h"
#include "math/rotor.h"

enum { AXIS_TERMS = ROTOR_RATES };

enum axis_motion_kind { AXIS_FIXED, AXIS_PRECESSES, AXIS_PRESCRIBED, AXIS_FOLLOWS };

struct axis_motion {
    enum axis_motion_kind kind;
    struct vec3 axis; /* e_d at time `from`; for AXIS_FIXED at any time */
    /* origin of the times below [s]; for AXIS_PRESCRIBED it moves on with the search */
    double from;
    struct rotor rotor; /* AXIS_PRECESSES */
    /* polynomial of the time since `from`: lambda in e' = lambda x e for AXIS_PRESCRIBED, the direction for
     * AXIS_FOLLOWS */
    struct vec3 coefficient[AXIS_TERMS];
};

struct axis_motion axis_motion_fixed(struct vec3 axis);
struct axis_motion axis_motion_of_rotor(const struct rotor *rotor);

/* From `count` coefficients, up to AXIS_TERMS. A constant rate makes a steady turn. */
struct axis_motion axis_motion_prescribed(struct vec3 axis, const struct vec3 *rate, int count);
struct axis_motion axis_motion_following(const struct vec3 *direction, int count);

/* e_d and its rate, at a time no earlier than `from`. */
struct rotor_axis axis_motion_at(const struct axis_motion *motion, double time);

/* Moves the origin to `time`; earlier times may not be asked for any more. */
void axis_motion_move_on(struct axis_motion *motion, double time);

/*
 * Bounds over [time, time + length] for the frame that carries the axis along and does not turn about it. Its
 * angular velocity is e x e', of size |e'|; the rate of this is e x e''. INFINITY: there is no bound.
 */
struct axis_bounds {
    double speed; /* bound of |e'| [1/s] */
    double turn;  /* bound of |e x e''| [1/s^2] */
};
struct axis_bounds axis_motion_bounds(const struct axis_motion *motion, double time, double length);

/*
 * Gap and distances from the end planes at one time, as functions whose second derivative is bounded from
 * below. The separation is a polynomial of time, the gap is not. docs/conservative_advancement.md derives the
 * bounds.
 */

/* Coefficients of the separation: displacements are of degree four at most. */
enum { ADVANCEMENT_TERMS = 5 };

struct advancement_path {
    struct contact_shape shape; /* with the axis at the start; `axis` gives the axis at any time */
    struct vec3
        c[ADVANCEMENT_TERMS]; /* separation, by powers of the time from the present on [m, m/s, ...] */
    struct axis_motion axis;
    double rounding; /* rounding bound of c at the start [m] */
};

/* The change that is searched: the bodies come into contact, or contact ends. */
enum advancement_change { ADVANCEMENT_TOUCH, ADVANCEMENT_PARTING };

/* A function that is positive before the change; its second derivative is at least -bend. */
struct falling {
    double value, slope, bend;
};

/* The gap and the distances of the source beyond either end plane. A touch is where all are negative. For a
 * parting all have the other sign, and one negative function is enough. */
enum { ADVANCEMENT_GAP, ADVANCEMENT_UPPER_END, ADVANCEMENT_LOWER_END, ADVANCEMENT_FUNCTIONS };

struct advancement_instant {
    struct vec3 c[ADVANCEMENT_TERMS]; /* separation and its time derivatives [m, m/s, ...] */
    struct contact_geometry geometry;
    double axial_rate; /* rate of c.e_d [m/s] */
    struct falling of[ADVANCEMENT_FUNCTIONS];
    double noise[ADVANCEMENT_FUNCTIONS]; /* rounding bound of each function [m] */
};

/* Functions and their slopes at a time, without bounds of their second derivatives. */
void advancement_at(const struct advancement_path *path, enum advancement_change change, double time,
                    struct advancement_instant *at);

struct advancement_result {
    double after;     /* seconds from the present to the change; INFINITY: none before `searched` */
    double gap;       /* at the change; zero unless the source passes an end plane [m] */
    double searched;  /* nothing else changes up to here [s] */
    long evaluations; /* number of evaluations of gap and rate */
};

/* The first change within `horizon` seconds that is deeper than rounding, located to rounding. After `budget`
 * > 0 evaluations the search ends early, at `searched` < horizon. */
struct advancement_result advancement_first(const struct advancement_path *path,
                                            enum advancement_change change, double horizon, long budget);

#endif
