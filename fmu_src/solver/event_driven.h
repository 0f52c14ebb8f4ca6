/* Pairs that press, in pieces as long as the motion along the contact allows (piece.h). */
#ifndef CONTACT_EVENT_DRIVEN_H
#define CONTACT_EVENT_DRIVEN_H

#include "solver/solver.h"

#if SCENE_ANY_FREE

/*
 * Advances the pair that presses. ADVANCE_FAILED where no piece of motion can be had, because the centres meet (d = 0), or where
 * contacts share a free body; solver.c then lets CVODE take over and counts it.
 */
enum advance_result event_driven_advance(const struct scene_values *v, struct motion *q,
                                         struct advance *step);

#endif
#endif
