/* Contacts between bodies neither of which is free: the motion is given, only impulse, dissipated energy, work and peaks are to be found. */
#ifndef CONTACT_SAMPLED_H
#define CONTACT_SAMPLED_H

#include "solver/solver.h"

#if SCENE_ANY_FREE

/* Integrates such contacts over [q->clock, end], on which no regime changes, by adaptive Gauss-Legendre quadrature to
 * solver.relative_tolerance. Each panel takes one of the budget; nothing counts as a solver's step, for there is no solver. Returns the
 * clock it came to, before `end` where the budget ran out; q->clock is left to the caller. */
double sampled_integrate(const struct scene_values *v, struct motion *q, double end, long *budget);

/* All there is to do in a scene without a free body. */
enum advance_result sampled_advance(const struct scene_values *v, struct motion *q, struct advance *step);

#endif
#endif
