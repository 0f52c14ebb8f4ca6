/*
 * Friction of a contact whose motion is given: how it begins and ends, and the events of elastic friction,
 * at which it sticks, slides or lifts.
 */
#ifndef CONTACT_SEGMENT_DRIVEN_FRICTION_H
#define CONTACT_SEGMENT_DRIVEN_FRICTION_H

#include "segment/driven_panel.h"

#if SCENE_ANY_TURNING

#if SCENE_ANY_FRICTION

/* The least event function, and which. */
enum driven_event { DRIVEN_STICK, DRIVEN_CAP, DRIVEN_LIFT };

struct driven_margin {
    double value; /* [N], or [m/s] */
    double scale; /* of what the value is a difference */
    enum driven_event event;
};

struct driven_margin driven_margin_at(const struct driven_contact *c, double clock, struct vec3 spring);

/* Whether an event function is below `floor`, or below zero where that is less, by more than rounding. */
bool driven_margin_is_below(struct driven_margin margin, double floor);

/* The regime and the spring after an event at an instant; what sticks again keeps the spring that sliding
 * had. */
void driven_take_event(const struct driven_contact *c, double clock, struct vec3 spring,
                       enum driven_event event);

/* Of elastic friction after inputs have jumped: the spring lies across the new normal, and one event at most
 * follows. */
void driven_friction_settle(const struct scene_values *v, struct scene_state *q, int contact);

#endif

/* At the touch and at the parting. */
void driven_friction_begin(const struct scene_values *v, struct scene_state *q, double clock, int contact);
void driven_friction_end(struct scene_state *q, int contact);

/* xi, zero in scenes without friction [m]. */
struct vec3 driven_spring(const struct scene_state *q, int contact);

#endif
#endif
