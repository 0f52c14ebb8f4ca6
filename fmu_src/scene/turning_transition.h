/* Changes of the regime of friction, besides those of the contact: who rubs begins to stick or to slide. */
#ifndef CONTACT_SCENE_TURNING_TRANSITION_H
#define CONTACT_SCENE_TURNING_TRANSITION_H

#include "scene/ode.h"
#include "scene/turning_motion.h"

#if SCENE_ANY_FRICTION

/*
 * After a contact has changed its regime from `before` at the present instant: friction begins with a spring
 * at rest, sticking where that persists; or ends, and what its spring stores is dissipated; or goes on, in
 * the regime that the new force asks for. Nothing is done where the contact does not rub.
 */
void turning_take_regime(const struct scene_values *v, struct scene_state *q, int contact,
                         enum contact_regime before);

/* After one of friction's own events (scene/ode.h) at the present instant. */
void turning_take_event(const struct scene_values *v, struct scene_state *q, int contact,
                        enum ode_event event);

#endif
#endif
