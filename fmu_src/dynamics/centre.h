/* Where the centres of solid bodies meet, d = 0, the normal turns round: from there it is where the motion leads (contact_way_out). */
#ifndef CONTACT_CENTRE_H
#define CONTACT_CENTRE_H

#include "dynamics/system.h"

/* Whether they have met, as far as positions or a carried gap tell. */
bool centre_is_met(const struct scene_values *v, const struct system_instant *at, int contact,
                   const struct contact_shape *shape);

#endif
