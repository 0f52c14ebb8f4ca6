/* What the tests of one pressing contact share. */
#ifndef PRESSED_MODEL_H
#define PRESSED_MODEL_H

#include "dynamics/energy.h"
#include "dynamics/press.h"
#include "scene_model.h"

/* The model from its start on, bodies pressed together. */
static inline void pressed_begin(struct model *m)
{
    model_prepare(m);
    m->state.motion.contact[0].regime = (int32_t)REGIME_PRESSING;
}

static inline struct press press_of(const struct model *m)
{
    struct system_instant at;
    struct press p;
    system_now(&m->state.values, &m->state.motion, &at);
    press_make(&p, &m->state.values, &m->state.motion, &at, 0);
    return p;
}

/* energy.total */
static inline double balance(const struct model *m)
{
    struct system_instant at;
    const struct scene_values *v = &m->state.values;
    const struct motion *q = &m->state.motion;
    system_now(v, q, &at);
    return energy_kinetic_of(v, &at) + energy_potential_of(v, &at) + energy_stored(v, q, &at) +
           q->dissipated - q->external_work;
}

#endif
