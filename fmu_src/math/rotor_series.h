/*
 * Bodies with an axis of symmetry whose turning is no closed form, by power series of time:
 *
 *   e_3' = lambda x e_3       lambda = L / I_1, or a prescribed angular velocity: a polynomial of time
 *   omega_3' = tau.e_3 / I_3  under a torque tau, a polynomial of time
 *
 * L grows by the integral of tau. Each step spans a radian at most, over which the series leave less than
 * rounding, so that errors are those of rounding only; the cost is in proportion to the turns.
 */
#ifndef CONTACT_MATH_ROTOR_SERIES_H
#define CONTACT_MATH_ROTOR_SERIES_H

#include "math/rotor.h"

/* Coefficients of lambda and of a torque. */
enum { ROTOR_RATES = 4, ROTOR_TORQUES = 3 };

/* lambda of a body under a torque, from its state on. */
void rotor_rates_under_torque(const struct rotor_state *start, double transverse_inertia,
                              double axial_inertia, const struct vec3 torque[ROTOR_TORQUES],
                              struct vec3 lambda[ROTOR_RATES]);

/* Where an axis has turned to after time >= 0. */
struct vec3 rotor_axis_after(const struct vec3 lambda[ROTOR_RATES], struct vec3 axis, double time);

/* The state after time >= 0 under a torque. */
struct rotor_state rotor_under_torque(const struct rotor_state *start, double transverse_inertia,
                                      double axial_inertia, const struct vec3 torque[ROTOR_TORQUES],
                                      double time);

/* The same polynomial with its origin moved on by `time`. */
void rotor_rates_shift(struct vec3 *coefficient, int count, double time);

#endif
