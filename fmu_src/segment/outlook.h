/*
 * When a contact's regime changes next, as far as that can be foreseen: in closed form (regime_change.h)
 * where its axis keeps its direction, by a search that misses no touch (tumbling_touch.h) where it turns.
 */
#ifndef CONTACT_SEGMENT_OUTLOOK_H
#define CONTACT_SEGMENT_OUTLOOK_H

#include "segment/regime_change.h"

struct outlook {
    struct regime_change next;
    double searched;  /* how far: the horizon, unless the budget ended the search [s] */
    long evaluations; /* of the budget, that the search took; none in closed form */
};

/* Within `horizon` seconds of the instant `at`, the present. Nothing is foreseen where the integrator watches
 * the change: in a contact that transmits a force while something turns or rubs, and where another contact
 * acts on its bodies. `budget` > 0. */
struct outlook outlook_of(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, int contact, double horizon, long budget);

#endif
