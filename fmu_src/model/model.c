#include "model/model.h"

#include <math.h>
#include <string.h>

#include "flight/flight.h"
#include "model/state.h"

struct model *model_create(const struct model_host *host)
{
    struct model *m = host->allocate(1, sizeof *m);
    if (m) {
        m->host = *host;
        model_reset(m);
    }
    return m;
}

void model_destroy(struct model *m)
{
    if (m) {
        motion_close(&m->integrator);
        m->host.release(m);
    }
}

void model_reset(struct model *m)
{
    memset(&m->state, 0, sizeof m->state);
    m->state.exchange = m->host.exchange ? EXCHANGE_EVENTS : EXCHANGE_NONE;
    scene_start(&m->state.values);
    m->state.motion.v = &m->state.values;
    m->outputs = OUTPUTS_NONE;
}

enum model_status model_setup(struct model *m, bool tolerance_defined, double tolerance, double start_time)
{
    if (tolerance_defined && !(tolerance > 0.0 && isfinite(tolerance))) {
        return model_report(m, MODEL_ERROR, "The tolerance %s is refused (allowed: positive finite numbers).",
                            shortest_digits(tolerance).text);
    }
    const struct variable *row = tolerance_defined ? scene_tolerance : NULL;
    const double used = row ? fmin(fmax(tolerance, row->min), row->max) : 0.0;
    m->state.importer_tolerance = used;
    m->state.start_time = start_time;
    m->outputs = OUTPUTS_NONE;
    return !row || used == tolerance
               ? MODEL_OK
               : model_report(m, MODEL_WARNING,
                              "The tolerance %s is outside the range %g .. %g of %s; %g is used.",
                              shortest_digits(tolerance).text, row->min, row->max, row->name, used);
}

double model_time(const struct model *m)
{
    return m->state.initialized ? scene_time(&m->state.motion) : m->state.start_time;
}

/* Returns the motion to the state before a step; the integrator restarts there. */
static void undo_step(struct model *m, const struct scene_state *before)
{
    scene_state_copy(before, &m->state.motion);
    motion_catch_up(m);
    scene_rebase(&m->state.motion);
}

/* Takes a step. The motion returns to the state before the step where the step ends beyond the range of
 * numbers, or where a step that is to be taken as a whole ends early. */
static enum model_status take_step(struct model *m, const struct step_request *request)
{
    struct scene_state before;
    scene_state_copy(&m->state.motion, &before);
    const enum model_status status = motion_advance(m, request);
    if (!motion_is_finite(&m->state.motion)) {
        undo_step(m, &before);
        return model_report(m, MODEL_DISCARD,
                            "The step to %s s takes the motion beyond the range of numbers; it stays at %s s "
                            "(allowed: steps with finite speeds, displacements and energies).",
                            shortest_digits(request->end_time).text, shortest_digits(model_time(m)).text);
    }
    if (status == MODEL_DISCARD && request->whole) {
        undo_step(m, &before);
    }
    return status;
}

bool model_step_deferred(struct model *m, double end_time)
{
    struct scene_state *q = &m->state.motion;
    if (!SCENE_ANY_FREE || m->state.signals_open || !flight_defer(q, end_time)) {
        return false;
    }
    if (m->outputs != OUTPUTS_NONE && q->only_flies) {
        outputs_foresee(m, q->clock);
    } else {
        m->outputs = OUTPUTS_NONE;
    }
    return true;
}

/* Lets the owner read the outputs of an event within a step; reading them does not change the run. */
static double ask_owner(void *context, double end_time)
{
    struct model *m = context;
    const struct scene_state kept = m->state.motion;
    m->outputs = OUTPUTS_NONE;
    end_time = m->request->at_event(m->request->context, end_time);
    m->state.motion = kept;
    return end_time;
}

enum model_status model_step(struct model *m, const struct step_request *request)
{
    if (!m->state.initialized) {
        return model_report(m, MODEL_ERROR, "A step to %s s before the end of the initialization.",
                            shortest_digits(request->end_time).text);
    }
    if (m->state.signals_open && model_close_inputs(m) != MODEL_OK) {
        return MODEL_DISCARD;
    }
    if (model_step_deferred(m, request->end_time) ||
        (SCENE_ANY_FREE && flight_end_means(&m->state.motion, request->end_time) &&
         model_step_deferred(m, request->end_time))) {
        return MODEL_OK;
    }
    m->outputs = OUTPUTS_NONE; /* at_event and the logger may read outputs within the step */
    struct step_request inner = *request;
    inner.at_event = request->at_event != NULL ? ask_owner : NULL;
    inner.context = m;
    m->request = request;
    const enum model_status status = take_step(m, &inner);
    m->outputs = OUTPUTS_NONE;
    return status;
}

/* A saved state is struct model_state itself. */

size_t model_state_size(void)
{
    return sizeof(struct model_state);
}

/* Whether the solver's method uses a history that is not part of the saved state, as CVODE does. */
static bool has_history(const struct scene_values *v)
{
    return SCENE_ANY_FREE && solver_method(v) != SOLVER_METHOD_EVENT_DRIVEN;
}

void model_save(struct model *m, void *bytes)
{
    if (m->state.initialized && !m->host.exchange && has_history(&m->state.values)) {
        motion_catch_up(m);
        scene_rebase(&m->state.motion);
        m->outputs = OUTPUTS_NONE;
    }
    struct scene_state *q = &m->state.motion;
    q->v = NULL; /* an address is no part of the state */
    memcpy(bytes, &m->state, sizeof m->state);
    q->v = &m->state.values;
}

/* This function is not inlined, because its two callers would then each contain it. */
CONTACT_NOINLINE static bool value_in_range(const struct scene_values *values, const struct variable *row)
{
    if (row->causality >= VARIABLE_STATE) {
        return true; /* it is computed from values that are checked */
    }
    const double value = variable_value(row, values);
    return isfinite(value) && (row->causality == VARIABLE_OUTPUT || (value >= row->min && value <= row->max));
}

/* Whether a quaternion is an orientation, that is of unit length to rounding. Before the end of
 * initialization it may be zero instead. */
static bool is_orientation(struct quaternion a, bool initialized)
{
    return fabs(quaternion_dot(a, a) - 1.0) < 1e-9 || (!initialized && quaternion_dot(a, a) == 0.0);
}

static bool turning_is_sound(const struct scene_state *q, bool initialized)
{
    bool sound = all_finite(&q->turning, &q->unfinished);
    for (int i = 0; SCENE_ANY_ROTATION && sound && i < SCENE_BODIES; ++i) {
        const double follows = q->path[i].turn_follows;
        sound = is_orientation(q->turn_origin[i].orientation, initialized) &&
                is_orientation(q->turning.body[i].orientation, initialized) &&
                (follows == TURN_FOLLOWS_VELOCITY || follows == TURN_FOLLOWS_AXIS ||
                 follows == TURN_FOLLOWS_AXIS_ALONE);
    }
    return sound;
}

static bool known_regime(int32_t regime)
{
    return regime >= REGIME_APART && regime <= REGIME_SEPARATING;
}

/* Whether a zone is one of struct contact_solid. The sign tells the two ends apart, hence a side has none. */
static bool known_zone(int32_t zone)
{
    const int32_t part = zone < 0 ? -zone : zone;
    const bool is_skew = SCENE_ANY_SKEW && ((zone >= SKEW_ZONE && zone <= SKEW_LAST) || zone == -SKEW_FACE);
    return zone == 0 || zone == ZONE_SIDE || part == ZONE_CAP || part == ZONE_RIM || is_skew;
}

/* Whether a vector has unit length, to rounding. */
static bool is_direction(struct vec3 a)
{
    return fabs(vec3_dot(a, a) - 1.0) < 1e-9;
}

static bool contact_is_sound(const struct scene_state *q, int number, bool initialized)
{
    const struct contact_state *contact = &q->contact[number];
    struct contact_parameters fixed = contact->parameters;
    contact_fix_axes(q->v, number, &fixed);
    bool friction_is_known = true;
    for (int i = 0; i < OPPOSED; ++i) {
        const int32_t regime = contact->friction_regime[i];
        friction_is_known =
            friction_is_known && regime >= (int32_t)FRICTION_STICKING && regime <= (int32_t)FRICTION_LIFTED;
    }
    const bool placed = (contact->side == 1 || contact->side == -1) && is_direction(contact->physics.normal);
    const void *const bytes[] = {&fixed, &contact->parameters}; /* doubles without padding */
    const bool has_axes = !initialized || memcmp(bytes[0], bytes[1], sizeof fixed) == 0;
    /* The times up to which a search has looked ahead may be infinite, but not NaN. */
    const struct contact_schedule *ahead = &contact->schedule;
    return known_regime(contact->regime) && (!initialized || placed) && friction_is_known &&
           known_zone(contact->zone) && has_axes && known_regime(ahead->change_regime) &&
           contact->record.onsets >= 0 && !isnan(ahead->change_clock) && !isnan(ahead->dead_band_clock) &&
           isfinite(ahead->change_gap) && all_finite(contact, &contact->record.onsets);
}

/* Whether the step that event_driven goes on with is sound, or event_driven starts anew. */
static bool unfinished_is_sound(const struct scene_state *q, bool initialized)
{
    const struct unfinished_step *step = &q->unfinished;
    const bool is_method = (step->stages == 4 || step->stages == 8 || step->stages == 12) &&
                           step->pace >= 0 && step->pace < RADAU_PACES &&
                           (step->pace == RADAU_EVEN || step->stages == RADAU_MOST_STAGES);
    const struct step_plan *plan = &q->plan;
    const bool is_plan =
        plan->longest >= 0.0 && plan->last_length >= 0.0 && plan->last_error >= 0.0 && plan->solvable > 0.0;
    const bool is_step = is_method && is_plan && step->event >= -1 && step->event < ODE_EVENTS &&
                         step->length > 0.0 && step->start <= step->present && step->present <= q->clock &&
                         step->end >= q->clock && step->end_part >= 0.0 && step->end_part <= 2.0;
    return !SCENE_ANY_FREE || !initialized || q->integrator_fresh == 1 || !scene_keeps_steps(q->v) ||
           (is_step && all_finite(step, &step->stages));
}

/* Whether the phase that event_driven goes on with is sound. Its segments are made again: those of a forged
 * start may end earlier, or not be made at all. */
static bool phase_is_sound(const struct model_state *state)
{
    const struct scene_state *q = &state->motion;
    const struct phase_start *start = &q->phase;
    bool sound = state->initialized && state->exchange == EXCHANGE_NONE && start->clock >= 0.0 &&
                 start->clock <= start->followed && start->followed <= q->clock && q->clock <= start->end &&
                 start->longest > 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sound = sound && is_direction(start->contact[j].normal);
    }
    return start->end == 0.0 || (sound && all_finite(start->contact, &start->counters));
}

/* Whether the motion is as model_save leaves it. It does not rely on a history of CVODE, because saved states
 * hold none. */
static bool motion_is_sound(const struct scene_state *q, bool initialized)
{
    const struct solver_counters *n = &q->counters;
    const bool counted = n->steps >= 0 && n->force_evaluations >= 0 && n->events >= 0 &&
                         n->rejected_steps >= 0 && n->fallbacks >= 0;
    const bool fresh =
        q->integrator_fresh == 1 || (q->integrator_fresh == 0 && !(initialized && has_history(q->v)));
    const bool clocks_are_sound =
        q->clock >= 0.0 && !isnan(q->horizon_clock) && !isnan(q->deferrable_clock) &&
        (q->deferred == 0 || q->deferred == 1) && (q->only_flies == 0 || q->only_flies == 1) &&
        (q->deferred == 0 || (q->deferred_from >= 0.0 && q->deferred_from <= q->clock));
    /* Larger coefficients would overflow when the path's origin is moved; inputs and derivatives stay below
     * 1e150. */
    const bool paths_are_sound = all_within(q->path, q->path + SCENE_BODIES, 1e300);
    return counted && fresh && clocks_are_sound && paths_are_sound && unfinished_is_sound(q, initialized) &&
           all_finite(q->origin, &q->counters) && all_finite(q, q->contact);
}

/* Whether all members of a state are in range. A checksum (fmi/instance.c) finds accidents only, not bytes
 * made on purpose. */
static bool state_is_sound(const struct model_state *state)
{
    const bool initialized = state->initialized != 0;
    bool sound = true;
    for (int i = 0; sound && i < scene_variable_count; ++i) {
        sound = value_in_range(&state->values, &scene_variables[i]) &&
                (!state->tuned || value_in_range(&state->in_force, &scene_variables[i]));
    }
    for (int j = 0; sound && j < SCENE_CONTACTS; ++j) {
        sound = contact_is_sound(&state->motion, j, initialized);
    }
    return sound && motion_is_sound(&state->motion, initialized) && phase_is_sound(state) &&
           turning_is_sound(&state->motion, initialized) && all_finite(state->signals, &state->motion) &&
           (!state->motion.deferred || (state->initialized && state->exchange == EXCHANGE_NONE)) &&
           all_finite(&state->importer_tolerance, &state->in_force) && state->tuned <= 1;
}

/* Whether all variables of a model in a restored state are finite when they are read; values near the end of
 * their range may give infinite outputs. Reading may change the state. If the memory for the integrator runs
 * out, integrator.message says so. */
static bool gives_numbers(struct model *m)
{
    bool finite = !m->state.initialized || m->host.exchange || motion_open(m, "") == MODEL_OK;
    if (finite && !model_update_outputs(m, OUTPUTS_ALL)) {
        m->state.signals_changed = 0; /* refused inputs may still be replaced */
        (void)model_update_outputs(m, OUTPUTS_ALL);
    }
    for (int i = 0; i < scene_variable_count && finite; ++i) {
        finite = value_in_range(&m->state.values, &scene_variables[i]);
    }
    return finite;
}

/* A model of its own tries the state first, without messages. Where the state is refused, `m` stays as it is,
 * and the memory of its integrator still fits its values. */
enum model_status model_restore(struct model *m, const void *bytes)
{
    struct model trial = {.host = m->host, .outputs = OUTPUTS_NONE};
    memcpy(&trial.state, bytes, sizeof trial.state);
    trial.state.motion.v = &trial.state.values;
    const unsigned exchange = trial.state.exchange;
    if (exchange > EXCHANGE_CONTINUOUS || (exchange != EXCHANGE_NONE) != m->host.exchange) {
        return model_report(
            m, MODEL_ERROR, "Saved state refused: it was saved while %s integrates, expected: while %s does.",
            m->host.exchange ? "the model" : "the importer", m->host.exchange ? "the importer" : "the model");
    }
    if (!state_is_sound(&trial.state)) {
        return model_report(m, MODEL_ERROR, "Saved state refused: it holds values out of range.");
    }
    trial.host.log = NULL;
    if (!gives_numbers(&trial)) {
        motion_close(&trial.integrator);
        return model_report(m, MODEL_ERROR, "Saved state refused: %s.",
                            SCENE_ANY_FREE && trial.integrator.message[0]
                                ? trial.integrator.message
                                : "its motion is beyond the range of numbers");
    }
    motion_close(&m->integrator);
    m->integrator = trial.integrator;
    memcpy(&m->state, bytes, sizeof m->state);
    m->state.motion.v = &m->state.values;
    m->outputs = OUTPUTS_NONE;
    return MODEL_OK;
}

const struct variable *vector_variable(uint32_t reference)
{
    const struct variable *variable = scene_variable(reference);
    return variable != NULL && variable->component == 0 ? variable : NULL;
}

const struct variable *listed_variable(const struct variable_list *list, uint32_t reference)
{
    static const struct variable time = {
        .name = "time", .type = VARIABLE_REAL, .causality = VARIABLE_INDEPENDENT, .length = 1};
    return !list->vectors ? scene_variable(reference) : reference == 0 ? &time : vector_variable(reference);
}

const struct variable *next_variable(const struct variable_list *list, const struct variable *last,
                                     size_t *place)
{
    if (last != NULL && list->vectors && last->component + 1 < last->length) {
        return last + 1;
    }
    return *place < list->count ? listed_variable(list, list->references[(*place)++]) : NULL;
}
