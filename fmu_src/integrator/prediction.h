/*
 * These functions find when a contact's regime changes.
 *
 * Without a contact force the separation is a polynomial c(t) of degree four or less (two for constant
 * force). The gap of bodies that are apart is monotone between two roots of rho.rho' = 0, all of which are
 * isolated, so that no touch is missed however long the interval is. A separating contact is looked at
 * between these roots, with the digits that its gap has. Conservative advancement, which misses no touch
 * either, finds the changes where the axis turns, at a torus and at skew cylinders, at cylinders of finite
 * length, open or capped, and where the importer moves both bodies.
 *
 * With a contact force between free bodies only the passage of a cylinder's end is known in advance, because
 * the force is perpendicular to the axis. Where another contact acts on one of the bodies no change is known
 * in advance; the integrator then finds the change as a root.
 */
#ifndef CONTACT_INTEGRATOR_PREDICTION_H
#define CONTACT_INTEGRATOR_PREDICTION_H

#include "scene/evaluate.h"

struct regime_change {
    double after; /* seconds from the present; INFINITY when nothing changes within the horizon */
    enum contact_regime regime; /* the regime after the change */
    double gap;                 /* gap g at the change, to the present accuracy [m] */
    bool passes_centre;         /* whether d may fall to its rounding within the horizon */
};

/*
 * A prediction is the next foreseen change of a contact's regime.
 *
 * The change is exact to the rounding of the gap, which just after a contact is much less than the rounding
 * of positions. While the gap, or the distance from an end plane, is still within rounding, a change belongs
 * to the transition just made and is ignored.
 */

struct prediction {
    struct regime_change next;
    double searched;  /* time searched [s]: the horizon, unless the budget ended the search */
    long evaluations; /* evaluations that the search took from the budget; 0 without advancement */
};

/* Returns the prediction within `horizon` seconds of the present instant `at`; `budget` > 0. No change is
 * foreseen where the integrator watches for it. The integrator does so in a contact that transmits a force
 * while something turns or rubs, and where another contact acts on its bodies. */
struct prediction prediction_of(const struct scene_instant *at, int contact, double horizon, long budget);

#endif
