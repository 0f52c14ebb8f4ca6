/* The shape of a contact: by its parameters, in its zone and as it has turned. */
#include "contact/zone.h"
#include "scene/evaluate.h"

static bool has_caps(const struct scene_values *v, int body)
{
#if SCENE_ANY_CAPS
    return body_shape(body) == SHAPE_CYLINDER && body_finite_length(v, body) &&
           body_ends(v, body) == ENDS_CAPPED;
#else
    (void)v, (void)body;
    return false;
#endif
}

int scene_contact_side(const struct scene_values *v, const struct scene_state *q, int contact)
{
    if (has_caps(v, contact_destination(contact))) {
        return 1;
    }
    if (contact_location(v, contact) != LOCATION_AUTOMATIC) {
        return contact_location(v, contact) == LOCATION_INSIDE ? -1 : 1;
    }
    return q->contact[contact].side;
}

bool scene_ends_suddenly(const struct scene_values *v, int contact)
{
    const int body = contact_destination(contact);
#if SCENE_ANY_CYLINDER
    return body_shape(body) == SHAPE_CYLINDER && body_finite_length(v, body) && !has_caps(v, body);
#else
    (void)v, (void)body;
    return false;
#endif
}

struct contact_shape scene_whole_shape(const struct scene_values *v, const struct scene_state *q, int contact)
{
    const int destination = contact_destination(contact);
    struct contact_shape shape = {.source_radius = body_radius(v, contact_source(contact)),
                                  .other_radius = body_radius(v, destination),
                                  .half_length = (double)INFINITY,
                                  .side = scene_contact_side(v, q, contact),
                                  .destination = body_shape(destination)};
#if SCENE_ANY_CYLINDER
    if (shape.destination == SHAPE_CYLINDER) {
        shape.axis = q->contact[contact].parameters.axis;
        if (body_finite_length(v, destination)) {
            shape.half_length = 0.5 * body_length(v, destination);
        }
    }
#endif
#if SCENE_ANY_PLANE
    if (shape.destination == SHAPE_PLANE) {
        shape.axis = q->contact[contact].parameters.axis;
    }
#endif
#if SCENE_ANY_CAPS
    if (has_caps(v, destination)) {
        shape.solid = (struct contact_solid){shape.axis, shape.other_radius, shape.half_length, 0};
        shape.half_length = (double)INFINITY; /* the gap goes on beyond the ends */
    }
#endif
    return shape;
}

#if SCENE_ANY_CAPS
struct contact_shape scene_contact_shape(const struct scene_values *v, const struct scene_state *q,
                                         int contact)
{
    const int zone = q->contact[contact].zone;
    if (zone == 0) {
        return scene_whole_shape(v, q, contact);
    }
    const struct contact_shape shape = scene_whole_shape(v, q, contact);
    return contact_shape_in(&shape, zone);
}

struct contact_shape scene_shape_met(const struct scene_values *v, const struct scene_state *q,
                                     const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
    const int zone = at->geometry[contact].zone;
    return zone != 0 ? contact_shape_in(&shape, zone) : shape;
}
#else
struct contact_shape scene_contact_shape(const struct scene_values *v, const struct scene_state *q,
                                         int contact)
{
    return scene_whole_shape(v, q, contact);
}

struct contact_shape scene_shape_met(const struct scene_values *v, const struct scene_state *q,
                                     const struct scene_instant *at, int contact)
{
    return scene_contact_shape_at(v, q, at, contact);
}
#endif

struct contact_shape scene_contact_shape_at(const struct scene_values *v, const struct scene_state *q,
                                            const struct scene_instant *at, int contact)
{
    struct contact_shape shape = scene_contact_shape(v, q, contact);
#if SCENE_ANY_ROTATION
    if (body_turns(v, contact_destination(contact)) && shape.destination != SHAPE_SPHERE) {
        shape.axis = at->turning.axis[contact];
#if SCENE_ANY_CAPS
        if (contact_is_capped(&shape)) {
            shape.solid.axis = at->turning.axis[contact];
            shape = shape.solid.zone != 0 ? contact_shape_in(&shape, shape.solid.zone) : shape;
        }
#endif
    }
#else
    (void)at;
#endif
    return shape;
}

bool scene_within_extents(const struct contact_shape *shape, const struct contact_geometry *geometry)
{
    return !SCENE_ANY_CYLINDER || contact_within_extents(shape, geometry->axial);
}

double scene_beyond_ends(const struct contact_shape *shape, const struct contact_geometry *geometry)
{
    return SCENE_ANY_CYLINDER ? fabs(geometry->axial) - shape->half_length : -(double)INFINITY;
}
