#include "scene/singularity.h"

#include <float.h>

#include "scene/rounding.h"

/* A distance below this part of the bodies' size is none. */
static const double CENTRE = 1e-9;

bool singularity_is_reached(const struct scene_values *v, const struct scene_instant *at, int contact,
                            const struct contact_shape *shape)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const double reach = contact_reach(shape);
    if (g->degenerate || !contact_may_reach_centre(shape)) {
        return g->degenerate;
    }
    return reach + g->gap <= 16.0 * DBL_EPSILON * reach ||
           (g->distance <= CENTRE * reach && g->distance <= rounding_of_gap(v, at, contact));
}

struct vec3 singularity_escape(const struct contact_shape *shape, struct vec3 rate, struct vec3 acceleration,
                               struct vec3 held)
{
    const struct vec3 at_rest = contact_escape_direction(shape, acceleration, held);
    return contact_escape_direction(shape, rate, at_rest);
}
