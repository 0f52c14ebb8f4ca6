/*
 * How far a contact is from its next change of regime, for an integrator that finds zeros of continuous
 * functions: event indicators with a hysteresis. Each is widened by a few rounding errors to the side where
 * it is, so that it is never zero right after a change and rounding alone changes nothing.
 */
#ifndef CONTACT_SCENE_REGIME_MARGIN_H
#define CONTACT_SCENE_REGIME_MARGIN_H

#include "scene/ode.h"

/* The gap, or how far the source is beyond the ends of its cylinder where that is more [m]: positive without
 * contact, negative in contact. */
double regime_touch_margin(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at, int contact);

/* The force at which the dashpot changes the law [N]: F_n of the full law, or under an approach-only dashpot
 * its viscous part; positive in compression, negative in restitution and while separating; 1 N where nothing
 * changes. */
double regime_dashpot_margin(const struct scene_values *v, const struct scene_state *q,
                             const struct scene_instant *at, int contact);

/* How far the source's centre is within the edges of the zone of a capped cylinder that the contact is in;
 * 1 m where there is none [m]. */
double regime_zone_margin(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, int contact);

#if SCENE_ANY_FRICTION
/* The event functions of friction (contact/friction.h), negative on the other side of their change: that of
 * a contact that slides, that of friction at its largest force, that of a dashpot that pulls; 1 where nothing
 * changes. */
double regime_friction_margin(const struct scene_values *v, const struct scene_state *q,
                              const struct scene_instant *at, int contact, enum ode_event event);

/* The event of friction whose margin has passed zero; ODE_EVENT_GAP: none has. */
enum ode_event regime_friction_event(const struct scene_values *v, const struct scene_state *q,
                                     const struct scene_instant *at, int contact);
#endif

/* The regime that follows from touch and dashpot: the present one unless a margin has passed zero. */
enum contact_regime regime_by_margins(const struct scene_values *v, const struct scene_state *q,
                                      const struct scene_instant *at, int contact);

#endif
