/*
 * The first change of regime of a contact whose motion is given: neither body is free, so the path is the
 * same in every regime.
 *
 * A condition that is zero at an event is computed again after it, from paths with a new origin, and rounding
 * may then give it either sign. A change counts only where its condition is beyond what rounding can do to
 * it; it takes place where the condition is zero. So no event can follow from the rounding of the one before.
 */
#ifndef CONTACT_SEGMENT_DRIVEN_CHANGE_H
#define CONTACT_SEGMENT_DRIVEN_CHANGE_H

#include "segment/relative_path.h"

/* Of the positions that the path starts from, and the speed at which they change. */
struct driven_rounding {
    double gap;   /* what rounding makes of the gap [m] */
    double axial; /* and of the place along a cylinder's axis [m] */
    double speed; /* |w| over the whole path at most [m/s] */
};

struct driven_change {
    double s; /* of the path, INFINITY where nothing changes */
    enum contact_regime regime;
    double gap; /* then [m] */
};

/* `events`: `count` instants of the path, sorted, among them all at which the regime may change. */
struct driven_change driven_first_change(const struct relative_path *path, const struct contact_law *law,
                                         const struct driven_rounding *rounding, const double *events,
                                         int count, enum contact_regime present);

#endif
