/*
 * A capped cylinder along a path that is given: flight, or two bodies whose motion is prescribed.
 *
 * The first touch needs no zones. The solid is convex, so that its distance from a point is at least that
 * from the plane through the point nearest to it, n.(c(t + s) - c(t)) + g(t): a polynomial of s, whose first
 * root comes no later than the touch. From there the next one is taken; the steps converge as Newton's do,
 * and no touch is missed however long the path is.
 *
 * In contact the path is followed from zone to zone. Edges of a zone are roots of polynomials, all isolated;
 * between them a point that is clear of all edges tells the zone.
 */
#ifndef CONTACT_FLIGHT_ZONE_PATH_H
#define CONTACT_FLIGHT_ZONE_PATH_H

#include "flight/relative_path.h"

/* Roundings of the gap [m]. */
double zone_path_rounding(const struct contact_solid *solid, const struct separation_path *path);

/* The first touch after `settled` seconds, INFINITY if there is none within the horizon [s]; `gap` is that at
 * the start of the path, which may be known better than by positions [m]. */
double zone_path_first_touch(const struct contact_shape *shape, const struct separation_path *path,
                             double gap, double settled, double horizon);

/* When the path leaves the zone solid->zone [s]; INFINITY: not within the horizon. */
double zone_path_end(const struct contact_solid *solid, const struct separation_path *path, double horizon);

/* The same of the outer edges only, those to the rim, of side and cap. */
double zone_path_leaves_face(const struct contact_solid *solid, const struct separation_path *path,
                             double horizon);

/* All instants at which a path passes from any zone to another, and more: parts of the horizon, sorted; at
 * most ZONE_EDGES of them. Returns how many. */
enum { ZONE_EDGES = 4 * POLYNOMIAL_MAX_DEGREE };
int zone_path_edges(const struct contact_solid *solid, const struct separation_path *path, double horizon,
                    double edges[ZONE_EDGES]);

/* A place between two neighbouring edges that tells the zone there: the path may touch an edge between
 * them. */
double zone_path_between(const struct contact_solid *solid, const struct separation_path *path,
                         double horizon, double from, double to);

/*
 * Changes of regime at the rim of a capped cylinder along a path that is given (flight while separating, or
 * prescribed motion). The gap is a root of polynomials of degree eight, and the law's conditions go beyond
 * what polynomials can tell, so the path is followed in steps that are short against the circle's distance.
 */

struct rim_change {
    double time; /* [s]; INFINITY where nothing changes */
    enum contact_regime regime;
};

/* The first change from `present` between two times; `rounding` is that of the gap where the path begins. */
struct rim_change rim_first_change(const struct contact_shape *shape, const struct contact_law *law,
                                   const struct separation_path *path, double rounding,
                                   enum contact_regime present, double from, double until);

/* The least gap between two times [m]. */
double rim_least_gap(const struct contact_shape *shape, const struct separation_path *path, double from,
                     double until);

/* The next change of regime of a contact with a capped cylinder, or of its zone, where no contact force acts
 * or all motion is given: prediction.h for that shape. A change of zone leaves the regime as it is. */

/* Of bodies that are apart: when they touch [s]; INFINITY: not within the horizon. */
double zone_change_touch(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, double clock, int contact, double horizon);

/* Of a contact: when it leaves its zone [s], INFINITY: not within the horizon. */
double zone_change_after(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, double clock, int contact, double horizon);

/* At a rim, within the zone. */
struct rim_change zone_change_at_rim(const struct scene_values *v, const struct scene_state *q,
                                     const struct scene_instant *at, double clock, int contact,
                                     double horizon);

#endif
