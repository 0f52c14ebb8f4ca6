/*
 * The first change of regime of a contact along a path that is known (relative_path.h), and what the path
 * tells about the centres: regime_change.h puts it together.
 */
#ifndef CONTACT_SEGMENT_PATH_CHANGE_H
#define CONTACT_SEGMENT_PATH_CHANGE_H

#include "segment/flight_candidates.h"
#include "segment/regime_change.h"

/* The first of `count` sorted events, all in [0, 1], from which on the regime is not the present one; none
 * counts before `settle`. `ends_only`: only the passage of a cylinder's end changes it. The centres are not
 * looked at. */
struct regime_change path_first_change(const struct relative_path *path, const double *events, int count,
                                       const struct contact_law *law, enum contact_regime present,
                                       bool ends_only, double settle);

/* Whether the distance vanishes before `until`, as far as rounding can tell. A source that stays where it is,
 * on the axis say, passes nothing: it keeps the direction it has. */
bool path_passes_centre(const struct relative_path *path, const struct extremes *extremes, double until);

/* Whether the length of the path alone tells that the bodies neither touch nor meet their centres. */
bool path_keeps_away(const struct relative_path *path);

#endif
