/*
 * The general segment integrates the whole scene (scene/ode.h) by Radau IIA (math/radau_step.h). It takes the
 * motions that no other segment takes, such as bodies in several contacts. A polynomial through the Radau
 * stages stands for each event function, so that no terminal event within a step is missed. The step is then
 * made to end at the event.
 */
#ifndef CONTACT_INTEGRATOR_GENERAL_H
#define CONTACT_INTEGRATOR_GENERAL_H

#include "integrator/phases.h"

struct general;

/* Makes the integrator's memory, and makes it anew where the states need more of it. On failure the function
 * returns false, writes a message (INTEGRATOR_MESSAGE_SIZE bytes) and leaves *slot as it was. */
bool general_open(struct general **slot, const struct scene_values *v, const struct integrator_memory *memory,
                  char *message);

void general_close(struct general **slot);

/* Integrates within fixed regimes up to the first terminal event, or step->clock_end. All that one call hands
 * on to the next is stored in the motion `q`. Where scene_keeps_steps, `q` also stores the last step,
 * which may go on beyond step->clock_end up to step->clock_limit. The function returns ADVANCE_FAILED, with a
 * message, where no step is accurate enough. */
enum advance_result general_advance(struct general *g, struct scene_state *q, struct advance *step);

/* Moves the scene along the step that `q` keeps (struct unfinished_step) to a clock within it, and notes the
 * peaks since the clock `noted`. */
void general_follow_kept(struct general *g, struct scene_state *q, double noted, double clock);

#endif
