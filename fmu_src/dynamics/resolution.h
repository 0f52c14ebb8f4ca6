/* What rounding leaves of gaps, rates and margins. */
#ifndef CONTACT_RESOLUTION_H
#define CONTACT_RESOLUTION_H

#include "dynamics/system.h"

/* How far rounding alone may move the gap: eight roundings of the terms it is computed from, the locations, the displacements and
 * the radii, of a shell all but filled their difference, which is exact [m]. Below it the sign of the gap means nothing. */
double resolution_of_gap(const struct scene_values *v, const struct system_instant *at, int contact);

/* Likewise of where the source is along a cylinder's axis: of what lies along it, and of the half length it is compared with [m]. */
double resolution_of_axial(const struct scene_values *v, const struct system_instant *at, int contact,
                           const struct contact_shape *shape);

/* Likewise of w and g': of the speeds that they are differences of [m/s]. */
double resolution_of_rate(const struct system_instant *at, int contact);

/* What is added to a regime margin so that it starts above zero although the phase begins at zero, give or take rounding
 * and the integrator's tolerance of speeds, `tolerated` [m/s]: a margin that starts below is never seen to fall, and one that
 * hovers about zero, as at rest, falls again and again. The force is continuous there, so little depends on the moment. */
double resolution_armour(const struct scene_values *v, const struct motion *q,
                         const struct system_instant *at, int contact, double tolerated);

#endif
