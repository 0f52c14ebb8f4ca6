/*
 * How the axis of a destination turns with time, and bounds of how fast: it stands still; goes round a fixed
 * direction steadily (the precession of a torque-free body, a constant angular velocity); turns with a rate
 * that is polynomial in time (a torque, a prescribed angular velocity); or is a polynomial itself, of any
 * length but zero.
 */
#ifndef CONTACT_SEGMENT_AXIS_MOTION_H
#define CONTACT_SEGMENT_AXIS_MOTION_H

#include "math/rotor_series.h"

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
struct axis_motion axis_motion_driven(struct vec3 axis, const struct vec3 *rate, int count);
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

#endif
