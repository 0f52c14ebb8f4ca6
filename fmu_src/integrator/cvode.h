/* Integration of free bodies by SUNDIALS CVODE (Hindmarsh et al., ACM TOMS 31 (2005) 363), within fixed
 * regimes. */
#ifndef CONTACT_INTEGRATOR_CVODE_H
#define CONTACT_INTEGRATOR_CVODE_H

#include "integrator/phases.h"

struct cvode;

/* Makes the integrator's memory, and makes it anew when the method or the number of states has changed. On
 * failure it returns false, writes a message (INTEGRATOR_MESSAGE_SIZE bytes) and leaves *slot unchanged. */
bool cvode_open(struct cvode **slot, const struct scene_values *v, const struct integrator_memory *memory,
                char *message);

void cvode_close(struct cvode **slot);

enum advance_result cvode_advance(struct cvode *c, struct scene_state *q, struct advance *step);

#endif
