/* A piece of head-on motion in closed form (dynamics/press_straight.h). */
#ifndef CONTACT_STRAIGHT_PIECE_H
#define CONTACT_STRAIGHT_PIECE_H

#include "solver/piece.h"

#if SCENE_ANY_FREE

/* Over all of `longest` [s] where the bodies neither part nor change their regime any more, else over a turn of the oscillation at
 * most, or for as long as it decays. False where the motion is of another kind. p->press, regime, resolution and tolerance are set. */
bool straight_piece_make(struct piece *p, double longest);

#endif
#endif
