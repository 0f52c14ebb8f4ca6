#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "contact/law.h"
#include "model/state.h"
#include "scene/evaluate.h"
#include "scene/transition.h"

/*
 * Between communication points each input continues from its last value as a polynomial with the given
 * derivatives. A prescribed body follows its prescribed velocity, unless the importer gives derivatives of
 * its displacement. Where all bodies are prescribed, they move by given derivatives only. An importer that
 * integrates (Model Exchange) sets inputs at each instant; in between they stay constant.
 */

/* Sets the coefficients 0..2 of a path by signals of its components that were set at this communication
 * point. A new value or derivative ends the derivatives of higher order that are not set with it. Lower
 * orders keep their present values. */
static void put_signals(struct vec3 *path, struct vec3 value, const double signals[][2], const uint8_t *marks)
{
    for (int k = 0; k < 3; ++k) {
        const double set[] = {vec3_get(value, k), signals[k][0], 0.5 * signals[k][1]};
        for (int i = 0; i < 3; ++i) {
            if (marks[k] & ((2 << i) - 1)) { /* this order or a lower one */
                *vec3_part(&path[i], k) = marks[k] & (1 << i) ? set[i] : 0.0;
            }
        }
    }
}

/* Lets a displacement go on as a polynomial of third degree where it follows the velocity, and else of second
 * degree. */
static void extend_displacement(struct body_path *path, const uint8_t *marks, bool follows_velocity)
{
    for (int k = 0; k < 3; ++k) {
        if (marks[k] & SIGNAL_SET) {
            *vec3_part(&path->displacement[3], k) = 0.0;
        }
        for (int i = 0; i < 3 && follows_velocity && !(marks[k] & SIGNAL_EXPLICIT); ++i) {
            *vec3_part(&path->displacement[i + 1], k) = vec3_get(path->velocity[i], k) / (i + 1);
        }
    }
}

static bool inputs_prescribe_all(const struct scene_values *v)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (!body_is_prescribed(v, i)) {
            return false;
        }
    }
    return true;
}

/* This table lists the inputs of a body in the order of their signals: the row, the path that takes the
 * input, its value, and whether the body follows it. The orientation has no derivatives. */
static const struct input_kind {
    int row;
    size_t path; /* its place in struct body_path [bytes] */
    struct vec3 (*value)(const struct scene_values *v, int body);
    bool (*in_use)(const struct scene_values *v, int body);
} input_kinds[] = {
    {ROW_body_prescribed_displacement, offsetof(struct body_path, displacement), body_prescribed_displacement,
     body_is_prescribed},
    {ROW_body_prescribed_velocity, offsetof(struct body_path, velocity), body_prescribed_velocity,
     body_is_prescribed},
    {ROW_body_external_force, offsetof(struct body_path, force), body_external_force, body_is_free},
    {ROW_body_prescribed_angular_velocity, offsetof(struct body_path, angular_velocity),
     body_prescribed_angular_velocity, SCENE_ANY_ROTATION ? body_turn_is_prescribed : NULL},
    {ROW_body_prescribed_axis, offsetof(struct body_path, axis), body_prescribed_axis,
     SCENE_ANY_ROTATION ? body_turn_is_prescribed : NULL},
    {ROW_body_external_torque, offsetof(struct body_path, torque), body_external_torque, body_turns_freely},
    {.row = ROW_body_prescribed_orientation}};

enum {
    VECTOR_INPUTS = SCENE_ANY_ROTATION ? sizeof input_kinds / sizeof input_kinds[0] - 1 : 3,
    AXIS_SIGNAL = 12,       /* the first signal of the prescribed axis */
    ORIENTATION_SIGNAL = 18 /* the first of the prescribed orientation */
};

/* Renews the rotation that a body is prescribed. The prescribed axis follows its given derivatives where it
 * has some, else the angular velocity; in Model Exchange the axis input alone tells it. */
static void renew_turn(const struct model *m, int body, const uint8_t *marks, struct body_path *path)
{
    struct quaternion given = body_prescribed_orientation(&m->state.values, body);
    const bool follows = SCENE_ANY_COMPOUND && body_turn_is_prescribed(&m->state.values, body);
    for (int k = 0; follows && k < 4; ++k) {
        if (marks[ORIENTATION_SIGNAL + k] & SIGNAL_VALUE) {
            *quaternion_part(&path->orientation, k) = *quaternion_part(&given, k);
        }
    }
    const uint8_t *axis = marks + AXIS_SIGNAL;
    const bool has_rate = ((axis[0] | axis[1] | axis[2]) & SIGNAL_EXPLICIT) != 0;
    path->turn_follows = m->host.exchange ? TURN_FOLLOWS_AXIS_ALONE
                         : has_rate       ? TURN_FOLLOWS_AXIS
                                          : TURN_FOLLOWS_VELOCITY;
}

static void input_path_renew(const struct model *m, int body, const uint8_t *marks, struct body_path *path)
{
    const struct scene_values *v = &m->state.values;
    for (int i = 0; i < VECTOR_INPUTS; ++i) {
        const struct input_kind *kind = &input_kinds[i];
        if (kind->in_use(v, body)) {
            put_signals((struct vec3 *)((char *)path + kind->path), kind->value(v, body),
                        &m->state.signals[body][3 * i], &marks[3 * i]);
        }
    }
    if (body_is_prescribed(v, body)) {
        extend_displacement(path, marks, !m->host.exchange && !inputs_prescribe_all(v));
    }
    if (SCENE_ANY_ROTATION) {
        renew_turn(m, body, marks, path);
    }
}

void model_start_paths(struct model *m)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const uint8_t *set = m->state.marks[i];
        struct body_path *path = &m->state.motion.path[i];
        uint8_t marks[SIGNALS_EACH];
        for (int k = 0; k < SIGNALS_EACH; ++k) {
            marks[k] = set[k] | SIGNAL_VALUE;
        }
        input_path_renew(m, i, marks, path);
        /* until the inputs are set, parameters give the orientation and the axis */
        if (SCENE_ANY_COMPOUND && !(set[ORIENTATION_SIGNAL] | set[ORIENTATION_SIGNAL + 1] |
                                    set[ORIENTATION_SIGNAL + 2] | set[ORIENTATION_SIGNAL + 3])) {
            path->orientation = body_initial_orientation(&m->state.values, i);
        }
        if (SCENE_ANY_ROTATION && body_has_axis(i) &&
            !(set[AXIS_SIGNAL] | set[AXIS_SIGNAL + 1] | set[AXIS_SIGNAL + 2])) {
            path->axis[0] = body_axis(&m->state.values, i);
        }
    }
}

static void input_path_shift(const struct model *m, int body, struct body_path *path)
{
    const double clock = m->state.motion.clock;
    body_path_shift(&m->state.values, body, path, clock);
    if (SCENE_ANY_ROTATION && path->turn_follows == TURN_FOLLOWS_VELOCITY &&
        body_shape(body) != SHAPE_SPHERE && body_turn_is_prescribed(&m->state.values, body)) {
        /* the axis or the orientation has followed the angular velocity; components that are not set go on
         * from where it is */
        const struct body_turn now = turning_prescribed_at(&m->state.motion, clock, body);
        path->axis[0] = body_is_compound(body) ? path->axis[0] : quaternion_third_axis(now.orientation);
        path->orientation = now.orientation;
    }
}

/* Returns the damping factor that gives the coefficient of restitution. That of the linear law belongs to a
 * spring p_n; it is 0 where neither body is free, because such bodies cannot rebound. */
static double damping_by_restitution(const struct scene_values *v, int contact, double p_n)
{
    const double restitution = contact_restitution(v, contact);
    const enum dashpot dashpot = (enum dashpot)contact_dashpot(v, contact);
    const double per_mass = scene_inverse_mass(v, contact);
    if (scene_is_hertz(v, contact)) {
        return restitution_hunt_crossley(restitution, dashpot);
    }
    const double ratio = per_mass > 0.0 ? restitution_damping_ratio(restitution, dashpot) : 0.0;
    return ratio > 0.0 ? 2.0 * ratio * sqrt(p_n) / sqrt(per_mass) : 0.0;
}

struct contact_coefficients model_factors(const struct scene_state *q, int contact, double diagonal)
{
    const struct scene_values *v = q->v;
    const bool is_hertz = scene_is_hertz(v, contact);
    const double time = contact_characteristic_time(v, contact);
    const double scale = contact_reference_modulus(v, contact) * diagonal;
    const bool is_automatic = contact_penalty_control(v, contact) == PENALTY_CONTROL_AUTOMATIC;
    const bool only_damps = contact_penalty_control(v, contact) == PENALTY_CONTROL_VISCOUS_ONLY && !is_hertz;
    struct contact_coefficients at = {contact_penalty_factor(v, contact),
                                      contact_viscous_penalty_factor(v, contact)};
    if (is_hertz) { /* one k_h serves all zones of a shape */
        const struct contact_shape shape = scene_whole_shape(q, contact);
        at.k = is_automatic ? hertz_stiffness(&shape, scene_hertz_modulus(v, contact))
                            : contact_hertz_stiffness(v, contact);
        at.c = contact_hunt_crossley_factor(v, contact);
    } else if (is_automatic) {
        at.k = contact_penalty_multiplier(v, contact) * scale;
    }
    if (contact_method(v, contact) == METHOD_PENALTY) {
        at.c = 0.0;
    } else if (SCENE_ANY_RESTITUTION && contact_viscous_control(v, contact) == VISCOUS_CONTROL_RESTITUTION) {
        at.c = damping_by_restitution(v, contact, at.k);
    } else if (contact_viscous_control(v, contact) == VISCOUS_CONTROL_AUTOMATIC) {
        at.c = is_hertz ? time / diagonal : time * (only_damps ? scale : at.k);
    }
    at.k = only_damps ? 0.0 : at.k;
    return at;
}

/* Returns the slope of a factor that is proportional to a power of the diagonal, from its value at twice the
 * diagonal. `grows` is the relative slope of the diagonal. */
static double slope_of_power(double factor, double at_twice, double grows)
{
    return factor > 0.0 ? factor * log2(at_twice / factor) * grows : 0.0;
}

struct contact_law model_law_slope(const struct model *m, int contact, double diagonal_slope)
{
    const struct contact_parameters *at = &m->state.motion.contact[contact].parameters;
    const struct contact_coefficients twice = model_factors(&m->state.motion, contact, 2.0 * at->diagonal);
    const double grows = diagonal_slope / at->diagonal;
    return (struct contact_law){.stiffness = slope_of_power(at->factors.k, twice.k, grows),
                                .damping = slope_of_power(at->factors.c, twice.c, grows),
                                .law = scene_is_hertz(&m->state.values, contact) ? LAW_HERTZ : LAW_LINEAR};
}

/*
 * Some parameters may be set between steps: the factors of the law, its dashpot, gravity, the solver's
 * tolerances. A new value is in force from the communication point at which it is set. The values before are
 * kept until then, so that a parameter that is set back, or set without effect, changes nothing.
 */

/* Gives a contact new factors of its law. Errors of the gap and its rate make the error bound of the force
 * [N], and the factors multiply them. */
static void take_factors(struct contact_state *state, struct contact_coefficients next)
{
    const struct contact_coefficients *now = &state->parameters.factors;
    const double by_gap = now->k > 0.0 ? next.k / now->k : 1.0;
    const double by_rate = now->c > 0.0 ? next.c / now->c : 1.0;
    double *error = &state->physics.force_error;
    *error = fmin(*error * fmax(1.0, fmax(by_gap, by_rate)), DBL_MAX);
    state->parameters.factors = next;
}

/* Takes over the parameters of `v` that differ from those of `before` and may be set between steps, and books
 * the energy that they add or remove. Returns false where a force, a factor or the work is not finite. The
 * caller must then give up the state q. */
static bool motion_tune(const struct scene_values *v, const struct scene_values *before,
                        struct scene_state *q)
{
    const struct vec3 more_gravity = vec3_sub(gravity(v), gravity(before));
    struct contact_coefficients factors[SCENE_CONTACTS];
    bool law_changed[SCENE_CONTACTS];
    bool changed = !vec3_is_zero(more_gravity);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_coefficients *now = &q->contact[j].parameters.factors;
        factors[j] = model_factors(q, j, q->contact[j].parameters.diagonal);
        law_changed[j] = factors[j].k != now->k || factors[j].c != now->c ||
                         contact_dashpot(v, j) != contact_dashpot(before, j);
        changed = changed || law_changed[j];
    }
    if (solver_relative_tolerance(v) != solver_relative_tolerance(before) ||
        solver_absolute_tolerance(v) != solver_absolute_tolerance(before)) {
        q->integrator_fresh = 1; /* CVODE reads tolerances only at a start */
        q->phase.end = 0.0;
        q->deferrable_clock = 0.0; /* without its phase a deferred motion would fly */
    }
    if (!changed) {
        return true;
    }
    double stored = 0.0;
    bool stopped[SCENE_CONTACTS * OPPOSED];
    const bool remembers = motion_remembers_force(q);
    if (remembers) {
        struct scene_instant at;
        scene_now(q, &at);
        stored = energy_stored(&at);
        transition_stop_sliding(q, &at, stopped);
        q->external_work += energy_potential(&at, more_gravity);
        scene_rebase(q);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        take_factors(&q->contact[j], factors[j]);
    }
    if (remembers) {
        transition_take_law(q, law_changed, stored, stopped);
    }
    struct scene_instant after;
    scene_now(q, &after);
    double sum = !SCENE_ANY_FREE || scene_is_force_element(v) ? 0.0 : q->external_work;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += factors[j].k + factors[j].c + fabs(after.normal_force[j]);
    }
    return isfinite(sum);
}

/* Takes parameters that were set between steps over into the motion and books the energy that they add or
 * remove. Returns false, and leaves the motion unchanged, where a force or an energy would be beyond the
 * range of numbers. */
static bool model_tune(struct model *m)
{
    if (!m->state.tuned) {
        return true;
    }
    const struct scene_state before = m->state.motion;
    const bool taken = motion_tune(&m->state.values, &m->state.in_force, &m->state.motion);
    if (!taken) {
        m->state.motion = before;
    }
    m->state.tuned = !taken;
    return taken;
}

/* Whether model_tune would accept one value. */
static bool model_can_tune(struct model *m, const struct variable *variable, double value)
{
    motion_catch_up(m);
    struct scene_values v = m->state.values;
    struct scene_state q = m->state.motion;
    variable_put(variable, &v, value);
    q.v = &v;
    return motion_tune(&v, m->state.tuned ? &m->state.in_force : &m->state.values, &q);
}

/* Returns the index of an input among the signals of its body. */
static int signal_of(const struct variable *input)
{
    int i = 0;
    while (input->row != input_kinds[i].row) {
        ++i;
    }
    return 3 * i + input->component;
}

/* Returns the marks of an input, which are about to change. */
static uint8_t *changed_marks(struct model *m, const struct variable *input)
{
    m->outputs = OUTPUTS_NONE;
    m->state.signals_changed = 1;
    m->state.signals_open = 1;
    return &m->state.marks[input->element][signal_of(input)];
}

double variable_value(const struct variable *variable, const struct scene_values *values)
{
    const char *at = (const char *)values + variable->offset;
    return variable->type == VARIABLE_REAL ? *(const double *)at : *(const int32_t *)at;
}

void variable_put(const struct variable *variable, struct scene_values *values, double value)
{
    char *at = (char *)values + variable->offset;
    if (variable->type == VARIABLE_REAL) {
        *(double *)at = value;
    } else {
        *(int32_t *)at = (int32_t)value;
    }
}

enum model_status model_check(struct model *m, const struct variable *variable, double value)
{
    if (isfinite(value) && value >= variable->min && value <= variable->max) {
        const bool tunes = m->state.initialized && variable->causality == VARIABLE_PARAMETER;
        return !tunes || model_can_tune(m, variable, value)
                   ? MODEL_OK
                   : model_report(m, MODEL_DISCARD,
                                  "%s = %s refused: a force or an energy would be beyond the range of "
                                  "numbers (allowed: values with finite ones); it stays as it was.",
                                  variable->name, shortest_digits(value).text);
    }
    return model_report(m, MODEL_DISCARD, "%s = %s refused (allowed: %s .. %s); it stays as it was.",
                        variable->name, shortest_digits(value).text, shortest_digits(variable->min).text,
                        shortest_digits(variable->max).text);
}

void model_set(struct model *m, const struct variable *variable, double value)
{
    const bool tunes = m->state.initialized && variable->causality == VARIABLE_PARAMETER;
    if (tunes && !m->state.tuned) { /* a deferred flight took place under the gravity in force before */
        motion_catch_up(m);
        m->state.in_force = m->state.values;
    }
    if (tunes) {
        m->state.tuned = m->state.signals_changed = m->state.signals_open = 1;
    }
    variable_put(variable, &m->state.values, value);
    m->outputs = OUTPUTS_NONE;
    if (variable->causality == VARIABLE_INPUT) {
        uint8_t *marks = changed_marks(m, variable);
        /* A new value without derivatives at the same communication point ends earlier derivatives. */
        *marks = (uint8_t)((*marks & SIGNAL_DERIVATIVES ? *marks : 0) | SIGNAL_VALUE);
    }
}

void model_set_input_derivative(struct model *m, const struct variable *variable, int order, double value)
{
    m->state.signals[variable->element][signal_of(variable)][order - 1] = value;
    *changed_marks(m, variable) |= (uint8_t)((1 << order) | SIGNAL_EXPLICIT);
}

/* Directions count as parallel within this angle [rad]: their rounding, and that of a user's products. */
static const double PARALLEL = 1e-12;

bool model_tilts_axis(const struct scene_values *v, int body, struct vec3 a)
{
    const struct vec3 across = vec3_sub(a, body_part_that_turns(v, body, a));
    return vec3_norm(across) > PARALLEL * vec3_norm(a);
}

/* Whether the prescribed rotation of a body would tilt an axis that keeps its direction. */
static bool turn_tilts_axis(const struct model *m, int body)
{
    struct body_path path = m->state.motion.path[body];
    input_path_renew(m, body, m->state.marks[body], &path);
    return model_tilts_axis(&m->state.values, body, path.angular_velocity[0]) ||
           model_tilts_axis(&m->state.values, body, path.angular_velocity[1]) ||
           model_tilts_axis(&m->state.values, body, path.angular_velocity[2]);
}

const char *model_unfit_turn(const struct model *m, int body)
{
    const struct scene_values *v = &m->state.values;
    if (!body_turn_is_prescribed(v, body)) {
        return NULL;
    }
    return body_has_axis(body) && vec3_is_zero(body_prescribed_axis(v, body)) ? "prescribed_axis"
           : body_is_compound(body) && quaternion_is_zero(body_prescribed_orientation(v, body))
               ? "prescribed_orientation"
           : SCENE_ANY_KEPT_AXIS && turn_tilts_axis(m, body) ? "prescribed_angular_velocity"
                                                             : NULL;
}

enum model_status model_refuse_turn(const struct model *m, enum model_status status, int body,
                                    const char *name)
{
    const char *of = scene_body_name(body);
    const char *follows = status == MODEL_DISCARD ? " and is not in force" : "";
    return strstr(name, "velocity") != NULL
               ? model_report(
                     m, status,
                     "%s.%s would tilt %s.axis%s: a cylinder that touches a cylinder turns about its "
                     "own axis (allowed: multiples of the axis).",
                     of, name, of, follows)
               : model_report(
                     m, status,
                     "%s.%s is zero, which has no direction%s (allowed: at least one component other "
                     "than zero).",
                     of, name, follows);
}

enum model_status model_refuse_inputs(const struct model *m)
{
    for (int i = 0; SCENE_ANY_ROTATION && i < SCENE_BODIES; ++i) {
        const char *unfit = model_unfit_turn(m, i);
        if (unfit != NULL) {
            return model_refuse_turn(m, MODEL_DISCARD, i, unfit);
        }
    }
    return model_report(m, MODEL_DISCARD,
                        "The %s set last would take an energy beyond the range of numbers and are not in "
                        "force (allowed: %s with finite energies).",
                        m->state.tuned ? "parameters or inputs" : "inputs",
                        m->state.tuned ? "values" : "inputs");
}

bool model_apply_inputs(struct model *m)
{
    struct scene_state *q = &m->state.motion;
    if (!m->state.signals_changed || !m->state.initialized) {
        return true;
    }
    motion_catch_up(m);
    if (!model_tune(m)) {
        return false;
    }
    struct body_path next[SCENE_BODIES];
    bool same = true;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        next[i] = q->path[i];
        input_path_shift(m, i, &next[i]);
        const struct body_path before = next[i];
        input_path_renew(m, i, m->state.marks[i], &next[i]);
        if (SCENE_ANY_ROTATION && model_unfit_turn(m, i) != NULL) {
            return false;
        }
        const void *bytes[2] = {&before, &next[i]}; /* a path has no padding */
        same = same && memcmp(bytes[0], bytes[1], sizeof before) == 0;
    }
    bool applied = true;
    if (m->state.exchange == EXCHANGE_CONTINUOUS) {
        memcpy(q->path, next, sizeof q->path); /* the power of the inputs is integrated */
    } else {
        applied = same || motion_follow(q, next, !m->host.exchange);
    }
    m->state.signals_changed = !applied;
    return applied;
}

/* Two rates agree if their difference divided by the larger of them is not above this: an importer's
 * difference quotients of displacements are no more accurate. */
static const double RATE_AGREEMENT = 1e-6;

/* These are the bits of model_state.warned_of_rate. */
enum { WARNED_OF_DISPLACEMENT = 1, WARNED_OF_AXIS = 2 };

/* Warns once where two rates of one quantity differ by more than their rounding plus `least`, in the unit of
 * the rates: `given` follows from derivatives that the importer gives, `other` from another input. */
static void warn_of_rates(struct model *m, int body, int bit, struct vec3 given, struct vec3 other,
                          double least)
{
    static const char *const texts[][4] = {
        [WARNED_OF_DISPLACEMENT] = {"prescribed_displacement", "m/s", "prescribed_velocity is",
                                    "the displacement, the gap rate and the work the velocity"},
        [WARNED_OF_AXIS] = {"prescribed_axis, as a unit vector,", "1/s",
                            "prescribed_angular_velocity turns it by",
                            "the axis, slip and work the angular velocity"}};
    const double size = fmax(vec3_norm(given), vec3_norm(other));
    if ((m->state.warned_of_rate[body] & bit) != 0 ||
        !(vec3_norm(vec3_sub(given, other)) > RATE_AGREEMENT * size + least)) {
        return;
    }
    m->state.warned_of_rate[body] |= (uint8_t)bit;
    const char *name = scene_body_name(body);
    const char *const *text = texts[bit];
    model_report(m, MODEL_WARNING,
                 "%s.%s has the derivative (%g, %g, %g) %s at %s s, but %s.%s (%g, %g, %g) %s: the gap "
                 "follows %s, and energies need not balance (allowed: equal ones). Given once.",
                 name, text[0], given.x, given.y, given.z, text[1],
                 shortest_digits(scene_time(&m->state.motion)).text, name, text[2], other.x, other.y, other.z,
                 text[1], text[3]);
}

/* Two rates of a unit axis agree if they differ by no more than this [1/s], which is the rounding of an axis
 * divided by a microsecond. */
static const double AXIS_AGREEMENT = 1e-9;

/* Warns of a prescribed axis whose given derivatives contradict the angular velocity of its body. */
static void warn_of_axis(struct model *m, int body, const struct body_path *path)
{
    const double length = vec3_norm(path->axis[0]);
    const struct vec3 axis = vec3_scale(1.0 / length, path->axis[0]);
    const struct vec3 raw = vec3_scale(1.0 / length, path->axis[1]);
    const struct vec3 rate = vec3_axpy(raw, -vec3_dot(raw, axis), axis);
    const struct vec3 turning = vec3_cross(path->angular_velocity[0], axis);
    warn_of_rates(m, body, WARNED_OF_AXIS, rate, turning, AXIS_AGREEMENT);
}

/* Warns once of each prescribed body whose given derivative of displacement is not its prescribed
 * velocity. */
static void warn_of_bodies(struct model *m)
{
    const struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    /* A scene without a solver takes the start value that solver.absolute_tolerance has elsewhere. */
    const double least_speed = SCENE_ANY_FREE ? solver_absolute_tolerance(v) : 1e-12;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const uint8_t *marks = m->state.marks[i];
        struct body_path path = q->path[i];
        body_path_shift(v, i, &path, q->clock);
        /* Without given derivatives a displacement follows the velocity, or rests where all bodies are
         * prescribed, and does not contradict it. There a derivative of zero means that none is given. */
        const bool has_rate = ((marks[0] | marks[1] | marks[2]) & SIGNAL_EXPLICIT) != 0 &&
                              !(inputs_prescribe_all(v) && vec3_is_zero(path.displacement[1]));
        if (body_turn_is_prescribed(v, i) && body_has_axis(i) && path.turn_follows == TURN_FOLLOWS_AXIS) {
            warn_of_axis(m, i, &path);
        }
        if (body_is_prescribed(v, i) && has_rate) {
            warn_of_rates(m, i, WARNED_OF_DISPLACEMENT, path.displacement[1], path.velocity[0], least_speed);
        }
    }
}

enum model_status model_close_inputs(struct model *m)
{
    if (!model_apply_inputs(m)) {
        return model_refuse_inputs(m);
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        for (int k = 0; k < SIGNALS_EACH; ++k) {
            m->state.marks[i][k] &= SIGNAL_EXPLICIT;
        }
    }
    m->state.signals_changed = 0;
    m->state.signals_open = 0;
    warn_of_bodies(m);
    return MODEL_OK;
}
