/* The next change of regime of a contact with a capped cylinder, or of its zone, where no contact force acts
 * or all motion is given: regime_change.h for that shape. A change of zone leaves the regime as it is. */
#ifndef CONTACT_SEGMENT_ZONE_CHANGE_H
#define CONTACT_SEGMENT_ZONE_CHANGE_H

#include "segment/rim_change.h"

#if SCENE_ANY_CAPS

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
#endif
