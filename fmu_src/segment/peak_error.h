/* How far rounding may change the peaks of a contact that is stiff beyond all technique. */
#ifndef CONTACT_SEGMENT_PEAK_ERROR_H
#define CONTACT_SEGMENT_PEAK_ERROR_H

#include "segment/segment.h"

/* To be called once the peaks of a segment of `time` seconds are in the state. */
void peak_error_note(const struct segment *p, double time, struct contact_state *state);

#endif
