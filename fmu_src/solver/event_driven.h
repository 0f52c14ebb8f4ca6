/* Contacts to an accuracy of their own, not by steps that follow their oscillation: see event_driven.c. */
#ifndef CONTACT_EVENT_DRIVEN_H
#define CONTACT_EVENT_DRIVEN_H

#include "solver/solver.h"

#if SCENE_ANY_FREE

/*
 * Advances the pair that presses. ADVANCE_FAILED where no piece of motion can be had, because the centres meet (d = 0), or where
 * the scene has more than one contact; solver.c then lets CVODE take over.
 */
enum advance_result event_driven_advance(const struct scene_values *v, struct motion *q,
                                         struct advance *step);

#endif
#endif
