/*
 * Conservative advancement to the first touch of a sphere with a destination whose axis turns (a cylinder
 * that tumbles, a plane that tilts), with a cylinder of finite length or with a torus. The search misses no
 * touch deeper than rounding, however long the flight (docs/conservative_advancement.md).
 *
 * The axis either stands still, or turns steadily about a fixed direction (the precession of a torque-free
 * body, a constant angular velocity), or turns with an angular velocity that is polynomial in time (a torque,
 * a prescribed angular velocity), or follows a polynomial of time, which need not have unit length but must
 * not be zero. The lever arms of compound bodies turn in the same ways, or with a body that tumbles.
 */
#ifndef CONTACT_FLIGHT_CONSERVATIVE_ADVANCEMENT_H
#define CONTACT_FLIGHT_CONSERVATIVE_ADVANCEMENT_H

#include "contact/shape.h"
#include "math/rotor.h"

enum { AXIS_TERMS = ROTOR_TORQUES };

enum axis_motion_kind { AXIS_FIXED, AXIS_PRECESSES, AXIS_FOLLOWS, AXIS_TUMBLES };

struct axis_motion {
    enum axis_motion_kind kind;
    struct vec3 axis; /* e_d at time `from`; for AXIS_FIXED at any time */
    /* origin of the times below [s]; for AXIS_TUMBLES it moves on with the search */
    double from;
    struct rotor rotor; /* for AXIS_PRECESSES */
    /* coefficients of a polynomial of the time since `from`: of the direction of e for AXIS_FOLLOWS, of the
     * torque for AXIS_TUMBLES */
    struct vec3 coefficient[AXIS_TERMS];
    /* for AXIS_TUMBLES: the body at `from`, in whose frame the axis is `axis`, and its moments of inertia */
    struct body_turn body;
    struct vec3 inertia;
};

struct axis_motion axis_motion_of_rotor(const struct rotor *rotor);

/* Return the motion from the coefficients of an angular velocity, of which a constant one makes a steady
 * turn, and from those of a direction. */
struct axis_motion axis_motion_prescribed(struct vec3 axis, const struct vec3 rate[AXIS_TERMS]);
struct axis_motion axis_motion_following(const struct vec3 direction[AXIS_TERMS]);

/* Returns the motion of a direction, given in the body's frame, of a body with three moments of inertia. */
struct axis_motion axis_motion_tumbling(struct vec3 axis, const struct body_turn *body, struct vec3 inertia,
                                        const struct vec3 torque[ROTOR_TORQUES]);

/*
 * The gap and the distances from the end planes at one time. Each is a function of time whose second
 * derivative has a lower bound. The separation is a polynomial of time, but the gap is not.
 * docs/conservative_advancement.md derives the bounds.
 */

/* This is the number of coefficients of the separation, a polynomial of degree four at most. */
enum { ADVANCEMENT_TERMS = 5 };

/* The change that the search looks for: the bodies come into contact, or contact ends. */
enum advancement_change { ADVANCEMENT_TOUCH, ADVANCEMENT_PARTING };

struct advancement_path {
    enum advancement_change change;
    struct contact_shape shape; /* holds the axis at the start; `axis` below gives the axis at any time */
    struct vec3 c[ADVANCEMENT_TERMS]; /* separation by powers of the time since now [m, m/s, ...] */
    int degree;                       /* of c; later coefficients are zero */
    /* the rate of the separation that the force law uses less c' [m/s, ...]; the search does not read it */
    struct vec3 mismatch[ADVANCEMENT_TERMS - 1];
    struct axis_motion axis;
    double rounding; /* rounding bound of c at the start [m] */
    /* the lever arms of the parts of compound bodies that meet, 0: source, 1: destination: directions and
     * lengths [m], the length is zero for other bodies. They are added to c. */
    struct axis_motion lever[2];
    double lever_length[2];
};

/* Returns an upper bound of the angular velocity [rad/s] of the axis and the lever arms. */
double advancement_turning(const struct advancement_path *path, double time, double length);

/* Moves the origins of the axis and the lever arms to `time`. After that no function may be called for an
 * earlier time on this path. */
void advancement_move_on(struct advancement_path *path, double time);

/* A function that is positive before the change; its second derivative is at least -bend. Where `steepest` is
 * above zero, its rate is at least -steepest, whatever the bend. */
struct falling {
    double value, slope, bend, steepest;
};

/* The functions are the gap and the distances of the source beyond the two end planes. The bodies touch where
 * all functions are negative. For a parting all functions change sign, and one negative function is
 * enough. */
enum { ADVANCEMENT_GAP, ADVANCEMENT_UPPER_END, ADVANCEMENT_LOWER_END, ADVANCEMENT_FUNCTIONS };

struct advancement_instant {
    struct vec3 c[ADVANCEMENT_TERMS]; /* separation and its time derivatives [m, m/s, ...] */
    struct rotor_axis axis;           /* e_d and its rate */
    struct contact_geometry geometry;
    double axial_rate; /* rate of geometry.axial [m/s] */
    struct falling of[ADVANCEMENT_FUNCTIONS];
    double noise[ADVANCEMENT_FUNCTIONS]; /* rounding bound of each function [m] */
};

/* Sets the functions and their slopes at a time; the bounds of the second derivatives are not set. */
void advancement_at(const struct advancement_path *path, double time, struct advancement_instant *at);

struct advancement_result {
    double after;     /* time from the present to the change [s]; INFINITY: no change before `searched` */
    double gap;       /* gap at the change [m]; zero unless the source passes an end plane */
    double searched;  /* end of the searched time [s]; no other change is before it */
    long evaluations; /* number of evaluations of gap and rate */
};

/* Returns the first change within `horizon` seconds that is deeper than rounding, at a time exact to
 * rounding. The search ends early, at `searched` < horizon, after `budget` > 0 evaluations. */
struct advancement_result advancement_first(const struct advancement_path *path, double horizon, long budget);

#endif
