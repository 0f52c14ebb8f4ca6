/*
 * Contact with a capped cylinder along a given path: flight, or prescribed motion of both bodies.
 *
 * The first touch needs no zones. The solid is convex, so its distance from a point is at least that of the
 * tangent plane at the nearest point. The gap at the time t + s is therefore at least n.(c(t + s) - c(t)) +
 * g(t). The first root s of this polynomial is no later than the touch, and the next tangent plane is taken
 * there. The steps converge like Newton's method, and no touch is missed however long the path is.
 *
 * In contact the path is followed from zone to zone. The path crosses zone edges at roots of polynomials, all
 * of which are isolated. A time between two neighbouring roots that is clear of all edges shows the zone.
 */
#ifndef CONTACT_FLIGHT_ZONE_PATH_H
#define CONTACT_FLIGHT_ZONE_PATH_H

#include "flight/relative_path.h"

/* Returns the rounding bound of the gap [m]. */
double zone_path_rounding(const struct contact_solid *solid, const struct separation_path *path);

/* Returns the time at which the path leaves the zone solid->zone [s]; INFINITY: not within the horizon. */
double zone_path_end(const struct contact_solid *solid, const struct separation_path *path, double horizon);

/* Returns when the path leaves a side or cap across its edge to the rim [s]; INFINITY: not within the
 * horizon. */
double zone_path_leaves_face(const struct contact_solid *solid, const struct separation_path *path,
                             double horizon);

/* Event prediction (prediction.h) for capped cylinders: the next change of regime or zone while no contact
 * force acts or all motion is prescribed. A change of zone keeps the regime. */

/* Returns the time until bodies that are apart touch [s]; INFINITY: not within the horizon. */
double zone_change_touch(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, double clock, int contact, double horizon);

#endif
