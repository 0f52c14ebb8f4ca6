/* The end of initialization: checks of the parameters, warnings, and the start of the motion. */
#include <math.h>
#include <string.h>

#include "contact/law.h"
#include "contact/shape.h"
#include "model/state.h"
#include "scene/evaluate.h"

/* Relative rounding of a sum of moments of inertia, which equals the third one of a flat body. */
static const double INERTIA_ROUNDING = 1e-12;

/* Checks the principal moments of inertia of a compound that turns freely. */
static enum model_status check_inertia(struct model *m, int body)
{
    const struct vec3 of = body_principal_inertia(&m->state.values, body);
    const double largest = vec3_max_abs(of);
    return largest <= (of.x + of.y + of.z - largest) * (1.0 + INERTIA_ROUNDING)
               ? MODEL_OK
               : model_report(
                     m, MODEL_ERROR,
                     "%s.principal_inertia = (%g, %g, %g) kg m^2 contradicts itself: no body has one "
                     "larger than the sum of the others (allowed: at most that sum).",
                     scene_body_name(body), of.x, of.y, of.z);
}

static enum model_status check_rotation(struct model *m, int body)
{
    const struct scene_values *v = &m->state.values;
    const bool turns = body_turns_freely(v, body);
    const char *unfit = model_unfit_turn(m, body);
    if (body_is_compound(body) && quaternion_is_zero(body_initial_orientation(v, body))) {
        unfit = "initial_orientation";
    }
    if (SCENE_ANY_KEPT_AXIS && turns && model_tilts_axis(v, body, body_initial_angular_velocity(v, body))) {
        unfit = "initial_angular_velocity";
    }
    if (unfit != NULL) {
        return model_refuse_turn(m, MODEL_ERROR, body, unfit);
    }
    return turns && body_is_compound(body) ? check_inertia(m, body) : MODEL_OK;
}

/* This is the least sine of the angle between skew axes. The place of contact keeps ten digits beyond it. */
static const double LEAST_SKEW = 1e-6;

/* Checks that axes have directions, and that those of two cylinders are parallel, or skew by choice. */
static enum model_status check_axes(struct model *m, int contact)
{
    const struct scene_values *v = &m->state.values;
    const int bodies[] = {contact_destination(contact), contact_source(contact)};
    for (int i = 0; i < 2; ++i) {
        if (body_has_axis(bodies[i]) && !(vec3_norm(body_axis(v, bodies[i])) > 0.0)) {
            return model_refuse_turn(m, MODEL_ERROR, bodies[i], "axis");
        }
    }
    const char *names[] = {scene_body_name(bodies[0]), scene_body_name(bodies[1])};
    const struct vec3 axis = body_axis(v, bodies[0]);
    if (contact_has_skew_axes(v, contact)) {
        const double sine = vec3_norm(vec3_cross(body_unit_axis(v, bodies[0]), body_unit_axis(v, bodies[1])));
        return sine >= LEAST_SKEW
                   ? MODEL_OK
                   : model_report(m, MODEL_ERROR,
                                  "%s.axis = (%g, %g, %g) contradicts %s.axes = skew: it is parallel to "
                                  "%s.axis, to an angle of %g rad (allowed: 1e-6 rad at least, or axes = "
                                  "parallel).",
                                  names[0], axis.x, axis.y, axis.z, scene_contact_name(contact), names[1],
                                  sine);
    }
    return !SCENE_ANY_KEPT_AXIS || !model_tilts_axis(v, bodies[1], axis)
               ? MODEL_OK
               : model_report(m, MODEL_ERROR,
                              "%s.axis = (%g, %g, %g) contradicts %s.axis: contact of two cylinders takes "
                              "parallel axes where %s.axes is parallel (allowed: multiples of %s.axis, or "
                              "axes = skew).",
                              names[0], axis.x, axis.y, axis.z, names[1], scene_contact_name(contact),
                              names[1]);
}

/* Checks that a source that may touch a torus from within passes through the hole. One that touches all round
 * the hole has no nearest point. */
static enum model_status check_ring(struct model *m, int contact)
{
    const struct scene_values *v = &m->state.values;
    const int body = contact_destination(contact);
    const double ring = body_ring_radius(v, body);
    const double r_s = contact_source_radius(v, contact);
    const char *name = scene_body_name(body);
    const char *source = scene_body_name(contact_source(contact));
    const bool may_fill = contact_location(v, contact) != LOCATION_INSIDE &&
                          body_side(v, body) != TUBE_SIDE_OUTER_RACE && r_s + body_radius(v, body) >= ring;
    return !may_fill
               ? MODEL_OK
               : model_report(
                     m, MODEL_ERROR,
                     "%s.radius = %s m contradicts %s.ring_radius = %s m: the source would touch all round "
                     "the hole (allowed: one that fits through, location inside, or side outer_race).",
                     source, shortest_digits(r_s).text, name, shortest_digits(ring).text);
}

/* Checks that a contact's factors are finite, as products of finite parameters need not be. */
static enum model_status check_factors(struct model *m, int contact)
{
    const struct scene_values *v = &m->state.values;
    const struct contact_parameters *at = &m->state.motion.contact[contact].parameters;
    const char *name = scene_contact_name(contact);
    if (isfinite(at->factors.k) && isfinite(at->factors.c)) {
        return MODEL_OK;
    }
    return scene_is_hertz(v, contact)
               ? model_report(
                     m, MODEL_ERROR,
                     "Hertz's factors of %s are not finite: k_h = %g N/m^1.5, chi = %g s/m (allowed: "
                     "finite products of moduli, radii and times).",
                     name, at->factors.k, at->factors.c)
               : model_report(m, MODEL_ERROR,
                              "The automatic penalty factors of %s are not finite: p_n = %g N/m, p_nv = %g N "
                              "s/m from %s.penalty_multiplier = %g, %s.reference_modulus = %g Pa, diagonal = "
                              "%g m (allowed: finite products).",
                              name, at->factors.k, at->factors.c, name,
                              contact_penalty_multiplier(v, contact), name,
                              contact_reference_modulus(v, contact), at->diagonal);
}

/* The penetration at the start divided by the smaller radius, above which the model warns. A penalty
 * contact is meant for small deformations and throws such bodies apart; perhaps lengths were meant in
 * millimetres. */
static const double DEEP_START = 0.1;

static void warn_of_deep_start(const struct model *m, const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_whole_shape(&m->state.motion, contact);
    const struct contact_law law = scene_contact_law(&m->state.motion, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const double radius = shape.other_radius > 0.0 ? fmin(shape.source_radius, shape.other_radius)
                                                   : shape.source_radius; /* the other body is a plane */
    if (!(-g->gap > DEEP_START * radius) || scene_beyond_ends(&shape, g) > 0.0) {
        return;
    }
    model_report(
        m, MODEL_WARNING,
        "%s.gap = %g m at the start: the bodies overlap by more than a tenth of the smaller radius, %g m, "
        "and %g J are stored in it (allowed: any, but the law is meant for small ones). Given once.",
        scene_contact_name(contact), g->gap, radius, contact_stored_energy(&law, REGIME_COMPRESSION, g->gap));
}

/* Checks that the forces and energies at the start are finite, and warns of deep penetrations. */
static enum model_status check_start(struct model *m)
{
    const struct scene_values *v = &m->state.values;
    struct scene_instant at;
    scene_now(&m->state.motion, &at);
    double sum = 0.0;
    if (SCENE_ANY_FREE && !scene_is_force_element(v)) {
        const struct scene_energies energy = scene_energies_of(&at);
        sum = energy.kinetic + energy.potential + energy.stored;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += at.normal_force[j];
    }
    if (!isfinite(sum)) {
        return model_report(
            m, MODEL_ERROR,
            "The start is beyond the range of numbers (allowed: finite forces and energies).");
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        warn_of_deep_start(m, &at, j);
    }
    return MODEL_OK;
}

/* A source within its destination conforms to it where r_s / r_d exceeds this number. The effective radius
 * r_s r_d / (r_d - r_s) is then more than nine times r_d. */
static const double CONFORMING = 0.9;

/* Warns of conforming surfaces. Hertz's theory assumes a contact area that is small compared with the
 * bodies. */
static enum model_status warn_of_conforming(struct model *m)
{
    enum model_status status = MODEL_OK;
    const struct scene_values *v = &m->state.values;
    for (int j = 0; SCENE_ANY_HERTZ && j < SCENE_CONTACTS; ++j) {
        const struct contact_shape shape = scene_contact_shape(&m->state.motion, j);
        if (scene_is_hertz(v, j) && contact_penalty_control(v, j) == PENALTY_CONTROL_AUTOMATIC &&
            shape.side < 0 && shape.source_radius > CONFORMING * shape.other_radius) {
            status = model_report(m, MODEL_WARNING,
                                  "%s: %s.radius = %s m is hardly smaller than %s.radius = %s m around it: "
                                  "such surfaces follow each other, and the stiffness of Hertz's theory is "
                                  "only roughly right (its range: up to nine tenths).",
                                  scene_contact_name(j), scene_body_name(contact_source(j)),
                                  shortest_digits(shape.source_radius).text,
                                  scene_body_name(contact_destination(j)),
                                  shortest_digits(shape.other_radius).text);
        }
    }
    return status;
}

/*
 * Warns of each parameter that has been set and that nothing reads, naming the choice by which something
 * would: a user may have meant the parameter to take effect. A parameter counts as set when it differs from
 * its start value: some importers set every parameter to its start value, and a warning for each of them
 * would hide the one that matters.
 */
static void warn_of_idle(struct model *m)
{
    struct scene_values start;
    const struct variable *warned = NULL;
    if (!model_reports(m, MODEL_WARNING)) {
        return;
    }
    scene_start(&start);
    for (int i = 0; i < scene_variable_count; ++i) {
        const struct variable *variable = &scene_variables[i];
        const double value = variable_value(variable, &m->state.values);
        const char *choices = scene_idle(&m->state.values, i);
        if (!choices || value == variable_value(variable, &start) ||
            (warned && warned->row == variable->row && warned->element == variable->element)) {
            continue;
        }
        warned = variable; /* one warning for the three components of a vector */
        model_report(m, MODEL_WARNING, "%s = %s was set and is not in force: nothing reads it unless %s.",
                     variable->name, shortest_digits(value).text, choices);
    }
}

/* Checks the parameters for contradictions and reports the first; where there is none, the motion is at its
 * start. */
CONTACT_COLD static enum model_status check_consistency(struct model *m)
{
    double numbers[2] = {0.0, 0.0};
    const char *refusal = scene_refusal(&m->state.values, numbers);
    if (refusal) {
        return model_report(m, MODEL_ERROR, refusal, shortest_digits(numbers[0]).text,
                            shortest_digits(numbers[1]).text);
    }
    enum model_status status = MODEL_OK;
    for (int i = 0; SCENE_ANY_ROTATION && i < SCENE_BODIES && status == MODEL_OK; ++i) {
        status = check_rotation(m, i);
    }
    for (int j = 0; j < SCENE_CONTACTS && status == MODEL_OK; ++j) {
        const bool is_torus = SCENE_ANY_TORUS && body_shape(contact_destination(j)) == SHAPE_TORUS;
        status = is_torus ? check_ring(m, j) : MODEL_OK;
        status = SCENE_ANY_AXIS && status == MODEL_OK ? check_axes(m, j) : status;
    }
    if (status == MODEL_OK) {
        model_prepare(m);
    }
    for (int j = 0; j < SCENE_CONTACTS && status == MODEL_OK; ++j) {
        status = check_factors(m, j);
    }
    status = status == MODEL_OK ? check_start(m) : status;
    return status == MODEL_OK ? warn_of_conforming(m) : status;
}

/* Sets half of the extents of a body's axis-aligned box [m]. A cylinder along the unit vector e extends by
 * L/2 |e_i| + r sqrt(1 - e_i^2) in direction i. L = 0 gives the box of the cross-section, which represents an
 * infinite cylinder; e = 0 that of a sphere. The tube of a torus goes beyond the circle in its middle. */
static void put_half_extents(const struct scene_values *v, int body, double radius, double half[3])
{
    const bool is_cylinder = SCENE_ANY_CYLINDER && body_shape(body) == SHAPE_CYLINDER;
    const bool is_torus = SCENE_ANY_TORUS && body_shape(body) == SHAPE_TORUS;
    const bool has_length = is_cylinder && body_finite_length(v, body);
    const struct vec3 zero = {0.0, 0.0, 0.0};
    const struct vec3 axis = is_cylinder || is_torus ? body_unit_axis(v, body) : zero;
    double e[3];
    vec3_to(axis, e);
    for (int i = 0; i < 3; ++i) {
        const double across = sqrt(fmax(0.0, (1.0 - e[i]) * (1.0 + e[i])));
        half[i] = (has_length ? 0.5 * body_length(v, body) : 0.0) * fabs(e[i]) +
                  (is_torus ? radius + body_ring_radius(v, body) * across : radius * across);
    }
}

/* A plane has no box. Where faces of two boxes coincide, the face of the source counts. */
double model_diagonal(const struct scene_values *v, int contact, struct vec3 c, struct vec3 rate,
                      double *slope)
{
    const int to = contact_destination(contact);
    const bool on_plane = SCENE_ANY_PLANE && body_shape(to) == SHAPE_PLANE;
    double a[3], b[3], place[3], moves[3], edge[3];
    vec3_to(c, place);
    vec3_to(rate, moves);
    put_half_extents(v, contact_source(contact), contact_source_radius(v, contact), a);
    put_half_extents(v, to, contact_destination_radius(v, contact), b);
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double high = on_plane ? a[i] : fmax(a[i], place[i] + b[i]);
        const double low = on_plane ? -a[i] : fmin(-a[i], place[i] - b[i]);
        edge[i] = high - low;
        sum += edge[i] * ((high > a[i]) - (low < -a[i])) * moves[i];
    }
    const double diagonal = vec3_norm(vec3_from(edge));
    *slope = sum / diagonal;
    return diagonal;
}

static void prepare_contact(struct scene_state *q, int contact)
{
    struct contact_state *state = &q->contact[contact];
    struct contact_parameters *fixed = &state->parameters;
    state->regime = (int32_t)REGIME_APART;
    contact_fix_axes(q->v, contact, fixed);
    struct contact_shape shape = scene_contact_shape(q, contact);
    state->physics.normal = contact_default_normal(&shape);
    struct scene_instant at;
    double still;
    scene_kinematics_now(q, &at);
    fixed->diagonal = model_diagonal(q->v, contact, at.separation[contact], vec3_make(0.0, 0.0, 0.0), &still);
    if (SCENE_ANY_FRICTION) { /* v_0: automatic, or the user's; 1e-3 has the unit 1/s */
        fixed->slip_velocity = contact_slip_velocity_control(q->v, contact) == SLIP_VELOCITY_CONTROL_AUTOMATIC
                                   ? 1e-3 * fixed->diagonal
                                   : contact_characteristic_slip_velocity(q->v, contact);
    }
    state->side = shape.side;
    if (contact_location(q->v, contact) == LOCATION_AUTOMATIC && !contact_is_zoned(&shape)) {
        /* The source is inside when its centre is closer than r_d to the centre or axis, and it fits in. */
        state->side =
            at.geometry[contact].distance < shape.other_radius && shape.source_radius < shape.other_radius
                ? -1
                : 1;
    }
    state->physics.normal = at.geometry[contact].normal;
    fixed->factors = model_factors(q, contact, fixed->diagonal);
}

/* Returns the orientation that a body starts with, the smallest rotation that takes z to its axis. */
static struct quaternion start_orientation(const struct scene_values *v, int body)
{
    if (body_is_compound(body)) {
        return quaternion_unit(body_initial_orientation(v, body));
    }
    return body_has_axis(body) ? quaternion_between(vec3_make(0.0, 0.0, 1.0), body_unit_axis(v, body))
                               : quaternion_identity();
}

/* Sets orientations and angular velocities at the start. */
static void place_rotations(struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        struct body_turn *origin = &q->turn_origin[i];
        origin->orientation = !body_turn_is_prescribed(q->v, i) ? start_orientation(q->v, i)
                              : body_is_compound(i)             ? q->path[i].orientation
                                                                : quaternion_identity();
        origin->angular_velocity =
            body_turns_freely(q->v, i) ? body_initial_angular_velocity(q->v, i) : vec3_make(0.0, 0.0, 0.0);
        q->turning.body[i] = *origin;
    }
    turning_take_axes(q);
}

void model_prepare(struct model *m)
{
    struct scene_state *q = &m->state.motion;
    const struct scene_values *v = &m->state.values;
    memset(q, 0, sizeof *q);
    q->v = v;
    if (m->state.importer_tolerance > 0.0) {
        put_solver_relative_tolerance(&m->state.values, m->state.importer_tolerance);
    }
    q->base = m->state.start_time;
    model_start_paths(m);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            q->origin[i] = (struct body_origin){body_initial_displacement(v, i), body_initial_velocity(v, i)};
            q->body[i].velocity = q->origin[i].velocity;
        }
    }
    if (SCENE_ANY_ROTATION) {
        place_rotations(q);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].side = 1;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        prepare_contact(q, j);
    }
    motion_begin(q);
    if (m->host.exchange) {
        motion_forget_integration(q);
    }
}

enum model_status model_exit_initialization(struct model *m)
{
    const enum model_status checked = check_consistency(m);
    if (checked > MODEL_WARNING) {
        return checked;
    }
    if (!m->host.exchange && motion_open(m, "Initialization failed") != MODEL_OK) {
        return MODEL_ERROR;
    }
    warn_of_idle(m);
    m->state.initialized = 1;
    m->outputs = OUTPUTS_NONE;
    return checked;
}
