/*
 * These functions find where a contact's path, a polynomial of time, crosses the edges of zones of a capped
 * cylinder or of skew cylinders. All roots of polynomials are isolated. A place between two neighbouring
 * roots that is clear of all edges shows whether the centre is within the zone there.
 */
#ifndef CONTACT_FLIGHT_ZONE_PATH_H
#define CONTACT_FLIGHT_ZONE_PATH_H

#include "flight/relative_path.h"

/* Returns the rounding bound of the distances of a centre c from the edges [m]. */
double zone_path_rounding(const struct contact_solid *solid, struct vec3 c);

/* Returns the time at which the path leaves the zone solid->zone of a capped cylinder [s]; INFINITY: not
 * within the horizon. */
double zone_path_end(const struct contact_solid *solid, const struct separation_path *path, double horizon);

/* Returns when the path leaves a side, a cap or the face of skew cylinders across its outer edge [s];
 * INFINITY: not within the horizon. */
double zone_path_leaves_face(const struct contact_solid *solid, const struct separation_path *path,
                             double horizon);

#endif
