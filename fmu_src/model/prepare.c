/* The end of initialization: checks of the parameters, warnings, and the start of the motion. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "contact/law.h"
#include "contact/shape.h"
#include "model/state.h"
#include "scene/evaluate.h"

/* Relative rounding of a sum of moments of inertia, which equals the third one of a flat body. */
static const double INERTIA_ROUNDING = 1e-12;

/* Checks the moments of inertia of a freely turning body. If the density is nowhere negative, the transverse
 * moment is at least half of the axial one. */
static enum model_status check_inertia(struct model *m, int body)
{
    const struct scene_values *v = &m->state.values;
    const char *name = scene_body_name(body);
    const bool tilts = body_tips(v, body);
    if (body_inertia_control(v, body) == INERTIA_CONTROL_AUTOMATIC) {
        return MODEL_OK;
    }
    if (body_is_compound(body)) {
        const struct vec3 of = body_principal_inertia(v, body);
        const double largest = vec3_max_abs(of);
        return largest <= (of.x + of.y + of.z - largest) * (1.0 + INERTIA_ROUNDING)
                   ? MODEL_OK
                   : model_report(m, MODEL_ERROR,
                                  "%s.principal_inertia = (%g, %g, %g) kg m^2 contradicts itself: no body "
                                  "has one larger than the sum of the others (allowed: at most that sum).",
                                  name, of.x, of.y, of.z);
    }
    const double axial = body_axial_inertia(v, body);
    const double transverse = body_transverse_inertia(v, body);
    return !tilts || transverse >= 0.5 * axial
               ? MODEL_OK
               : model_report(m, MODEL_ERROR,
                              "%s.transverse_inertia = %s kg m^2 contradicts %s.axial_inertia = %s kg m^2: "
                              "no body has so little (allowed: half of axial_inertia at least).",
                              name, shortest_digits(transverse).text, name, shortest_digits(axial).text);
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
    return SCENE_ANY_FREE_ROTATION && turns ? check_inertia(m, body) : MODEL_OK;
}

/* Checks that the static coefficient of elastic friction is not below the sliding one. */
static enum model_status check_friction(struct model *m, int contact)
{
    const struct scene_values *v = &m->state.values;
    const char *name = scene_contact_name(contact);
    const double coefficient = contact_friction_coefficient(v, contact);
    const double static_coefficient = contact_static_friction_coefficient(v, contact);
    if (contact_has_spring(v, contact, OPPOSED_SLIP) && static_coefficient < coefficient) {
        return model_report(m, MODEL_ERROR,
                            "%s.static_friction_coefficient = %s contradicts %s.friction_coefficient = %s "
                            "(allowed: one that is not smaller).",
                            name, shortest_digits(static_coefficient).text, name,
                            shortest_digits(coefficient).text);
    }
    return MODEL_OK;
}

/* Least sine of the angle between skew axes. The place of contact keeps ten digits beyond it. */
static const double LEAST_SKEW = 1e-6;

/* Checks that the axes of cylinders with skew axes are not nearly parallel. */
static enum model_status check_skew(struct model *m, int contact)
{
    const struct scene_values *v = &m->state.values;
    const char *name = scene_contact_name(contact);
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const double sine = vec3_norm(vec3_cross(body_unit_axis(v, source), body_unit_axis(v, destination)));
    const struct vec3 axis = body_axis(v, destination);
    return sine >= LEAST_SKEW
               ? MODEL_OK
               : model_report(m, MODEL_ERROR,
                              "%s.axis = (%g, %g, %g) contradicts %s.axes = skew: it is parallel to %s.axis, "
                              "to an angle of %g rad (allowed: 1e-6 rad at least, or axes = parallel).",
                              scene_body_name(destination), axis.x, axis.y, axis.z, name,
                              scene_body_name(source), sine);
}

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
    if (contact_has_skew_axes(v, contact)) {
        return check_skew(m, contact);
    }
    if (!SCENE_ANY_KEPT_AXIS || !model_tilts_axis(v, bodies[1], body_axis(v, bodies[0]))) {
        return MODEL_OK;
    }
    const char *names[] = {scene_body_name(bodies[0]), scene_body_name(bodies[1])};
    const struct vec3 axis = body_axis(v, bodies[0]);
    return model_report(m, MODEL_ERROR,
                        "%s.axis = (%g, %g, %g) contradicts %s.axis: contact of two cylinders takes parallel "
                        "axes where %s.axes is parallel (allowed: multiples of %s.axis, or axes = skew).",
                        names[0], axis.x, axis.y, axis.z, names[1], scene_contact_name(contact), names[1]);
}

/* Checks that a torus has a hole, and that a source that may touch it from within passes through: where one
 * touches all round no point is the nearest. */
static enum model_status check_ring(struct model *m, int contact, double r_s, double r_d)
{
    const struct scene_values *v = &m->state.values;
    const int body = contact_destination(contact);
    const double ring = body_ring_radius(v, body);
    const char *name = scene_body_name(body);
    const char *source = scene_body_name(contact_source(contact));
    if (r_d >= ring) {
        return model_report(m, MODEL_ERROR,
                            "%s.radius = %s m contradicts %s.ring_radius = %s m: a torus has a hole "
                            "(allowed: a tube with a smaller radius than the ring).",
                            name, shortest_digits(r_d).text, name, shortest_digits(ring).text);
    }
    const bool may_fill = contact_location(v, contact) != LOCATION_INSIDE &&
                          body_side(v, body) != TUBE_SIDE_OUTER_RACE && r_s + r_d >= ring;
    return !may_fill
               ? MODEL_OK
               : model_report(
                     m, MODEL_ERROR,
                     "%s.radius = %s m contradicts %s.ring_radius = %s m: the source would touch all round "
                     "the hole (allowed: one that fits through, location inside, or side outer_race).",
                     source, shortest_digits(r_s).text, name, shortest_digits(ring).text);
}

static enum model_status check_contact(struct model *m, int contact)
{
    const struct scene_values *v = &m->state.values;
    const char *name = scene_contact_name(contact);
    const char *source = scene_source_name(contact);
    const char *destination = scene_body_name(contact_destination(contact));
    const double r_s = contact_source_radius(v, contact);
    const double r_d = contact_destination_radius(v, contact);
    if (contact_location(v, contact) == LOCATION_INSIDE && r_s >= r_d) {
        return model_report(m, MODEL_ERROR,
                            "%s.location = inside contradicts %s.radius = %s m >= %s.radius = %s m (allowed: "
                            "a source smaller than its hollow destination).",
                            name, source, shortest_digits(r_s).text, destination, shortest_digits(r_d).text);
    }
    enum model_status status = MODEL_OK;
    if (SCENE_ANY_TORUS && body_shape(contact_destination(contact)) == SHAPE_TORUS) {
        status = check_ring(m, contact, r_s, r_d);
    }
    status = SCENE_ANY_AXIS && status == MODEL_OK ? check_axes(m, contact) : status;
    return status == MODEL_OK ? check_friction(m, contact) : status;
}

/* Checks that a contact's factors are finite, as products of finite parameters need not be. */
static enum model_status check_factors(struct model *m, int contact)
{
    const struct contact_state *state = &m->state.motion.contact[contact];
    if (isfinite(state->parameters.factors.k) && isfinite(state->parameters.factors.c)) {
        return MODEL_OK;
    }
    const char *name = scene_contact_name(contact);
    if (scene_is_hertz(&m->state.values, contact)) {
        return model_report(m, MODEL_ERROR,
                            "Hertz's factors of %s are not finite: k_h = %g N/m^1.5, chi = %g s/m (allowed: "
                            "finite products of moduli, radii and times).",
                            name, state->parameters.factors.k, state->parameters.factors.c);
    }
    return model_report(m, MODEL_ERROR,
                        "The automatic penalty factors of %s are not finite: p_n = %g N/m, p_nv = %g N s/m "
                        "from %s.penalty_multiplier = %g, %s.reference_modulus = %g Pa, diagonal = %g m "
                        "(allowed: finite products).",
                        name, state->parameters.factors.k, state->parameters.factors.c, name,
                        contact_penalty_multiplier(&m->state.values, contact), name,
                        contact_reference_modulus(&m->state.values, contact), state->parameters.diagonal);
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

/* Largest r_s divided by r_d without conformity. The effective radius r_s r_d / (r_d - r_s) is here already
 * ten times r_s. */
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

/* Whether a condition holds for a body or contact. Sets *first to the first body or contact whose choice
 * counts for it. */
static bool condition_holds(const struct scene_values *v, const struct scene_use *use, int element,
                            int *first)
{
    *first = use->whose == USE_OF_SOURCE        ? contact_source(element)
             : use->whose == USE_OF_DESTINATION ? contact_destination(element)
             : use->whose == USE_OF_ANY         ? 0
                                                : element;
    const int last = use->whose == USE_OF_ANY ? use->owners : *first + 1;
    for (int i = *first; i < last; ++i) {
        if ((1 << scene_choice(v, use->choice, i)) & use->items) {
            return true;
        }
    }
    return false;
}

/* Bytes for the choices that a message names. */
enum { REMEDY_SIZE = 200 };

/* Whether nothing reads a parameter. `remedy` then names the choices by which something would read it, as
 * "contact.friction = elastic and ...", for the alternative with the fewest missing conditions. */
static bool is_idle(const struct scene_values *v, const struct variable *variable, char *remedy)
{
    int least = 0;
    const struct scene_use *next = NULL; /* alternative */
    for (const struct scene_use *use = scene_uses; use->row != ROW_COUNT; use = next) {
        char found[REMEDY_SIZE];
        size_t used = 0;
        int missing = 0;
        int first = 0;
        for (next = use; next->row == use->row && next->alternative == use->alternative; ++next) {
            if (use->row != variable->row || condition_holds(v, next, variable->element, &first)) {
                continue;
            }
            const struct variable *choice = variable_of_row(next->choice, first);
            const int length = snprintf(found + used, REMEDY_SIZE - used, "%s%s = %s",
                                        missing > 0 ? " and " : "", choice ? choice->name : "", next->wanted);
            used = length > 0 && used + (size_t)length < REMEDY_SIZE ? used + (size_t)length : used;
            missing += 1;
        }
        if (use->row == variable->row && missing == 0) {
            return false;
        }
        if (missing > 0 && (least == 0 || missing < least)) {
            least = missing;
            memcpy(remedy, found, sizeof found);
        }
    }
    return least > 0;
}

/*
 * A user may have meant a parameter to take effect that nothing reads. A parameter counts as set when it
 * differs from its start value: some importers set every parameter to its start value, and a warning for each
 * of them would hide the one that matters.
 */
void model_warn_of_idle(struct model *m)
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
        char remedy[REMEDY_SIZE];
        if (variable->causality != VARIABLE_PARAMETER || value == variable_value(variable, &start) ||
            (warned && warned->row == variable->row && warned->element == variable->element) ||
            !is_idle(&m->state.values, variable, remedy)) {
            continue;
        }
        warned = variable; /* one warning for the three components of a vector */
        model_report(m, MODEL_WARNING, "%s = %s was set and is not in force: nothing reads it unless %s.",
                     variable->name, shortest_digits(value).text, remedy);
    }
}

enum model_status model_check_consistency(struct model *m)
{
    const char *refusal = scene_refusal(&m->state.values);
    if (refusal) {
        return model_report(m, MODEL_ERROR, "%s", refusal);
    }
    if (SCENE_ANY_ROTATION) {
        for (int i = 0; i < SCENE_BODIES; ++i) {
            const enum model_status status = check_rotation(m, i);
            if (status != MODEL_OK) {
                return status;
            }
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        enum model_status status = check_contact(m, j);
        if (status == MODEL_OK) {
            model_prepare(m);
            status = check_factors(m, j);
        }
        if (status != MODEL_OK) {
            return status;
        }
    }
    const enum model_status status = check_start(m);
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

/* Returns the place of the destination of a contact relative to the source at the start [m], or of the parts
 * of compounds that meet. A common offset of the bodies thus costs no digits. */
static struct vec3 start_separation(const struct scene_state *q, int contact)
{
    const int from = contact_source(contact);
    const int to = contact_destination(contact);
    const struct vec3 apart = vec3_sub(body_center(q->v, to), body_center(q->v, from));
    struct vec3 moved = vec3_sub(scene_displacement_of(q, to, scene_body_now(q, to).moved),
                                 scene_displacement_of(q, from, scene_body_now(q, from).moved));
    if (SCENE_ANY_COMPOUND) {
        const struct vec3 start =
            quaternion_rotate(q->turn_origin[from].orientation, contact_source_part(contact));
        const struct vec3 end =
            quaternion_rotate(q->turn_origin[to].orientation, contact_destination_part(contact));
        moved = vec3_add(moved, vec3_sub(end, start));
    }
    return vec3_add(apart, moved);
}

/* Returns the diagonal [m] of the smallest axis-aligned box around both bodies of a contact at the start; it
 * scales the automatic penalty factors. Sets *slope to its rate while the destination moves with `rate`
 * [m/s]. A plane has no box. Where faces of two boxes coincide, that of the source counts. */
static double start_diagonal(const struct scene_state *q, int contact, struct vec3 rate, double *slope)
{
    const int to = contact_destination(contact);
    const bool on_plane = SCENE_ANY_PLANE && body_shape(to) == SHAPE_PLANE;
    double a[3], b[3], c[3], moves[3], edge[3];
    vec3_to(start_separation(q, contact), c);
    vec3_to(rate, moves);
    put_half_extents(q->v, contact_source(contact), contact_source_radius(q->v, contact), a);
    put_half_extents(q->v, to, contact_destination_radius(q->v, contact), b);
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double high = on_plane ? a[i] : fmax(a[i], c[i] + b[i]);
        const double low = on_plane ? -a[i] : fmin(-a[i], c[i] - b[i]);
        edge[i] = high - low;
        sum += edge[i] * ((high > a[i]) - (low < -a[i])) * moves[i];
    }
    const double diagonal = vec3_norm(vec3_from(edge));
    *slope = sum / diagonal;
    return diagonal;
}

double model_diagonal_slope(const struct model *m, int contact, struct vec3 rate)
{
    double slope;
    (void)start_diagonal(&m->state.motion, contact, rate, &slope);
    return slope;
}

static void prepare_contact(struct scene_state *q, int contact)
{
    struct contact_state *state = &q->contact[contact];
    double still;
    state->parameters.diagonal = start_diagonal(q, contact, vec3_make(0.0, 0.0, 0.0), &still);
    state->side = 1;
    state->regime = (int32_t)REGIME_APART;
    if (SCENE_ANY_FRICTION) { /* v_0: automatic, or the user's; 1e-3 has the unit 1/s */
        state->parameters.slip_velocity =
            contact_slip_velocity_control(q->v, contact) == SLIP_VELOCITY_CONTROL_AUTOMATIC
                ? 1e-3 * state->parameters.diagonal
                : contact_characteristic_slip_velocity(q->v, contact);
    }
    if (SCENE_ANY_AXIS && body_has_axis(contact_destination(contact))) {
        state->parameters.axis = body_unit_axis(q->v, contact_destination(contact));
    }
    struct contact_shape shape = scene_contact_shape(q, contact);
    state->physics.normal = contact_default_normal(&shape);
    struct scene_instant at;
    scene_now(q, &at);
    state->side = shape.side;
    if (contact_location(q->v, contact) == LOCATION_AUTOMATIC && !contact_is_zoned(&shape)) {
        /* The source is inside when its centre is closer than r_d to the centre or axis, and it fits in. */
        state->side =
            at.geometry[contact].distance < shape.other_radius && shape.source_radius < shape.other_radius
                ? -1
                : 1;
    }
    state->physics.normal = at.geometry[contact].normal;
    state->parameters.factors = model_factors(q, contact);
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
        turning_place(q);
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
