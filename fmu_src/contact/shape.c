#include <stdlib.h>

#include "contact/shape.h"

bool contact_is_cylinder(const struct contact_shape *shape)
{
    return CONTACT_ANY_CYLINDER && shape->destination == SHAPE_CYLINDER;
}

bool contact_is_plane(const struct contact_shape *shape)
{
    return CONTACT_ANY_PLANE && (!CONTACT_ANY_CURVED || shape->destination == SHAPE_PLANE);
}

bool contact_is_rim(const struct contact_shape *shape)
{
    return CONTACT_ANY_CAPS && shape->destination == SHAPE_RIM;
}

bool contact_is_capped(const struct contact_shape *shape)
{
    return CONTACT_ANY_CAPS && shape->solid.half_height > 0.0;
}

bool contact_is_torus(const struct contact_shape *shape)
{
    return CONTACT_ANY_TORUS && shape->destination == SHAPE_TORUS;
}

bool contact_is_circle(const struct contact_shape *shape)
{
    return contact_is_rim(shape) || contact_is_torus(shape);
}

const struct skew_frame *contact_skew_frame(const struct contact_solid *solid)
{
#if CONTACT_ANY_SKEW
    return &solid->skew;
#else
    static const struct skew_frame NONE = {.sine = 0.0};
    (void)solid;
    return &NONE;
#endif
}

static bool solid_is_skew(const struct contact_solid *solid)
{
    return CONTACT_ANY_SKEW && contact_skew_frame(solid)->half[0] > 0.0;
}

bool contact_is_skew(const struct contact_shape *shape)
{
    return solid_is_skew(&shape->solid);
}

bool contact_is_zoned(const struct contact_shape *shape)
{
    return contact_is_capped(shape) || contact_is_skew(shape);
}

bool contact_may_reach_centre(const struct contact_shape *shape)
{
    return shape->side > 0 && !contact_is_plane(shape) && !contact_is_circle(shape);
}

bool contact_turns(const struct contact_shape *shape, const struct contact_geometry *at)
{
    return !at->degenerate && !contact_is_plane(shape);
}

double contact_reach(const struct contact_shape *shape)
{
    return shape->side > 0 ? shape->source_radius + shape->other_radius
                           : shape->other_radius - shape->source_radius;
}

/* Returns the unit vector across the axis e nearest to the negative coordinate axis least aligned with e. */
static struct vec3 across_axis(struct vec3 e)
{
    struct vec3 start = {0.0, 0.0, -1.0};
    if (fabs(e.x) < fabs(e.z) && fabs(e.x) <= fabs(e.y)) {
        start = vec3_make(-1.0, 0.0, 0.0);
    } else if (fabs(e.y) < fabs(e.z)) {
        start = vec3_make(0.0, -1.0, 0.0);
    }
    const struct vec3 across = vec3_axpy(start, -vec3_dot(start, e), e);
    return vec3_scale(1.0 / vec3_norm(across), across);
}

/* Returns the part of c across a cylinder's axis; `axial` is c.e_d. Near the axis the result of one
 * projection, of which less than about half of the digits is left, may point along the axis by rounding; a
 * second projection removes that part. The result is zero where too little is left; c then counts as on the
 * axis. */
static struct vec3 contact_across_axis(const struct contact_shape *shape, struct vec3 c, double axial)
{
    const struct vec3 once = vec3_axpy(c, -axial, shape->axis);
    const double size = fabs(once.x) + fabs(once.y) + fabs(once.z);
    if (!(size < 1e-8 * fabs(axial))) {
        return once;
    }
    const struct vec3 twice = vec3_axpy(once, -vec3_dot(once, shape->axis), shape->axis);
    return vec3_norm(twice) > 0.1 * size ? twice : vec3_make(0.0, 0.0, 0.0);
}

struct vec3 contact_across(const struct contact_shape *shape, struct vec3 c)
{
    if (!contact_is_cylinder(shape)) {
        return c;
    }
    return contact_across_axis(shape, c, vec3_dot(c, shape->axis));
}

double contact_along_plane(struct vec3 normal, struct vec3 a)
{
    const double along = vec3_dot(normal, a);
    const double terms = fabs(normal.x * a.x) + fabs(normal.y * a.y) + fabs(normal.z * a.z);
    return fabs(along) > 4.0 * DBL_EPSILON * terms ? along : 0.0;
}

struct vec3 contact_across_plane(struct vec3 normal, struct vec3 a)
{
    const struct vec3 once = vec3_axpy(a, -vec3_dot(normal, a), normal);
    if (vec3_max_abs(once) <= 4.0 * DBL_EPSILON * vec3_max_abs(a)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    return vec3_axpy(once, -vec3_dot(normal, once), normal);
}

/* Whether the source nearly fills its shell, r_d / 2 < r_s; the difference r_d - r_s is then exact. */
static bool fills_shell(const struct contact_shape *shape)
{
    return shape->side < 0 && shape->source_radius > 0.5 * shape->other_radius;
}

/* Returns g. The radii are subtracted one after the other, the larger first: their sum would be rounded. */
static double gap_at(const struct contact_shape *shape, double distance)
{
    const double source = shape->source_radius;
    const double other = shape->other_radius;
    if (shape->side > 0) {
        return source > other ? (distance - source) - other : (distance - other) - source;
    }
    /* other - source is exact for a source that nearly fills its shell. For a smaller source, other -
     * distance is exact at the touch. */
    return fills_shell(shape) ? (other - source) - distance : (other - distance) - source;
}

/* Sets the offset from a circle, where n points to the circle's nearest point. Let a be the unit vector from
 * the source's centre to the axis, perpendicular to the axis, and e the axis. Relative to the source's
 * centre, the centre of the circle is at rho a - beyond e; the nearest point of the circle is its radius R
 * times a closer. On the axis all points of the circle are equally near, and a may be any of the unit vectors
 * across the axis. */
static void put_circle(const struct contact_shape *shape, struct vec3 c, struct contact_geometry *at)
{
    const double axial = vec3_dot(c, shape->axis);
    struct vec3 across = vec3_axpy(c, -axial, shape->axis);
    double rho = vec3_norm(across); /* above R in the zone of a rim */
    if (contact_is_torus(shape) && !(rho > DBL_MIN)) {
        rho = DBL_EPSILON * shape->solid.radius;
        across = vec3_scale(rho, across_axis(shape->axis));
    }
    const double radial = rho - shape->solid.radius;
    const double beyond = -axial - shape->solid.half_height;
    at->offset = vec3_axpy(vec3_scale(radial / rho, across), -beyond, shape->axis);
    at->circumferential = vec3_cross(shape->axis, vec3_scale(1.0 / rho, across));
    at->circumferential_part = shape->solid.radius / rho;
    at->gap_terms = shape->solid.radius + shape->solid.half_height;
    at->axial = shape->solid.race * rho + (shape->solid.race < 0 ? 2.0 * shape->solid.radius : 0.0);
}

/* Makes n perpendicular to the axis of a cylinder where the centre is on the axis. n may come from a cap or a
 * rim, or from a time at which the axis pointed elsewhere. */
static void hold_across(const struct contact_shape *side, struct contact_geometry *at)
{
    const struct vec3 across = contact_across(side, at->normal);
    const double size = vec3_norm(across);
    at->normal = size > 0.0 ? vec3_scale(1.0 / size, across) : contact_default_normal(side);
}

static struct contact_geometry geometry_in(const struct contact_shape *shape, struct vec3 c, struct vec3 w,
                                           struct vec3 fallback)
{
    struct contact_geometry at = {.offset = c, .normal = fallback};
    if (contact_is_cylinder(shape)) {
        at.axial = vec3_dot(c, shape->axis);
        at.offset = contact_across_axis(shape, c, at.axial);
    } else if (contact_is_circle(shape)) {
        put_circle(shape, c, &at);
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
    if (at.degenerate && contact_is_cylinder(shape)) {
        hold_across(shape, &at);
    }
    at.gap = gap_at(shape, at.distance);
    at.gap_terms += fills_shell(shape) ? contact_reach(shape) : shape->source_radius + shape->other_radius;
    at.gap_rate = shape->side * vec3_dot(at.normal, w);
    return at;
}

/* Which ends of both axes a zone of skew cylinders is at: -1, +1, or 0 within. */
struct skew_ends {
    int at[2];
};

static inline struct skew_ends skew_ends_of(int zone)
{
    const int place = abs(zone) - SKEW_ZONE;
    return (struct skew_ends){{place / 3 - 1, place % 3 - 1}};
}

/* Returns the distance of c from the nearest plane that bounds a zone of skew cylinders [m], negative beyond
 * it. Where the zone is at an end of one axis, the place along the other is measured from there. */
static double skew_margin(const struct skew_frame *frame, int zone, struct vec3 c)
{
    const struct skew_ends ends = skew_ends_of(zone);
    const double height = (zone < 0 ? -1.0 : 1.0) * vec3_dot(c, frame->normal);
    double margin = abs(zone) == SKEW_FACE ? height : (double)INFINITY;
    for (int i = 0; i < 2; ++i) {
        const int end = ends.at[i];
        const int other = ends.at[1 - i];
        if (end != 0 && !isfinite(frame->half[i])) {
            return -(double)INFINITY;
        }
        const double most = other != 0 ? frame->half[i] : frame->reach[i];
        const double place = vec3_dot(c, other != 0 ? frame->along[i] : frame->across[i]) -
                             (other != 0 ? frame->cosine * other * frame->half[1 - i] : 0.0);
        const double room = end != 0 ? end * place - most : most - fabs(place);
        margin = room < margin ? room : margin;
    }
    return margin;
}

/* Returns the place of the edge or corner of the parallelogram that a zone is at, zero at its face [m]. */
static struct vec3 skew_corner(const struct skew_frame *frame, int zone)
{
    const struct skew_ends ends = skew_ends_of(zone);
    struct vec3 corner = {0.0, 0.0, 0.0};
    for (int i = 0; i < 2; ++i) {
        corner = ends.at[i] != 0 ? vec3_axpy(corner, ends.at[i] * frame->half[i], frame->along[i]) : corner;
    }
    return corner;
}

/* Makes a pair of skew cylinders the shape that c meets in its zone. */
static void enter_skew_zone(struct contact_shape *shape)
{
    static const enum shape SHAPES[] = {SHAPE_PLANE, SHAPE_CYLINDER, SHAPE_SPHERE};
    const struct skew_frame *frame = contact_skew_frame(&shape->solid);
    const int zone = shape->solid.zone;
    const struct skew_ends ends = skew_ends_of(zone);
    shape->destination = zone == 0 ? SHAPE_SKEW : SHAPES[(ends.at[0] != 0) + (ends.at[1] != 0)];
    shape->axis = ends.at[1] != 0 ? frame->along[0] : vec3_scale(-1.0, frame->along[1]);
    if (shape->destination == SHAPE_PLANE) { /* its outward normal is -n */
        shape->axis = vec3_scale(zone < 0 ? 1.0 : -1.0, frame->normal);
    }
}

struct contact_geometry contact_geometry_at(const struct contact_shape *shape, struct vec3 c, struct vec3 w,
                                            struct vec3 fallback)
{
    if (!contact_is_zoned(shape)) {
        return geometry_in(shape, c, w, fallback);
    }
    struct contact_shape found;
    const struct contact_shape *in = shape;
    if (shape->solid.zone == 0) {
        found = *shape;
        contact_enter_zone(&found, contact_zone_at(&shape->solid, 0, c));
        in = &found;
    }
    const int zone = in->solid.zone;
    const struct vec3 none = {0.0, 0.0, 0.0};
    const struct vec3 corner = contact_is_skew(in) ? skew_corner(contact_skew_frame(&in->solid), zone) : none;
    struct contact_geometry at = geometry_in(in, vec3_sub(c, corner), w, fallback);
    at.zone = zone;
    at.gap_terms += vec3_max_abs(corner);
    return at;
}

struct vec3 contact_turning_part(const struct contact_shape *shape, const struct contact_geometry *at,
                                 struct vec3 w)
{
    if (contact_is_plane(shape)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    struct vec3 across = vec3_axpy(w, -vec3_dot(at->normal, w), at->normal);
    if (contact_is_cylinder(shape)) {
        across = vec3_axpy(across, -vec3_dot(shape->axis, w), shape->axis);
    }
    if (contact_is_circle(shape)) {
        across = vec3_axpy(across, -at->circumferential_part * vec3_dot(at->circumferential, w),
                           at->circumferential);
    }
    return across;
}

double contact_turning_rate(const struct contact_shape *shape, const struct contact_geometry *at,
                            struct vec3 w)
{
    const struct vec3 turned = contact_turning_part(shape, at, w);
    return vec3_dot(contact_is_circle(shape) ? w : turned, turned);
}

struct vec3 contact_default_normal(const struct contact_shape *shape)
{
    if (contact_is_plane(shape)) {
        return vec3_sub(vec3_make(0.0, 0.0, 0.0), shape->axis);
    }
    if (!contact_is_cylinder(shape)) {
        return vec3_make(0.0, 0.0, -1.0);
    }
    return across_axis(shape->axis);
}

struct solid_place contact_place_at(const struct contact_solid *solid, struct vec3 c)
{
    const double axial = vec3_dot(c, solid->axis);
    const double rho = vec3_norm(vec3_axpy(c, -axial, solid->axis));
    return (struct solid_place){rho - solid->radius, fabs(axial) - solid->half_height};
}

void contact_enter_zone(struct contact_shape *shape, int zone)
{
    const int end = zone < 0 ? -1 : 1;
    if (!(CONTACT_ANY_CAPS || CONTACT_ANY_SKEW) || zone == shape->solid.zone) {
        return;
    }
    shape->solid.zone = zone;
    if (contact_is_skew(shape)) {
        enter_skew_zone(shape);
        return;
    }
    shape->axis = vec3_scale(end, shape->solid.axis);
    const bool is_cap = end * zone == ZONE_CAP;
    const bool is_rim = end * zone == ZONE_RIM;
    shape->destination = is_cap ? SHAPE_PLANE : is_rim ? SHAPE_RIM : SHAPE_CYLINDER;
    shape->other_radius = is_cap ? shape->solid.half_height : is_rim ? 0.0 : shape->solid.radius;
}

double contact_zone_margin(const struct contact_solid *solid, int zone, struct vec3 c)
{
    if (solid_is_skew(solid)) {
        return skew_margin(contact_skew_frame(solid), zone, c);
    }
    const struct solid_place at = contact_place_at(solid, c);
    if (zone == ZONE_SIDE) {
        return fmin(at.radial, 0.0) - at.axial;
    }
    /* distances of the centre beyond the middle plane and beyond the cap, at the zone's end [m] */
    const double height = (zone < 0 ? 1.0 : -1.0) * vec3_dot(c, solid->axis);
    const double beyond = height - solid->half_height;
    if (zone == ZONE_CAP || zone == -ZONE_CAP) {
        return fmin(fmin(beyond, 0.0) - at.radial, height);
    }
    return fmin(at.radial, beyond);
}

int contact_zone_at(const struct contact_solid *solid, int except, struct vec3 c)
{
    const int end = vec3_dot(c, solid->axis) > 0.0 ? -1 : 1;
    const int capped[] = {end * ZONE_RIM, end * ZONE_CAP, ZONE_SIDE}; /* the last of equal ones counts */
    const bool is_skew = solid_is_skew(solid);
    const int face = vec3_dot(c, contact_skew_frame(solid)->normal) > 0.0 ? SKEW_FACE : -SKEW_FACE;
    const int count = is_skew ? SKEW_LAST - SKEW_ZONE + 2 : (int)(sizeof capped / sizeof capped[0]);
    double most = -(double)INFINITY;
    int nearest = 0;
    for (int i = 0; i < count && !(most > 0.0); ++i) {
        const int place = i == 0 ? SKEW_FACE : SKEW_LAST + 1 - i; /* c is most often at the face */
        const int zone = !is_skew ? capped[i] : place == SKEW_FACE ? face : place;
        const double margin = contact_zone_margin(solid, zone, c);
        if (zone != except && margin >= most) {
            nearest = zone;
            most = margin;
        }
    }
    return nearest;
}

int contact_zone_next(const struct contact_solid *solid, int zone, struct vec3 c, struct vec3 rate,
                      double rounding)
{
    /* 16 roundings ahead the zone is clear, unless c moves along the edge of two */
    const double speed = vec3_norm(rate);
    const struct vec3 ahead = speed > 0.0 ? vec3_axpy(c, 16.0 * rounding / speed, rate) : c;
    return contact_zone_at(solid, solid_is_skew(solid) ? 0 : zone, ahead);
}

bool contact_zone_jumps(const struct contact_solid *solid, int zone, int next, struct vec3 c, double distance,
                        double rounding)
{
    if (solid_is_skew(solid)) {
        return zone == -next || distance <= rounding;
    }
    const struct solid_place place = contact_place_at(solid, c);
    return (abs(zone) != ZONE_RIM && abs(next) != ZONE_RIM) ||
           fmax(fabs(place.radial), fabs(place.axial)) <= rounding;
}

/* The part of -e_d across e_s is projected twice, so that the normal is perpendicular to both axes to
 * rounding where they are nearly parallel too. */
struct skew_frame contact_skew_axes(struct vec3 source_axis, struct vec3 destination_axis)
{
    const struct vec3 e = source_axis;
    const struct vec3 other = vec3_scale(-1.0, destination_axis);
    const double cosine = vec3_dot(other, e);
    const struct vec3 once = vec3_axpy(other, -cosine, e);
    const struct vec3 twice = vec3_axpy(once, -vec3_dot(once, e), e);
    const double sine = vec3_norm(twice);
    const struct vec3 across = vec3_scale(1.0 / sine, twice);
    return (struct skew_frame){.along = {e, other},
                               .across = {vec3_axpy(vec3_scale(sine, e), -cosine, across), across},
                               .normal = vec3_cross(across, e),
                               .cosine = cosine,
                               .sine = sine};
}

/* Returns the change of the foot by a change of c within a zone. */
static struct vec3 foot_along(const struct skew_frame *frame, int zone, struct vec3 change)
{
    const struct skew_ends ends = skew_ends_of(zone);
    const struct vec3 slope =
        ends.at[1] != 0 ? frame->along[0] : vec3_scale(1.0 / frame->sine, frame->across[0]);
    return vec3_scale(ends.at[0] != 0 ? 0.0 : vec3_dot(slope, change), frame->along[0]);
}

struct vec3 contact_foot_along(const struct contact_shape *shape, struct vec3 change)
{
    return contact_is_skew(shape) ? foot_along(contact_skew_frame(&shape->solid), shape->solid.zone, change)
                                  : vec3_make(0.0, 0.0, 0.0);
}

struct vec3 contact_foot(const struct contact_shape *shape, int zone, struct vec3 c)
{
    if (!contact_is_skew(shape)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    const struct skew_frame *frame = contact_skew_frame(&shape->solid);
    const int end = skew_ends_of(zone).at[0];
    const struct vec3 along = foot_along(frame, zone, vec3_sub(c, skew_corner(frame, zone)));
    return vec3_axpy(along, end != 0 ? end * frame->half[0] : 0.0, frame->along[0]);
}

struct vec3 contact_source_arm(const struct contact_shape *shape, struct vec3 normal, struct vec3 foot)
{
    const struct vec3 radial = vec3_scale(shape->side * shape->source_radius, normal);
    return contact_is_skew(shape) ? vec3_add(foot, radial) : radial;
}
