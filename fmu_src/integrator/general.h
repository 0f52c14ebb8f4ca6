/*
 * The general segment: integration of the whole scene (scene/ode.h) by Radau IIA (math/radau_step.h), for
 * whatever no other segment takes: bodies in several contacts. Terminal events are found on the polynomials
 * of the event functions through the stages, so that none is missed within a step, and steps are made to end
 * there.
 */
#ifndef CONTACT_INTEGRATOR_GENERAL_H
#define CONTACT_INTEGRATOR_GENERAL_H

#include "integrator/phases.h"

struct general;

/* Makes, or makes anew when the number of states differs, the integrator's memory. On failure returns false
 * with a message (INTEGRATOR_MESSAGE_SIZE bytes) and leaves *slot as it was. */
bool general_open(struct general **slot, const struct scene_values *v, const struct integrator_memory *memory,
                  char *message);

void general_close(struct general **slot);

/* Integrates within fixed regimes up to the first terminal event, or step->clock_end. Keeps nothing from one
 * call to the next but what is in the motion; there, where something turns or rubs, the last step, which may
 * go on beyond step->clock_end up to step->clock_limit. ADVANCE_FAILED where no step is accurate enough, with
 * a message. */
enum advance_result general_advance(struct general *g, const struct scene_values *v, struct scene_state *q,
                                    struct advance *step);

#endif
