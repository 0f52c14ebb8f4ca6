/* The largest force and penetration within a piece of pressing motion. */
#ifndef CONTACT_PEAKS_H
#define CONTACT_PEAKS_H

#include "solver/piece.h"

#if SCENE_ANY_FREE

/* Takes the piece up to `end` into account for the peaks of the communication step. */
void peaks_note(struct piece *p, struct contact_state *state, double end);

#endif
#endif
