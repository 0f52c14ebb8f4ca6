/* Pairs that press, in pieces as long as the motion along the contact allows (piece.h). */
#ifndef CONTACT_EVENT_DRIVEN_H
#define CONTACT_EVENT_DRIVEN_H

#include "solver/solver.h"

#if SCENE_ANY_FREE

/*
 * Advances the pairs that press, and the contacts whose motion is given beside them. ADVANCE_FAILED where contacts share a free body;
 * solver.c then lets CVODE take over and counts it.
 */
enum advance_result event_driven_advance(const struct scene_values *v, struct motion *q,
                                         struct advance *step);

#endif
#endif
