/*
 * What free_exchange.c has of bodies that turn and contacts that rub: orientations, of any length,
 * angular velocities, springs of elastic friction and the work of friction as states; their rates; event
 * indicators of friction. All are false, or zero, for what is none of these.
 */
#ifndef CONTACT_MODEL_TURNING_EXCHANGE_H
#define CONTACT_MODEL_TURNING_EXCHANGE_H

#include "model/motion.h"

bool turning_exchange_set(struct scene_state *q, const struct variable *state, double value);
bool turning_exchange_get(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, const struct variable *variable, double *value);

/* Mixes the bits of numbers into a mark (FNV-1a, by words). */
static inline uint64_t mark_of(uint64_t mark, const double *values, int count)
{
    for (int i = 0; i < count; ++i) {
        uint64_t bits;
        memcpy(&bits, values + i, sizeof bits);
        mark = (mark ^ bits) * UINT64_C(1099511628211);
    }
    return mark;
}

/* The mark with the states of what rubs that events make jump. */
uint64_t turning_exchange_booked(const struct scene_state *q, uint64_t mark);

/* Along a path: a change of a state; what a rate changes by. */
bool turning_exchange_move(const struct scene_values *v, const struct scene_state *q,
                           const struct variable *state, double change, struct scene_jet *along);
bool turning_exchange_slope(const struct scene_values *v, const struct scene_state *q,
                            const struct scene_jet *along, const struct variable *variable, double *slope);

#endif
