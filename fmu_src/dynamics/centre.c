#include "dynamics/centre.h"

#include <float.h>

#include "dynamics/resolution.h"

/* A distance below this part of the bodies' size is none. */
static const double CENTRE = 1e-9;

bool centre_is_met(const struct scene_values *v, const struct system_instant *at, int contact,
                   const struct contact_shape *shape)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const double reach = contact_reach(shape);
    if (g->degenerate || shape->side < 0) {
        return g->degenerate;
    }
    return reach + g->gap <= 16.0 * DBL_EPSILON * reach ||
           (g->distance <= CENTRE * reach && g->distance <= resolution_of_gap(v, at, contact));
}
