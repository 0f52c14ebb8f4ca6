/* Which bodies move by Newton's law and which contacts act on them, in the regimes of the moment. */
#ifndef CONTACT_INVOLVED_H
#define CONTACT_INVOLVED_H

#include "dynamics/motion.h"

/* Whether body i is free, prescribed; constants where the scene pins it. */
bool body_is_free(const struct scene_values *v, int body);
bool body_is_prescribed(const struct scene_values *v, int body);

/* Whether neither body of the contact is free: its motion is given. */
bool contact_is_held(const struct scene_values *v, int contact);

/* Whether no body is free: the scene is a force element and has no states. */
bool system_is_force_element(const struct scene_values *v);

/* Whether any free body is in more than one contact, so that contacts may act on each other through it. */
bool system_shares_free_body(const struct scene_values *v);

/* Whether no bodies overlap. */
bool system_is_apart(const struct motion *q);

/* Whether a contact transmits a force (it presses or recedes), whether any contact but `except` presses on a body. */
bool contact_transmits(const struct motion *q, int contact);
bool body_is_pressed(const struct motion *q, int body, int except);

/* Whether a free body of the contact is pressed by another contact, so that its motion is no polynomial even while this one
 * is apart. Never, at compile time, in scenes of one contact. */
bool contact_is_coupled(const struct scene_values *v, const struct motion *q, int contact);

#endif
