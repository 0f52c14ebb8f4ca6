#include "scene/present.h"

#include <float.h>

#include "scene/free_bodies.h"
#include "scene/rounding.h"
#include "scene/singularity.h"

void scene_kinematics_now(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    scene_kinematics(v, q, q->clock, free_bodies_now(q), at);
    free_bodies_put_gaps(v, q, at);
}

void scene_now(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    scene_kinematics_now(v, q, at);
    scene_forces(v, q, q->clock, at);
}

/* Bounds of the rounding error: positions at different times may be off to either side. */
static const double END_ROUNDINGS = 4.0;

bool scene_shown_within(const struct scene_values *v, const struct scene_state *q,
                        const struct scene_instant *at, int contact, const struct contact_shape *shape)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const bool within = scene_within_extents(shape, g);
    if (!SCENE_ANY_CYLINDER || !isfinite(shape->half_length) ||
        fabs(scene_beyond_ends(shape, g)) > END_ROUNDINGS * rounding_of_axial(v, at, contact, shape)) {
        return within;
    }
    const bool overlaps = g->gap < -rounding_of_gap(v, at, contact);
    return q->contact[contact].regime != (int32_t)REGIME_APART || (within && !overlaps);
}

/* By the law alone, of a contact with this gap, within the destination's extents or not. */
static enum contact_regime regime_by_law(const struct scene_values *v, const struct scene_state *q,
                                         const struct scene_instant *at, int contact, double gap, bool within)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    double rate = g->gap_rate;
    if (singularity_is_reached(v, at, contact, &shape)) {
        const struct vec3 w = at->rate[contact];
        const struct vec3 none = {0.0, 0.0, 0.0};
        rate = shape.side * vec3_dot(singularity_escape(&shape, w, none, none), w);
    }
    return contact_regime_of(&law, gap, rate, within);
}

enum contact_regime scene_regime(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    return regime_by_law(v, q, at, contact, g->gap, scene_within_extents(&shape, g));
}

enum contact_regime scene_regime_of_touching(const struct scene_values *v, const struct scene_state *q,
                                             const struct scene_instant *at, int contact)
{
    const double gap = fmin(at->geometry[contact].gap, -DBL_MIN); /* rounding may show none */
    return regime_by_law(v, q, at, contact, gap, true);
}
