#include "scene/present.h"

#include "scene/free_bodies.h"
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

enum contact_regime scene_regime(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_instant *at, int contact)
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
    return contact_regime_of(&law, g->gap, rate, scene_within_extents(&shape, g));
}
