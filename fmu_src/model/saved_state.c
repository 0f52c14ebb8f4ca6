/* Saved states: the flat struct itself behind a header that says what it is. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "model/motion.h"

enum { HEADER_SIZE = offsetof(struct model_state, values) };

/* FNV-1a, 64 bit (Fowler, Noll, Vo): finds any altered byte, which is all that is asked of it. */
static uint64_t checksum_of(const unsigned char *bytes, size_t size)
{
    uint64_t hash = 14695981039346656037u;
    for (size_t i = 0; i < size; ++i) {
        hash = (hash ^ bytes[i]) * 1099511628211u;
    }
    return hash;
}

static uint64_t payload_checksum(const struct model_state *state)
{
    return checksum_of((const unsigned char *)state + HEADER_SIZE, sizeof *state - HEADER_SIZE);
}

size_t model_state_size(void)
{
    return sizeof(struct model_state);
}

void model_save(struct model *m, void *bytes)
{
    if (m->state.initialized && !m->host.exchange && motion_has_history(&m->state.values)) {
        motion_catch_up(&m->state.values, &m->state.motion);
        scene_rebase(&m->state.values, &m->state.motion);
        m->outputs = OUTPUTS_NONE;
    }
    m->state.checksum = payload_checksum(&m->state);
    memcpy(bytes, &m->state, sizeof m->state);
}

static bool value_in_range(const struct scene_values *values, const struct variable *row)
{
    if (variable_is_local(row)) {
        return true; /* computed from what is checked */
    }
    const double value = variable_number(row, (const char *)values + row->offset);
    return isfinite(value) && (row->causality == VARIABLE_OUTPUT || (value >= row->min && value <= row->max));
}

/* Whether the bytes from one member up to another, doubles all of them, are numbers of this size at most. */
static bool all_within(const void *from, const void *to, double most)
{
    const char *end = to;
    for (const char *at = from; at < end; at += sizeof(double)) {
        double value;
        memcpy(&value, at, sizeof value);
        if (!(fabs(value) <= most)) {
            return false;
        }
    }
    return true;
}

static bool all_finite(const void *from, const void *to)
{
    return all_within(from, to, DBL_MAX);
}

/* Inputs and their derivatives are below 1e150; more would overflow when the path's origin is moved. */
static bool paths_are_sound(const struct scene_state *q)
{
    return all_within(q->path, q->path + SCENE_BODIES, 1e300);
}

/* An orientation, to rounding; after the end of initialization all have one. */
static bool is_orientation(struct quaternion a, bool initialized)
{
    return fabs(quaternion_dot(a, a) - 1.0) < 1e-9 || (!initialized && quaternion_dot(a, a) == 0.0);
}

static bool turning_is_sound(const struct scene_state *q, bool initialized)
{
    if (!all_finite(&q->turning, &q->turning + 1)) {
        return false;
    }
    for (int i = 0; SCENE_ANY_ROTATION && i < SCENE_BODIES; ++i) {
        const double follows = q->path[i].turn_follows;
        if (!is_orientation(q->turn_origin[i].orientation, initialized) ||
            !is_orientation(q->turning.body[i].orientation, initialized) ||
            (follows != TURN_FOLLOWS_VELOCITY && follows != TURN_FOLLOWS_AXIS &&
             follows != TURN_FOLLOWS_AXIS_ALONE)) {
            return false;
        }
    }
    return all_finite(q->turn_origin, q->turn_origin + SCENE_BODIES);
}

static bool known_regime(int32_t regime)
{
    return regime >= REGIME_APART && regime <= REGIME_SEPARATING;
}

/* As in struct contact_solid: a side has no end that could be the other one. */
static bool known_zone(int32_t zone)
{
    const int32_t part = zone < 0 ? -zone : zone;
    return zone == 0 || zone == ZONE_SIDE || part == ZONE_CAP || part == ZONE_RIM;
}

/* A unit vector, to rounding. */
static bool is_direction(struct vec3 a)
{
    return fabs(vec3_dot(a, a) - 1.0) < 1e-9;
}

static bool contact_is_sound(const struct contact_state *contact, bool initialized)
{
    if (!known_regime(contact->regime) || (initialized && contact->side != 1 && contact->side != -1)) {
        return false;
    }
    if (initialized && !is_direction(contact->normal)) {
        return false;
    }
    if (contact->friction_regime < (int32_t)FRICTION_STICKING ||
        contact->friction_regime > (int32_t)FRICTION_LIFTED) {
        return false;
    }
    if (!known_zone(contact->zone)) {
        return false;
    }
    if ((SCENE_ANY_CYLINDER || SCENE_ANY_PLANE) && initialized && !is_direction(contact->parameters.axis) &&
        !vec3_is_zero(contact->parameters.axis)) { /* spheres have the axis zero */
        return false;
    }
    /* Times up to which something was looked for may be infinite. */
    const struct contact_schedule *ahead = &contact->schedule;
    return known_regime(ahead->change_regime) && contact->record.onsets >= 0 && !isnan(ahead->change_clock) &&
           !isnan(ahead->settled_clock) && isfinite(ahead->change_gap) &&
           all_finite(contact, &contact->record.onsets);
}

/* What event_driven goes on with unless it starts anew. */
static bool unfinished_is_sound(const struct scene_values *v, const struct scene_state *q, bool initialized)
{
    const struct unfinished_step *step = &q->unfinished;
    const bool is_step = (step->stages == 4 || step->stages == 8 || step->stages == 12) &&
                         step->event >= -1 && step->event < ODE_EVENTS && step->solvable > 0.0 &&
                         step->simple > 0.0 && step->length > 0.0 && step->start <= q->clock &&
                         step->end >= q->clock;
    return !SCENE_ANY_FREE || !initialized || q->integrator_fresh == 1 || !scene_turns(v) ||
           (is_step && all_finite(step, &step->solvable) && all_finite(step->at_start, &step->stages));
}

/* As model_save leaves it: without a history of CVODE, of which a restored state has nothing. */
static bool motion_is_sound(const struct scene_values *v, const struct scene_state *q, bool initialized)
{
    const struct solver_counters *n = &q->counters;
    const bool counted = n->steps >= 0 && n->force_evaluations >= 0 && n->events >= 0 &&
                         n->rejected_steps >= 0 && n->fallbacks >= 0;
    const bool fresh =
        q->integrator_fresh == 1 || (q->integrator_fresh == 0 && !(initialized && motion_has_history(v)));
    const bool clocks_are_sound = q->clock >= 0.0 && !isnan(q->horizon_clock) &&
                                  !isnan(q->deferrable_clock) && (q->deferred == 0 || q->deferred == 1);
    return counted && fresh && clocks_are_sound && paths_are_sound(q) &&
           unfinished_is_sound(v, q, initialized) && all_finite(q->origin, &q->counters) &&
           all_finite(q, q->contact);
}

/* A wrong checksum catches accidents; this catches what could still do harm. */
static bool state_is_sound(const struct model_state *state)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        if (!value_in_range(&state->values, &scene_variables[i])) {
            return false;
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!contact_is_sound(&state->motion.contact[j], state->initialized != 0)) {
            return false;
        }
    }
    return motion_is_sound(&state->values, &state->motion, state->initialized != 0) &&
           turning_is_sound(&state->motion, state->initialized != 0) &&
           all_finite(state->signals, &state->motion) &&
           all_finite(&state->importer_tolerance, state->in_force.dashpot) && state->tuned <= 1;
}

/* Whether all that can be read then are numbers; numbers near the end of their range may give none. Says
 * nothing. */
static bool gives_numbers(struct model *m, const struct model_state *state)
{
    const struct model_state before = m->state;
    const struct model_host host = m->host;
    m->host.log = NULL;
    m->state = *state;
    m->outputs = OUTPUTS_NONE;
    if (!model_update_outputs(m, OUTPUTS_ALL)) {
        m->state.signals_changed = 0; /* inputs that are no good may still be replaced */
        (void)model_update_outputs(m, OUTPUTS_ALL);
    }
    bool finite = true;
    for (int i = 0; i < scene_variable_count && finite; ++i) {
        finite = value_in_range(&m->state.values, &scene_variables[i]);
    }
    m->state = before;
    m->host = host;
    m->outputs = OUTPUTS_NONE;
    return finite;
}

static enum model_status check_header(struct model *m, const struct model_state *state)
{
    if (state->magic != MODEL_STATE_MAGIC || state->version != MODEL_STATE_VERSION ||
        state->scene != SCENE_HASH || state->size != sizeof *state ||
        state->checksum != payload_checksum(state)) {
        return model_report(m, MODEL_ERROR,
                            "Saved state refused: it is not of version %u of %s, or it has been altered.",
                            MODEL_STATE_VERSION, SCENE_NAME);
    }
    if (state->exchange > EXCHANGE_CONTINUOUS || (state->exchange != EXCHANGE_NONE) != m->host.exchange) {
        return model_report(
            m, MODEL_ERROR, "Saved state refused: it was saved while %s integrates, expected: while %s does.",
            m->host.exchange ? "the model" : "the importer", m->host.exchange ? "the importer" : "the model");
    }
    if (!state_is_sound(state)) {
        return model_report(m, MODEL_ERROR, "Saved state refused: it holds values out of range.");
    }
    return MODEL_OK;
}

enum model_status model_restore(struct model *m, const void *bytes, size_t size)
{
    if (size != sizeof m->state) {
        return model_report(m, MODEL_ERROR, "Saved state refused: %zu bytes (allowed: %zu).", size,
                            sizeof m->state);
    }
    struct model_state state;
    memcpy(&state, bytes, sizeof state);
    enum model_status status = check_header(m, &state);
    if (status != MODEL_OK) {
        return status;
    }
    if (!gives_numbers(m, &state)) {
        return model_report(m, MODEL_ERROR,
                            "Saved state refused: its motion is beyond the range of numbers.");
    }
    status = state.initialized && !m->host.exchange ? motion_open(m, &state.values, "Saved state refused")
                                                    : MODEL_OK;
    if (status == MODEL_OK) {
        m->state = state;
        m->outputs = OUTPUTS_NONE;
    }
    return status;
}
