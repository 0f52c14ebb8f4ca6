/* Where a segment leaves the zone of a capped cylinder that it is made for (zone.h): a terminal event, after
 * which the regime goes on in the next zone. Without capped cylinders there is none. */
#ifndef CONTACT_SEGMENT_ZONE_END_H
#define CONTACT_SEGMENT_ZONE_END_H

#include "segment/segment.h"

#if SCENE_ANY_CAPS

/* Ends the segment there, if that is before p->terminal. */
void zone_end_note(struct segment *p);

static inline bool zone_end_is_terminal(const struct segment *p)
{
    return p->leaves_zone;
}

#else

static inline void zone_end_note(struct segment *p)
{
    (void)p;
}

static inline bool zone_end_is_terminal(const struct segment *p)
{
    (void)p;
    return false;
}

#endif
#endif
