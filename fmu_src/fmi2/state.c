/*
 * Saved states: one flat row of bytes without pointers, a header of the adapter followed by the model's part.
 * What the importer serializes are these bytes as they stand; what it brings back is checked as a whole
 * before it is used. In memory they follow a link (state_list.h), by which the importer's pointers are
 * recognised.
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "fmi2/call_order.h"
#include "fmi2/log.h"
#include "fmi2/state_list.h"
#include "scene.h"

/* "CONT" on a little-endian machine; a block of the other byte order does not match. */
#define BLOCK_MAGIC 0x544E4F43u
/* Raised whenever the header's or the model's layout or meaning changes. */
#define BLOCK_VERSION 1u

struct block_header {
    uint32_t magic;
    uint32_t version;
    uint32_t scene;    /* SCENE_HASH: states fit only the FMU that wrote them */
    uint32_t checksum; /* of everything behind this field */
    uint64_t size;     /* of the whole block, bytes */
    double start_time; /* s */
    double stop_time;  /* s */
    uint32_t set_up;
    uint32_t phase;
};

_Static_assert(sizeof(struct block_header) == 48, "no padding, and the model's bytes stay aligned to 8");

#define CHECKED_FROM (offsetof(struct block_header, checksum) + sizeof(uint32_t))

static size_t block_size(void)
{
    return sizeof(struct block_header) + model_state_size();
}

static unsigned char *model_bytes(void *block)
{
    return (unsigned char *)block + sizeof(struct block_header);
}

/* FNV-1a, 32 bit: every single flipped bit changes it. */
static uint32_t block_checksum(const void *block)
{
    const unsigned char *bytes = block;
    const size_t size = block_size();
    uint32_t hash = 2166136261u;
    for (size_t i = CHECKED_FROM; i < size; ++i) {
        hash = (hash ^ bytes[i]) * 16777619u;
    }
    return hash;
}

static void write_block(struct instance *instance, void *block)
{
    model_save(instance->model, model_bytes(block));
    struct block_header header = {
        .magic = BLOCK_MAGIC,
        .version = BLOCK_VERSION,
        .scene = SCENE_HASH,
        .size = block_size(),
        .start_time = instance->experiment.start_time,
        .stop_time = instance->experiment.stop_time,
        .set_up = instance->experiment.set_up ? 1 : 0,
        .phase = (uint32_t)instance->phase,
    };
    memcpy(block, &header, sizeof header);
    header.checksum = block_checksum(block);
    memcpy(block, &header, sizeof header);
}

static bool one_phase(uint32_t phase)
{
    return phase != 0 && (phase & (phase - 1)) == 0 && phase <= (uint32_t)PHASE_FATAL;
}

static bool plausible_header(const struct block_header *header)
{
    return one_phase(header->phase) && header->set_up <= 1 && isfinite(header->start_time) &&
           header->stop_time >= header->start_time;
}

static fmi2Status refuse_number(struct instance *instance, enum call call, const char *what,
                                unsigned long got, unsigned long expected)
{
    return log_report(instance, fmi2Error, "%s: state has %s %lu (0x%lX), expected %lu (0x%lX)",
                      call_name(call), what, got, got, expected, expected);
}

/* Whether a block of that many bytes is a whole state of this FMU. Never reads beyond size. */
static fmi2Status check_block(struct instance *instance, enum call call, const void *block, size_t size)
{
    struct block_header header;
    if (size < sizeof header) {
        return refuse_number(instance, call, "size", (unsigned long)size, (unsigned long)block_size());
    }
    memcpy(&header, block, sizeof header);
    if (header.magic != BLOCK_MAGIC) {
        return refuse_number(instance, call, "magic number", header.magic, BLOCK_MAGIC);
    }
    if (header.version != BLOCK_VERSION) {
        return refuse_number(instance, call, "version", header.version, BLOCK_VERSION);
    }
    if (header.scene != SCENE_HASH) {
        return refuse_number(instance, call, "model", header.scene, SCENE_HASH);
    }
    if (size != block_size() || header.size != size) {
        return refuse_number(instance, call, "size", (unsigned long)size, (unsigned long)block_size());
    }
    if (block_checksum(block) != header.checksum) {
        return refuse_number(instance, call, "checksum", block_checksum(block), header.checksum);
    }
    if (!plausible_header(&header)) {
        return log_report(instance, fmi2Error, "%s: state has a header out of range", call_name(call));
    }
    return fmi2OK;
}

/* The block of an importer's state, or NULL after a message. */
static struct state_block *given_block(struct instance *instance, enum call call, fmi2FMUstate state)
{
    if (!call_array_given(instance, call, "FMUstate", state, 1)) {
        return NULL;
    }
    struct state_block *block = state_list_find(instance, state);
    if (block == NULL) {
        log_report(instance, fmi2Error,
                   "%s: FMUstate is unknown, expected a state that this instance gave and that is not freed",
                   call_name(call));
    }
    return block;
}

/*
 * The block to write for an importer's state pointer: the one it leads to, or a new one where it is null or,
 * from an importer that never initialised it, leads anywhere else. NULL after a message.
 */
static struct state_block *block_to_write(struct instance *instance, enum call call, fmi2FMUstate *state)
{
    struct state_block *block = state_list_find(instance, *state);
    if (block == NULL) {
        block = state_list_add(instance, block_size());
        if (block == NULL) {
            log_report(instance, fmi2Error, "%s: no memory for %lu bytes", call_name(call),
                       (unsigned long)block_size());
            return NULL;
        }
        *state = block;
    }
    return block;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_GetFMUstate) ||
        !call_array_given(instance, CALL_GetFMUstate, "FMUstate", FMUstate, 1)) {
        return fmi2Error;
    }
    struct state_block *block = block_to_write(instance, CALL_GetFMUstate, FMUstate);
    if (block == NULL) {
        return fmi2Error;
    }
    write_block(instance, block->bytes);
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_SetFMUstate)) {
        return fmi2Error;
    }
    struct state_block *block = given_block(instance, CALL_SetFMUstate, FMUstate);
    if (block == NULL || check_block(instance, CALL_SetFMUstate, block->bytes, block_size()) != fmi2OK) {
        return fmi2Error;
    }
    const fmi2Status status =
        status_of(model_restore(instance->model, model_bytes(block->bytes), model_state_size()));
    if (status <= fmi2Warning) {
        struct block_header header;
        memcpy(&header, block->bytes, sizeof header);
        instance->experiment.start_time = header.start_time;
        instance->experiment.stop_time = header.stop_time;
        instance->experiment.set_up = header.set_up != 0;
        instance->phase = (enum phase)header.phase;
    }
    return status;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_FreeFMUstate)) {
        return fmi2Error;
    }
    if (FMUstate == NULL || *FMUstate == NULL) {
        return fmi2OK;
    }
    struct state_block *block = given_block(instance, CALL_FreeFMUstate, *FMUstate);
    if (block == NULL) {
        return fmi2Error;
    }
    state_list_remove(instance, block);
    *FMUstate = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_SerializedFMUstateSize) ||
        given_block(instance, CALL_SerializedFMUstateSize, FMUstate) == NULL ||
        !call_array_given(instance, CALL_SerializedFMUstateSize, "size", size, 1)) {
        return fmi2Error;
    }
    *size = block_size();
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[],
                                 size_t size)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_SerializeFMUstate)) {
        return fmi2Error;
    }
    struct state_block *block = given_block(instance, CALL_SerializeFMUstate, FMUstate);
    if (block == NULL || !call_array_given(instance, CALL_SerializeFMUstate, "serializedState",
                                           serializedState, block_size())) {
        return fmi2Error;
    }
    if (size < block_size()) {
        return log_report(instance, fmi2Error, "fmi2SerializeFMUstate: room for %lu bytes, expected %lu",
                          (unsigned long)size, (unsigned long)block_size());
    }
    memcpy(serializedState, block->bytes, block_size());
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    struct instance *instance = c;
    if (!call_allowed(instance, CALL_DeSerializeFMUstate) ||
        !call_array_given(instance, CALL_DeSerializeFMUstate, "serializedState", serializedState, size) ||
        !call_array_given(instance, CALL_DeSerializeFMUstate, "FMUstate", FMUstate, 1) ||
        check_block(instance, CALL_DeSerializeFMUstate, serializedState, size) != fmi2OK) {
        return fmi2Error;
    }
    struct state_block *block = block_to_write(instance, CALL_DeSerializeFMUstate, FMUstate);
    if (block == NULL) {
        return fmi2Error;
    }
    memcpy(block->bytes, serializedState, size);
    return fmi2OK;
}
