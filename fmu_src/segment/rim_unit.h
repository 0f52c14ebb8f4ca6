/* The unit of a series at a rim (rim_series.h). */
#ifndef CONTACT_SEGMENT_RIM_UNIT_H
#define CONTACT_SEGMENT_RIM_UNIT_H

#include "segment/contact_pair.h"

/* One radian of the spring, one decay time of the dashpot, or the passage, whichever is shortest: [s], or
 * [s/sqrt(m)] by the root of the penetration. The order of magnitude is enough. */
double rim_unit_of(const struct contact_pair *from, bool by_root);

#endif
