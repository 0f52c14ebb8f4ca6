/*
 * Head-on flight: bodies that are apart and move along their normal alone, under a constant relative
 * acceleration along it. The gap is a parabola of time and its zero a root of a quadratic equation.
 */
#ifndef CONTACT_SEGMENT_FLIGHT_HEAD_ON_H
#define CONTACT_SEGMENT_FLIGHT_HEAD_ON_H

#include "segment/relative_path.h"

/* Whether the separation, without a cylinder's axial part, moves so. Exactly so, not nearly: any other motion
 * leaves the normal. */
bool flight_is_head_on(const struct contact_shape *shape, const struct separation_path *separation,
                       struct vec3 normal);

/* The first touch in seconds from now, INFINITY: none within the horizon. False where a closer look is
 * needed: rounding (of the gap: `gap_rounding`) decides whether the bodies touch, or the source may pass the
 * centre of a hollow destination. */
bool flight_head_on_touch(const struct contact_shape *shape, const struct separation_path *separation,
                          const struct contact_geometry *now, double rounding, double horizon, double *touch);

/* How a separating contact ends: the gap opens (apart), or the law pushes again (compression); INFINITY:
 * never. */
struct flight_regime_end {
    double after; /* [s] */
    enum contact_regime regime;
    double gap; /* then [m] */
};

/* The end of a separating regime. `margin_rounding` is the rounding bound of the event function [N]. The
 * centre is not passed: the gap grows as long as the formula would pull. */
bool flight_head_on_regime_end(const struct contact_shape *shape, const struct contact_law *law,
                               const struct separation_path *separation, const struct contact_geometry *now,
                               double rounding, double margin_rounding, struct flight_regime_end *end);

#endif
