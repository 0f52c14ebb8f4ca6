/* Contacts by Taylor series of high order, exact to rounding; what ends a phase is a root of a series. */
#ifndef CONTACT_EVENT_DRIVEN_H
#define CONTACT_EVENT_DRIVEN_H

#include "solver/solver.h"

#if SCENE_ANY_FREE

/*
 * Advances the pair that presses. ADVANCE_FAILED where the series cannot go on, because the centres meet (d = 0), or where
 * the scene has more than one contact; solver.c then lets CVODE take over.
 */
enum advance_result event_driven_advance(const struct scene_values *v, struct motion *q,
                                         struct advance *step);

#endif
#endif
