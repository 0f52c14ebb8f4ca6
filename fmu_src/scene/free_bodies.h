/*
 * What free bodies add to the state of motion, to an instant of it and to its jet. Scenes without a body that
 * may be free have given_bodies.c instead, where these functions do nothing.
 */
#ifndef CONTACT_SCENE_FREE_BODIES_H
#define CONTACT_SCENE_FREE_BODIES_H

#include "scene/scene_jet.h"

/* Parts of scene_rebase: the origins of bodies are moved to where they are; the clocks kept of contacts are
 * shifted with the clock. */
void free_bodies_rebase(struct scene_state *q);
void free_bodies_shift_clocks(struct scene_state *q);

/* Where a free body is, by `bodies`. */
void free_bodies_put(const struct scene_state *q, const struct body_state *bodies, int body,
                     struct body_instant *at);

/* The present states of the free bodies, NULL in scenes that have none. */
const struct body_state *free_bodies_now(const struct scene_state *q);

/* Puts accumulated gaps and carried rates into the present instant where they are known. */
void free_bodies_put_gaps(const struct scene_values *v, const struct scene_state *q,
                          struct scene_instant *at);

/* The change of acceleration of free bodies, by the forces of the contacts; whether there are free bodies.
 * And energies dissipated and supplied. */
bool free_bodies_put_jerk(const struct scene_values *v, const struct scene_state *q, struct scene_jet *along);
void free_bodies_put_work(const struct scene_values *v, const struct scene_state *q, struct scene_jet *along);

/* Half the change of a free body's acceleration with the external force and the contact forces [m/s^3 in
 * time]; the power of dissipation, and that of external forces on free bodies and of what moves prescribed
 * ones against the contacts [W], of order 0 or 1. */
struct vec3 free_bodies_half_jerk(const struct scene_values *v, const struct scene_jet *along, int body);
double free_bodies_dissipated_power(const struct scene_values *v, const struct scene_state *q,
                                    const struct scene_jet *along, int order);
double free_bodies_external_power(const struct scene_values *v, const struct scene_state *q,
                                  const struct scene_jet *along, int order);

#endif
