/* Kinematically driven contacts: neither body is free. The motion is prescribed; impulse, dissipated energy,
 * external work and peaks are quadratures. */
#ifndef CONTACT_INTEGRATOR_PRESCRIBED_H
#define CONTACT_INTEGRATOR_PRESCRIBED_H

#include "integrator/advance.h"

/* Integrates such contacts over [q->clock, end], on which no regime changes, by adaptive Gauss-Legendre
 * quadrature to solver.relative_tolerance. Each panel takes one step of the budget, but does not count in
 * solver.steps. Returns the clock reached, before `end` where the budget ran out; does not change
 * q->clock. */
double prescribed_integrate(const struct scene_values *v, struct scene_state *q, double end, long *budget);

/* All there is to do in a scene without a free body. */
enum advance_result prescribed_advance(const struct scene_values *v, struct scene_state *q,
                                       struct advance *step);

#endif
