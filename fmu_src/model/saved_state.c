/* Saved states: the flat struct itself behind a header that says what it is. */
#include <math.h>
#include <string.h>

#include "dynamics/flight.h"
#include "model/state.h"

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
    if (m->state.initialized) {
#if SCENE_ANY_FREE
        flight_arrive(&m->state.values, &m->state.motion);
#endif
        motion_rebase(&m->state.motion);
        m->outputs = OUTPUTS_NONE;
    }
    m->state.checksum = payload_checksum(&m->state);
    memcpy(bytes, &m->state, sizeof m->state);
}

static bool value_in_range(const struct scene_values *values, const struct variable *row)
{
    const char *at = (const char *)values + row->offset;
    if (row->type == VARIABLE_REAL) {
        double value;
        memcpy(&value, at, sizeof value);
        return isfinite(value) &&
               (row->causality == VARIABLE_OUTPUT || (value >= row->min && value <= row->max));
    }
    int32_t value;
    memcpy(&value, at, sizeof value);
    return row->causality == VARIABLE_OUTPUT || (value >= row->min && value <= row->max);
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
        const struct contact_state *contact = &state->motion.contact[j];
        if (contact->regime < REGIME_APART || contact->regime > REGIME_RELEASED ||
            (state->initialized && contact->side != 1 && contact->side != -1)) {
            return false;
        }
#if SCENE_ANY_FREE
        if (contact->change_regime < REGIME_APART || contact->change_regime > REGIME_RELEASED) {
            return false;
        }
#endif
    }
#if SCENE_ANY_FREE
    if (state->motion.quiet_clock != 0.0 || state->motion.gliding != 0) {
        return false; /* nobody saves a glide, see model_save */
    }
#endif
    return isfinite(state->motion.base) && isfinite(state->motion.clock) && isfinite(state->start_time);
}

static enum model_status check_header(struct model *m, const struct model_state *state)
{
    if (state->magic != MODEL_STATE_MAGIC) {
        return model_report(m, MODEL_ERROR,
                            "Saved state refused: it is not one of this model (mark %08x, allowed: %08x).",
                            (unsigned)state->magic, MODEL_STATE_MAGIC);
    }
    if (state->version != MODEL_STATE_VERSION) {
        return model_report(m, MODEL_ERROR, "Saved state refused: version %u (allowed: %u).",
                            (unsigned)state->version, MODEL_STATE_VERSION);
    }
    if (state->scene != SCENE_HASH) {
        return model_report(m, MODEL_ERROR,
                            "Saved state refused: it belongs to another scene (%08x, allowed: %08x, %s).",
                            (unsigned)state->scene, (unsigned)SCENE_HASH, SCENE_NAME);
    }
    if (state->size != sizeof *state || state->checksum != payload_checksum(state)) {
        return model_report(m, MODEL_ERROR, "Saved state refused: its bytes have been altered (checksum).");
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
    const enum model_status status = check_header(m, &state);
    if (status != MODEL_OK) {
        return status;
    }
#if SCENE_ANY_FREE
    if (state.initialized && !model_open_solver(m, &state.values)) {
        return model_report(m, MODEL_ERROR, "Saved state refused: %s.", m->solver.message);
    }
#endif
    m->state = state;
    m->outputs = OUTPUTS_NONE;
    return MODEL_OK;
}
