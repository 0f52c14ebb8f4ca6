/* What the tests of one contact that transmits a force share. */
#ifndef PRESSED_MODEL_H
#define PRESSED_MODEL_H

#include "scene/present.h"
#include "scene_model.h"
#include "touch/pair.h"

/* The model from its start on, bodies overlapping. */
static inline void compressed_begin(struct model *m)
{
    model_prepare(m);
    m->state.motion.contact[0].regime = (int32_t)REGIME_COMPRESSION;
}

static inline struct contact_pair pair_of(const struct model *m)
{
    struct scene_instant at;
    struct contact_pair p;
    scene_now(&m->state.values, &m->state.motion, &at);
    pair_make(&p, &m->state.values, &m->state.motion, &at, 0);
    return p;
}

/* energy.total */
static inline double balance(const struct model *m)
{
    struct scene_instant at;
    const struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    scene_now(v, q, &at);
    return energy_kinetic_of(v, &at) + energy_potential_of(v, &at) + energy_stored(v, q, &at) +
           q->dissipated - q->external_work;
}

#endif
