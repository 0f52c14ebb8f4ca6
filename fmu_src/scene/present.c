#include "scene/present.h"

#include <float.h>

#include "scene/rounding.h"
#include "scene/singularity.h"

#if SCENE_ANY_FREE
/* DBL_MAX or INFINITY where nothing is known. */
static double accumulated_gap_of(const struct scene_state *q, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    if (contact_transmits(q, contact) || q->clock == 0.0) {
        return state->accumulated_gap;
    }
    return q->clock == state->change_clock ? state->change_gap : (double)INFINITY;
}

/* Of a stiff contact the force that velocities would make by their rounding alone may exceed the load.
 * Velocities that have been changed show it by a larger difference. */
static void take_known_rate(const struct scene_state *q, int contact, struct contact_geometry *geometry)
{
    const struct contact_state *state = &q->contact[contact];
    if (contact_transmits(q, contact) &&
        fabs(state->carried_rate - geometry->gap_rate) < state->rate_rounding) {
        geometry->gap_rate = state->carried_rate;
    }
}

/* The penetration of a stiff contact at rest is less than the rounding of d, so the accumulated gap is used.
 * It is not if it differs by more than rounding: positions have then been changed since. */
static void take_accumulated_gaps(const struct scene_values *v, const struct scene_state *q,
                                  struct scene_instant *at)
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

bool system_rate_is_known(const struct scene_state *q, const struct scene_instant *at, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    return state->rate_rounding > 0.0 && contact_transmits(q, contact) &&
           at->geometry[contact].gap_rate == state->carried_rate;
}

void scene_kinematics_now(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    scene_kinematics(v, q, q->clock, q->body, at);
    take_accumulated_gaps(v, q, at);
}
#else
void scene_kinematics_now(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    scene_kinematics(v, q, q->clock, 0, at);
}
#endif

void scene_now(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    scene_kinematics_now(v, q, at);
    scene_forces(v, q, q->clock, at);
}

enum contact_regime scene_regime(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    double rate = g->gap_rate;
    if (singularity_is_reached(v, at, contact, &shape)) {
        const struct vec3 w = at->rate[contact];
        const struct vec3 none = {0.0, 0.0, 0.0};
        rate = shape.side * vec3_dot(singularity_escape(&shape, w, none, none), w);
    }
    return contact_regime_of(&law, g->gap, rate, scene_within_extents(&shape, g));
}
