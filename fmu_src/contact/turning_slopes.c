#include "contact/turning_slopes.h"

/* a - n (n.a) */
static struct vec3 without_normal(struct vec3 a, struct vec3 n)
{
    return vec3_axpy(a, -vec3_dot(n, a), n);
}

static struct vec3 matrix_times(double m[3][3], struct vec3 a)
{
    return vec3_make(m[0][0] * a.x + m[0][1] * a.y + m[0][2] * a.z,
                     m[1][0] * a.x + m[1][1] * a.y + m[1][2] * a.z,
                     m[2][0] * a.x + m[2][1] * a.y + m[2][2] * a.z);
}

struct turning_slopes turning_slopes_at(const struct contact_shape *shape, const struct contact_geometry *at,
                                        const struct turning_motion *motion, const struct turning_laws *laws)
{
    struct turning_slopes s = {.shape = *shape, .geometry = *at, .motion = *motion};
    const struct vec3 n = at->normal;
    const double lever = shape->source_radius * shape->side;
    s.seen_rate = vec3_sub(motion->rate, vec3_cross(motion->destination_rotation, motion->separation));
    s.across = contact_turning_part(shape, at, s.seen_rate);
    s.inverse_distance = contact_turns(shape, at) ? 1.0 / at->distance : 0.0;
    s.normal_rate = vec3_axpy(vec3_cross(motion->destination_rotation, n), s.inverse_distance, s.across);
    const struct vec3 spin = vec3_sub(motion->source_rotation, motion->destination_rotation);
    s.slip = vec3_sub(vec3_scale(lever, vec3_cross(spin, n)), without_normal(s.seen_rate, n));

    s.normal_force = contact_force(&laws->normal, laws->regime, at->gap, at->gap_rate);
    s.normal_slopes = contact_force_slopes(&laws->normal, laws->regime, at->gap, at->gap_rate);
    s.stored_slope = contact_stored_slope(&laws->normal, laws->regime, at->gap);
    s.bend = contact_stored_bend(&laws->normal, laws->regime, at->gap);

    const struct friction_state rubbing = {s.normal_force, s.slip, motion->spring};
    s.friction_force = friction_force(&laws->friction, laws->friction_regime, rubbing);
    s.force_slopes = friction_force_slopes(&laws->friction, laws->friction_regime, rubbing);
    s.spring_slopes = friction_spring_rate_slopes(&laws->friction, laws->friction_regime, rubbing);
    s.force = vec3_axpy(s.friction_force, -shape->side * s.normal_force, n);
    return s;
}

/* Changes of the geometry: of n, d, w_g, the part of it across n, and its part n.w_g along n. */
struct geometry_change {
    struct vec3 normal, seen_rate, tangential;
    double distance, along;
    struct vec3 axis; /* of the shape */
    struct vec3 hoop; /* of a rim: b, and r_d / rho */
    double hoop_part;
};

#ifndef CONTACT_NO_CAPS
/* d offset of a rim and d b, with offset = (rho - r_d) a + (c.e + h) e, b = e x a, rho a = c - (c.e) e. */
static struct vec3 rim_offset_along(const struct turning_slopes *s, const struct turning_motion *change,
                                    struct geometry_change *d)
{
    const struct vec3 e = s->shape.axis;
    const struct vec3 c = s->motion.separation;
    const struct vec3 a = vec3_cross(s->geometry.hoop, e);
    const double axial = vec3_dot(c, e);
    const double rho = vec3_dot(c, a);
    const double more_axial = vec3_dot(change->separation, e) + vec3_dot(c, d->axis);
    const struct vec3 across = vec3_axpy(vec3_axpy(change->separation, -more_axial, e), -axial, d->axis);
    const double more_rho = vec3_dot(a, across);
    const struct vec3 turned = vec3_scale(1.0 / rho, vec3_axpy(across, -more_rho, a));
    d->hoop = vec3_add(vec3_cross(d->axis, a), vec3_cross(e, turned));
    d->hoop_part = -s->geometry.hoop_part * more_rho / rho;
    const struct vec3 radial = vec3_axpy(vec3_scale(more_rho, a), rho - s->shape.solid.radius, turned);
    return vec3_axpy(vec3_axpy(radial, more_axial, e), axial + s->shape.solid.half_height, d->axis);
}

/* What the part along the circle takes from n': d of (r_d / rho) b (b.w_g) */
static struct vec3 hoop_along(const struct turning_slopes *s, const struct geometry_change *d)
{
    const struct vec3 b = s->geometry.hoop;
    const double part = s->geometry.hoop_part;
    const double rate = vec3_dot(b, s->seen_rate);
    const double more =
        d->hoop_part * rate + part * (vec3_dot(d->hoop, s->seen_rate) + vec3_dot(b, d->seen_rate));
    return vec3_axpy(vec3_scale(more, b), part * rate, d->hoop);
}
#endif

/* d offset, of a shape whose normal turns with it. */
static struct vec3 offset_along(const struct turning_slopes *s, const struct turning_motion *change,
                                struct geometry_change *d)
{
#ifndef CONTACT_NO_CAPS
    if (contact_is_rim(&s->shape)) {
        return rim_offset_along(s, change, d);
    }
#endif
    if (!contact_is_cylinder(&s->shape)) {
        return change->separation;
    }
    const struct vec3 axis = s->shape.axis;
    const double axial = vec3_dot(change->separation, axis) + vec3_dot(s->motion.separation, d->axis);
    return vec3_axpy(vec3_axpy(change->separation, -axial, axis), -s->geometry.axial, d->axis);
}

static struct geometry_change geometry_along(const struct turning_slopes *s,
                                             const struct turning_motion *change)
{
    const struct vec3 n = s->geometry.normal;
    const struct turning_motion *at = &s->motion;
    struct geometry_change d;
    d.axis = contact_is_upside_down(&s->shape) ? vec3_scale(-1.0, change->axis) : change->axis;
    if (contact_is_plane(&s->shape)) {
        d.normal = vec3_scale(-1.0, d.axis);
        d.distance = vec3_dot(n, change->separation) + vec3_dot(d.normal, at->separation);
    } else {
        const struct vec3 offset = offset_along(s, change, &d);
        d.distance = vec3_dot(n, offset);
        d.normal = vec3_scale(s->inverse_distance, vec3_axpy(offset, -d.distance, n));
    }
    d.seen_rate = vec3_sub(vec3_sub(change->rate, vec3_cross(change->destination_rotation, at->separation)),
                           vec3_cross(at->destination_rotation, change->separation));
    d.along = vec3_dot(d.normal, s->seen_rate) + vec3_dot(n, d.seen_rate);
    d.tangential = vec3_axpy(vec3_axpy(d.seen_rate, -vec3_dot(n, s->seen_rate), d.normal), -d.along, n);
    return d;
}

/* n' = across / d + omega_d x n */
static struct vec3 normal_rate_along(const struct turning_slopes *s, const struct turning_motion *change,
                                     const struct geometry_change *d)
{
    const struct vec3 turned = vec3_add(vec3_cross(change->destination_rotation, s->geometry.normal),
                                        vec3_cross(s->motion.destination_rotation, d->normal));
    if (contact_is_plane(&s->shape)) {
        return turned;
    }
    struct vec3 across = d->tangential;
    if (contact_is_cylinder(&s->shape)) {
        const struct vec3 axis = s->shape.axis;
        const double axial = vec3_dot(d->axis, s->seen_rate) + vec3_dot(axis, d->seen_rate);
        across = vec3_axpy(vec3_axpy(across, -vec3_dot(axis, s->seen_rate), d->axis), -axial, axis);
    }
#ifndef CONTACT_NO_CAPS
    if (contact_is_rim(&s->shape)) {
        across = vec3_sub(across, hoop_along(s, d));
    }
#endif
    across = vec3_axpy(across, -d->distance * s->inverse_distance, s->across);
    return vec3_axpy(turned, s->inverse_distance, across);
}

static struct vec3 slip_along(const struct turning_slopes *s, const struct turning_motion *change,
                              const struct geometry_change *d)
{
    const double lever = s->shape.source_radius * s->shape.side;
    const struct vec3 spin = vec3_sub(s->motion.source_rotation, s->motion.destination_rotation);
    const struct vec3 more_spin = vec3_sub(change->source_rotation, change->destination_rotation);
    const struct vec3 rolled =
        vec3_add(vec3_cross(more_spin, s->geometry.normal), vec3_cross(spin, d->normal));
    return vec3_sub(vec3_scale(lever, rolled), d->tangential);
}

static struct vec3 by_friction_state(const struct friction_slopes *slopes, double normal_force,
                                     struct vec3 slip, struct vec3 spring)
{
    struct friction_slopes m = *slopes;
    const struct vec3 by_motion = vec3_add(matrix_times(m.by_slip, slip), matrix_times(m.by_spring, spring));
    return vec3_axpy(by_motion, normal_force, m.by_normal_force);
}

struct turning_change turning_slopes_along(const struct turning_slopes *s,
                                           const struct turning_motion *change)
{
    const struct geometry_change d = geometry_along(s, change);
    const double side = s->shape.side;
    const double gap = side * d.distance;
    const double gap_rate = side * d.along;
    const double normal_force = s->normal_slopes.by_gap * gap + s->normal_slopes.by_rate * gap_rate;
    const struct vec3 slip = slip_along(s, change, &d);
    const struct vec3 friction = by_friction_state(&s->force_slopes, normal_force, slip, change->spring);

    struct turning_change out;
    const struct vec3 n = s->geometry.normal;
    out.force = vec3_axpy(vec3_axpy(friction, -side * normal_force, n), -side * s->normal_force, d.normal);

    const double lever = s->shape.source_radius * side;
    const struct vec3 arm = vec3_scale(lever, n);
    const struct vec3 more_arm = vec3_scale(lever, d.normal);
    out.source_torque = vec3_add(vec3_cross(more_arm, s->force), vec3_cross(arm, out.force));
    out.destination_torque = vec3_add(vec3_cross(vec3_sub(change->separation, more_arm), s->force),
                                      vec3_cross(vec3_sub(s->motion.separation, arm), out.force));

    const struct vec3 spring = s->motion.spring;
    const struct vec3 normal_rate = normal_rate_along(s, change, &d);
    const double tilted = vec3_dot(change->spring, s->normal_rate) + vec3_dot(spring, normal_rate);
    out.spring_rate = by_friction_state(&s->spring_slopes, normal_force, slip, change->spring);
    out.spring_rate = vec3_axpy(out.spring_rate, -vec3_dot(spring, s->normal_rate), d.normal);
    out.spring_rate = vec3_axpy(out.spring_rate, -tilted, n);

    out.dissipated_power = -(normal_force + s->bend * gap) * s->geometry.gap_rate -
                           (s->normal_force + s->stored_slope) * gap_rate;
    out.friction_power = -vec3_dot(friction, s->slip) - vec3_dot(s->friction_force, slip);
    return out;
}
