/* This file computes the outputs of bodies, contacts, rotation and friction, and their derivatives along a
 * path. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/shape.h"
#include "flight/flight.h"
#include "model/state.h"
#include "scene/evaluate.h"
#include "scene/scene_jet.h"

/* Returns by how much an impulse has grown since `mark`, divided by the length of the step [s]. The function
 * does not multiply by the reciprocal, which is infinite for steps of less than 1e-308 s. */
static struct vec3 mean_of(struct vec3 now, struct vec3 mark, double window)
{
    const struct vec3 impulse = vec3_sub(now, mark);
    return window > 0.0 ? vec3_make(impulse.x / window, impulse.y / window, impulse.z / window)
                        : vec3_make(0.0, 0.0, 0.0);
}

/* This is the largest error of a known peak force by rounding, divided by the peak force. The force of a
 * contact is itself known to this accuracy (touch/segment.c). */
static const double KNOWN = 1e-6;

static bool peaks_are_known(const struct contact_state *state)
{
    return !(state->record.force_bound > state->peaks.force * (1.0 + KNOWN));
}

/* Whether an output can be read where the motion is finite. */
static bool is_known(const struct model *m, const struct variable *variable)
{
    const bool is_peak =
        variable->row == ROW_contact_peak_force || variable->row == ROW_contact_peak_penetration;
    return !SCENE_ANY_FREE || !is_peak || peaks_are_known(&m->state.motion.contact[variable->element]);
}

/* Sets the outputs of a contact over a step or the run. */
static void put_history(struct scene_values *v, const struct scene_state *q, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    const struct contact_impulses *now = &state->physics.impulse;
    const struct contact_impulses *mark = &state->record.impulse_mark;
    const double window = q->step_length;
    const bool touching = state->regime != REGIME_APART;
    put_contact_mean_force(v, contact, mean_of(now->force, mark->force, window));
    if (SCENE_ANY_TURNING) {
        put_contact_mean_source_torque(v, contact, mean_of(now->source_torque, mark->source_torque, window));
        put_contact_mean_destination_torque(
            v, contact, mean_of(now->destination_torque, mark->destination_torque, window));
    }
    put_contact_peak_force(v, contact, state->peaks.force);
    put_contact_peak_penetration(v, contact, state->peaks.penetration);
    put_contact_onsets(v, contact, state->record.onsets);
    put_contact_last_onset_time(v, contact, state->record.onset_time);
    put_contact_last_duration(v, contact,
                              touching ? q->clock - state->record.touch_clock : state->record.last_duration);
}

/* Sets the energies [J], or one of their coefficients along a path. `friction` holds what friction and its
 * springs take. */
static void put_energies(struct scene_values *v, const struct scene_energies *energy, double dissipated,
                         double external_work, double friction)
{
    const double total = energy->kinetic + energy->potential + energy->stored + dissipated - external_work +
                         (energy->rotational + friction);
    put_energy_kinetic(v, energy->kinetic);
    put_energy_potential(v, energy->potential);
    put_energy_contact(v, energy->stored);
    put_energy_rotational(v, energy->rotational);
    put_energy_tangential(v, energy->tangential);
    put_energy_friction(v, friction - energy->tangential);
    put_energy_dissipated(v, dissipated);
    put_energy_external_work(v, external_work);
    put_energy_total(v, total);
}

static void put_counters(struct scene_values *v, const struct scene_state *q)
{
    put_solver_steps(v, q->counters.steps);
    put_solver_force_evaluations(v, q->counters.force_evaluations);
    put_solver_events(v, q->counters.events);
    put_solver_rejected_steps(v, q->counters.rejected_steps);
    put_solver_fallbacks(v, q->counters.fallbacks);
    if (HAS_solver_islands || HAS_solver_largest_island) {
        const struct islands islands = scene_islands(q);
        put_solver_islands(v, islands.count);
        put_solver_largest_island(v, islands.largest);
    }
}

bool model_has_derivatives(const struct variable *variable)
{
    return variable->row != ROW_contact_mean_force && variable->row != ROW_contact_mean_source_torque &&
           variable->row != ROW_contact_mean_destination_torque && variable->row != ROW_contact_peak_force &&
           variable->row != ROW_contact_peak_penetration;
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

/* Returns coefficient `order` of the position of a body. */
static struct vec3 position_term(const struct scene_values *v, const struct scene_jet *along, int body,
                                 int order)
{
    const struct vec3 displacement = along->displacement[body][order];
    return order == 0 ? vec3_add(body_center(v, body), displacement) : displacement;
}

/* Sets coefficient `order` of the outputs of a body. */
static void put_body_terms(struct scene_values *v, const struct scene_jet *along, int body, int order)
{
    put_body_displacement(v, body, along->displacement[body][order]);
    put_body_position(v, body, position_term(v, along, body, order));
    put_body_velocity(v, body, along->velocity[body][order]);
    put_body_angular_velocity(v, body, along->angular_velocity[body][order]);
    put_body_orientation(v, body, along->orientation[body][order]);
    if (SCENE_ANY_ROTATION) {
        struct vec3 axis[JET_TERMS] = {
            quaternion_rotate(along->orientation[body][0], (struct vec3){.z = 1.0})};
        if (order > 0) {
            jet_axis_of(along, body, axis);
        }
        put_body_current_axis(v, body, axis[order]);
    }
    if (body_is_compound(body)) {
        const struct contact_load load = jet_load_on(along, body, order);
        put_body_contact_force(v, body, load.force);
        put_body_contact_torque(v, body, load.torque);
    }
}

/* Sets coefficient `order` of the outputs of friction and rotation in a contact. */
static void put_rubbing_terms(struct scene_values *v, const struct scene_jet *along, double side, int contact,
                              int order)
{
    const struct turning_jet *turning = &along->turning[contact];
    put_contact_friction_force(v, contact, turning->friction_force[order]);
    put_contact_slip_velocity(v, contact, turning->motion[OPPOSED_SLIP][order]);
    put_contact_source_torque(v, contact, turning->source_torque[order]);
    put_contact_destination_torque(v, contact, turning->destination_torque[order]);
    if (SCENE_ANY_ROLLING) {
        const struct vec3 *normal = along->contact[contact].normal;
        double spinning[JET_TERMS];
        for (int i = 0; i <= order; ++i) {
            spinning[i] = jet_dot(turning->spin, normal, i);
        }
        put_contact_rolling_torque(v, contact, turning->resistance[order]);
        put_contact_rolling_rate(v, contact,
                                 vec3_sub(turning->spin[order], jet_scale(spinning, normal, order)));
        put_contact_spinning_rate(v, contact, side * spinning[order]);
    }
}

/* Rounding may decide on which side of an open end a source is, where its distance from the end is less than
 * so many rounding bounds of the axial position. The position may be wrong by a bound to either side, at two
 * times that are compared. */
static const double END_ROUNDINGS = 4.0;

/* Whether outputs show the source within the extents of the destination. Where rounding may put the source on
 * either side of an open end, the present regime decides. */
static bool is_shown_within(const struct scene_instant *at, int contact, const struct contact_shape *shape)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const double beyond = scene_beyond_ends(shape, g);
    const bool within = beyond <= 0.0;
    if (!SCENE_ANY_ENDS || !isfinite(shape->half_length) ||
        fabs(beyond) > END_ROUNDINGS * rounding_of_axial(at, contact, shape)) {
        return within;
    }
    const bool overlaps = g->gap < -rounding_of_gap(at, contact);
    return at->q->contact[contact].regime != (int32_t)REGIME_APART || (within && !overlaps);
}

/* Sets coefficient `order` of the outputs of a contact. */
static void put_contact_terms(struct scene_values *v, const struct scene_instant *at,
                              const struct scene_jet *along, int contact, int order)
{
    const struct contact_jet *jet = &along->contact[contact];
    const struct contact_shape shape = scene_shape_met(at, contact);
    const struct vec3 normal = jet->normal[order];
    /* the direction is towards the destination's centre (sphere) or the contact point (other shapes) */
    const bool flipped = (contact_is_cylinder(&shape) || contact_is_torus(&shape)) && shape.side < 0;
    const bool within = is_shown_within(at, contact, &shape);
    const struct vec3 arm = SCENE_ANY_TURNING ? along->turning[contact].source_arm[order]
                                              : vec3_scale(shape.side * shape.source_radius, normal);
    const struct vec3 source_point =
        vec3_add(position_term(at->v, along, contact_source(contact), order), arm);
    const double beyond = order == 0 ? contact_gap_beyond_ends(at->v, contact) : 0.0;
    put_contact_gap(v, contact, within ? jet->gap[order] : beyond);
    put_contact_gap_rate(v, contact, within ? jet->gap_rate[order] : 0.0);
    put_contact_distance(v, contact, distance_term(&shape, jet, order));
    put_contact_direction(v, contact, flipped ? vec3_scale(-1.0, normal) : normal);
    put_contact_source_point(v, contact, source_point);
    /* by g n beyond the source's point, on the destination's surface */
    put_contact_point(v, contact,
                      vec3_axpy(source_point, shape.side, jet_scale(jet->gap, jet->normal, order)));
    put_contact_normal_force(v, contact, jet->normal_force[order]);
    put_contact_source_force(v, contact, jet->source_force[order]);
    put_contact_destination_force(v, contact, vec3_scale(-1.0, jet->source_force[order]));
    if (SCENE_ANY_TURNING) {
        put_rubbing_terms(v, along, shape.side, contact, order);
    }
}

/* Sets the factors of a contact's law, the diagonal of its box [m] and v_0 [m/s], or the slopes of all of
 * them. */
static void put_factors(struct scene_values *v, int contact, const struct contact_law *law, double diagonal,
                        double slip_velocity)
{
    const struct contact_coefficients of = contact_factors_of(law, REGIME_COMPRESSION);
    const bool is_hertz = contact_is_hertz(law);
    put_contact_effective_penalty_factor(v, contact, is_hertz ? 0.0 : of.k);
    put_contact_effective_viscous_penalty_factor(v, contact, is_hertz ? 0.0 : of.c);
    put_contact_effective_hertz_stiffness(v, contact, is_hertz ? of.k : 0.0);
    put_contact_effective_hunt_crossley_factor(v, contact, is_hertz ? of.c : 0.0);
    put_contact_effective_slip_velocity(v, contact, slip_velocity);
    put_contact_diagonal(v, contact, diagonal);
}

void output_terms(const struct model *m, const struct scene_instant *at, const struct scene_jet *along,
                  int order, struct scene_values *terms)
{
    const bool starting = !m->state.initialized;
    memset(terms, 0, sizeof *terms);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        put_body_terms(terms, along, i, order);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_jet *jet = &along->contact[j];
        const bool touches = at->q->contact[j].regime != (int32_t)REGIME_APART;
        put_contact_terms(terms, at, along, j, order);
        put_factors(terms, j, &along->law_slope[j], along->diagonal_slope[j], along->slip_velocity_slope[j]);
        if (starting) { /* until initialization ends, peaks are values at the start */
            put_contact_peak_force(terms, j, at->normal_force[j] > 0.0 ? jet->normal_force[order] : 0.0);
            put_contact_peak_penetration(terms, j, touches ? -jet->gap[order] : 0.0);
        }
        put_contact_last_duration(terms, j, touches ? along->time[order] : 0.0);
    }
    if (SCENE_ANY_FREE) {
        const struct scene_energies energy = jet_energies_of(at->q, along, order);
        put_energies(terms, &energy, along->dissipated[order], along->external_work[order],
                     along->friction[order]);
    }
}

/* Sets the first coefficients of bodies and contacts to what outputs show at an instant. */
static void put_instant(const struct scene_instant *at, struct scene_jet *along)
{
    const struct turning_instant *now = &at->turning;
    memset(along, 0, sizeof *along);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        along->displacement[i][0] = at->displacement[i];
        along->velocity[i][0] = at->velocity[i];
        if (scene_turns(at->v)) {
            along->angular_velocity[i][0] = now->body[i].angular_velocity;
        }
        if (SCENE_ANY_ROTATION) { /* also where nothing turns */
            along->orientation[i][0] = now->body[i].orientation;
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_geometry *g = &at->geometry[j];
        const struct contact_shape shape = scene_shape_met(at, j);
        /* rounding can make the smooth formula negative, so F_n is clipped unless the dashpot may pull */
        const bool may_pull = contact_dashpot(at->v, j) == DASHPOT_UNCLAMPED;
        const double force = may_pull ? at->normal_force[j] : fmax(at->normal_force[j], 0.0);
        along->contact[j] = (struct contact_jet){
            .separation = {at->separation[j]},
            .axis = {shape.solid.axis},
            .normal = {g->normal},
            .distance = {g->distance},
            .gap = {g->gap},
            .gap_rate = {g->gap_rate},
            .normal_force = {force},
            .source_force = {contact_rubs(at->v, j) ? at->source_force[j]
                                                    : vec3_scale(-shape.side * force, g->normal)}};
        if (SCENE_ANY_TURNING) {
            along->turning[j] = (struct turning_jet){.source_arm = {now->source_arm[j]},
                                                     .friction_force = {now->friction_force[j]},
                                                     .source_torque = {now->source_torque[j]},
                                                     .destination_torque = {now->destination_torque[j]},
                                                     .spin = {turning_spin(at, j)},
                                                     .resistance = {now->resistance[j]},
                                                     .motion = {{now->slip[j]}}};
        }
    }
}

/* Sets the outputs of a contact that have no derivatives, and the parameters that follow from others. */
static void put_contact_state(struct scene_values *v, const struct scene_instant *at, int contact)
{
    const struct contact_state *state = &at->q->contact[contact];
    const struct contact_shape shape = scene_shape_met(at, contact);
    const struct contact_law law = scene_contact_law(at->q, contact);
    const bool touches = state->regime != (int32_t)REGIME_APART;
    const int zone = contact_is_capped(&shape) ? abs(at->geometry[contact].zone) : (int)ZONE_SIDE;
    put_contact_active(v, contact, touches);
    put_contact_within_extents(v, contact, is_shown_within(at, contact, &shape));
    put_contact_zone(v, contact, touches ? zone : (int)ZONE_NONE);
    if (SCENE_ANY_TURNING) {
        put_contact_sticking(v, contact, sticks(v, at->q, at, contact));
    }
    put_factors(v, contact, &law, state->parameters.diagonal, state->parameters.slip_velocity);
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

/* Sets the outputs displacement, position and velocity of a body. */
static void present_body(struct scene_values *v, const struct scene_state *q, int body, struct body_state at)
{
    const struct vec3 displacement = scene_displacement_of(q, body, at.moved);
    put_body_displacement(v, body, displacement);
    put_body_position(v, body, vec3_add(body_center(v, body), displacement));
    put_body_velocity(v, body, at.velocity);
}

/* Computes the outputs of bodies at their present places: of all bodies, or of those alone that are not free.
 * The function is not inlined into outputs_foresee, which would then save more registers at each call. */
CONTACT_NOINLINE static void show_bodies(struct model *m, bool all)
{
    struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (all || !body_is_free(v, i)) {
            present_body(v, q, i, scene_body_at(q, q->clock, i));
        }
    }
}

/* The clock is passed by value, because reading it back just after it was written costs more time. */
void outputs_foresee(struct model *m, double clock)
{
    struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    m->outputs = OUTPUTS_BODIES;
    _Static_assert(((int)MOTION_PRESCRIBED & ~(int)MOTION_FIXED) != 0, "fixed bodies hide prescribed ones");
    int others = 0; /* bits of the motions that are not free; costs one instruction for each body */
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            present_body(v, q, i, flight_unforced_at(q, i, clock));
        } else {
            others |= body_motion(v, i);
        }
    }
    if (others & ~(int)MOTION_FIXED) {
        show_bodies(m, false);
    }
}

static void update_all(struct model *m)
{
    struct scene_values *v = &m->state.values;
    struct scene_state settled;
    struct scene_instant at;
    struct scene_jet shown;
    m->outputs = OUTPUTS_ALL;
    motion_shown(&m->state.motion, &settled, &at);
    put_instant(&at, &shown);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        put_body_terms(v, &shown, i, 0);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        m->state.motion.contact[j].physics.normal = at.geometry[j].normal;
        put_contact_terms(v, &at, &shown, j, 0);
        put_contact_state(v, &at, j);
        put_history(v, at.q, j);
        if (!peaks_are_known(&at.q->contact[j])) { /* model_read has to look at each output by itself */
            m->outputs = OUTPUTS_BODIES;
        }
    }
    if (SCENE_ANY_FREE) {
        const struct scene_energies energy = scene_energies_of(&at);
        put_energies(v, &energy, at.q->dissipated, at.q->external_work, at.q->friction_energy);
        put_counters(v, at.q);
    }
    warn_of_missing_direction(m, &at);
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
    motion_catch_up(m);
    show_bodies(m, true);
    m->outputs = OUTPUTS_BODIES;
    bool all = wanted > OUTPUTS_BODIES || scene_is_force_element(&m->state.values);
    for (int j = 0; j < SCENE_CONTACTS; ++j) { /* overlapping bodies may need a warning, whatever is wanted */
        all = all || m->state.motion.contact[j].regime != (int32_t)REGIME_APART;
    }
    if (all) {
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

enum model_status model_read(struct model *m, const struct variable *variable, double *value)
{
    if (!model_update_outputs(m, outputs_for(m, variable))) {
        return model_refuse_inputs(m);
    }
    if (!is_known(m, variable)) {
        return model_report(
            m, MODEL_DISCARD,
            "%s is not known: in a contact as stiff as this, rounding of gap and speed where it "
            "began makes more than 1e-6 of the peak (allowed: a smaller penalty factor, or, where "
            "the contact is damped, a later communication step; other outputs can be read).",
            variable->name);
    }
    if (variable->causality >= VARIABLE_STATE) {
        struct scene_instant now;
        scene_now(&m->state.motion, &now);
        *value = model_exchange_value(&now, variable);
    } else {
        *value = variable_value(variable, &m->state.values);
    }
    if (!isfinite(*value)) {
        return model_report(m, MODEL_DISCARD,
                            "%s is beyond the range of numbers (allowed: parameters and inputs with finite "
                            "forces and energies).",
                            variable->name);
    }
    return MODEL_OK;
}

bool model_get_reals(struct model *m, const struct variable_list *list, size_t count, double *values)
{
    const double *end = values + count;
    for (size_t i = 0; i < list->count; ++i) {
        const uint32_t reference = list->references[i];
        const uint32_t real = reference < SCENE_REFERENCES ? scene_reals[reference] : 0;
        const uint32_t length = list->vectors ? real >> VARIABLE_LENGTH : 1;
        if (i == 0 && (real & (VARIABLE_BODY | VARIABLE_COMPUTED))) {
            (void)model_update_outputs(m, real & VARIABLE_COMPUTED ? OUTPUTS_ALL : OUTPUTS_BODIES);
        }
        if (!(real & (uint32_t)m->outputs) || length == 0 || length > (size_t)(end - values)) {
            return false;
        }
        const double *from = (const double *)((const char *)&m->state.values + (real & VARIABLE_OFFSET));
        for (uint32_t k = 0; k < length; ++k) {
            *values++ = from[k];
        }
    }
    /* products of values within their ranges may be more than a double holds */
    return values == end && (m->outputs < OUTPUTS_ALL || all_finite(end - count, end));
}
