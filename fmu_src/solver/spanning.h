/* Long collocated steps: many oscillations of a contact, all of them so small and so far from parting that nothing happens. */
#ifndef CONTACT_SPANNING_H
#define CONTACT_SPANNING_H

#include "solver/piece.h"

#if SCENE_ANY_FREE

/* Where the present oscillation allows it. p->press, regime, resolution and tolerance are set. */
bool spanning_piece(struct piece *p, const struct press_outlook *outlook, double longest);

/* What a step leaves out that feels an oscillation or fast decay of amplitude `a` [m] to first order only: the next order of
 * its closed-form part, smaller by the ratio of the rates once more, and the mean of (a/d)^2 in n' for as long as it lasts, in
 * radians of the motion along the contact [m]. */
double spanning_left_out(double a, double ratio, double distance, double radians);

#endif
#endif
