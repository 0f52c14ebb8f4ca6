#include "scene/zones.h"

#include <stdlib.h>

#include "contact/zone.h"
#include "scene/rounding.h"

#if SCENE_ANY_CAPS

void zones_follow(struct scene_state *q, const struct scene_instant *at, int contact)
{
    struct contact_state *state = &q->contact[contact];
    if (state->regime == (int32_t)REGIME_APART) {
        state->zone = 0;
    } else if (state->zone == 0) {
        state->zone = at->geometry[contact].zone;
    }
}

/* Whether the centre is at the circle of the rim, to rounding, and moves. */
static bool is_at_circle(const struct scene_values *v, const struct contact_shape *shape,
                         const struct scene_instant *at, int contact)
{
    const struct solid_place place = contact_place_at(&shape->solid, at->separation[contact]);
    return fmax(fabs(place.radial), fabs(place.axial)) <= rounding_of_gap(v, at, contact) &&
           !vec3_is_zero(at->rate[contact]);
}

void zones_pass(const struct scene_values *v, struct scene_state *q, const struct scene_instant *at,
                int contact)
{
    const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
    const int zone = q->contact[contact].zone;
    if (zone != 0 && is_at_circle(v, &shape, at, contact)) {
        q->contact[contact].zone =
            contact_zone_ahead(&shape.solid, at->separation[contact], at->rate[contact]);
    } else if (zone != 0) {
        q->contact[contact].zone = contact_zone_after(&shape.solid, zone, at->separation[contact]);
    }
}

void zones_settle(const struct scene_values *v, struct scene_state *q, const struct scene_instant *at,
                  int contact)
{
    if (zones_margin(v, q, at, contact) < -rounding_of_gap(v, at, contact)) {
        const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
        const struct solid_place place = contact_place_at(&shape.solid, at->separation[contact]);
        q->contact[contact].zone = contact_zone_by(&place);
    }
}

double zones_margin(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                    int contact)
{
    const int zone = q->contact[contact].zone;
    if (zone == 0) {
        return NO_ZONE_MARGIN;
    }
    const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
    return contact_zone_margin(&shape.solid, zone, at->separation[contact]);
}

enum zone zones_shown(const struct scene_values *v, const struct scene_state *q,
                      const struct scene_instant *at, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    if (state->regime == (int32_t)REGIME_APART) {
        return ZONE_NONE;
    }
    const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
    return contact_is_capped(&shape) ? (enum zone)abs(at->geometry[contact].zone) : ZONE_SIDE;
}

#endif
