#include "contact/geometry.h"

#include "contact/zone.h"

double contact_reach(const struct contact_shape *shape)
{
    return shape->side > 0 ? shape->source_radius + shape->other_radius
                           : shape->other_radius - shape->source_radius;
}

/* Then r_d - r_s is exact. */
static bool fills_shell(const struct contact_shape *shape)
{
    return shape->side < 0 && shape->source_radius > 0.5 * shape->other_radius;
}

/* The radii are subtracted one after the other, the larger first: their sum would be rounded once more. */
static double gap_at(const struct contact_shape *shape, double distance)
{
    const double source = shape->source_radius;
    const double other = shape->other_radius;
    if (shape->side > 0) {
        return source > other ? (distance - source) - other : (distance - other) - source;
    }
    /* other - source is exact for a source that nearly fills its shell; other - distance is exact for a
     * smaller one where they touch. */
    return fills_shell(shape) ? (other - source) - distance : (other - distance) - source;
}

struct vec3 contact_across_again(const struct contact_shape *shape, struct vec3 once)
{
    if (vec3_is_zero(once)) {
        return vec3_make(0.0, 0.0, 0.0); /* as gravity along the axis leaves */
    }
    const double size = fabs(once.x) + fabs(once.y) + fabs(once.z);
    const struct vec3 twice = vec3_axpy(once, -vec3_dot(once, shape->axis), shape->axis);
    return vec3_norm(twice) > 0.1 * size ? twice : vec3_make(0.0, 0.0, 0.0);
}

static struct contact_geometry geometry_in(const struct contact_shape *shape, struct vec3 c, struct vec3 w,
                                           struct vec3 fallback)
{
    struct contact_geometry at = {.offset = c, .normal = fallback};
    if (contact_is_cylinder(shape)) {
        at.axial = vec3_dot(c, shape->axis);
        at.offset = contact_across_axis(shape, c, at.axial);
    }
    if (contact_is_plane(shape)) {
        at.normal = vec3_sub(vec3_make(0.0, 0.0, 0.0), shape->axis);
        at.distance = vec3_dot(at.normal, c);
        at.degenerate = false;
    } else {
        at.distance = vec3_norm(at.offset);
        at.degenerate = !(at.distance > 0.0);
    }
    if (contact_turns(shape, &at)) {
        at.normal =
            (struct vec3){at.offset.x / at.distance, at.offset.y / at.distance, at.offset.z / at.distance};
    }
    at.gap = gap_at(shape, at.distance);
    at.gap_terms = fills_shell(shape) ? contact_reach(shape) : shape->source_radius + shape->other_radius;
    at.gap_rate = shape->side * vec3_dot(at.normal, w);
    return at;
}

#ifdef CONTACT_NO_CAPS
struct contact_geometry contact_geometry_at(const struct contact_shape *shape, struct vec3 c, struct vec3 w,
                                            struct vec3 fallback)
{
    return geometry_in(shape, c, w, fallback);
}
#else

/* Towards the nearest point of the circle: with the unit vector a from the centre to the axis, across it, c
 * less that circle's centre is rho a - beyond e, and its nearest point r_d a. */
static struct contact_geometry geometry_of_rim(const struct contact_shape *shape, struct vec3 c,
                                               struct vec3 w, struct vec3 fallback)
{
    struct contact_geometry at = {.normal = fallback};
    const double axial = vec3_dot(c, shape->axis);
    const struct vec3 across = vec3_axpy(c, -axial, shape->axis);
    const double rho = vec3_norm(across); /* above r_d in the zone */
    const double radial = rho - shape->solid.radius;
    const double beyond = -axial - shape->solid.half_height;
    at.offset = vec3_axpy(vec3_scale(radial / rho, across), -beyond, shape->axis);
    at.distance = vec3_norm(vec3_make(radial, beyond, 0.0));
    at.degenerate = !(at.distance > 0.0);
    if (!at.degenerate) {
        at.normal = vec3_scale(1.0 / at.distance, at.offset);
    }
    at.hoop = vec3_cross(shape->axis, vec3_scale(1.0 / rho, across));
    at.hoop_part = shape->solid.radius / rho;
    at.gap = gap_at(shape, at.distance);
    at.gap_terms = shape->source_radius + shape->solid.radius + shape->solid.half_height;
    at.gap_rate = vec3_dot(at.normal, w);
    return at;
}

struct contact_geometry contact_geometry_at(const struct contact_shape *shape, struct vec3 c, struct vec3 w,
                                            struct vec3 fallback)
{
    if (!contact_is_capped(shape)) {
        return geometry_in(shape, c, w, fallback);
    }
    struct contact_shape in = *shape;
    if (in.solid.zone == 0) {
        const struct solid_place place = contact_place_at(&shape->solid, c);
        in = contact_shape_in(shape, contact_zone_by(&place));
    }
    struct contact_geometry at =
        contact_is_rim(&in) ? geometry_of_rim(&in, c, w, fallback) : geometry_in(&in, c, w, fallback);
    at.zone = in.solid.zone;
    return at;
}
#endif

bool contact_within_extents(const struct contact_shape *shape, double axial)
{
    return fabs(axial) <= shape->half_length;
}

struct vec3 contact_direction_of(const struct contact_shape *shape, const struct contact_geometry *at)
{
    const bool flipped = contact_is_cylinder(shape) && shape->side < 0;
    return flipped ? vec3_scale(-1.0, at->normal) : at->normal;
}

struct vec3 contact_tangential(const struct contact_shape *shape, struct vec3 normal, struct vec3 w)
{
    if (contact_is_plane(shape)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    struct vec3 across = vec3_axpy(w, -vec3_dot(normal, w), normal);
    if (contact_is_cylinder(shape)) {
        across = vec3_axpy(across, -vec3_dot(shape->axis, w), shape->axis);
    }
    return across;
}

struct vec3 contact_turning_part(const struct contact_shape *shape, const struct contact_geometry *at,
                                 struct vec3 w)
{
#ifndef CONTACT_NO_CAPS
    if (contact_is_rim(shape)) {
        const struct vec3 across = vec3_axpy(w, -vec3_dot(at->normal, w), at->normal);
        return vec3_axpy(across, -at->hoop_part * vec3_dot(at->hoop, w), at->hoop);
    }
#endif
    return contact_tangential(shape, at->normal, w);
}

double contact_turning_rate(const struct contact_shape *shape, const struct contact_geometry *at,
                            struct vec3 w, struct vec3 moved)
{
    const struct vec3 turned = contact_turning_part(shape, at, moved);
    return vec3_dot(contact_is_rim(shape) ? w : contact_tangential(shape, at->normal, w), turned);
}

struct vec3 contact_escape_direction(const struct contact_shape *shape, struct vec3 w, struct vec3 fallback)
{
    if (contact_is_cylinder(shape)) {
        w = contact_across_axis(shape, w, vec3_dot(w, shape->axis));
    }
    const double speed = vec3_norm(w);
    return speed > 0.0 ? vec3_make(w.x / speed, w.y / speed, w.z / speed) : fallback;
}

struct vec3 contact_default_normal(const struct contact_shape *shape)
{
    if (contact_is_plane(shape)) {
        return vec3_sub(vec3_make(0.0, 0.0, 0.0), shape->axis);
    }
    if (!contact_is_cylinder(shape)) {
        return vec3_make(0.0, 0.0, -1.0);
    }
    const struct vec3 e = shape->axis;
    struct vec3 start = {0.0, 0.0, -1.0};
    if (fabs(e.x) < fabs(e.z) && fabs(e.x) <= fabs(e.y)) {
        start = vec3_make(-1.0, 0.0, 0.0);
    } else if (fabs(e.y) < fabs(e.z)) {
        start = vec3_make(0.0, -1.0, 0.0);
    }
    const struct vec3 across = vec3_axpy(start, -vec3_dot(start, e), e);
    return vec3_scale(1.0 / vec3_norm(across), across);
}
