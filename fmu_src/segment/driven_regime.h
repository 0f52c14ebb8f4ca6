/*
 * The regimes of a contact that turns or rubs while its motion is given, of its law and of friction: which
 * they are as it begins, the event functions that end them, and what follows each event. Between two events
 * nothing changes them, so that all forces are smooth there.
 */
#ifndef CONTACT_SEGMENT_DRIVEN_REGIME_H
#define CONTACT_SEGMENT_DRIVEN_REGIME_H

#include "segment/driven_panel.h"

#if SCENE_ANY_TURNING

/* The law's event (contact/law.h); friction ends or begins under a dashpot that pulls, reaches its largest
 * force or leaves it, sticks or breaks away (contact/friction.h). */
enum driven_event { DRIVEN_LAW, DRIVEN_LIFT, DRIVEN_CAP, DRIVEN_STICK, DRIVEN_EVENTS };

/* Event functions, positive within the regimes, and what rounding makes of them. */
struct driven_margins {
    double value[DRIVEN_EVENTS];
    double noise[DRIVEN_EVENTS];
};

void driven_margins_at(const struct driven_contact *c, double clock, struct vec3 spring,
                       struct driven_margins *margins);

/* The first event whose function is below zero by more than rounding, of friction below what it was at `start`
 * too; DRIVEN_EVENTS: none is. */
enum driven_event driven_event_passed(const struct driven_margins *now, const struct driven_margins *start);

/* The regimes and the spring after an event at an instant; what sticks again keeps the spring that sliding
 * had. */
void driven_take_event(const struct driven_contact *c, double clock, struct vec3 spring,
                       enum driven_event event);

/* The regimes from the touch on, and after the parting. */
void driven_begin(const struct driven_contact *c, double clock);
void driven_end(const struct driven_contact *c);

/* Puts the regimes to what the present asks for: at the start, and after inputs have jumped. */
void driven_turning_settle(const struct scene_values *v, struct scene_state *q, int contact);

/* xi, zero in scenes without friction [m]. */
struct vec3 driven_spring(const struct scene_state *q, int contact);

#endif
#endif
