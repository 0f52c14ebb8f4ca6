/* The terminal event of a segment: which event function ends the regime, and with which hysteresis. The
 * passage of the centre ends a segment too. */
#ifndef CONTACT_TOUCH_TERMINAL_EVENT_H
#define CONTACT_TOUCH_TERMINAL_EVENT_H

#include "touch/segment.h"

/* How far the rounding of g' moves the gap at most [m]: each segment
 * computes g' afresh from rounded velocities. */
double terminal_event_gap_noise(const struct contact_pair *from);

/* Gap up to which contact lasts where the separation is slow [m]. */
double terminal_event_gap_tolerance(const struct segment *p);

/* Whether the law can end the regime before the gap opens, and its event function (contact_event):
 * the regime lasts while factor quantity + offset > 0. */
bool terminal_event_by_law(const struct segment *p);
struct event_function terminal_event_margin(const struct segment *p);

struct terminal_event terminal_event_first(struct segment *p);

/* The s at which d = 0 and n reverses; INFINITY: not within the segment. */
double terminal_event_centre(const struct segment *p);

/* Ends the segment at d = 0, if that is before p->terminal: n reverses there, whether or not the regime
 * changes. */
void terminal_event_at_centre(struct segment *p);

#endif
