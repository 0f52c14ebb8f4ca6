/* How long bodies in flight certainly do not touch, which is cheaper to tell than when they do. */
#ifndef CONTACT_SEGMENT_FLIGHT_APART_H
#define CONTACT_SEGMENT_FLIGHT_APART_H

#include "scene/evaluate.h"

/* Whether anything of the kind can be told: not of a source inside, nor of bodies whose motion is given. */
bool flight_apart_is_known(const struct scene_values *v, const struct scene_state *q, int contact);

/* Seconds from the present instant `at` for which bodies that are apart cannot touch, without external
 * forces; INFINITY: never; 0: not known. A convex destination lies behind the plane that touches it in the
 * point nearest to the source, so the gap is at least the source's height above that plane, a parabola of
 * time. */
double flight_apart_for(const struct scene_values *v, const struct scene_state *q,
                        const struct scene_instant *at, int contact);

#endif
