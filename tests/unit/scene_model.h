/* A model of the scene without an adapter: values are written where the accessors read them. */
#ifndef SCENE_MODEL_H
#define SCENE_MODEL_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/state.h"
#include "scene/evaluate.h"

enum { SOURCE = 0, DESTINATION = 1 };

/* A model with start values, gravity off and a cylinder along z; it needs no memory until it steps. */
static inline struct model scene_model(void)
{
    struct model m;
    memset(&m, 0, sizeof m);
    m.host.allocate = calloc;
    m.host.release = free;
    model_reset(&m);
    m.state.values.world.gravity[2] = 0.0;
#if SCENE_ANY_CYLINDER
    m.state.values.body[DESTINATION].axis[1] = 0.0;
    m.state.values.body[DESTINATION].axis[2] = 1.0;
#endif
    return m;
}

/* The position and velocity a free body starts with. */
static inline void scene_start_free(struct model *m, int body, struct vec3 centre, struct vec3 velocity)
{
    struct scene_body_values *values = &m->state.values.body[body];
    values->motion = MOTION_FREE;
    vec3_to(centre, values->center);
    vec3_to(velocity, values->initial_velocity);
}

#endif
