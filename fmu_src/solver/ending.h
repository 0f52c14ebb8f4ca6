/* When a regime of a pressing contact ends: what is watched, and by how much it must be passed. Where the centres meet it may go on. */
#ifndef CONTACT_ENDING_H
#define CONTACT_ENDING_H

#include "solver/piece.h"

#if SCENE_ANY_FREE

/* How far the rounding of g' moves the gap at most [m].
 * Each piece takes g' anew from the velocities, rounded as they are. */
double ending_gap_noise(const struct press *from);

/* Bodies that hardly part are held together until the gap is so wide [m]. */
double ending_gap_slack(const struct piece *p);

/* Whether the law itself, not the gap, can end the regime; then by what: see contact_regime_margin. The regime lasts while
 * factor quantity + offset > 0. */
bool ending_by_law(const struct piece *p);
struct watched ending_margin(const struct piece *p);

struct ending ending_first(struct piece *p);

/* Ends the piece where it meets the centre, if that is before p->ending: the normal turns round, whether or not the regime changes. */
void ending_at_centre(struct piece *p);

#endif
#endif
