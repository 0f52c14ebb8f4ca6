/*
 * The jet (scene_jet.h) of what turns and rubs: rotations of the bodies, and contacts whose axis turns,
 * with their torques, slip, friction and springs. Coefficients of order up to two.
 */
#ifndef CONTACT_SCENE_TURNING_JET_H
#define CONTACT_SCENE_TURNING_JET_H

#include "scene/scene_jet.h"
#include "scene/turning_motion.h"

#if SCENE_ANY_TURNING

/* Coefficient `order` of a cross product. */
struct vec3 turning_jet_cross(const struct vec3 *a, const struct vec3 *b, int order);

/* The rotations of the bodies in time, as far as the instant tells them: of bodies that turn freely the
 * change of their angular acceleration is missing. And the rates of the springs. */
CONTACT_COLD void turning_jet_put_bodies(const struct scene_values *v, const struct scene_state *q,
                                         const struct scene_instant *at, struct scene_jet *along);

/* What is missing, from contacts that are known to the first order. */
CONTACT_COLD void turning_jet_put_changes(const struct scene_values *v, const struct scene_state *q,
                                          const struct scene_instant *at, struct scene_jet *along);

/* The change of the angular acceleration of a body that turns freely. */
CONTACT_COLD struct vec3 turning_jet_spin_change(const struct scene_values *v, const struct scene_state *q,
                                                 const struct scene_instant *at,
                                                 const struct scene_jet *along, int body);

/* A change of the axis of a body of prescribed rotation, component by component, of the input as given. */
CONTACT_COLD void turning_jet_move_axis(const struct scene_values *v, const struct scene_instant *at,
                                        int body, int component, double change, struct scene_jet *along);

/* A contact from what is there of bodies, springs and factors: all of it where something turns or rubs; where
 * nothing does, torques and slip of a contact that is known. */
CONTACT_COLD void turning_jet_of_contact(const struct scene_values *v, const struct scene_state *q,
                                         const struct scene_instant *at, int contact,
                                         struct scene_jet *along);

/* Coefficients of energies [J], and of the powers of what turns: of friction and its springs, of torques from
 * outside [W]. */
CONTACT_COLD double turning_jet_of_rotational(const struct scene_values *v, const struct scene_jet *along,
                                              int order);
CONTACT_COLD double turning_jet_of_tangential(const struct scene_values *v, const struct scene_state *q,
                                              const struct scene_jet *along, int order);
CONTACT_COLD double turning_jet_friction_power(const struct scene_values *v, const struct scene_jet *along,
                                               int order);
CONTACT_COLD double turning_jet_external_power(const struct scene_values *v, const struct scene_state *q,
                                               const struct scene_jet *along, int order);

#endif
#endif
