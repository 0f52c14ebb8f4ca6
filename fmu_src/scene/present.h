/*
 * The scene at its present clock. Where integration has accumulated a gap or carried its rate, both are more
 * accurate than positions and velocities tell and take the place of what those give.
 */
#ifndef CONTACT_SCENE_PRESENT_H
#define CONTACT_SCENE_PRESENT_H

#include "scene/evaluate.h"

/* Everything of the instant; and without accelerations and forces. */
void scene_kinematics_now(const struct scene_values *v, const struct scene_state *q,
                          struct scene_instant *at);
void scene_now(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at);

/* Whether the gap of scene_now is the accumulated one, more accurate than positions give it: in contact, as
 * contact ends, and where a change of regime was foreseen. */
bool scene_gap_is_accumulated(const struct scene_state *q, const struct scene_instant *at, int contact);

/* Whether g' there is the carried one. */
bool scene_rate_is_known(const struct scene_state *q, const struct scene_instant *at, int contact);

/* Whether the source is within the extents of the destination, as users see it. In the plane of an open end
 * rounding takes either side of it, and the regime that is in force decides. */
bool scene_shown_within(const struct scene_values *v, const struct scene_state *q,
                        const struct scene_instant *at, int contact, const struct contact_shape *shape);

/* The regime that the geometry of the instant asks for. */
enum contact_regime scene_regime(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_instant *at, int contact);

/* Of a contact that goes on touching, whatever rounding makes of its gap: the regime that its law asks
 * for. */
enum contact_regime scene_regime_of_touching(const struct scene_values *v, const struct scene_state *q,
                                             const struct scene_instant *at, int contact);

#endif
