/* The outputs of bodies, contacts, rotation and friction, and their derivatives along a path. */
#include <math.h>

#include "contact/shape.h"
#include "model/state.h"
#include "scene/evaluate.h"
#include "scene/scene_jet.h"

/* Returns an impulse divided by the length of the step [s]. The function does not multiply by the reciprocal,
 * which is infinite for steps of less than 1e-308 s. */
static struct vec3 mean_of(struct vec3 impulse, double window)
{
    return window > 0.0 ? vec3_make(impulse.x / window, impulse.y / window, impulse.z / window)
                        : vec3_make(0.0, 0.0, 0.0);
}

/* Largest error of a known peak force by rounding, divided by the peak force. The force of a contact is
 * itself known to this accuracy (touch/segment.c). */
static const double KNOWN = 1e-6;

static bool peaks_are_known(const struct contact_state *state)
{
    return !(state->record.force_bound > state->peaks.force * (1.0 + KNOWN));
}

/* Returns why an output cannot be read although the motion is finite, or NULL where it can be read. */
static const char *unknown_reason(const struct model *m, const struct variable *variable)
{
    const bool is_peak =
        variable->row == ROW_contact_peak_force || variable->row == ROW_contact_peak_penetration;
    if (!SCENE_ANY_FREE || !is_peak || peaks_are_known(&m->state.motion.contact[variable->element])) {
        return NULL;
    }
    return "in a contact as stiff as this, rounding of gap and speed where it began makes more than 1e-6 of "
           "the peak (allowed: a smaller penalty factor, or, where the contact is damped, a later "
           "communication step; other outputs can be read)";
}

static double put_history(struct scene_values *v, const struct scene_state *q, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    const struct contact_impulses *now = &state->physics.impulse;
    const struct contact_impulses *mark = &state->record.impulse_mark;
    const struct vec3 impulse = vec3_sub(now->force, mark->force);
    const bool touching = state->regime != REGIME_APART;
    const struct vec3 mean = mean_of(impulse, q->step_length);
    put_contact_mean_force(v, contact, mean);
    if (SCENE_ANY_TURNING) {
        put_contact_mean_source_torque(
            v, contact, mean_of(vec3_sub(now->source_torque, mark->source_torque), q->step_length));
        put_contact_mean_destination_torque(
            v, contact, mean_of(vec3_sub(now->destination_torque, mark->destination_torque), q->step_length));
    }
    put_contact_peak_force(v, contact, state->peaks.force);
    put_contact_peak_penetration(v, contact, state->peaks.penetration);
    put_contact_onsets(v, contact, state->record.onsets);
    put_contact_last_onset_time(v, contact, state->record.onset_time);
    put_contact_last_duration(v, contact,
                              touching ? q->clock - state->record.touch_clock : state->record.last_duration);
    const double known = peaks_are_known(state) ? 0.0 : (double)INFINITY;
    return mean.x + mean.y + mean.z + state->peaks.force + known;
}

/* Sets the energies and the counters. Returns the total energy [J]. */
static double put_energies(struct scene_values *v, const struct scene_instant *at)
{
    const struct scene_state *q = at->q;
    const struct scene_energies energy = scene_energies_of(at);
    const double total = energy.kinetic + energy.potential + energy.stored + q->dissipated -
                         q->external_work + (energy.rotational + q->friction_energy);
    put_energy_kinetic(v, energy.kinetic);
    put_energy_potential(v, energy.potential);
    put_energy_contact(v, energy.stored);
    put_energy_rotational(v, energy.rotational);
    put_energy_tangential(v, energy.tangential);
    put_energy_friction(v, q->friction_energy - energy.tangential);
    put_energy_dissipated(v, q->dissipated);
    put_energy_external_work(v, q->external_work);
    put_energy_total(v, total);
    put_solver_steps(v, q->counters.steps);
    put_solver_force_evaluations(v, q->counters.force_evaluations);
    put_solver_events(v, q->counters.events);
    put_solver_rejected_steps(v, q->counters.rejected_steps);
    put_solver_fallbacks(v, q->counters.fallbacks);
#if HAS_solver_islands || HAS_solver_largest_island
    {
        const struct islands islands = scene_islands(q);
        put_solver_islands(v, islands.count);
        put_solver_largest_island(v, islands.largest);
    }
#endif
    return total;
}

/* Sets the energies, the counters and the contact outputs over a step or the run. Returns a sum that is
 * finite only if all of them are. */
static double show_motion(struct scene_values *v, const struct scene_instant *at)
{
    double sum = SCENE_ANY_FREE ? put_energies(v, at) : motion_size(at->q);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += put_history(v, at->q, j);
    }
    return sum;
}

bool model_has_derivatives(const struct variable *variable)
{
    return variable->row != ROW_contact_mean_force && variable->row != ROW_contact_mean_source_torque &&
           variable->row != ROW_contact_mean_destination_torque && variable->row != ROW_contact_peak_force &&
           variable->row != ROW_contact_peak_penetration;
}

/* Returns coefficient `order` of an energy [J/s^order in time]. */
static double energy_term(const struct model *m, const struct scene_jet *along, int row, int order)
{
    const struct scene_energies energy = jet_energies_of(&m->state.motion, along, order);
    switch (row) {
    case ROW_energy_kinetic:
        return energy.kinetic;
    case ROW_energy_potential:
        return energy.potential;
    case ROW_energy_contact:
        return energy.stored;
    case ROW_energy_rotational:
        return energy.rotational;
    case ROW_energy_tangential:
        return energy.tangential;
    case ROW_energy_friction:
        return along->friction[order] - energy.tangential;
    case ROW_energy_dissipated:
        return along->dissipated[order];
    case ROW_energy_external_work:
        return along->external_work[order];
    case ROW_energy_total:
        return energy.kinetic + energy.potential + energy.stored + along->dissipated[order] -
               along->external_work[order] +
               (SCENE_ANY_TURNING ? energy.rotational + along->friction[order] : 0.0);
    default:
        return 0.0;
    }
}

static bool sticks(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                   int contact)
{
    if (contact_friction(v, contact) == FRICTION_NONE ||
        q->contact[contact].regime == (int32_t)REGIME_APART) {
        return false;
    }
    return contact_has_spring(v, contact, OPPOSED_SLIP)
               ? q->contact[contact].friction_regime[OPPOSED_SLIP] == (int32_t)FRICTION_STICKING
               : vec3_norm(at->turning.slip[contact]) < q->contact[contact].parameters.slip_velocity;
}

static double put_rubbing(struct scene_values *v, const struct scene_instant *at, int contact)
{
    const struct turning_instant *turning = &at->turning;
    const int source = contact_source(contact);
    const struct vec3 centre = vec3_add(body_center(v, source), at->displacement[source]);
    const struct vec3 friction = turning->friction_force[contact];
    if (SCENE_ANY_FRICTION) {
        put_contact_effective_slip_velocity(v, contact, at->q->contact[contact].parameters.slip_velocity);
    }
    put_contact_sticking(v, contact, sticks(v, at->q, at, contact));
    put_contact_friction_force(v, contact, friction);
    put_contact_slip_velocity(v, contact, turning->slip[contact]);
    put_contact_source_point(v, contact, vec3_add(centre, turning->source_arm[contact]));
    put_contact_source_torque(v, contact, turning->source_torque[contact]);
    put_contact_destination_torque(v, contact, turning->destination_torque[contact]);
    if (SCENE_ANY_ROLLING) {
        const struct vec3 spin = turning_spin(at, contact);
        const struct vec3 n = at->geometry[contact].normal;
        const double along = vec3_dot(spin, n);
        put_contact_rolling_torque(v, contact, turning->resistance[contact]);
        put_contact_rolling_rate(v, contact, vec3_axpy(spin, -along, n));
        put_contact_spinning_rate(v, contact, scene_contact_side(at->q, contact) * along);
    }
    return vec3_norm(friction) + vec3_norm(turning->slip[contact]) +
           vec3_norm(turning->source_torque[contact]) + vec3_norm(turning->destination_torque[contact]);
}

/* Sets the sums of the forces and torques of the contacts of a compound body about its centre of mass. */
static void put_contact_sums(struct scene_values *v, const struct scene_instant *at, int body)
{
    const struct contact_load sum = scene_load_on(at, body);
    put_body_contact_force(v, body, sum.force);
    put_body_contact_torque(v, body, sum.torque);
}

/* Completes the instant by rotation and friction, and sets the outputs of bodies that turn and contacts that
 * rub. Returns a sum of them, which is finite only if every output is. */
static double show_turning(struct scene_values *v, struct scene_instant *at)
{
    double sum = 0.0;
    if (!scene_turns(v)) {
        turning_complete(at);
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const struct body_turn *turn = &at->turning.body[i];
        const bool rests = SCENE_ANY_ROTATION && !body_turns(v, i);
        const struct quaternion orientation = rests ? turning_start_orientation(v, i) : turn->orientation;
        put_body_angular_velocity(v, i, turn->angular_velocity);
        put_body_orientation(v, i, orientation);
        put_body_current_axis(v, i, quaternion_third_axis(orientation));
        if (body_is_compound(i)) {
            put_contact_sums(v, at, i);
        }
        sum += vec3_norm(turn->angular_velocity);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += put_rubbing(v, at, j);
    }
    return sum;
}

/* Returns coefficient `order` of an output of the resistance to rolling; a scalar is the first component. */
static struct vec3 resistance_term(double side, const struct turning_jet *turning, const struct vec3 *normal,
                                   int row, int order)
{
    double along[JET_TERMS];
    for (int i = 0; i <= order; ++i) {
        along[i] = jet_dot(turning->spin, normal, i);
    }
    return row == ROW_contact_rolling_torque ? turning->resistance[order]
           : row == ROW_contact_rolling_rate ? vec3_sub(turning->spin[order], jet_scale(along, normal, order))
                                             : vec3_make(side * along[order], 0.0, 0.0);
}

/* Returns coefficient `order` of the place at which both forces of a contact act, on the source's surface. */
static struct vec3 source_point_term(const struct scene_jet *along, const struct contact_shape *shape,
                                     int contact, int order)
{
    const struct vec3 arm = SCENE_ANY_TURNING ? along->turning[contact].source_arm[order]
                                              : vec3_scale(shape->side * shape->source_radius,
                                                           along->contact[contact].normal[order]);
    return vec3_add(along->displacement[contact_source(contact)][order], arm);
}

/* Returns coefficient `order` of the output `distance`, for a capped cylinder that of the distance from its
 * axis in every zone. */
static double distance_term(const struct contact_shape *shape, const struct contact_jet *jet, int order)
{
    struct vec3 across[JET_TERMS], to_axis[JET_TERMS];
    double axial[JET_TERMS], rho[JET_TERMS];
    if (!contact_is_capped(shape)) {
        return jet->distance[order];
    }
    jet_across(JET_TERMS, jet->separation, jet->axis, across, axial);
    jet_direction(JET_TERMS, across, rho, to_axis);
    return order > 0 && !(rho[0] > 0.0) ? 0.0 : rho[order];
}

/* Returns coefficient `order` of a vector output of a contact; zero where the output is constant. */
static struct vec3 contact_vector_term(const struct scene_jet *along, const struct contact_shape *shape,
                                       int contact, int row, int order)
{
    const struct contact_jet *jet = &along->contact[contact];
    const struct turning_jet *turning = &along->turning[contact];
    switch (row) {
    case ROW_contact_direction: {
        const struct contact_geometry turned = {.normal = jet->normal[order]};
        return contact_direction_of(shape, &turned);
    }
    case ROW_contact_source_force:
        return jet->source_force[order];
    case ROW_contact_destination_force:
        return vec3_scale(-1.0, jet->source_force[order]);
    case ROW_contact_point: /* by g n beyond the source's point, on the destination's surface */
        return vec3_axpy(source_point_term(along, shape, contact, order), shape->side,
                         jet_scale(jet->gap, jet->normal, order));
    case ROW_contact_source_point:
        return source_point_term(along, shape, contact, order);
    case ROW_contact_friction_force:
        return turning->friction_force[order];
    case ROW_contact_slip_velocity:
        return turning->motion[OPPOSED_SLIP][order];
    case ROW_contact_source_torque:
        return turning->source_torque[order];
    case ROW_contact_destination_torque:
        return turning->destination_torque[order];
    case ROW_contact_rolling_torque:
    case ROW_contact_rolling_rate:
    case ROW_contact_spinning_rate:
        return SCENE_ANY_ROLLING ? resistance_term(shape->side, turning, jet->normal, row, order)
                                 : vec3_make(0.0, 0.0, 0.0);
    default:
        return vec3_make(0.0, 0.0, 0.0);
    }
}

static double contact_term(const struct scene_instant *at, const struct scene_jet *along,
                           const struct variable *variable, int order)
{
    const int j = variable->element;
    const struct contact_shape shape = scene_shape_met(at, j);
    const struct contact_jet *contact = &along->contact[j];
    switch (variable->row) {
    case ROW_contact_gap:
        return scene_shown_within(at, j, &shape) ? contact->gap[order] : 0.0;
    case ROW_contact_gap_rate:
        return scene_shown_within(at, j, &shape) ? contact->gap_rate[order] : 0.0;
    case ROW_contact_distance:
        return distance_term(&shape, contact, order);
    case ROW_contact_normal_force:
        return contact->normal_force[order];
    default:
        return vec3_get(contact_vector_term(along, &shape, j, variable->row, order), variable->component);
    }
}

double output_term(const struct model *m, const struct scene_instant *at, const struct scene_jet *along,
                   const struct variable *variable, int order)
{
    const int j = variable->element;
    const int k = variable->component;
    const bool starting = !m->state.initialized;
    const bool touches = j < SCENE_CONTACTS && at->q->contact[j].regime != REGIME_APART;
    struct quaternion orientation;
    struct vec3 axis[JET_TERMS];
    switch (variable->row) {
    case ROW_body_displacement:
    case ROW_body_position:
        return vec3_get(along->displacement[j][order], k);
    case ROW_body_velocity:
        return vec3_get(along->velocity[j][order], k);
    case ROW_body_angular_velocity:
        return vec3_get(along->angular_velocity[j][order], k);
    case ROW_body_current_axis:
        if (SCENE_ANY_ROTATION) {
            jet_axis_of(along, j, axis);
            return vec3_get(axis[order], k);
        }
        return 0.0;
    case ROW_body_contact_force:
        return SCENE_ANY_COMPOUND ? vec3_get(jet_load_on(along, j, order).force, k) : 0.0;
    case ROW_body_contact_torque:
        return SCENE_ANY_COMPOUND ? vec3_get(jet_load_on(along, j, order).torque, k) : 0.0;
    case ROW_body_orientation:
        orientation = along->orientation[j][order];
        return *quaternion_part(&orientation, k);
    case ROW_contact_peak_force: /* until initialization ends, peaks are values at the start */
        return starting && at->normal_force[j] > 0.0 ? along->contact[j].normal_force[order] : 0.0;
    case ROW_contact_peak_penetration:
        return starting && touches ? -along->contact[j].gap[order] : 0.0;
    case ROW_contact_last_duration: /* the duration grows with time in contact */
        return touches ? along->time[order] : 0.0;
    case ROW_energy_kinetic:
    case ROW_energy_potential:
    case ROW_energy_contact:
    case ROW_energy_dissipated:
    case ROW_energy_external_work:
    case ROW_energy_total:
    case ROW_energy_rotational:
    case ROW_energy_tangential:
    case ROW_energy_friction:
        return energy_term(m, along, variable->row, order);
    default:
        return contact_term(at, along, variable, order);
    }
}

/* Returns the output `distance` [m], for a capped cylinder the distance from its axis in every zone. */
static double distance_of(const struct contact_shape *shape, const struct scene_instant *at, int contact)
{
    if (contact_is_capped(shape)) {
        const struct vec3 c = at->separation[contact];
        return vec3_norm(vec3_axpy(c, -vec3_dot(c, shape->solid.axis), shape->solid.axis));
    }
    return at->geometry[contact].distance;
}

/* Sets the outputs of a contact. Returns a sum that is finite only if all of them are, since products of
 * values within their ranges may be more than a double holds. */
static double put_contact(struct scene_values *v, const struct scene_instant *at, int contact)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_shape shape = scene_shape_met(at, contact);
    const int source = contact_source(contact);
    const struct vec3 centre =
        vec3_add(vec3_add(body_center(v, source), at->displacement[source]), scene_lever(at, contact, 0));
    const double distance = distance_of(&shape, at, contact);
    const struct contact_law law = scene_contact_law(at->q, contact);
    const struct contact_state *state = &at->q->contact[contact];
    const enum contact_regime regime = (enum contact_regime)state->regime;
    const bool within = scene_shown_within(at, contact, &shape);
    const double force = contact_normal_force_of(&law, regime, g->gap, g->gap_rate);
    const struct contact_coefficients factors = contact_coefficients_of(&law, REGIME_COMPRESSION);
    const struct contact_coefficients none = {0.0, 0.0};
    const struct contact_coefficients hertz = contact_is_hertz(&law) ? contact_factors_of(&law) : none;
    put_contact_effective_penalty_factor(v, contact, factors.k);
    put_contact_effective_viscous_penalty_factor(v, contact, factors.c);
    put_contact_effective_hertz_stiffness(v, contact, hertz.k);
    put_contact_effective_hunt_crossley_factor(v, contact, hertz.c);
    put_contact_diagonal(v, contact, state->parameters.diagonal);
    put_contact_gap(v, contact, within ? g->gap : contact_gap_beyond_ends(v, contact));
    put_contact_gap_rate(v, contact, within ? g->gap_rate : 0.0);
    put_contact_distance(v, contact, distance);
    put_contact_direction(v, contact, contact_direction_of(&shape, g));
    const struct vec3 foot =
        contact_is_skew(&shape) ? vec3_add(centre, contact_foot(&shape, at->separation[contact])) : centre;
    put_contact_point(v, contact, vec3_axpy(foot, g->distance - shape.other_radius, g->normal));
    put_contact_active(v, contact, regime != REGIME_APART);
    put_contact_within_extents(v, contact, within);
    put_contact_zone(v, contact, (int32_t)zones_shown(at, contact));
    const struct vec3 source_force =
        contact_rubs(v, contact) ? at->source_force[contact] : vec3_scale(-shape.side * force, g->normal);
    put_contact_normal_force(v, contact, force);
    put_contact_source_force(v, contact, source_force);
    put_contact_destination_force(v, contact, vec3_scale(-1.0, source_force));
    return force + distance + g->gap_rate + factors.k + factors.c + (hertz.k + hertz.c);
}

static void warn_of_missing_direction(struct model *m, const struct scene_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (SCENE_ANY_CURVED && at->geometry[j].degenerate && at->q->contact[j].regime != REGIME_APART &&
            !m->state.warned_of_direction[j]) {
            m->state.warned_of_direction[j] = 1;
            const struct vec3 n = at->geometry[j].normal;
            model_report(m, MODEL_WARNING,
                         "%s.distance = 0 at %s s: the overlapping bodies have no defined normal; the "
                         "direction (%g, %g, %g) is used (allowed: distance > 0). Given once.",
                         scene_contact_name(j), shortest_digits(scene_time(at->q)).text, n.x, n.y, n.z);
        }
    }
}

static void update_bodies(struct model *m)
{
    struct scene_values *v = &m->state.values;
    motion_catch_up(m);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        present_body_now(v, &m->state.motion, i);
    }
    m->outputs = OUTPUTS_BODIES;
}

static void update_all(struct model *m)
{
    struct scene_values *v = &m->state.values;
    struct scene_state settled;
    const struct scene_state *q = motion_shown(&m->state.motion, &settled);
    struct scene_instant at;
    double sum = 0.0;
    scene_now(q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        m->state.motion.contact[j].physics.normal = at.geometry[j].normal;
        sum += put_contact(v, &at, j);
    }
    sum += show_motion(v, &at) + (SCENE_ANY_TURNING ? show_turning(v, &at) : 0.0);
    warn_of_missing_direction(m, &at);
    /* If some output is not finite, model_read has to look at each by itself. */
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
    /* Overlapping bodies may need a warning, whichever outputs are wanted. */
    if (wanted > OUTPUTS_BODIES || scene_is_force_element(&m->state.values) ||
        !scene_is_apart(&m->state.motion)) {
        update_all(m);
    }
    return true;
}

/* Returns the outputs that have to be computed so that a variable shows the present. */
static enum outputs outputs_for(const struct model *m, const struct variable *variable)
{
    if (variable->row == ROW_body_displacement || variable->row == ROW_body_position ||
        variable->row == ROW_body_velocity) {
        return OUTPUTS_BODIES;
    }
    const bool given = variable->causality == VARIABLE_PARAMETER || variable->causality == VARIABLE_INPUT;
    return given && m->state.initialized ? OUTPUTS_NONE : OUTPUTS_ALL;
}

enum model_status model_read(struct model *m, const struct variable *variable, void *value)
{
    if (!model_update_outputs(m, outputs_for(m, variable))) {
        return model_refuse_inputs(m);
    }
    const char *unknown = unknown_reason(m, variable);
    if (unknown) {
        return model_report(m, MODEL_DISCARD, "%s is not known: %s.", variable->name, unknown);
    }
    double local = 0.0;
    const void *at = (const char *)&m->state.values + variable->offset;
    if (variable_is_local(variable)) {
        struct scene_instant now;
        scene_now(&m->state.motion, &now);
        local = model_exchange_value(&now, variable);
        at = &local;
    }
    if (!isfinite(variable_number(variable, at))) {
        return model_report(m, MODEL_DISCARD,
                            "%s is beyond the range of numbers (allowed: parameters and inputs with finite "
                            "forces and energies).",
                            variable->name);
    }
    memcpy(value, at, variable_size(variable));
    return MODEL_OK;
}

size_t model_get_reals(struct model *m, const uint32_t *references, size_t count, double *values)
{
    for (size_t i = 0; i < count; ++i) {
        const uint32_t real = references[i] < SCENE_REFERENCES ? scene_reals[references[i]] : 0;
        if (i == 0 && (real & (VARIABLE_BODY | VARIABLE_COMPUTED))) {
            (void)model_update_outputs(m, real & VARIABLE_COMPUTED ? OUTPUTS_ALL : OUTPUTS_BODIES);
        }
        if (!(real & (uint32_t)m->outputs)) {
            return i;
        }
        memcpy(&values[i], (const char *)&m->state.values + (real & VARIABLE_OFFSET), sizeof values[i]);
    }
    return count;
}
