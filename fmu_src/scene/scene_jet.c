#include <string.h>

#include "contact/slopes.h"
#include "math/series.h"
#include "scene/evaluate.h"
#include "scene/scene_jet.h"

/* Puts the terms of the vector a as the quaternion q of unit length turns it (quaternion_rotate). */
static void put_turned(int terms, const struct quaternion q[JET_TERMS], const struct vec3 a[JET_TERMS],
                       struct vec3 turned[JET_TERMS])
{
    struct vec3 v[JET_TERMS], across[JET_TERMS];
    double w[JET_TERMS];
    for (int i = 0; i < terms; ++i) {
        v[i] = quaternion_vector(q[i]);
        w[i] = q[i].w;
        across[i] = jet_cross(v, a, i);
        const struct vec3 moved = vec3_add(jet_scale(w, across, i), jet_cross(v, across, i));
        turned[i] = vec3_axpy(a[i], 2.0, moved);
    }
}

void jet_begin(const struct scene_instant *at, struct scene_jet *along)
{
    memset(along, 0, sizeof *along);
    along->terms = JET_TERMS;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        along->displacement[i][0] = at->displacement[i];
        along->velocity[i][0] = at->velocity[i];
        if (scene_turns(at->v)) {
            along->angular_velocity[i][0] = at->turning.body[i].angular_velocity;
            along->orientation[i][0] = at->turning.body[i].orientation;
        }
    }
}

void jet_axis_of(const struct scene_jet *along, int body, struct vec3 axis[JET_TERMS])
{
    const struct vec3 z[JET_TERMS] = {{0.0, 0.0, 1.0}};
    put_turned(along->terms, along->orientation[body], z, axis);
}

/* Puts the terms of the lever arms R o of compound bodies at both ends of a contact, and adds those by which
 * they change the separation c and its rate w; w[i] takes those of omega x R o. The orientations and angular
 * velocities of `along` must be set. */
static void add_levers(const struct scene_jet *along, int contact, struct vec3 c[JET_TERMS],
                       struct vec3 w[JET_TERMS], struct vec3 lever[2][JET_TERMS])
{
    for (int end = 0; SCENE_ANY_COMPOUND && end < 2; ++end) {
        const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
        const double sign = end == 0 ? -1.0 : 1.0;
        const struct vec3 part[JET_TERMS] = {end == 0 ? contact_source_part(contact)
                                                      : contact_destination_part(contact)};
        put_turned(JET_TERMS, along->orientation[body], part, lever[end]);
        for (int i = 0; i < JET_TERMS; ++i) {
            c[i] = vec3_axpy(c[i], sign, lever[end][i]);
            w[i] = vec3_axpy(w[i], sign, jet_cross(along->angular_velocity[body], lever[end], i));
        }
    }
}

/* The jets on which a contact's geometry and force depend: c, w, the rate of c as the destination sees it,
 * the rotations of both bodies, the axis of the shape. */
struct contact_path {
    struct vec3 c[JET_TERMS], w[JET_TERMS], seen[JET_TERMS];
    const struct vec3 *source, *destination; /* angular velocities */
    struct vec3 axis[JET_TERMS];
    struct vec3 lever[2][JET_TERMS]; /* R o of compounds at source and destination (scene_lever) */
    int terms;                       /* number of terms that are wanted */
};

static struct contact_path path_of(const struct scene_instant *at, const struct scene_jet *along,
                                   const struct contact_shape *shape, int contact)
{
    const int from = contact_source(contact);
    const int to = contact_destination(contact);
    struct contact_path path;
    memset(&path, 0, sizeof path);
    path.source = along->angular_velocity[from];
    path.destination = along->angular_velocity[to];
    path.terms = along->terms;
    for (int i = 1; i < path.terms; ++i) {
        path.c[i] = vec3_sub(along->displacement[to][i], along->displacement[from][i]);
        path.w[i] = vec3_sub(along->velocity[to][i], along->velocity[from][i]);
    }
    add_levers(along, contact, path.c, path.w, path.lever);
    path.c[0] = at->separation[contact];
    path.w[0] = at->rate[contact];
    if (SCENE_ANY_AXIS) {
        path.axis[0] = shape->axis;
    }
    memcpy(path.seen, path.w, sizeof path.seen);
    if (contact_tips(at->v, contact)) {
        /* a shape's axis is opposite to the body's at a capped cylinder's end to which -e_d points */
        const double sign = contact_is_capped(shape) && shape->solid.zone < 0 ? -1.0 : 1.0;
        jet_axis_of(along, to, path.axis);
        for (int i = 0; i < path.terms; ++i) {
            path.axis[i] = vec3_scale(sign, path.axis[i]);
        }
    }
    const bool turns = scene_turns(at->v) && !contact_is_skew(shape);
    for (int i = 0; turns && i < path.terms; ++i) {
        path.seen[i] = vec3_sub(path.w[i], jet_cross(path.destination, path.c, i));
    }
    return path;
}

/* Sets the wanted Taylor coefficients of the offset d n, but for the first one. The offset is c itself, the
 * part of c across a cylinder's axis, or the vector to the nearest point of a circle, which is
 * (rho - R) a - (height - h) e. The unit vector a points to the axis, rho a = c - (c.e) e, height = -c.e,
 * h = L/2, and e points out of the cylinder at the rim's end. */
static void put_offset(const struct contact_shape *shape, const struct contact_path *path,
                       struct vec3 offset[JET_TERMS])
{
    struct vec3 across[JET_TERMS];
    double axial[JET_TERMS], rho[JET_TERMS];
    memcpy(&offset[1], &path->c[1], 2 * sizeof offset[1]);
    if (!contact_is_cylinder(shape) && !contact_is_circle(shape)) {
        return;
    }
    jet_across(path->terms, path->c, path->axis, across, axial);
    memcpy(&offset[1], &across[1], (size_t)(path->terms - 1) * sizeof offset[1]);
    if (contact_is_circle(shape)) {
        struct vec3 to_axis[JET_TERMS];
        jet_direction(path->terms, across, rho, to_axis);
        rho[0] -= shape->solid.radius;
        axial[0] += shape->solid.half_height;
        for (int i = 1; i < path->terms; ++i) {
            offset[i] = vec3_add(jet_scale(rho, to_axis, i), jet_scale(axial, path->axis, i));
        }
    }
}

/* Sets the terms of d and n, the length and the direction of the offset. A plane has n = -e, and where d = 0
 * n is constant; both have d' = (n.c)'. */
static void put_distance(const struct contact_shape *shape, const struct contact_geometry *g,
                         const struct contact_path *path, struct contact_jet *jet)
{
    struct vec3 offset[JET_TERMS] = {g->offset};
    if (contact_turns(shape, g)) {
        put_offset(shape, path, offset);
        jet_direction(path->terms, offset, jet->distance, jet->normal);
        return;
    }
    jet->normal[0] = g->normal;
    jet->distance[0] = g->distance;
    for (int i = 1; i < path->terms; ++i) {
        jet->normal[i] = vec3_make(0.0, 0.0, 0.0);
        if (contact_is_plane(shape)) {
            jet->normal[i] = vec3_scale(-1.0, path->axis[i]);
        }
        jet->distance[i] = jet_dot(jet->normal, path->c, i);
    }
}

static void put_normal_force(const struct contact_shape *shape, const struct contact_geometry *g,
                             const struct contact_path *path, const struct contact_law *law,
                             const struct contact_law *change, enum contact_regime regime,
                             struct contact_jet *jet)
{
    for (int i = 0; i < path->terms; ++i) {
        jet->gap[i] = i > 0 ? shape->side * jet->distance[i] : g->gap;
        jet->gap_rate[i] = i > 0 ? shape->side * jet_dot(jet->normal, path->seen, i) : g->gap_rate;
        jet->normal_force[i] = contact_force_term(law, change, regime, jet->gap, jet->gap_rate, i);
        jet->source_force[i] = vec3_scale(-shape->side, jet_scale(jet->normal_force, jet->normal, i));
    }
}

/* Sets the terms of the lever arms, of the slip and of omega of a contact whose normal is known. */
static void put_slip(const struct contact_shape *shape, const struct contact_path *path,
                     const struct contact_jet *jet, struct turning_jet *turning)
{
    struct vec3 all[JET_TERMS] = {{0.0, 0.0, 0.0}};
    for (int i = 0; i < path->terms; ++i) {
        const struct vec3 foot = i == 0 ? contact_foot(shape, shape->solid.zone, path->c[0])
                                        : contact_foot_along(shape, path->c[i]);
        turning->source_arm[i] = contact_source_arm(shape, jet->normal[i], foot);
        turning->destination_arm[i] = vec3_sub(turning->source_arm[i], path->c[i]);
        const struct vec3 past = vec3_sub(jet_cross(path->source, turning->source_arm, i),
                                          jet_cross(path->destination, turning->destination_arm, i));
        all[i] = vec3_sub(past, path->w[i]);
        turning->spin[i] = vec3_sub(path->source[i], path->destination[i]);
    }
    opposed_laid_terms(OPPOSED_SLIP, path->terms, all, jet->normal, turning->motion[OPPOSED_SLIP]);
    for (int i = 0; SCENE_ANY_COMPOUND && i < path->terms; ++i) { /* the arms began at the spheres' centres */
        turning->source_arm[i] = vec3_add(turning->source_arm[i], path->lever[0][i]);
        turning->destination_arm[i] = vec3_add(turning->destination_arm[i], path->lever[1][i]);
    }
}

/* Returns the arguments of the law that opposes a motion along the path. Where the inputs jump, the spring
 * before the jump is laid anew. */
static struct friction_path friction_path_of(const struct scene_instant *at, const struct scene_jet *along,
                                             int contact, int part)
{
    const struct contact_jet *jet = &along->contact[contact];
    struct friction_path path = {.terms = along->terms,
                                 .slip_velocity_slope =
                                     part == OPPOSED_SLIP ? along->slip_velocity_slope[contact] : 0.0};
    memcpy(path.normal_force, jet->normal_force, sizeof path.normal_force);
    memcpy(path.slip, along->turning[contact].motion[part], sizeof path.slip);
    memcpy(path.spring, along->spring[contact][part], sizeof path.spring);
    path.spring[0] = at->turning.spring[contact][part];
    for (int i = 0; i < JET_TERMS; ++i) {
        path.depth[i] = -jet->gap[i];
    }
    if (along->spring_before != NULL) {
        const struct vec3 before[JET_TERMS] = {along->spring_before[contact][part]};
        struct vec3 laid[JET_TERMS];
        opposed_laid_terms((enum opposed)part, path.terms, before, jet->normal, laid);
        path.spring[1] = vec3_add(path.spring[1], laid[1]);
    }
    return path;
}

/* Sets the terms of the opposed motions, of the forces and torques that oppose them, and of the energy that
 * their springs store. */
static void put_friction(const struct scene_instant *at, int contact, struct scene_jet *along)
{
    const struct scene_state *q = at->q;
    struct contact_jet *jet = &along->contact[contact];
    struct turning_jet *turning = &along->turning[contact];
    const bool rubs = contact_rubs(q->v, contact) && q->contact[contact].regime != (int32_t)REGIME_APART;
    for (int part = 0; SCENE_ANY_FRICTION && rubs && part < contact_opposed(q->v, contact); ++part) {
        const bool slips = part == OPPOSED_SLIP;
        struct vec3 *sum = slips ? turning->friction_force : turning->resistance;
        struct vec3 force[JET_TERMS];
        double stored[JET_TERMS];
        if (!slips) {
            opposed_laid_terms((enum opposed)part, along->terms, turning->spin, jet->normal,
                               turning->motion[part]);
        }
        const struct friction_law law = scene_friction_law(q, contact, part);
        const enum friction_regime regime = (enum friction_regime)q->contact[contact].friction_regime[part];
        const struct friction_path path = friction_path_of(at, along, contact, part);
        friction_force_terms(&law, regime, &path, force);
        friction_stored_terms(&law, regime, &path, stored);
        for (int i = 0; i < along->terms; ++i) {
            sum[i] = vec3_add(sum[i], force[i]);
            turning->stored[i] += stored[i];
            jet->source_force[i] = slips ? vec3_add(jet->source_force[i], force[i]) : jet->source_force[i];
        }
    }
}

/* Sets the terms of what rotation and friction add to the jet of the normal force. */
static void put_turning(const struct scene_instant *at, const struct contact_shape *shape,
                        const struct contact_path *path, int contact, struct scene_jet *along)
{
    struct contact_jet *jet = &along->contact[contact];
    struct turning_jet *turning = &along->turning[contact];
    memset(turning, 0, sizeof *turning);
    put_slip(shape, path, jet, turning);
    put_friction(at, contact, along);
    for (int i = 0; i < path->terms; ++i) {
        turning->source_torque[i] = jet_cross(turning->source_arm, jet->source_force, i);
        turning->destination_torque[i] = jet_cross(jet->source_force, turning->destination_arm, i);
        if (contact_resists(at->v, contact)) {
            const struct vec3 resistance = turning->resistance[i];
            turning->source_torque[i] = vec3_add(turning->source_torque[i], resistance);
            turning->destination_torque[i] = vec3_sub(turning->destination_torque[i], resistance);
        }
    }
}

void jet_of_contact(const struct scene_instant *at, int contact, bool rubs, struct scene_jet *along)
{
    const enum contact_regime regime = (enum contact_regime)at->q->contact[contact].regime;
    const struct contact_shape shape = scene_shape_met(at, contact);
    const struct contact_law law = scene_contact_law(at->q, contact);
    const struct contact_path path = path_of(at, along, &shape, contact);
    memcpy(along->contact[contact].separation, path.c, sizeof path.c);
    if (SCENE_ANY_CAPS) {
        memcpy(along->contact[contact].axis, path.axis, sizeof path.axis);
    }
    put_distance(&shape, &at->geometry[contact], &path, &along->contact[contact]);
    put_normal_force(&shape, &at->geometry[contact], &path, &law, &along->law_slope[contact], regime,
                     &along->contact[contact]);
    if (SCENE_ANY_TURNING && rubs) {
        put_turning(at, &shape, &path, contact, along);
    }
}

void jet_of_contacts(const struct scene_instant *at, const bool *met, bool rubs, struct scene_jet *along)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!(along->touching && at->q->contact[j].regime == (int32_t)REGIME_APART) && (!met || met[j])) {
            jet_of_contact(at, j, rubs, along);
        }
    }
}

/* Puts the orientation's terms from the angular velocity: q' = (0, omega) q / 2. */
static void put_orientation(const struct vec3 omega[2], struct quaternion q[JET_TERMS])
{
    q[1] = quaternion_rate(q[0], omega[0]);
    q[2] = quaternion_scale(
        0.5, quaternion_axpy(quaternion_rate(q[0], omega[1]), 1.0, quaternion_rate(q[1], omega[0])));
}

/* Puts the terms of a prescribed rotation. An axis that follows a path of its own, a polynomial that need not
 * have unit length, turns by e x e', and the body spins about it. */
static void put_prescribed(const struct scene_instant *at, int body, struct scene_jet *along)
{
    struct body_path path = at->q->path[body];
    struct vec3 *omega = along->angular_velocity[body];
    struct vec3 e[JET_TERMS] = {quaternion_third_axis(along->orientation[body][0])};
    omega[2] = path.angular_velocity[2];
    struct vec3 seen[2] = {omega[0], omega[1]};
    if (path.turn_follows != TURN_FOLLOWS_VELOCITY && body_has_axis(body)) {
        double length[JET_TERMS];
        struct vec3 unit[JET_TERMS];
        body_path_shift(at->v, body, &path, at->clock);
        jet_direction(JET_TERMS, path.axis, length, unit);
        if (length[0] > 0.0) {
            memcpy(&e[1], &unit[1], 2 * sizeof e[1]);
        }
        const struct vec3 rate[2] = {e[1], vec3_scale(2.0, e[2])};
        const double spin[2] = {jet_dot(omega, e, 0), jet_dot(omega, e, 1)};
        for (int i = 0; i < 2; ++i) {
            seen[i] = vec3_add(jet_cross(e, rate, i), jet_scale(spin, e, i));
        }
    }
    put_orientation(seen, along->orientation[body]);
}

/* Sets the rotations of the bodies in time and the rates of the springs from the instant. The second
 * derivative of the angular velocity of a body that turns freely follows by put_turning_changes. */
static void put_turning_bodies(const struct scene_instant *at, struct scene_jet *along)
{
    for (int i = 0; SCENE_ANY_ROTATION && i < SCENE_BODIES; ++i) {
        along->angular_velocity[i][1] = turning_acceleration(at, i);
        if (body_turn_is_prescribed(at->v, i)) {
            put_prescribed(at, i, along);
        } else if (body_turns_freely(at->v, i)) {
            const struct body_path *path = &at->q->path[i];
            along->torque[i] = path_slope(path->torque, at->clock);
            put_orientation(along->angular_velocity[i], along->orientation[i]);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        for (int i = 0; i < OPPOSED; ++i) {
            if (contact_has_spring(at->v, j, i)) {
                along->spring[j][i][0] = at->turning.spring[j][i];
                along->spring[j][i][1] = turning_spring_rate(at, j, i);
            }
        }
    }
}

/* Puts the bodies' terms from their velocities and accelerations. */
static void put_bodies(const struct scene_instant *at, struct scene_jet *along)
{
    jet_begin(at, along);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        along->displacement[i][1] = at->velocity[i];
        along->displacement[i][2] = vec3_scale(0.5, at->acceleration[i]);
        along->velocity[i][1] = at->acceleration[i];
        along->velocity[i][2] = at->q->path[i].velocity[2];
    }
    if (scene_turns(at->v)) {
        put_turning_bodies(at, along);
    }
}

struct contact_load jet_load_on(const struct scene_jet *along, int body, int order)
{
    struct contact_load sum = {.force = {0.0, 0.0, 0.0}};
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        contact_load_add(j, body, along->contact[j].source_force[order],
                         along->turning[j].source_torque[order], along->turning[j].destination_torque[order],
                         &sum);
    }
    return sum;
}

struct vec3 free_bodies_half_jerk(const struct scene_values *v, const struct scene_jet *along, int body)
{
    const struct vec3 force = vec3_add(along->force[body], jet_load_on(along, body, 1).force);
    return vec3_scale(0.5 / body_mass(v, body), force);
}

struct scene_powers jet_powers_of_contact(const struct scene_state *q, const struct scene_jet *along,
                                          int contact, int order)
{
    const struct scene_values *v = q->v;
    const struct contact_jet *jet = &along->contact[contact];
    const struct turning_jet *turning = &along->turning[contact];
    const struct contact_law law = scene_contact_law(q, contact);
    struct scene_powers sum = {0.0, 0.0, 0.0};
    for (int end = 0; end < 2; ++end) {
        const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
        if (body_is_prescribed(v, body)) {
            const double given = jet_dot(jet->source_force, along->velocity[body], order);
            sum.external += end == 0 ? -given : given;
        }
        if (SCENE_ANY_ROTATION && scene_turns(v) && body_turn_is_prescribed(v, body)) {
            const struct vec3 *torque = end == 0 ? turning->source_torque : turning->destination_torque;
            sum.external -= jet_dot(torque, along->angular_velocity[body], order);
        }
    }
    sum.dissipated = contact_dissipated_term(&law, (enum contact_regime)q->contact[contact].regime,
                                             jet->normal_force, jet->gap, jet->gap_rate, order);
    if (contact_rubs(v, contact)) {
        sum.friction -= jet_dot(turning->friction_force, turning->motion[OPPOSED_SLIP], order);
    }
    if (contact_resists(v, contact)) {
        sum.friction -= jet_dot(turning->resistance, turning->spin, order);
    }
    return sum;
}

struct scene_powers jet_powers_of(const struct scene_instant *at, const struct scene_jet *along, int order)
{
    const struct scene_values *v = at->v;
    const struct body_path *path = at->q->path;
    struct scene_powers sum = {0.0, 0.0, 0.0};
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const struct vec3 force[2] = {path_at(path[i].force, 3, at->clock), along->force[i]};
            sum.external += jet_dot(force, along->velocity[i], order);
        }
        if (SCENE_ANY_ROTATION && scene_turns(v) && body_turns_freely(v, i)) {
            const struct vec3 torque[2] = {path_at(path[i].torque, 3, at->clock), along->torque[i]};
            sum.external += jet_dot(torque, along->angular_velocity[i], order);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct scene_powers of = jet_powers_of_contact(at->q, along, j, order);
        sum.dissipated += of.dissipated;
        sum.external += of.external;
        sum.friction += of.friction;
    }
    return sum;
}

/* Puts the first terms of R diag(d) R^T a, where the quaternion q turns the frame of a body into the world's
 * by R. */
static void put_along_axes(const struct quaternion q[JET_TERMS], struct vec3 d, const struct vec3 *a,
                           int terms, struct vec3 *sum)
{
    struct quaternion back[JET_TERMS] = {{0.0, 0.0, 0.0, 0.0}};
    struct vec3 in_body[JET_TERMS];
    for (int i = 0; i < terms; ++i) {
        back[i] = quaternion_inverse(q[i]);
    }
    put_turned(terms, back, a, in_body);
    for (int i = 0; i < terms; ++i) {
        in_body[i] = vec3_make(d.x * in_body[i].x, d.y * in_body[i].y, d.z * in_body[i].z);
    }
    put_turned(terms, q, in_body, sum);
}

/* The angular acceleration is omega' = R diag(1/I) R^T (tau - omega x L), where L = R diag(I) R^T omega with
 * the moments of inertia I. */
struct vec3 turning_jet_half_jerk(const struct scene_instant *at, const struct scene_jet *along, int body)
{
    struct vec3 momentum[2], faster[2];
    struct vec3 by[2] = {turning_torque_on(at, body), along->torque[body]};
    const struct vec3 *omega = along->angular_velocity[body];
    const struct vec3 inertia = body_inertia_of(at->v, body);
    by[1] = body_part_that_turns(at->v, body, vec3_add(by[1], jet_load_on(along, body, 1).torque));
    put_along_axes(along->orientation[body], inertia, omega, 2, momentum);
    for (int i = 0; i < 2; ++i) {
        by[i] = vec3_sub(by[i], jet_cross(omega, momentum, i));
    }
    put_along_axes(along->orientation[body], vec3_make(1.0 / inertia.x, 1.0 / inertia.y, 1.0 / inertia.z), by,
                   2, faster);
    return vec3_scale(0.5, faster[1]);
}

/* Sets n' = T w_g / d + omega_d x n and its change along the path (contact_turning_part). */
static void put_normal_rate(const struct contact_shape *shape, const struct contact_geometry *g,
                            const struct contact_path *path, const struct contact_jet *jet,
                            struct vec3 rate[2])
{
    struct vec3 moved[JET_TERMS], across[JET_TERMS]; /* the rate of the offset, and its part across n */
    double along[JET_TERMS], rho[JET_TERMS];
    for (int i = 0; i < 2; ++i) {
        moved[i] = path->seen[i];
        rate[i] =
            contact_is_skew(shape) ? vec3_make(0.0, 0.0, 0.0) : jet_cross(path->destination, jet->normal, i);
    }
    if (!contact_turns(shape, g)) {
        return;
    }
    if (contact_is_cylinder(shape)) {
        jet_across(2, path->seen, path->axis, moved, along);
    } else if (contact_is_circle(shape)) { /* the nearest point moves along the circle */
        struct vec3 radial[JET_TERMS], to_axis[JET_TERMS];
        double shared[2];
        jet_across(path->terms, path->c, path->axis, radial, along);
        jet_direction(path->terms, radial, rho, to_axis);
        const double part[2] = {g->circumferential_part, -g->circumferential_part * rho[1] / rho[0]};
        const struct vec3 b[2] = {jet_cross(path->axis, to_axis, 0), jet_cross(path->axis, to_axis, 1)};
        for (int i = 0; i < 2; ++i) {
            along[i] = jet_dot(b, path->seen, i);
            shared[i] = taylor_multiply(part, along, i);
            moved[i] = vec3_sub(moved[i], jet_scale(shared, b, i));
        }
    }
    jet_across(2, moved, jet->normal, across, along);
    const struct vec3 turned = vec3_scale(1.0 / g->distance, across[0]);
    rate[0] = vec3_add(rate[0], turned);
    rate[1] = vec3_axpy(rate[1], 1.0 / g->distance, vec3_axpy(across[1], -jet->distance[1], turned));
}

/* xi' is the sum of the law's rate f(F_n, v_t, xi) and opposed_turned. */
struct vec3 turning_jet_spring_change(const struct scene_instant *at, const struct scene_jet *along,
                                      int contact, int part)
{
    const struct friction_law law = scene_friction_law(at->q, contact, part);
    const enum friction_regime regime = (enum friction_regime)at->q->contact[contact].friction_regime[part];
    const struct contact_jet *jet = &along->contact[contact];
    struct vec3 rate[2];
    if (at->q->contact[contact].regime == (int32_t)REGIME_APART) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    const struct friction_path rubbing = friction_path_of(at, along, contact, part);
    const struct contact_shape shape = scene_shape_met(at, contact);
    const struct contact_path path = path_of(at, along, &shape, contact);
    put_normal_rate(&shape, &at->geometry[contact], &path, jet, rate);
    struct vec3 sum = friction_spring_rate_change(&law, regime, &rubbing);
    /* opposed_turned is linear in each of its three vectors, of which one changes at a time */
    for (int i = 0; i < 3; ++i) {
        sum = vec3_add(sum, opposed_turned((enum opposed)part, rubbing.spring[i == 0], jet->normal[i == 1],
                                           rate[i == 2]));
    }
    return sum;
}

/* Sets the second-order terms of rotations and springs from contacts known to the first order; without `all`
 * only the rotations that move a gap. */
static void put_turning_changes(const struct scene_instant *at, bool all, struct scene_jet *along)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_turns_freely(at->v, i) && (all || body_has_axis(i) || body_is_compound(i))) {
            along->angular_velocity[i][2] = turning_jet_half_jerk(at, along, i);
        }
    }
    for (int j = 0; all && j < SCENE_CONTACTS; ++j) {
        for (int i = 0; i < OPPOSED && at->q->contact[j].regime != (int32_t)REGIME_APART; ++i) {
            if (contact_has_spring(at->v, j, i)) {
                along->spring[j][i][2] = vec3_scale(0.5, turning_jet_spring_change(at, along, j, i));
            }
        }
    }
}

/* Puts the contacts' terms. The forces then give the coefficients 2 of the free bodies' velocities and of
 * rotations, on which the coefficients 2 of the contacts depend; therefore the contacts' terms are put
 * again: all of them, or those of the normal forces in `met`. */
static void put_contacts(const struct scene_instant *at, const bool *met, struct scene_jet *along)
{
    const bool all = met == NULL;
    const bool moves = !scene_is_force_element(at->v);
    jet_of_contacts(at, moves ? NULL : met, all || (moves && scene_turns(at->v)), along);
    if (scene_turns(at->v)) {
        put_turning_changes(at, all, along);
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(at->v, i)) {
            along->force[i] = path_slope(at->q->path[i].force, at->clock);
            along->velocity[i][2] = free_bodies_half_jerk(at->v, along, i);
        }
    }
    if (moves || (all && scene_turns(at->v))) {
        jet_of_contacts(at, met, all, along);
    }
}

void jet_in_time(const struct scene_instant *at, struct scene_jet *along)
{
    put_bodies(at, along);
    put_contacts(at, NULL, along);
    along->time[1] = SCENE_ANY_FREE ? 1.0 : 0.0;
    for (int i = 1; SCENE_ANY_FREE && i < JET_TERMS; ++i) {
        const struct scene_powers power = jet_powers_of(at, along, i - 1);
        along->dissipated[i] = power.dissipated / i;
        along->external_work[i] = power.external / i;
        along->friction[i] = power.friction / i;
    }
}

void jet_of_motion(const struct scene_instant *at, const bool *met, struct scene_jet *along)
{
    put_bodies(at, along);
    along->touching = true;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_prescribed(at->v, i)) {
            struct body_path path = at->q->path[i];
            body_path_shift(at->v, i, &path, at->clock);
            memcpy(&along->displacement[i][1], &path.displacement[1], 2 * sizeof path.displacement[1]);
        }
    }
    put_contacts(at, met, along);
}

void turning_jet_move_orientation(const struct scene_instant *at, int body, struct quaternion given,
                                  int component, double change, struct scene_jet *along)
{
    const struct quaternion unit = at->turning.body[body].orientation;
    const double length = copysign(sqrt(quaternion_dot(given, given)), quaternion_dot(given, unit));
    struct quaternion by = {component == 0, component == 1, component == 2, component == 3};
    by = quaternion_scale(change / length, quaternion_axpy(by, -quaternion_dot(by, unit), unit));
    along->orientation[body][1] = quaternion_axpy(along->orientation[body][1], 1.0, by);
}

struct scene_energies jet_energies_of(const struct scene_state *q, const struct scene_jet *along, int order)
{
    struct scene_energies sum = {0.0, 0.0, 0.0, 0.0, 0.0};
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(q->v, i)) {
            const double mass = body_mass(q->v, i);
            sum.kinetic += 0.5 * mass * jet_dot(along->velocity[i], along->velocity[i], order);
            sum.potential -= mass * vec3_dot(gravity(q->v), along->displacement[i][order]);
        }
        if (SCENE_ANY_TURNING && body_turns_freely(q->v, i)) {
            const struct vec3 *omega = along->angular_velocity[i];
            struct vec3 momentum[JET_TERMS];
            put_along_axes(along->orientation[i], body_inertia_of(q->v, i), omega, order + 1, momentum);
            sum.rotational += 0.5 * jet_dot(omega, momentum, order);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_law law = scene_contact_law(q, j);
        const enum contact_regime regime = (enum contact_regime)q->contact[j].regime;
        sum.stored += contact_stored_term(&law, &along->law_slope[j], regime, along->contact[j].gap, order);
        sum.tangential += SCENE_ANY_SPRINGS ? along->turning[j].stored[order] : 0.0;
    }
    return sum;
}
