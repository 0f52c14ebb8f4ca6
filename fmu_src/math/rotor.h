/*
 * The torque-free rigid body with an axis of symmetry, in closed form. e_3 is the third axis of the body's
 * frame, I_3 the moment of inertia about it, I_1 that across it; all else in the world's frame.
 *
 *   L = I_1 omega + (I_3 - I_1) (omega.e_3) e_3         conserved, as is omega.e_3 = omega_3
 *   P = L / I_1 = omega + (I_3/I_1 - 1) omega_3 e_3     the axis goes round L with it (precession)
 *   R(t) = Rot(L/|L|, |P| t) R(0) Rot(e_z, (1 - I_3/I_1) omega_3 t)
 *
 * A sphere is I_1 = I_3: then P = omega and the second rotation is none. Both rates have twice the digits of
 * a double and angles are reduced with them, so that the number of turns costs no digit.
 */
#ifndef CONTACT_MATH_ROTOR_H
#define CONTACT_MATH_ROTOR_H

#include "math/double_double.h"
#include "math/quaternion.h"

/* This struct holds the orientation and the angular velocity of a body. */
struct body_turn {
    struct quaternion orientation; /* unit, body to world */
    struct vec3 angular_velocity;  /* omega, in the world's frame [rad/s] */
};

/* Torque-free motion from a start, all of it. */
struct rotor {
    struct body_turn start;
    struct vec3 axis;                /* e_3 at the start, unit */
    struct vec3 direction;           /* L/|L|, unit; any where the body does not turn */
    double unit;                     /* a power of two [1/s], by which precession and spin are divided */
    struct double_double precession; /* |P| >= 0 [unit] */
    struct double_double spin;       /* (1 - I_3/I_1) omega_3 [unit] */
};

/* This struct holds moments of inertia in any unit, both positive and finite. */
struct rotor rotor_from(struct body_turn start, double transverse_inertia, double axial_inertia);

/* Returns the state after a time [s] of either sign. The quaternion's sign is continuous in time. */
struct body_turn rotor_at(const struct rotor *rotor, double time);

/* This struct holds the axis e_3 alone, and its rate omega x e_3. */
struct rotor_axis {
    struct vec3 axis; /* unit */
    struct vec3 rate; /* [1/s] */
};
struct rotor_axis rotor_axis_at(const struct rotor *rotor, double time);

/* Return |P| and the magnitude of the axis' rate [rad/s]; both are constant. */
double rotor_precession(const struct rotor *rotor);
double rotor_axis_speed(const struct rotor *rotor);

/*
 * These functions move a rigid body with three moments of inertia I under a torque tau, by power series of
 * time. The quaternion q is the body's orientation, and q* is its inverse. L is the angular momentum, the
 * integral of tau; l has the components of L in the body's frame, and omega those of the angular velocity.
 * The equations of Euler and of the orientation are
 *
 *   l' = l x omega + q* tau q,   omega = l / I by components,   q' = q (0, omega) / 2
 *
 * Each step keeps L, so that errors are those of rounding only; the cost is in proportion to the turns. The
 * body stays as it is where steps become less than a rounding of the time. A torque has three coefficients.
 */
enum { ROTOR_TORQUES = 3 };

struct body_turn rotor_of_three_after(const struct body_turn *start, struct vec3 inertia,
                                      const struct vec3 torque[ROTOR_TORQUES], double time);

/* Returns an orientation after time >= 0 [s] under an angular velocity that is a polynomial of time. It is
 * that of a body with three moments of one, whose torque is the rate of the angular velocity. */
struct quaternion rotor_turned_after(const struct vec3 omega[ROTOR_TORQUES], struct quaternion q,
                                     double time);

#endif
