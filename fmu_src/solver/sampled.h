/* Scenes without a free body: the motion is given, only impulse, dissipated energy, work and peaks are to be found. */
#ifndef CONTACT_SAMPLED_H
#define CONTACT_SAMPLED_H

#include "solver/solver.h"

#if SCENE_ANY_FREE

/* Integrates over [q->clock, step->clock_end], on which no regime changes, by adaptive Gauss-Legendre quadrature to
 * solver.relative_tolerance. Each panel takes one of the budget; nothing counts as a
 * solver's step, for there is no solver. */
enum advance_result sampled_advance(const struct scene_values *v, struct motion *q, struct advance *step);

#endif
#endif
