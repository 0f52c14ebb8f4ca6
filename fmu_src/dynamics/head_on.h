/*
 * Head-on flight: bodies that are apart and move along their normal alone, under a pull along it that stays the same. The gap is a
 * parabola of time and its zero a root of a quadratic equation.
 */
#ifndef CONTACT_HEAD_ON_H
#define CONTACT_HEAD_ON_H

#include "dynamics/approach.h"

#if SCENE_ANY_FREE

/* Whether the separation, without a cylinder's axial part, moves so. Exactly so, not nearly: any other motion leaves the normal. */
bool head_on_is(const struct contact_shape *shape, const struct separation *separation, struct vec3 normal);

/* The first touch in seconds from now, INFINITY: none within the horizon. False where a closer look is needed: rounding (of the gap:
 * `resolution`) decides whether the bodies touch, or the source may pass the centre of a hollow destination. */
bool head_on_touch(const struct contact_shape *shape, const struct separation *separation,
                   const struct contact_geometry *now, double resolution, double horizon, double *touch);

/* How a released contact ends: the gap opens (apart), or the law pushes again (pressing); INFINITY: never. */
struct head_on_end {
    double after; /* [s] */
    enum contact_regime regime;
    double gap; /* then [m] */
};

/* The same for bodies that overlap while the law would pull; `margin_resolution` is that of p_n g + p_nv g' [N]. The centre is not
 * passed: the gap widens as long as the law would pull. */
bool head_on_release(const struct contact_shape *shape, const struct contact_law *law,
                     const struct separation *separation, const struct contact_geometry *now,
                     double resolution, double margin_resolution, struct head_on_end *end);

#endif
#endif
