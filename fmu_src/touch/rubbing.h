/*
 * A sphere on a plane under regularized friction, where no load acts along the plane (rubbing.c). The normal
 * motion does not feel this friction, so that it is a segment of a contact pair (segment.h).
 */
#ifndef CONTACT_TOUCH_RUBBING_H
#define CONTACT_TOUCH_RUBBING_H

#include "touch/segment.h"

/* Whether segments solve a contact that transmits a force, although bodies turn or rub in the scene: the
 * contact has no friction and its destination no turning axis, and skew cylinders do not turn and meet
 * between their ends; or it is the case of this file. */
bool rubbing_is_solvable(const struct scene_instant *at, int contact);

/* Returns false where the cap of friction may act during a segment just made. Shortens a segment in which
 * quadratures would have to follow very many oscillations. */
bool rubbing_allows(struct segment *p, const struct scene_state *q, int contact);

/* Returns the time from the start of the segment [s] up to which a reading costs no more in a longer segment,
 * because the motion along the plane is a closed form there; INFINITY where few panels cover the rest. */
double rubbing_short_until(const struct segment *p, const struct scene_state *q, int contact);

/* Does the work of segment_advance and adds what friction does: the motion along the plane, the rotation of
 * the source, and the impulses and works of the friction force. */
void rubbing_advance(struct segment *p, double from, double s, struct scene_state *q, int contact);

#endif
