/* How long the regime of a contact in flight is taken to last although rounding says otherwise. */
#ifndef CONTACT_SEGMENT_SETTLING_H
#define CONTACT_SEGMENT_SETTLING_H

#include "segment/relative_path.h"

/* Rounding of the event function while separating. Of the rate: what it makes of n, from positions, and of
 * n.w. */
double settling_margin_rounding(const struct contact_shape *shape, const struct contact_law *law,
                                const struct contact_geometry *now, double gap_rounding, double by_positions,
                                const struct separation_path *separation);

/* Until then, in s of the path, the present regime, whose boundary has just been crossed, is taken to last.
 * `gap_rounding` is that of the gap, `by_positions` what it would be from positions alone. `just_begun`: at
 * the event itself, where an integrator has left of the force what its tolerance allows. */
double settling_time(const struct relative_path *path, const struct contact_shape *shape,
                     const struct contact_law *law, const struct contact_geometry *now, double gap_rounding,
                     double by_positions, const struct separation_path *separation,
                     enum contact_regime present, bool just_begun);

/* As long as a source may be on either side of an end plane by rounding, which is `rounding` along the axis,
 * the path says that it is where the present regime has it. */
void settling_at_ends(struct relative_path *path, const struct contact_shape *shape,
                      const struct contact_geometry *now, double rounding,
                      const struct separation_path *separation, enum contact_regime present);

#endif
