/*
 * The first touch of a sphere with a destination whose axis turns: a cylinder that tumbles, a plane that
 * tilts. No touch deeper than rounding is missed, however long the flight: docs/tumbling.md says why.
 */
#ifndef CONTACT_SEGMENT_TUMBLING_TOUCH_H
#define CONTACT_SEGMENT_TUMBLING_TOUCH_H

#include "segment/tumbling_gap.h"

struct tumbling_result {
    double after;     /* seconds from the present; INFINITY: not before `searched` */
    double gap;       /* then; zero unless the source passes an end plane [m] */
    double searched;  /* until then nothing else happens [s] */
    long evaluations; /* how often gap and rate were computed */
};

/* The first change within `horizon` seconds that is deeper than rounding, located to rounding. The search
 * ends early, at `searched` < horizon, after `budget` > 0 evaluations. */
struct tumbling_result tumbling_first(const struct tumbling_path *path, enum tumbling_change change,
                                      double horizon, long budget);

#endif
