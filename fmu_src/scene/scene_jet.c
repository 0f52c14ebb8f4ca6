#include "scene/scene_jet.h"

#include <string.h>

#include "scene/free_bodies.h"
#include "scene/turning_jet.h"

void jet_of_contacts(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at, struct scene_jet *along)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_shape shape = scene_shape_met(v, q, at, j);
        const struct contact_law law = scene_contact_law(v, q, j);
        const enum contact_regime regime = (enum contact_regime)q->contact[j].regime;
        struct vec3 c[JET_TERMS];
        struct vec3 w[JET_TERMS];
        for (int i = 0; i < JET_TERMS; ++i) {
            c[i] = vec3_sub(along->displacement[contact_destination(j)][i],
                            along->displacement[contact_source(j)][i]);
            w[i] =
                vec3_sub(along->velocity[contact_destination(j)][i], along->velocity[contact_source(j)][i]);
        }
        contact_jet_make(&shape, &at->geometry[j], c, w, &law, &along->law_slope[j], regime,
                         &along->contact[j]);
#if SCENE_ANY_TURNING
        turning_jet_of_contact(v, q, at, j, along);
#endif
    }
}

/* Bodies by their velocities and accelerations. */
static void put_bodies(const struct scene_values *v, const struct scene_state *q,
                       const struct scene_instant *at, struct scene_jet *along)
{
    memset(along, 0, sizeof *along);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        along->displacement[i][0] = at->displacement[i];
        along->displacement[i][1] = at->velocity[i];
        along->displacement[i][2] = vec3_scale(0.5, at->acceleration[i]);
        along->velocity[i][0] = at->velocity[i];
        along->velocity[i][1] = at->acceleration[i];
        along->velocity[i][2] = q->path[i].velocity[2];
    }
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        turning_jet_put_bodies(v, q, at, along);
    }
#else
    (void)v;
#endif
}

/* Contacts; then once more, as free bodies go by the forces of the first time. */
static void put_contacts(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, struct scene_jet *along)
{
    jet_of_contacts(v, q, at, along);
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        turning_jet_put_changes(v, q, at, along);
    }
#endif
    if (free_bodies_put_jerk(v, q, along) || (SCENE_ANY_TURNING && scene_turns(v))) {
        jet_of_contacts(v, q, at, along);
    }
}

void jet_in_time(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                 struct scene_jet *along)
{
    put_bodies(v, q, at, along);
    put_contacts(v, q, at, along);
    free_bodies_put_work(v, q, along);
}

void jet_of_motion(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                   struct scene_jet *along)
{
    put_bodies(v, q, at, along);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_prescribed(v, i)) {
            struct vec3 displacement[4];
            memcpy(displacement, q->path[i].displacement, sizeof displacement);
            path_shift(displacement, 4, q->clock);
            along->displacement[i][1] = displacement[1];
            along->displacement[i][2] = displacement[2];
        }
    }
    put_contacts(v, q, at, along);
}
