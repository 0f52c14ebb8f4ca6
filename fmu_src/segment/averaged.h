/* Averaged segments: many small oscillations in one collocated step, which is free of events. */
#ifndef CONTACT_SEGMENT_AVERAGED_H
#define CONTACT_SEGMENT_AVERAGED_H

#include "segment/segment.h"

/* False where the oscillation is too large. p->pair, regime, gap_rounding and tolerance are set. */
bool averaged_segment(struct segment *p, const struct pair_timescales *scales, double longest);

/* Error of treating an oscillation or fast decay of amplitude `a` [m] to first order: the second order of its
 * closed-form part, 4 a ratio^2 with `ratio` the tangential rate over the oscillation's; and the mean of
 * (a/d)^2 in n', which acts over `radians` of the tangential motion, 3 a^2 radians / d [m]. */
double averaged_error(double a, double ratio, double distance, double radians);

#endif
