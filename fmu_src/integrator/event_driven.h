/* Event-driven integration of contact pairs, segment by segment (touch/segment.h). */
#ifndef CONTACT_INTEGRATOR_EVENT_DRIVEN_H
#define CONTACT_INTEGRATOR_EVENT_DRIVEN_H

#include "integrator/advance.h"

/*
 * Advances the contact pairs, and the kinematically driven contacts with them. ADVANCE_FAILED where contacts
 * share a free body; phases.c then lets the general segment take over and counts it.
 */
enum advance_result event_driven_advance(const struct scene_values *v, struct scene_state *q,
                                         struct advance *step);

#endif
