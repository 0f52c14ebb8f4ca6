/* A segment of head-on motion in closed form (segment/pair_oscillation.h). */
#ifndef CONTACT_SEGMENT_CLOSED_FORM_H
#define CONTACT_SEGMENT_CLOSED_FORM_H

#include "segment/segment.h"

/* Over all of `longest` [s] where no event follows; else over a period of the oscillation at most, or over
 * the decay. False where the motion is not head-on. p->pair, regime, gap_rounding and tolerance are set. */
bool closed_form_make(struct segment *p, double longest);

#endif
