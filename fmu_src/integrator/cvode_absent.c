/* In place of CVODE in scenes that can do without it: pinned to event_driven. */
#include "integrator/cvode.h"

#include <stdio.h>

bool cvode_open(struct cvode **slot, const struct scene_values *v, const struct integrator_memory *memory,
                char *message)
{
    (void)slot, (void)v, (void)memory;
    snprintf(message, INTEGRATOR_MESSAGE_SIZE, "this FMU has no CVODE");
    return false;
}

void cvode_close(struct cvode **slot)
{
    (void)slot;
}

enum advance_result cvode_advance(struct cvode *c, const struct scene_values *v, struct scene_state *q,
                                  struct advance *step)
{
    (void)c, (void)v, (void)q, (void)step;
    return ADVANCE_FAILED;
}
