/*
 * Changes of regime at the rim of a capped cylinder along a path that is given (flight while separating, or
 * prescribed motion). The gap is a root of polynomials of degree eight, and the law's conditions go beyond
 * what polynomials can tell, so the path is followed in steps that are short against the circle's distance.
 */
#ifndef CONTACT_SEGMENT_RIM_CHANGE_H
#define CONTACT_SEGMENT_RIM_CHANGE_H

#include "segment/relative_path.h"

#if SCENE_ANY_CAPS

struct rim_change {
    double time; /* [s]; INFINITY where nothing changes */
    enum contact_regime regime;
};

/* The first change from `present` between two times; `rounding` is that of the gap where the path begins. */
struct rim_change rim_first_change(const struct contact_shape *shape, const struct contact_law *law,
                                   const struct separation_path *path, double rounding,
                                   enum contact_regime present, double from, double until);

/* The least gap between two times [m]. */
double rim_least_gap(const struct contact_shape *shape, const struct separation_path *path, double from,
                     double until);

#endif
#endif
