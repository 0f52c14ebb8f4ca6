/* Collocated steps whose nodes see the oscillation: impacts. */
#ifndef CONTACT_SEGMENT_RESOLVED_H
#define CONTACT_SEGMENT_RESOLVED_H

#include "segment/segment.h"

/* Below critical damping; up to the end of contact where that is near. p->pair, regime, gap_rounding and
 * tolerance are set. */
bool resolved_segment(struct segment *p, const struct pair_timescales *scales, double longest);

#endif
