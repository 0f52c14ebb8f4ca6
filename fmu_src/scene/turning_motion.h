/*
 * How what turns and rubs goes on from an instant (scene_evaluate): torques, angular accelerations, rates of
 * springs. World frame, SI units. Where a contact is apart all of its own are zero.
 */
#ifndef CONTACT_SCENE_TURNING_MOTION_H
#define CONTACT_SCENE_TURNING_MOTION_H

#include "contact/turning_slopes.h"
#include "scene/turning.h"

#if SCENE_ANY_TURNING

/* All torques about the centre of a body of free rotation: of its contacts and the external one [N m]. */
struct vec3 turning_torque_on(const struct scene_values *v, const struct scene_state *q, double clock,
                              const struct scene_instant *at, int body);

/*
 * d omega/dt [rad/s^2]. Of a free top with the axis e: with omega_3 = omega.e, tau_3 = tau.e
 *   I_1 omega' = tau - (I_3 - I_1) (tau_3 / I_3 e + omega_3 omega x e)
 */
struct vec3 turning_acceleration(const struct scene_values *v, const struct scene_state *q, double clock,
                                 const struct scene_instant *at, int body);

/* The motion of a contact as contact/turning_slopes.h has it, and its laws. */
struct turning_motion turning_motion_of(const struct turning_state *turning, const struct scene_instant *at,
                                        int contact);
struct turning_laws turning_laws_of(const struct scene_values *v, const struct scene_state *q, int contact);

/* F_n, slip and spring of a contact. */
struct friction_state turning_rubbing(const struct turning_state *turning, const struct scene_instant *at,
                                      int contact);

/* n', the rate of the normal [1/s]. */
struct vec3 turning_normal_rate(const struct scene_values *v, const struct scene_state *q,
                                const struct scene_instant *at, int contact);

/* xi', the turning with the normal included [m/s]. */
struct vec3 turning_spring_rate(const struct scene_values *v, const struct scene_state *q,
                                const struct turning_state *turning, const struct scene_instant *at,
                                int contact);

/* dF_n/dt [N/s]; of an instant with accelerations. */
double turning_normal_force_rate(const struct scene_values *v, const struct scene_state *q, double clock,
                                 const struct scene_instant *at, int contact);

/* -F_t.v_t, summed up over the contacts: what friction and its springs take [W]. */
double turning_friction_power(const struct scene_values *v, const struct scene_instant *at);

#endif
#endif
