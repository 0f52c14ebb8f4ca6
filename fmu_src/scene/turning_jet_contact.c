#include "scene/turning_jet.h"

#include <string.h>

#include "contact/friction_jet.h"

#if SCENE_ANY_TURNING

/* The motion of a contact: separation, its rate, rotations, axis; that of the shape which is met. */
struct contact_path {
    struct vec3 c[JET_TERMS], w[JET_TERMS], source[JET_TERMS], destination[JET_TERMS], axis[JET_TERMS];
};

static struct contact_path path_of(const struct scene_values *v, const struct scene_instant *at,
                                   const struct scene_jet *along, const struct contact_shape *shape,
                                   int contact)
{
    const int from = contact_source(contact);
    const int to = contact_destination(contact);
    struct contact_path path;
    memset(&path, 0, sizeof path);
    for (int i = 1; i < JET_TERMS; ++i) {
        path.c[i] = vec3_sub(along->displacement[to][i], along->displacement[from][i]);
        path.w[i] = vec3_sub(along->velocity[to][i], along->velocity[from][i]);
        path.source[i] = along->angular_velocity[from][i];
        path.destination[i] = along->angular_velocity[to][i];
        if (body_turns(v, to)) {
            path.axis[i] = along->axis[to][i];
        }
    }
    path.c[0] = at->separation[contact];
    path.w[0] = at->rate[contact];
    path.source[0] = at->turning.body[from].angular_velocity;
    path.destination[0] = at->turning.body[to].angular_velocity;
    path.axis[0] = at->turning.axis[contact];
    for (int i = 0; i < JET_TERMS && contact_is_upside_down(shape); ++i) {
        path.axis[i] = vec3_scale(-1.0, path.axis[i]);
    }
    return path;
}

/* n of the terms from 1 on, from d n = offset. */
static void put_normal(const struct vec3 offset[JET_TERMS], const double distance[JET_TERMS],
                       struct vec3 normal[JET_TERMS])
{
    for (int i = 1; i < JET_TERMS; ++i) {
        struct vec3 rest = offset[i];
        for (int k = 1; k <= i; ++k) {
            rest = vec3_axpy(rest, -distance[k], normal[i - k]);
        }
        normal[i] = vec3_scale(1.0 / distance[0], rest);
    }
}

#if SCENE_ANY_CAPS
/* Of a rim: offset = (rho - r_d) a - (height - h) e with the unit vector a to the axis, rho a = c - (c.e) e,
 * and height = -c.e, of e that points out of the rim's end. */
static void put_rim_offset(const struct contact_shape *shape, const struct contact_path *path,
                           struct vec3 offset[JET_TERMS])
{
    struct vec3 across[JET_TERMS], to_axis[JET_TERMS];
    double axial[JET_TERMS], radial[JET_TERMS], rho[JET_TERMS];
    for (int i = 0; i < JET_TERMS; ++i) {
        axial[i] = jet_dot(path->c, path->axis, i);
        across[i] = vec3_sub(path->c[i], jet_scale(axial, path->axis, i));
    }
    jet_length(across, rho);
    to_axis[0] = vec3_scale(1.0 / rho[0], across[0]);
    put_normal(across, rho, to_axis);
    for (int i = 0; i < JET_TERMS; ++i) {
        radial[i] = rho[i] - (i == 0 ? shape->solid.radius : 0.0);
        axial[i] += i == 0 ? shape->solid.half_height : 0.0;
    }
    for (int i = 1; i < JET_TERMS; ++i) {
        offset[i] = vec3_add(jet_scale(radial, to_axis, i), jet_scale(axial, path->axis, i));
    }
}
#endif

static void put_offset(const struct contact_shape *shape, const struct contact_path *path,
                       struct vec3 offset[JET_TERMS])
{
#if SCENE_ANY_CAPS
    if (contact_is_rim(shape)) {
        put_rim_offset(shape, path, offset);
        return;
    }
#endif
    for (int i = 1; i < JET_TERMS; ++i) {
        offset[i] = path->c[i];
        if (contact_is_cylinder(shape)) {
            double axial[JET_TERMS];
            for (int k = 0; k <= i; ++k) {
                axial[k] = jet_dot(path->c, path->axis, k);
            }
            offset[i] = vec3_sub(path->c[i], jet_scale(axial, path->axis, i));
        }
    }
}

/* d d = offset.d(offset), d n = offset; a plane has n = -e, d = n.c. */
static void put_distance(const struct contact_shape *shape, const struct contact_geometry *g,
                         const struct contact_path *path, struct contact_jet *jet)
{
    struct vec3 offset[JET_TERMS] = {g->offset};
    double length[JET_TERMS];
    jet->normal[0] = g->normal;
    jet->distance[0] = g->distance;
    put_offset(shape, path, offset);
    jet_length(offset, length);
    for (int i = 1; i < JET_TERMS; ++i) {
        jet->normal[i] = contact_is_plane(shape) ? vec3_scale(-1.0, path->axis[i]) : vec3_make(0.0, 0.0, 0.0);
    }
    for (int i = 1; i < JET_TERMS; ++i) {
        jet->distance[i] = contact_is_plane(shape) ? jet_dot(jet->normal, path->c, i)
                           : g->degenerate         ? 0.0
                                                   : length[i];
    }
    if (contact_turns(shape, g)) {
        put_normal(offset, jet->distance, jet->normal);
    }
}

static void put_normal_force(const struct contact_shape *shape, const struct contact_geometry *g,
                             const struct contact_path *path, const struct contact_law *law,
                             const struct contact_law *change, enum contact_regime regime,
                             struct contact_jet *jet)
{
    struct vec3 seen[JET_TERMS];
    for (int i = 0; i < JET_TERMS; ++i) {
        seen[i] = vec3_sub(path->w[i], turning_jet_cross(path->destination, path->c, i));
        jet->gap[i] = i > 0 ? shape->side * jet->distance[i] : g->gap;
        jet->gap_rate[i] = i > 0 ? shape->side * jet_dot(jet->normal, seen, i) : g->gap_rate;
        jet->normal_force[i] = contact_force_term(law, change, regime, jet->gap, jet->gap_rate, i);
        jet->source_force[i] = vec3_scale(-shape->side, jet_scale(jet->normal_force, jet->normal, i));
    }
}

/* Arms and slip, of a contact whose normal is known. */
static void put_slip(const struct contact_shape *shape, const struct contact_path *path,
                     const struct contact_jet *jet, struct turning_jet *turning)
{
    struct vec3 far[JET_TERMS];
    struct vec3 all[JET_TERMS];
    double along_normal[JET_TERMS];
    for (int i = 0; i < JET_TERMS; ++i) {
        turning->source_arm[i] = vec3_scale(shape->side * shape->source_radius, jet->normal[i]);
        far[i] = vec3_sub(turning->source_arm[i], path->c[i]);
        turning->destination_arm[i] = far[i];
        const struct vec3 past = vec3_sub(turning_jet_cross(path->source, turning->source_arm, i),
                                          turning_jet_cross(path->destination, far, i));
        all[i] = vec3_sub(past, path->w[i]);
        along_normal[i] = jet_dot(all, jet->normal, i);
        turning->slip[i] = vec3_sub(all[i], jet_scale(along_normal, jet->normal, i));
    }
}

static void put_friction(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_jet *along, int contact, struct contact_jet *jet,
                         struct turning_jet *turning)
{
    if (!contact_rubs(v, contact) || q->contact[contact].regime == (int32_t)REGIME_APART) {
        return;
    }
    const struct turning_laws laws = turning_laws_of(v, q, contact);
    struct friction_path path = {.slip_velocity_slope = along->slip_velocity_slope[contact]};
    memcpy(path.normal_force, jet->normal_force, sizeof path.normal_force);
    memcpy(path.slip, turning->slip, sizeof path.slip);
#if SCENE_ANY_FRICTION
    memcpy(path.spring, along->spring[contact], sizeof path.spring);
    path.spring[0] = q->turning.spring[contact];
    if (along->jumps) {
        path.spring[1] = vec3_axpy(path.spring[1], -vec3_dot(path.spring[0], jet->normal[1]), jet->normal[0]);
    }
#endif
    for (int i = 0; i < JET_TERMS; ++i) {
        turning->friction_force[i] = friction_force_term(&laws.friction, laws.friction_regime, &path, i);
        turning->stored[i] = friction_stored_term(&laws.friction, laws.friction_regime, &path, i);
        jet->source_force[i] = vec3_add(jet->source_force[i], turning->friction_force[i]);
    }
}

void turning_jet_of_contact(const struct scene_values *v, const struct scene_state *q,
                            const struct scene_instant *at, int contact, struct scene_jet *along)
{
    const struct contact_shape shape = scene_shape_met(v, q, at, contact);
    const struct contact_path path = path_of(v, at, along, &shape, contact);
    const struct contact_law law = scene_contact_law(v, q, contact);
    struct contact_jet *jet = &along->contact[contact];
    struct turning_jet *turning = &along->turning[contact];
    memset(turning, 0, sizeof *turning);
    if (scene_turns(v)) {
        put_distance(&shape, &at->geometry[contact], &path, jet);
        put_normal_force(&shape, &at->geometry[contact], &path, &law, &along->law_slope[contact],
                         (enum contact_regime)q->contact[contact].regime, jet);
    }
    put_slip(&shape, &path, jet, turning);
    put_friction(v, q, along, contact, jet, turning);
    for (int i = 0; i < JET_TERMS; ++i) {
        turning->source_torque[i] = turning_jet_cross(turning->source_arm, jet->source_force, i);
        turning->destination_torque[i] = turning_jet_cross(jet->source_force, turning->destination_arm, i);
    }
}

#endif
