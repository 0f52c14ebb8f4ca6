/* Which bodies move by Newton's law and which contacts act on them, in the regimes of the moment. */
#ifndef CONTACT_SCENE_TOPOLOGY_H
#define CONTACT_SCENE_TOPOLOGY_H

#include "scene/scene_state.h"

/* Whether body i is free, prescribed; constants where the scene pins it. */
bool body_is_free(const struct scene_values *v, int body);
bool body_is_prescribed(const struct scene_values *v, int body);

/* Whether body i turns by Euler's equations, by its inputs, in either way; constants where the scene pins
 * it. */
bool body_turns_freely(const struct scene_values *v, int body);
bool body_turn_is_prescribed(const struct scene_values *v, int body);
bool body_turns(const struct scene_values *v, int body);

/* Whether a contact may have a friction force; whether it stores energy in a tangential spring. */
bool contact_rubs(const struct scene_values *v, int contact);
bool contact_rubs_elastically(const struct scene_values *v, int contact);

/* Whether the contact has a torque, a slip velocity or friction that count. */
bool contact_turns_or_rubs(const struct scene_values *v, int contact);

/* Whether any body turns or any contact rubs. Where none does, all is as in scenes without rotation. */
bool scene_turns(const struct scene_values *v);

/* Copies a state, without what has no meaning where nothing turns or rubs. */
void scene_state_copy(const struct scene_values *v, const struct scene_state *from, struct scene_state *to);

/* Whether neither body of the contact is free or turns freely: its motion is given. */
bool contact_is_driven(const struct scene_values *v, int contact);

/* Whether no body is free or turns freely: the scene is a force element and has no states of bodies. */
bool scene_is_force_element(const struct scene_values *v);

/* Whether any free body is in more than one contact, so that contacts may act on each other through it. */
bool scene_shares_free_body(const struct scene_values *v);

/* Whether the motion may be integrated as differential equations (scene/ode.h): by CVODE, or by the general
 * segment of event_driven, for bodies in several contacts and where something turns or rubs. */
bool scene_uses_ode(const struct scene_values *v);

/* Whether no bodies overlap. */
bool scene_is_apart(const struct scene_state *q);

/* Whether a contact transmits a force (it is in compression or restitution), whether any contact but `except`
 * acts on a body. */
bool contact_transmits(const struct scene_state *q, int contact);
bool body_is_loaded(const struct scene_state *q, int body, int except);

/* Whether another contact exerts a force on a free body of this contact, so that its motion is no polynomial
 * even while this one is apart. Constant false in scenes of one contact. */
bool contact_is_coupled(const struct scene_values *v, const struct scene_state *q, int contact);

/* Whether it is known when the contact changes its regime before that is integrated (segment/outlook.h):
 * always where nothing turns or rubs, as far as closed forms tell; else while it transmits no force or its
 * motion is given, and no other contact acts on its bodies. */
bool contact_is_foreseen(const struct scene_values *v, const struct scene_state *q, int contact);

#endif
