/*
 * Saved states: one flat row of bytes without pointers, a header of the adapter followed by the model's part.
 * What the importer serializes are these bytes as they stand; what it brings back is checked as a whole
 * before it is used. In memory they follow a link (state_list.h), by which the importer's pointers are
 * recognised.
 */
#include "fmi/state_block.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "fmi/call_order.h"
#include "fmi/log.h"
#include "fmi/state_list.h"
#include "scene.h"

/* Raised whenever the header's or the model's layout or meaning changes. */
#define BLOCK_VERSION 1u

struct block_header {
    uint32_t magic; /* of the adapter; a block of the other byte order does not match */
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
        .magic = instance->adapter->state_magic,
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

static bool one_phase(uint32_t phase, unsigned allowed)
{
    return phase != 0 && (phase & (phase - 1)) == 0 && (phase & ~allowed) == 0;
}

static bool plausible_header(const struct instance *instance, const struct block_header *header)
{
    const unsigned phases =
        instance->host.exchange ? instance->adapter->exchange_phases : instance->adapter->state_phases;
    return one_phase(header->phase, phases) && header->set_up <= 1 && isfinite(header->start_time) &&
           header->stop_time >= header->start_time;
}

static enum model_status refuse_number(struct instance *instance, const struct call *call, const char *what,
                                       unsigned long got, unsigned long expected)
{
    return log_report(instance, MODEL_ERROR, "%s: state has %s %lu (0x%lX), expected %lu (0x%lX)", call->name,
                      what, got, got, expected, expected);
}

/* Whether a block of that many bytes is a whole state of this FMU. Never reads beyond size. */
static enum model_status check_block(struct instance *instance, const struct call *call, const void *block,
                                     size_t size)
{
    struct block_header header;
    if (size < sizeof header) {
        return refuse_number(instance, call, "size", (unsigned long)size, (unsigned long)block_size());
    }
    memcpy(&header, block, sizeof header);
    const uint32_t magic = instance->adapter->state_magic;
    if (header.magic != magic) {
        return refuse_number(instance, call, "magic number", header.magic, magic);
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
    if (!plausible_header(instance, &header)) {
        return log_report(instance, MODEL_ERROR, "%s: state has a header out of range", call->name);
    }
    return MODEL_OK;
}

/* The block of an importer's state, or NULL after a message. */
static struct state_block *given_block(struct instance *instance, const struct call *call, void *state)
{
    if (!call_array_given(instance, call, instance->adapter->state_name, state, 1)) {
        return NULL;
    }
    struct state_block *block = state_list_find(instance, state);
    if (block == NULL) {
        log_report(instance, MODEL_ERROR,
                   "%s: %s is unknown, expected a state that this instance gave and that is not freed",
                   call->name, instance->adapter->state_name);
    }
    return block;
}

/*
 * The block to write for an importer's state pointer: the one it leads to, or a new one where it is null or,
 * from an importer that never initialised it, leads anywhere else. NULL after a message.
 */
static struct state_block *block_to_write(struct instance *instance, const struct call *call, void **state)
{
    struct state_block *block = state_list_find(instance, *state);
    if (block == NULL) {
        block = state_list_add(instance, block_size());
        if (block == NULL) {
            log_report(instance, MODEL_ERROR, "%s: no memory for %lu bytes", call->name,
                       (unsigned long)block_size());
            return NULL;
        }
        *state = block;
    }
    return block;
}

enum model_status state_block_get(struct instance *instance, const struct call *call, void **state)
{
    if (!call_allowed(instance, call) ||
        !call_array_given(instance, call, instance->adapter->state_name, state, 1)) {
        return MODEL_ERROR;
    }
    struct state_block *block = block_to_write(instance, call, state);
    if (block == NULL) {
        return MODEL_ERROR;
    }
    write_block(instance, block->bytes);
    return MODEL_OK;
}

enum model_status state_block_set(struct instance *instance, const struct call *call, void *state)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    struct state_block *block = given_block(instance, call, state);
    if (block == NULL || check_block(instance, call, block->bytes, block_size()) != MODEL_OK) {
        return MODEL_ERROR;
    }
    const enum model_status status =
        model_restore(instance->model, model_bytes(block->bytes), model_state_size());
    if (status <= MODEL_WARNING) {
        struct block_header header;
        memcpy(&header, block->bytes, sizeof header);
        instance->experiment.start_time = header.start_time;
        instance->experiment.stop_time = header.stop_time;
        instance->experiment.set_up = header.set_up != 0;
        instance->phase = (enum phase)header.phase;
    }
    return status;
}

enum model_status state_block_free(struct instance *instance, const struct call *call, void **state)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    if (state == NULL || *state == NULL) {
        return MODEL_OK;
    }
    struct state_block *block = given_block(instance, call, *state);
    if (block == NULL) {
        return MODEL_ERROR;
    }
    state_list_remove(instance, block);
    *state = NULL;
    return MODEL_OK;
}

enum model_status state_block_size(struct instance *instance, const struct call *call, void *state,
                                   size_t *size)
{
    if (!call_allowed(instance, call) || given_block(instance, call, state) == NULL ||
        !call_array_given(instance, call, "size", size, 1)) {
        return MODEL_ERROR;
    }
    *size = block_size();
    return MODEL_OK;
}

enum model_status state_block_serialize(struct instance *instance, const struct call *call, void *state,
                                        void *bytes, size_t size)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    struct state_block *block = given_block(instance, call, state);
    if (block == NULL || !call_array_given(instance, call, "serializedState", bytes, block_size())) {
        return MODEL_ERROR;
    }
    if (size < block_size()) {
        return log_report(instance, MODEL_ERROR, "%s: room for %lu bytes, expected %lu", call->name,
                          (unsigned long)size, (unsigned long)block_size());
    }
    memcpy(bytes, block->bytes, block_size());
    return MODEL_OK;
}

enum model_status state_block_deserialize(struct instance *instance, const struct call *call,
                                          const void *bytes, size_t size, void **state)
{
    if (!call_allowed(instance, call) || !call_array_given(instance, call, "serializedState", bytes, size) ||
        !call_array_given(instance, call, instance->adapter->state_name, state, 1) ||
        check_block(instance, call, bytes, size) != MODEL_OK) {
        return MODEL_ERROR;
    }
    struct state_block *block = block_to_write(instance, call, state);
    if (block == NULL) {
        return MODEL_ERROR;
    }
    memcpy(block->bytes, bytes, size);
    return MODEL_OK;
}
