/* In place of the general segment in scenes that can do without: no method event_driven, or no free body in
 * two contacts and nothing that turns or rubs. */
#include "integrator/general.h"

bool general_open(struct general **slot, const struct scene_values *v, const struct integrator_memory *memory,
                  char *message)
{
    (void)slot, (void)v, (void)memory, (void)message;
    return true;
}

void general_close(struct general **slot)
{
    (void)slot;
}

enum advance_result general_advance(struct general *g, const struct scene_values *v, struct scene_state *q,
                                    struct advance *step)
{
    (void)g, (void)v, (void)q, (void)step;
    return ADVANCE_FAILED;
}
