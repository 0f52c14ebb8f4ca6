/* Until when bodies in flight certainly do not touch, which is cheaper to tell than when they do. */
#ifndef CONTACT_SEGMENT_FLIGHT_APART_H
#define CONTACT_SEGMENT_FLIGHT_APART_H

#include "scene/evaluate.h"

/* The clock before which no bodies that are apart touch, without external forces; INFINITY: never; 0: not
 * known. */
double flight_apart_until(const struct scene_values *v, const struct scene_state *q);

#endif
