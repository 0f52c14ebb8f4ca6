/* Bounds of the rounding errors of gaps, their rates and regime margins. */
#ifndef CONTACT_SCENE_ROUNDING_H
#define CONTACT_SCENE_ROUNDING_H

#include "scene/evaluate.h"

/* Bound of the rounding error of the gap [m]: eight roundings of the terms that it is computed from, which
 * are locations, displacements and radii (of a shell nearly filled by the source the difference of the radii,
 * which is exact). Below it the sign of the gap means nothing. */
double rounding_of_gap(const struct scene_values *v, const struct scene_instant *at, int contact);

/* The same for the axial position of the source that is compared with the half length of a cylinder [m]. */
double rounding_of_axial(const struct scene_values *v, const struct scene_instant *at, int contact,
                         const struct contact_shape *shape);

/* The same for w and g', which are differences of the bodies' velocities [m/s]. */
double rounding_of_rate(const struct scene_instant *at, int contact);

/* The same for an event function of the law with these slopes (contact_event), of speeds that are right to
 * `tolerated` [m/s]. */
double rounding_of_event(const struct scene_values *v, const struct contact_law *law,
                         const struct contact_slopes *slopes, const struct scene_instant *at, int contact,
                         double tolerated);

/* What rounding alone does to the force of a contact, through g, n and n.w [N]. */
double rounding_of_force(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, int contact);

/* An offset that makes a regime's margin positive at the start of a phase although rounding, or an error of
 * the speeds by `tolerated` [m/s], may have left it at or below zero. Without it a root finder would miss the
 * fall of a margin that starts below zero, and would find many of one that stays near zero, as at rest. The
 * force is continuous there, so the delay changes little. */
double rounding_margin_offset(const struct scene_values *v, const struct scene_state *q,
                              const struct scene_instant *at, int contact, double tolerated);

#endif
