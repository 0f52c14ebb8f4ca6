/*
 * Dense output of a contact whose motion no segment computes: the motion is given, or an integrator knows it
 * between the ends of its steps. And the largest values of force and penetration on it.
 */
#ifndef CONTACT_SEGMENT_SCENE_OUTPUT_H
#define CONTACT_SEGMENT_SCENE_OUTPUT_H

#include "segment/dense_output.h"

struct scene_output {
    const struct scene_values *values;
    const struct scene_state *state; /* regimes and paths */
    int contact;
    /* puts the free bodies where they are at a clock; NULL: the contact has none */
    void (*move)(void *mover, double clock, struct scene_state *q);
    void *mover;
    struct dense_output output; /* its variable is the clock; empty to begin with */
};

/* Takes the motion from where the last call ended, or `from`, to another clock into account for the peaks of
 * the communication step, looked at in so many parts that no quantity has two extrema within one. */
void scene_output_note_peaks(struct scene_output *o, double from, double to, int parts,
                             struct contact_peaks *peaks);

/* Where nothing turns or rubs, and the destination is no sphere: the impulse of the torque on it from one
 * clock to another, in so many panels of degree nine [N m s]. */
void scene_output_add_torque(const struct scene_output *o, double from, double to, int panels,
                             struct scene_state *q);

#endif
