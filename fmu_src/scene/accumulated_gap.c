/* The gap and its rate as integration carries them, where that is more accurate than positions give them. */
#include <float.h>

#include "scene/free_bodies.h"
#include "scene/present.h"
#include "scene/rounding.h"

/* DBL_MAX or INFINITY where nothing is known. */
static double accumulated_gap_of(const struct scene_state *q, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    if (contact_transmits(q, contact) || q->clock == 0.0) {
        return state->physics.accumulated_gap;
    }
    return q->clock == state->schedule.change_clock ? state->schedule.change_gap : (double)INFINITY;
}

/* Of a stiff contact the force that velocities would make by their rounding alone may exceed the load.
 * Velocities that have been changed show it by a larger difference. */
static void take_known_rate(const struct scene_state *q, int contact, struct contact_geometry *geometry)
{
    const struct contact_state *state = &q->contact[contact];
    if (contact_transmits(q, contact) &&
        fabs(state->physics.carried_rate - geometry->gap_rate) < state->physics.rate_rounding) {
        geometry->gap_rate = state->physics.carried_rate;
    }
}

/* The penetration of a stiff contact at rest is less than the rounding of d, so the accumulated gap is used.
 * It is not if it differs by more than rounding: positions have then been changed since. */
void free_bodies_put_gaps(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const double known = accumulated_gap_of(q, j);
        if (known < DBL_MAX && fabs(known - at->geometry[j].gap) <= rounding_of_gap(v, at, j)) {
            at->geometry[j].gap = known;
        }
        take_known_rate(q, j, &at->geometry[j]);
    }
}

bool scene_gap_is_accumulated(const struct scene_state *q, const struct scene_instant *at, int contact)
{
    return at->geometry[contact].gap == accumulated_gap_of(q, contact);
}

bool scene_rate_is_known(const struct scene_state *q, const struct scene_instant *at, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    return state->physics.rate_rounding > 0.0 && contact_transmits(q, contact) &&
           at->geometry[contact].gap_rate == state->physics.carried_rate;
}
