/* Energies of the scene [J]. kinetic + potential + contact + dissipated - external work stays constant; with
 * what turns and rubs, kinetic + rotational + potential + contact + tangential + dissipated + friction -
 * external work. */
#ifndef CONTACT_SCENE_ENERGY_H
#define CONTACT_SCENE_ENERGY_H

#include "scene/scene_jet.h"

/* Sum of m v^2 / 2 over the free bodies. */
double energy_kinetic_of(const struct scene_values *v, const struct scene_instant *at);

#if SCENE_ANY_TURNING
/* Sum of omega I omega / 2 over the bodies of free rotation; what the tangential springs store. */
double energy_rotational_of(const struct scene_values *v, const struct scene_instant *at);
double energy_tangential_of(const struct scene_values *v, const struct scene_state *q,
                            const struct scene_instant *at);
#endif

/* Minus the sum of m gravity.x over the free bodies; zero at the world's origin. */
double energy_potential_of(const struct scene_values *v, const struct scene_instant *at);

/* What that changes by when gravity does. */
double energy_potential_change(const struct scene_values *v, const struct scene_instant *at,
                               struct vec3 more_gravity);

/* Sum of p_n g^2 / 2 over the contacts. */
double energy_stored(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at);

/* -(F_n + p_n g) g' of a contact, and the sum over all [W]. */
double energy_dissipated_power_of(const struct scene_values *v, const struct scene_state *q,
                                  const struct scene_instant *at, int contact);
double energy_dissipated_power(const struct scene_values *v, const struct scene_state *q,
                               const struct scene_instant *at);

/* Coefficient `order` of the energies along a path (scene_jet.h). */
double jet_of_kinetic(const struct scene_values *v, const struct scene_jet *along, int order);
double jet_of_potential(const struct scene_values *v, const struct scene_jet *along, int order);
double jet_of_stored(const struct scene_values *v, const struct scene_state *q, const struct scene_jet *along,
                     int order);

#endif
