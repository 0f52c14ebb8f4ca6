/*
 * A capped cylinder along a given path: flight, or two bodies whose motion is prescribed.
 *
 * The first touch needs no zones. The solid is convex, so the distance of a point from it is at least the
 * distance from the tangent plane at the nearest point, n.(c(t + s) - c(t)) + g(t). The first root of this
 * polynomial of s comes no later than the touch, and the next plane is taken there. The steps converge as
 * Newton's do, and no touch is missed however long the path is.
 *
 * In contact the path is followed from zone to zone. Edges of a zone are roots of polynomials, all isolated;
 * a point between two of them that is clear of all edges shows the zone.
 */
#ifndef CONTACT_FLIGHT_ZONE_PATH_H
#define CONTACT_FLIGHT_ZONE_PATH_H

#include "flight/relative_path.h"

/* Rounding bound of the gap [m]. */
double zone_path_rounding(const struct contact_solid *solid, const struct separation_path *path);

/* The first touch after `settled` seconds; INFINITY: none within the horizon [s]. `gap` is the gap at the
 * start, which may have more digits than the positions [m]. */
double zone_path_first_touch(const struct contact_shape *shape, const struct separation_path *path,
                             double gap, double settled, double horizon);

/* When the path leaves the zone solid->zone [s]; INFINITY: not within the horizon. */
double zone_path_end(const struct contact_solid *solid, const struct separation_path *path, double horizon);

/* When the path leaves a side or cap across its edge to the rim [s]; INFINITY: not within the horizon. */
double zone_path_leaves_face(const struct contact_solid *solid, const struct separation_path *path,
                             double horizon);

/* A superset of the instants at which a path passes from one zone to another: parts of the horizon, sorted,
 * ZONE_EDGES at most. Returns their number. */
enum { ZONE_EDGES = 4 * POLYNOMIAL_MAX_DEGREE };
int zone_path_edges(const struct contact_solid *solid, const struct separation_path *path, double horizon,
                    double edges[ZONE_EDGES]);

/* A place between two neighbouring edges that shows the zone, clear of edges that the path only touches. */
double zone_path_between(const struct contact_solid *solid, const struct separation_path *path,
                         double horizon, double from, double to);

/*
 * Changes of regime at the rim of a capped cylinder along a given path (flight while separating, or
 * prescribed motion). The gap is a root of polynomials of degree eight, and the law's conditions are no
 * polynomials. So the path is followed in steps that are short against the distance from the circle.
 */

struct rim_change {
    double time; /* [s]; INFINITY where nothing changes */
    enum contact_regime regime;
};

/* The first change from `present` between two times; `rounding` is the rounding bound of the gap at the
 * start. */
struct rim_change rim_first_change(const struct contact_shape *shape, const struct contact_law *law,
                                   const struct separation_path *path, double rounding,
                                   enum contact_regime present, double from, double until);

/* The least gap between two times [m]. */
double rim_least_gap(const struct contact_shape *shape, const struct separation_path *path, double from,
                     double until);

/* Event prediction (prediction.h) for capped cylinders: the next change of regime or zone where no contact
 * force acts or all motion is prescribed. A change of zone keeps the regime. */

/* When bodies that are apart touch [s]; INFINITY: not within the horizon. */
double zone_change_touch(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, double clock, int contact, double horizon);

#endif
