#include "segment/tumbling_gap.h"

#include <float.h>

#include "contact/zone.h"

/* Roundings of a sum of products of vectors, as a gap is: as many as rounding_of_gap grants. */
static const double TUMBLING_ROUNDINGS = 8.0 * DBL_EPSILON;

bool tumbling_has_reach(const struct tumbling_path *path)
{
    return path->shape.side > 0 && (tumbling_functions(path) > 1 || contact_is_capped(&path->shape));
}

int tumbling_functions(const struct tumbling_path *path)
{
    const bool has_ends = contact_is_cylinder(&path->shape) && isfinite(path->shape.half_length);
    return has_ends ? TUMBLING_FUNCTIONS : 1;
}

/* The separation and its derivatives, by Horner's scheme. */
static void separation_at(const struct tumbling_path *path, double time, struct vec3 at[TUMBLING_TERMS])
{
    for (int k = 0; k < TUMBLING_TERMS; ++k) {
        at[k] = vec3_make(0.0, 0.0, 0.0);
    }
    for (int i = TUMBLING_TERMS - 1; i >= 0; --i) {
        for (int k = TUMBLING_TERMS - 1 - i; k > 0; --k) {
            at[k] = vec3_axpy(at[k - 1], time, at[k]);
        }
        at[0] = vec3_axpy(path->c[i], time, at[0]);
    }
    double factorial = 1.0;
    for (int k = 2; k < TUMBLING_TERMS; ++k) {
        factorial *= k;
        at[k] = vec3_scale(factorial, at[k]);
    }
}

/* The shape with its axis there; a capped cylinder as the solid that it is, in whatever zone it is met. */
static struct contact_shape shape_with(const struct tumbling_path *path, struct vec3 axis)
{
    struct contact_shape shape = path->shape;
    shape.axis = axis;
#ifndef CONTACT_NO_CAPS
    if (contact_is_capped(&shape)) {
        shape.solid.axis = axis;
        shape = contact_shape_in(&shape, 0);
    }
#endif
    return shape;
}

/* Inside a shell the change is that d grows through the reach at a touch, outside at a parting. */
static bool distance_grows(const struct tumbling_path *path, enum tumbling_change change)
{
    return (change == TUMBLING_TOUCH) == (path->shape.side < 0);
}

/* The distance whose square is smooth wherever the source is, and its reach: to an axis, or to a capped
 * solid, of which the source's centre is r_s away as they part. */
static double smooth_reach(const struct contact_shape *shape)
{
    return contact_is_capped(shape) ? shape->source_radius : contact_reach(shape);
}

static double smooth_distance(const struct contact_shape *shape, const struct contact_geometry *g)
{
    return contact_is_capped(shape) ? fmax(g->gap + shape->source_radius, 0.0) : g->distance;
}

/* (reach^2 - d^2)/(2 reach) in place of reach - d where d grows; of a plane d itself. */
static struct falling gap_function(const struct tumbling_path *path, enum tumbling_change change,
                                   const struct contact_shape *shape, const struct contact_geometry *g)
{
    const double sign = change == TUMBLING_TOUCH ? 1.0 : -1.0;
    struct falling gap = {sign * g->gap, sign * g->gap_rate, 0.0};
    if (distance_grows(path, change) && !contact_is_plane(shape)) {
        const double part = smooth_distance(shape, g) / smooth_reach(shape);
        const bool deep = contact_is_capped(shape) && !(part > 0.0);
        gap.value = deep ? 0.5 * shape->source_radius : gap.value * 0.5 * (1.0 + part);
        gap.slope *= part;
    }
    return gap;
}

void tumbling_at(const struct tumbling_path *path, enum tumbling_change change, double time,
                 struct tumbling_instant *at)
{
    separation_at(path, time, at->c);
    const struct rotor_axis axis = axis_motion_at(&path->axis, time);
    const struct contact_shape shape = shape_with(path, axis.axis);
    /* e x e' carries the axis along: the rate of c in a frame that turns so is what changes the gap */
    const struct vec3 omega = vec3_cross(axis.axis, axis.rate);
    const struct vec3 rate = vec3_sub(at->c[1], vec3_cross(omega, at->c[0]));
    at->geometry = contact_geometry_at(&shape, at->c[0], rate, path->shape.axis);
    at->axial_rate = vec3_dot(rate, axis.axis);
    at->of[TUMBLING_GAP] = gap_function(path, change, &shape, &at->geometry);
    const double distance = vec3_norm(at->c[0]);
    at->noise[TUMBLING_GAP] =
        fmax(path->rounding, TUMBLING_ROUNDINGS * (distance + shape.source_radius + shape.other_radius));
    for (int i = TUMBLING_UPPER_END; i < tumbling_functions(path); ++i) {
        const double end = i == TUMBLING_UPPER_END ? 1.0 : -1.0;
        const double sign = change == TUMBLING_TOUCH ? 1.0 : -1.0;
        at->of[i] = (struct falling){sign * (end * at->geometry.axial - shape.half_length),
                                     sign * end * at->axial_rate, 0.0};
        at->noise[i] = fmax(path->rounding, TUMBLING_ROUNDINGS * (distance + shape.half_length));
    }
}

/* sum over i of |c^(first + i)| length^i / i! */
static double size_within(const struct vec3 c[TUMBLING_TERMS], int first, double length)
{
    double size = 0.0;
    for (int i = TUMBLING_TERMS - 1; i >= first; --i) {
        const double norm = vec3_norm(c[i]);
        size = norm + (size > 0.0 ? size * length / (i - first + 1) : 0.0);
    }
    return size;
}

void tumbling_bend(const struct tumbling_path *path, enum tumbling_change change, double time, double length,
                   struct tumbling_instant *at)
{
    const struct axis_bounds axis = axis_motion_bounds(&path->axis, time, length);
    double bend = size_within(at->c, 2, length);
    double speed = size_within(at->c, 1, length);
    if (axis.speed > 0.0) {
        const double separation = size_within(at->c, 0, length);
        bend += 2.0 * axis.speed * speed + (axis.turn + axis.speed * axis.speed) * separation;
        speed += axis.speed * separation;
    }
    for (int i = 0; i < tumbling_functions(path); ++i) {
        at->of[i].bend = bend;
    }
    const struct contact_shape shape = shape_with(path, path->axis.axis);
    if (distance_grows(path, change) && !contact_is_plane(&shape)) {
        at->of[TUMBLING_GAP].bend += speed * speed / smooth_reach(&shape);
    }
}

struct falling tumbling_beyond_reach(const struct tumbling_path *path, const struct tumbling_instant *at,
                                     double length)
{
    const double distance = vec3_norm(at->c[0]);
    const struct contact_shape shape = shape_with(path, path->axis.axis);
    double farthest = contact_reach(&shape) + shape.half_length;
#ifndef CONTACT_NO_CAPS
    if (contact_is_capped(&shape)) {
        farthest = shape.solid.radius + shape.solid.half_height + shape.source_radius;
    }
#endif
    const double slope = distance > 0.0 ? vec3_dot(at->c[0], at->c[1]) / distance : 0.0;
    return (struct falling){distance - farthest, slope, size_within(at->c, 2, length)};
}

double falling_stays_above(const struct falling *f, double noise)
{
    const double height = f->value + noise;
    if (!(height > 0.0) || !(f->bend < (double)INFINITY)) {
        return 0.0;
    }
    const double root = sqrt(f->slope * f->slope + 2.0 * f->bend * height);
    if (f->slope >= 0.0) {
        return f->bend > 0.0 ? (f->slope + root) / f->bend : (double)INFINITY;
    }
    return 2.0 * height / (root - f->slope);
}
