/* The outputs: of bodies, of contacts, of what turns and rubs, and their derivatives along a path. */
#include <math.h>

#include "contact/shape.h"
#include "model/motion.h"
#include "model/report.h"
#include "scene/evaluate.h"
#include "scene/present.h"
#include "scene/scene_jet.h"

/* Derivatives of the outputs that sum up a communication step. */

bool model_has_derivatives(const struct variable *variable)
{
    return variable->row != ROW_contact_mean_force && variable->row != ROW_contact_mean_source_torque &&
           variable->row != ROW_contact_mean_destination_torque && variable->row != ROW_contact_peak_force &&
           variable->row != ROW_contact_peak_penetration;
}

/* Coefficient `order` of an output of the whole step. False: the variable is none. */
static bool step_term(const struct model *m, const struct scene_state *q, const struct scene_instant *at,
                      const struct scene_jet *along, const struct variable *variable, int order, double *term)
{
    const int j = variable->element;
    const bool touches = q->contact[j].regime != REGIME_APART;
    switch (variable->row) {
    case ROW_contact_peak_force: /* peaks are those of the start until the end of initialization */
        *term =
            !m->state.initialized && at->normal_force[j] > 0.0 ? along->contact[j].normal_force[order] : 0.0;
        return true;
    case ROW_contact_peak_penetration:
        *term = !m->state.initialized && touches ? -along->contact[j].gap[order] : 0.0;
        return true;
    case ROW_contact_mean_force:
    case ROW_contact_mean_source_torque:
    case ROW_contact_mean_destination_torque:
        *term = 0.0;
        return true;
    default:
        return false;
    }
}

/* The outputs of what turns and rubs. */

static void put_turn(struct scene_values *v, const struct turning_instant *turning, int body)
{
    const struct body_turn *turn = &turning->body[body];
    struct quaternion orientation = turn->orientation;
    struct vec3 axis = quaternion_third_axis(orientation);
    if (SCENE_ANY_ROTATION && !body_turns(v, body)) {
        orientation = turning_start_orientation(v, body);
        axis = quaternion_third_axis(orientation);
    }
    put_body_angular_velocity(v, body, turn->angular_velocity);
    put_body_orientation(v, body, orientation);
    put_body_current_axis(v, body, axis);
}

static bool sticks(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                   int contact)
{
    if (SCENE_ANY_FRICTION) {
        if (!contact_rubs(v, contact) || q->contact[contact].regime == (int32_t)REGIME_APART) {
            return false;
        }
        return contact_rubs_elastically(v, contact)
                   ? q->contact[contact].friction_regime == (int32_t)FRICTION_STICKING
                   : vec3_norm(at->turning.slip[contact]) < q->contact[contact].parameters.slip_velocity;
    }
    return false;
}

static double put_rubbing(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                          int contact)
{
    const struct turning_instant *turning = &at->turning;
    const int source = contact_source(contact);
    const struct vec3 centre = vec3_add(body_center(v, source), at->displacement[source]);
    const struct vec3 friction = turning->friction_force[contact];
    const struct vec3 force = at->source_force[contact];
    if (SCENE_ANY_FRICTION) {
        put_contact_effective_slip_velocity(v, contact, q->contact[contact].parameters.slip_velocity);
    }
    if (contact_rubs(v, contact)) {
        put_contact_source_force(v, contact, force);
        put_contact_destination_force(v, contact, vec3_scale(-1.0, force));
    }
    put_contact_sticking(v, contact, sticks(v, q, at, contact));
    put_contact_friction_force(v, contact, friction);
    put_contact_slip_velocity(v, contact, turning->slip[contact]);
    put_contact_source_point(v, contact, vec3_add(centre, turning->source_arm[contact]));
    put_contact_source_torque(v, contact, turning->source_torque[contact]);
    put_contact_destination_torque(v, contact, turning->destination_torque[contact]);
    return vec3_norm(friction) + vec3_norm(turning->slip[contact]) +
           vec3_norm(turning->source_torque[contact]) + vec3_norm(turning->destination_torque[contact]);
}

/* Shows what turns and rubs; a sum that is finite only if all of it is. */
static double show_turning(struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at)
{
    struct scene_instant known = *at;
    double sum = 0.0;
    if (!scene_turns(v)) {
        turning_complete(v, q, &known);
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        put_turn(v, &known.turning, i);
        sum += vec3_norm(known.turning.body[i].angular_velocity);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += put_rubbing(v, q, &known, j);
    }
    return sum;
}

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

/* d as users see it: of a capped cylinder from its axis, whichever zone is met. */
static double distance_term(const struct scene_values *v, const struct contact_shape *shape,
                            const struct scene_instant *at, const struct scene_jet *along, int contact,
                            int order)
{
    if (contact_is_capped(shape)) {
        const int destination = contact_destination(contact);
        struct vec3 c[JET_TERMS] = {at->separation[contact]};
        struct vec3 axis[JET_TERMS] = {shape->solid.axis};
        double rho[JET_TERMS];
        for (int i = 1; i < JET_TERMS; ++i) {
            c[i] = vec3_sub(along->displacement[destination][i],
                            along->displacement[contact_source(contact)][i]);
            if (SCENE_ANY_TURNING) {
                axis[i] = body_turns(v, destination) ? along->axis[destination][i] : axis[i];
            }
        }
        contact_axis_distance(c, axis, rho);
        return rho[order];
    }
    return along->contact[contact].distance[order];
}

static double contact_term(const struct model *m, const struct scene_state *q, const struct scene_instant *at,
                           const struct scene_jet *along, const struct variable *variable, int order)
{
    const struct scene_values *v = &m->state.values;
    const int j = variable->element;
    const struct contact_shape shape = scene_shape_met(v, q, at, j);
    const struct contact_jet *contact = &along->contact[j];
    struct vec3 vector = {0.0, 0.0, 0.0};
    switch (variable->row) {
    case ROW_contact_gap:
        return scene_shown_within(v, q, at, j, &shape) ? contact->gap[order] : 0.0;
    case ROW_contact_gap_rate:
        return scene_shown_within(v, q, at, j, &shape) ? contact->gap_rate[order] : 0.0;
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
        if (SCENE_ANY_TURNING) {
            vector = turning_term(along, variable, order);
        }
        break;
    }
    return vec3_get(vector, variable->component);
}

double output_term(const struct model *m, const struct scene_state *q, const struct scene_instant *at,
                   const struct scene_jet *along, const struct variable *variable, int order)
{
    switch (variable->row) {
    case ROW_body_displacement:
    case ROW_body_position:
        return vec3_get(along->displacement[variable->element][order], variable->component);
    case ROW_body_velocity:
        return vec3_get(along->velocity[variable->element][order], variable->component);
    case ROW_body_angular_velocity:
        return vec3_get(along->angular_velocity[variable->element][order], variable->component);
    case ROW_body_current_axis:
        return vec3_get(along->axis[variable->element][order], variable->component);
    case ROW_body_orientation:
        return quaternion_component(along->orientation[variable->element][order], variable->component);
    default:
        break;
    }
    double term = 0.0;
    return motion_jet(m, q, along, variable, order, &term) ||
                   step_term(m, q, at, along, variable, order, &term)
               ? term
               : contact_term(m, q, at, along, variable, order);
}

/* The outputs of the present instant: what the model shows, computed from the motion and nothing else. */

/* x_dst - r_d n for a sphere; for a cylinder the point of its wall nearest to the source: x_src + rho - r_d
 * n, also where it is capped. */
static struct vec3 contact_point_of(const struct scene_values *v, const struct contact_shape *shape,
                                    const struct scene_instant *at, int contact)
{
    const int source = contact_source(contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct vec3 centre = vec3_add(body_center(v, source), at->displacement[source]);
    const double reach = g->distance - shape->other_radius;
    return vec3_axpy(centre, reach, g->normal);
}

/* d as users see it: of a capped cylinder from its axis, whichever zone is met. */
static double distance_of(const struct contact_shape *shape, const struct scene_instant *at, int contact)
{
    if (contact_is_capped(shape)) {
        const struct vec3 none = {0.0, 0.0, 0.0};
        const struct vec3 c[3] = {at->separation[contact], none, none};
        const struct vec3 axis[3] = {shape->solid.axis, none, none};
        double rho[3];
        contact_axis_distance(c, axis, rho);
        return rho[0];
    }
    return at->geometry[contact].distance;
}

static void put_force(struct scene_values *v, int contact, double normal_force, struct vec3 source_force)
{
    put_contact_normal_force(v, contact, normal_force);
    put_contact_source_force(v, contact, source_force);
    put_contact_destination_force(v, contact, vec3_scale(-1.0, source_force));
}

/* A sum that is finite only if both factors are. */
static double put_hertz(struct scene_values *v, int contact, const struct contact_law *law)
{
    struct contact_coefficients factors = {0.0, 0.0};
    if (contact_is_hertz(law)) {
        factors = contact_factors_of(law);
    }
    put_contact_effective_hertz_stiffness(v, contact, factors.k);
    put_contact_effective_hunt_crossley_factor(v, contact, factors.c);
    return factors.k + factors.c;
}

/* Numbers within their ranges can still multiply to more than a double holds: these functions return a sum
 * that is finite only if all outputs of theirs are. */
static double put_contact(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                          int contact)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_shape shape = scene_shape_met(v, q, at, contact);
    const double distance = distance_of(&shape, at, contact);
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_state *state = &q->contact[contact];
    const enum contact_regime regime = (enum contact_regime)state->regime;
    const bool within = scene_shown_within(v, q, at, contact, &shape);
    const double force = contact_normal_force_of(&law, regime, g->gap, g->gap_rate);
    const struct contact_coefficients factors = contact_coefficients_of(&law, REGIME_COMPRESSION);
    put_contact_effective_penalty_factor(v, contact, factors.k);
    put_contact_effective_viscous_penalty_factor(v, contact, factors.c);
    put_contact_diagonal(v, contact, state->parameters.diagonal);
    put_contact_gap(v, contact, within ? g->gap : contact_gap_beyond_ends(v, contact));
    put_contact_gap_rate(v, contact, within ? g->gap_rate : 0.0);
    put_contact_distance(v, contact, distance);
    put_contact_direction(v, contact, contact_direction_of(&shape, g));
    put_contact_point(v, contact, contact_point_of(v, &shape, at, contact));
    put_contact_active(v, contact, regime != REGIME_APART);
    put_contact_within_extents(v, contact, within);
    put_contact_zone(v, contact, (int32_t)zones_shown(v, q, at, contact));
    put_force(v, contact, force, vec3_scale(-shape.side * force, g->normal));
    return force + distance + g->gap_rate + factors.k + factors.c + put_hertz(v, contact, &law);
}

static void warn_of_missing_direction(struct model *m, const struct scene_state *q,
                                      const struct scene_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (at->geometry[j].degenerate && q->contact[j].regime != REGIME_APART &&
            !m->state.warned_of_direction[j]) {
            m->state.warned_of_direction[j] = 1;
            const struct vec3 n = at->geometry[j].normal;
            model_report(
                m, MODEL_WARNING,
                "%s.distance = 0 at %s s: the overlapping bodies have no defined normal; the direction "
                "(%g, %g, %g) is used (allowed: distance > 0). Given once.",
                scene_contact_name(j), shortest_digits(scene_time(q)).text, n.x, n.y, n.z);
        }
    }
}

static void update_bodies(struct model *m)
{
    struct scene_values *v = &m->state.values;
    motion_catch_up(v, &m->state.motion);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const bool moves = body_is_free(v, i) || body_is_prescribed(v, i);
        if (m->outputs == OUTPUTS_NONE || moves) {
            present_body_now(v, &m->state.motion, i);
        }
    }
    m->outputs = OUTPUTS_BODIES;
}

static void update_all(struct model *m)
{
    struct scene_values *v = &m->state.values;
    struct scene_state settled;
    const struct scene_state *q = motion_shown(v, &m->state.motion, &settled);
    struct scene_instant at;
    double sum = 0.0;
    scene_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        m->state.motion.contact[j].normal = at.geometry[j].normal;
        sum += put_contact(v, q, &at, j);
    }
    sum += motion_show(v, q, &at) + (SCENE_ANY_TURNING ? show_turning(v, q, &at) : 0.0);
    warn_of_missing_direction(m, q, &at);
    /* What is no number has to be looked at one by one. */
    m->outputs = isfinite(sum) ? OUTPUTS_ALL : OUTPUTS_BODIES;
}

bool model_update_outputs(struct model *m, enum outputs wanted)
{
    if (m->outputs >= wanted) {
        return true;
    }
    if (!m->state.initialized) {
        model_prepare(m);
    } else if (!model_apply_inputs(m)) {
        return false;
    }
    update_bodies(m);
    /* Bodies that overlap may have to be warned of, whatever is asked. */
    if (wanted > OUTPUTS_BODIES || scene_is_force_element(&m->state.values) ||
        !scene_is_apart(&m->state.motion)) {
        update_all(m);
    }
    return true;
}
