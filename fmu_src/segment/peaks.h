/* Largest force and penetration within a segment. */
#ifndef CONTACT_SEGMENT_PEAKS_H
#define CONTACT_SEGMENT_PEAKS_H

#include "segment/segment.h"

/* Takes the segment up to `end` into account for the peaks of the communication step. */
void peaks_note(struct segment *p, struct contact_state *state, double end);

#endif
