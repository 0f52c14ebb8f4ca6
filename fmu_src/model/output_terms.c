#include "model/output_terms.h"

#include "contact/zone.h"
#include "model/motion.h"
#include "scene/present.h"
#include "scene/turning_jet.h"

#if SCENE_ANY_TURNING
/* Of the vectors that only contacts which turn or rub have. */
static struct vec3 turning_term(const struct scene_jet *along, const struct variable *variable, int order)
{
    const int j = variable->element;
    const struct turning_jet *turning = &along->turning[j];
    switch (variable->row) {
    case ROW_contact_friction_force:
        return turning->friction_force[order];
    case ROW_contact_slip_velocity:
        return turning->slip[order];
    case ROW_contact_source_point:
        return vec3_add(along->displacement[contact_source(j)][order], turning->source_arm[order]);
    case ROW_contact_source_torque:
        return turning->source_torque[order];
    case ROW_contact_destination_torque:
        return turning->destination_torque[order];
    default:
        return vec3_make(0.0, 0.0, 0.0);
    }
}

static double quaternion_component(struct quaternion a, int index)
{
    return index == 0 ? a.w : vec3_get(quaternion_vector(a), index - 1);
}
#endif

/* d as users see it: of a capped cylinder from its axis, whichever zone is met. */
static double distance_term(const struct scene_values *v, const struct contact_shape *shape,
                            const struct scene_instant *at, const struct scene_jet *along, int contact,
                            int order)
{
#if SCENE_ANY_CAPS
    if (contact_is_capped(shape)) {
        const int destination = contact_destination(contact);
        struct vec3 c[JET_TERMS] = {at->separation[contact]};
        struct vec3 axis[JET_TERMS] = {shape->solid.axis};
        double rho[JET_TERMS];
        for (int i = 1; i < JET_TERMS; ++i) {
            c[i] = vec3_sub(along->displacement[destination][i],
                            along->displacement[contact_source(contact)][i]);
#if SCENE_ANY_TURNING
            axis[i] = body_turns(v, destination) ? along->axis[destination][i] : axis[i];
#endif
        }
        contact_axis_distance(c, axis, rho);
        return rho[order];
    }
#endif
    (void)v, (void)shape, (void)at;
    return along->contact[contact].distance[order];
}

static double contact_term(const struct model *m, const struct scene_instant *at,
                           const struct scene_jet *along, const struct variable *variable, int order)
{
    const struct scene_values *v = &m->state.values;
    const int j = variable->element;
    const struct contact_shape shape = scene_shape_met(v, &m->state.motion, at, j);
    const struct contact_jet *contact = &along->contact[j];
    struct vec3 vector = {0.0, 0.0, 0.0};
    switch (variable->row) {
    case ROW_contact_gap:
        return scene_shown_within(v, &m->state.motion, at, j, &shape) ? contact->gap[order] : 0.0;
    case ROW_contact_gap_rate:
        return scene_shown_within(v, &m->state.motion, at, j, &shape) ? contact->gap_rate[order] : 0.0;
    case ROW_contact_distance:
        return distance_term(v, &shape, at, along, j, order);
    case ROW_contact_normal_force:
        return contact->normal_force[order];
    case ROW_contact_direction: {
        const struct contact_geometry turned = {.normal = contact->normal[order]};
        vector = contact_direction_of(&shape, &turned);
        break;
    }
    case ROW_contact_source_force:
        vector = contact->source_force[order];
        break;
    case ROW_contact_destination_force:
        vector = vec3_scale(-1.0, contact->source_force[order]);
        break;
    case ROW_contact_point: { /* x_src + (d - r_d) n */
        const double radius = shape.other_radius;
        vector = vec3_add(along->displacement[contact_source(j)][order],
                          jet_scale(contact->distance, contact->normal, order));
        vector = vec3_axpy(vector, -radius, contact->normal[order]);
        break;
    }
    default:
#if SCENE_ANY_TURNING
        vector = turning_term(along, variable, order);
#endif
        break;
    }
    return vec3_get(vector, variable->component);
}

double output_term(const struct model *m, const struct scene_instant *at, const struct scene_jet *along,
                   const struct variable *variable, int order)
{
    switch (variable->row) {
    case ROW_body_displacement:
    case ROW_body_position:
        return vec3_get(along->displacement[variable->element][order], variable->component);
    case ROW_body_velocity:
        return vec3_get(along->velocity[variable->element][order], variable->component);
#if SCENE_ANY_TURNING
    case ROW_body_angular_velocity:
        return vec3_get(along->angular_velocity[variable->element][order], variable->component);
    case ROW_body_current_axis:
        return vec3_get(along->axis[variable->element][order], variable->component);
    case ROW_body_orientation:
        return quaternion_component(along->orientation[variable->element][order], variable->component);
#endif
    default:
        break;
    }
    double term = 0.0;
    return motion_jet(m, at, along, variable, order, &term) ? term
                                                            : contact_term(m, at, along, variable, order);
}
