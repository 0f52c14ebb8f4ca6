#include "players3.h"

#include <stdlib.h>

#include "forge.h"
#include "host3.h"
#include "scene.h"

enum { CALLS_AT_MOST = 120 };

struct player3 players3[PLAYERS];

/* A saved state as bytes, for whoever deserializes next. */
static fmi3Byte blob[LARGEST_BLOCK];
static size_t blob_size;

/* A step has to end soon. */
static void bound_work(fmi3Instance c)
{
    const fmi3Int32 most = MOST_INTERNAL_STEPS;
    for (int i = 0; i < scene_variable_count; ++i) {
        if (scene_variables[i].row == ROW_solver_max_internal_steps) {
            (void)fmi3SetInt32(c, &scene_variables[i].reference, 1, &most, 1);
        }
    }
}

void player3_instantiate(struct player3 *player, struct bytes *b, bool exchange)
{
    if (player->instance != NULL) {
        return;
    }
    const unsigned odd = bytes_one(b), steps = bytes_one(b);
    const char *name = odd == 255 ? NULL : odd == 254 ? "" : "pl\xc3\xa4yer %s #r1#";
    const char *token = odd == 253 ? "another" : odd == 252 ? NULL : SCENE_TOKEN;
    const fmi3LogMessageCallback logger = odd == 251 ? NULL : host3_hear;
    const fmi3Boolean logging = odd % 2 == 0;
    const fmi3ValueReference required[2] = {scene_variables[steps % (unsigned)scene_variable_count].reference,
                                            steps == 255 ? bytes_word(b) : 0};
    player->exchange = exchange != (odd >= 230 && odd < 250);
    if (player->exchange) {
        player->instance =
            fmi3InstantiateModelExchange(name, token, NULL, fmi3False, logging, &host3, logger);
    } else {
        player->instance =
            fmi3InstantiateCoSimulation(name, token, NULL, fmi3False, logging, (steps & 1) != 0,
                                        (steps & 2) != 0, steps == 254 ? NULL : required, (steps >> 4) % 3,
                                        &host3, logger, (steps & 4) != 0 ? host3_update : NULL);
    }
    player->hears_all = logger != NULL;
    if (player->instance != NULL) {
        bound_work(player->instance);
    }
}

void player3_leave(struct player3 *player)
{
    fmi3FreeInstance(player->instance);
    memset(player, 0, sizeof *player);
}

fmi3Status player3_enter(struct player3 *player, struct bytes *b)
{
    const unsigned odd = bytes_one(b);
    const double tolerance = odd & 2 ? bytes_real(b) : 1e-6;
    const double start = (odd & 12) == 12 ? bytes_real(b) : 0.0;
    const double stop = (odd & 48) == 48 ? bytes_real(b) : 10.0;
    return fmi3EnterInitializationMode(player->instance, odd & 1, tolerance, start, (odd & 16) != 0, stop);
}

fmi3Status player3_initialize(struct player3 *player, struct bytes *b)
{
    const fmi3Status status = player3_enter(player, b);
    return status <= fmi3Warning ? fmi3ExitInitializationMode(player->instance) : status;
}

fmi3Status player3_reset(struct player3 *player)
{
    const fmi3Status status = fmi3Reset(player->instance);
    if (status == fmi3OK) {
        bound_work(player->instance);
    }
    return status;
}

static fmi3Status serialize(struct player3 *player, fmi3FMUState state, struct bytes *b)
{
    size_t size = 0;
    const unsigned odd = bytes_one(b);
    fmi3Status status = fmi3SerializedFMUStateSize(player->instance, state, odd == 254 ? NULL : &size);
    if (status == fmi3OK) {
        CLAIM(size <= sizeof blob);
        const size_t given = odd == 255 ? size / 2 : size;
        status = fmi3SerializeFMUState(player->instance, state, odd == 253 ? NULL : blob, given);
        blob_size = status == fmi3OK ? size : blob_size;
    }
    return status;
}

/* As they are, cut short, or changed with checksums that fit. */
static fmi3Status deserialize(struct player3 *player, fmi3FMUState *state, struct bytes *b)
{
    const unsigned odd = bytes_one(b);
    const size_t shorter = odd == 255 ? bytes_one(b) : 0;
    const size_t size = blob_size > shorter ? blob_size - shorter : 0;
    fmi3Byte *exact = malloc(size > 0 ? size : 1);
    CLAIM(exact != NULL);
    memcpy(exact, blob, size);
    if (odd < 100 && shorter == 0 && size > 0) {
        uint8_t row[12]; /* for the changes; the rest is for other calls */
        bytes_copy(b, row, sizeof row);
        struct bytes some = {row, sizeof row};
        forge_changes(exact, size, &some);
        forge_bound_work(exact, MOST_INTERNAL_STEPS);
        forge_checksums(exact, size);
    }
    const fmi3Status status = fmi3DeserializeFMUState(player->instance, exact, size, state);
    free(exact);
    return status;
}

fmi3Status player3_handle_state(struct player3 *player, struct bytes *b)
{
    fmi3FMUState *own = &player->states[bytes_choice(b, STATES)];
    fmi3FMUState foreign = players3[bytes_choice(b, PLAYERS)].states[0];
    fmi3FMUState given = bytes_one(b) == 255 ? foreign : *own;
    switch (bytes_choice(b, 8)) {
    case 0:
    case 1:
        return fmi3GetFMUState(player->instance, own);
    case 2:
    case 3:
        return fmi3SetFMUState(player->instance, given);
    case 4:
        return fmi3FreeFMUState(player->instance, own);
    case 5:
        return serialize(player, given, b);
    case 6:
        return deserialize(player, own, b);
    default:
        return fmi3SetFMUState(player->instance, bytes_one(b) == 255 ? (fmi3FMUState)blob : NULL);
    }
}

fmi3Status player3_debug_logging(struct player3 *player, struct bytes *b)
{
    static const fmi3String names[] = {"logAll", "logEvents", "logStatusDiscard", "nonsense", NULL};
    const fmi3String chosen[2] = {names[bytes_choice(b, 5)], names[bytes_choice(b, 5)]};
    const unsigned count = bytes_choice(b, 3);
    player->hears_all = false;
    return fmi3SetDebugLogging(player->instance, bytes_choice(b, 2) != 0, count,
                               bytes_one(b) == 255 ? NULL : chosen);
}

int players3_play(const uint8_t *data, size_t size, player3_call *call)
{
    struct bytes b = {data, size};
    host3_begin();
    memset(players3, 0, sizeof players3);
    blob_size = 0;
    for (int i = 0; i < CALLS_AT_MOST && b.left > 0; ++i) {
        struct player3 *player = &players3[bytes_choice(&b, PLAYERS)];
        const bool heard = player->instance != NULL && player->hears_all;
        const long messages = host3.messages;
        host3.told = player->instance;
        const fmi3Status status = call(player, &b);
        host3.told = NULL;
        CLAIM(status >= fmi3OK && status <= fmi3Error);
        CLAIM(status <= fmi3OK || !heard || !player->hears_all || host3.messages > messages);
        CLAIM(player->instance != NULL || status == fmi3Error || status == fmi3OK);
    }
    for (int i = 0; i < PLAYERS; ++i) {
        player3_leave(&players3[i]);
    }
    return 0;
}
