/*
 * When a contact's regime changes, in closed form.
 *
 * Without a contact force the separation is a polynomial c(t) of degree four or less (two for constant
 * force), so the conditions "bodies touch" (|rho|^2 = reach^2), "passes a cylinder's end" (c.e_d = +-L/2),
 * "gap rate changes sign" (rho.rho' = 0) and "law is zero" (p_n g + p_nv g' = 0, squared) are polynomials
 * too. All their roots are isolated, so no change is missed however long the interval is. The same holds in
 * every regime when no body is free.
 *
 * With a contact force between free bodies only the passage of an end is known in advance: the force is
 * perpendicular to the axis. Where another contact acts on one of the bodies nothing is; the integrator then
 * finds the change as a root.
 */
#ifndef CONTACT_INTEGRATOR_PREDICTION_H
#define CONTACT_INTEGRATOR_PREDICTION_H

#include "scene/evaluate.h"

struct regime_change {
    double after; /* seconds from the present; INFINITY when nothing changes within the horizon */
    enum contact_regime regime; /* the regime from then on */
    double gap;                 /* g then, as fine as it is known at present [m] */
    bool passes_centre;         /* within the horizon d comes down to its own rounding */
};

/*
 * The first change of the regime of `contact` within `horizon` seconds of the instant `at`, taken at `clock`.
 * Exact to the rounding of the gap, which after contact is much less than that of positions. A change so soon
 * that gap or end plane are still within rounding belongs to the transition just made, and is ignored.
 */
struct regime_change next_regime_change(const struct scene_values *v, const struct scene_state *q,
                                        const struct scene_instant *at, double clock, int contact,
                                        double horizon);

/* Whether the axis of the destination may turn. */
bool contact_axis_turns(const struct scene_values *v, int contact);

/* Takes the gap from `at`, the present, to the clock `until` into account for the peak penetration of a
 * contact that transmits no force or whose motion is given: its extremes are roots of a polynomial. */
void regime_change_note_depth(const struct scene_values *v, struct scene_state *q,
                              const struct scene_instant *at, int contact, double until);

/*
 * When a contact's regime changes next, as far as that can be foreseen: in closed form where its axis keeps
 * its direction, and by conservative advancement, which misses no touch, where the axis turns.
 */

struct prediction {
    struct regime_change next;
    double searched;  /* how far: the horizon, unless the budget ended the search [s] */
    long evaluations; /* of the budget, that the search took; none in closed form */
};

/* Within `horizon` seconds of the instant `at`, the present. Nothing is foreseen where the integrator watches
 * the change: in a contact that transmits a force while something turns or rubs, and where another contact
 * acts on its bodies. `budget` > 0. */
struct prediction prediction_of(const struct scene_values *v, const struct scene_state *q,
                                const struct scene_instant *at, int contact, double horizon, long budget);

/* Until when bodies in flight certainly do not touch, which is cheaper to tell than when they do. */

/* The clock before which no bodies that are apart touch, without external forces; INFINITY: never; 0: not
 * known. */
double flight_apart_until(const struct scene_values *v, const struct scene_state *q);

#endif
