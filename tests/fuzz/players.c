#include "players.h"

#include <stdlib.h>

#include "arrays.h"
#include "host.h"
#include "scene.h"

enum { CALLS_AT_MOST = 120 };

struct player players[PLAYERS];

/* A saved state as bytes, for whoever deserializes next. */
static fmi2Byte blob[16384];
static size_t blob_size;

static void bound_work(fmi2Component c)
{
    (void)host_set_integer(c, ROW_solver_max_internal_steps, 0, MOST_INTERNAL_STEPS);
}

void player_instantiate(struct player *player, struct bytes *b, fmi2Type usual)
{
    if (player->component != NULL) {
        return;
    }
    const unsigned odd = bytes_one(b);
    fmi2CallbackFunctions callbacks = *host_callbacks();
    if (odd & 1) {
        callbacks.logger = NULL;
    }
    if (odd & 2) {
        callbacks.allocateMemory = NULL;
    }
    if (odd & 4) {
        callbacks.freeMemory = NULL;
    }
    if (odd & 8) {
        host.countdown = bytes_choice(b, 4);
    }
    const fmi2Type type = odd & 16 ? (fmi2Type)bytes_choice(b, 3) : usual;
    const char *name = odd & 32 ? NULL : "pl\xc3\xa4yer %s #r1#";
    const char *guid = odd & 64 ? "another" : SCENE_GUID;
    player->component =
        fmi2Instantiate(name, type, guid, NULL, odd == 128 ? NULL : &callbacks, fmi2False, (odd & 128) != 0);
    player->hears_all = callbacks.logger != NULL;
    if (player->component != NULL) {
        bound_work(player->component);
    }
}

fmi2Status player_set_up(struct player *player, struct bytes *b)
{
    const unsigned odd = bytes_one(b);
    const double tolerance = odd & 2 ? bytes_real(b) : 1e-6;
    const double start = odd & 4 ? bytes_real(b) : 0.0;
    return fmi2SetupExperiment(player->component, odd & 1, tolerance, start, (odd & 8) != 0,
                               odd & 8 ? bytes_real(b) : 0.0);
}

fmi2Status player_initialize(struct player *player, struct bytes *b)
{
    fmi2Status status = player_set_up(player, b);
    if (status <= fmi2Warning) {
        status = fmi2EnterInitializationMode(player->component);
    }
    return status <= fmi2Warning ? fmi2ExitInitializationMode(player->component) : status;
}

fmi2Status player_set_one(struct player *player, struct bytes *b)
{
    const struct variable *variable = &scene_variables[bytes_one(b) % (unsigned)scene_variable_count];
    if (variable->type == VARIABLE_REAL) {
        const fmi2Real value = bytes_real(b);
        return fmi2SetReal(player->component, &variable->reference, 1, &value);
    }
    const fmi2Integer value = (fmi2Integer)bytes_choice(b, 5);
    return variable->type == VARIABLE_BOOLEAN
               ? fmi2SetBoolean(player->component, &variable->reference, 1, &value)
               : fmi2SetInteger(player->component, &variable->reference, 1, &value);
}

static fmi2Status serialize(struct player *player, fmi2FMUstate state, struct bytes *b)
{
    size_t size = 0;
    fmi2Status status = fmi2SerializedFMUstateSize(player->component, state, &size);
    if (status == fmi2OK) {
        CLAIM(size <= sizeof blob);
        const size_t given = bytes_one(b) == 255 ? size / 2 : size;
        status = fmi2SerializeFMUstate(player->component, state, blob, given);
        blob_size = status == fmi2OK ? size : blob_size;
    }
    return status;
}

static fmi2Status deserialize(struct player *player, fmi2FMUstate *state, struct bytes *b)
{
    const size_t shorter = bytes_one(b) == 255 ? bytes_one(b) : 0;
    const size_t size = blob_size > shorter ? blob_size - shorter : 0;
    fmi2Byte *exact = malloc(size > 0 ? size : 1);
    CLAIM(exact != NULL);
    memcpy(exact, blob, size);
    const fmi2Status status = fmi2DeSerializeFMUstate(player->component, exact, size, state);
    free(exact);
    return status;
}

fmi2Status player_handle_state(struct player *player, struct bytes *b)
{
    fmi2FMUstate *own = &player->states[bytes_choice(b, STATES)];
    fmi2FMUstate foreign = players[bytes_choice(b, PLAYERS)].states[0];
    fmi2FMUstate given = bytes_one(b) == 255 ? foreign : *own;
    switch (bytes_choice(b, 6)) {
    case 0:
        return fmi2GetFMUstate(player->component, own);
    case 1:
        return fmi2SetFMUstate(player->component, given);
    case 2:
        return fmi2FreeFMUstate(player->component, own);
    case 3:
        return serialize(player, given, b);
    case 4:
        return deserialize(player, own, b);
    default:
        return fmi2SetFMUstate(player->component, bytes_one(b) == 255 ? (fmi2FMUstate)blob : NULL);
    }
}

fmi2Status player_debug_logging(struct player *player, struct bytes *b)
{
    static const fmi2String names[] = {"logAll", "logEvents", "logStatusDiscard", "nonsense", NULL};
    const fmi2String chosen[2] = {names[bytes_choice(b, 5)], names[bytes_choice(b, 5)]};
    const unsigned count = bytes_choice(b, 3);
    player->hears_all = false;
    return fmi2SetDebugLogging(player->component, (fmi2Boolean)bytes_choice(b, 2), count,
                               bytes_one(b) == 255 ? NULL : chosen);
}

fmi2Status player_reset(struct player *player)
{
    const fmi2Status status = fmi2Reset(player->component);
    if (status == fmi2OK) {
        bound_work(player->component);
    }
    return status;
}

void player_leave(struct player *player)
{
    fmi2FreeInstance(player->component);
    memset(player, 0, sizeof *player);
}

fmi2Status player_fail_soon(struct bytes *b)
{
    host.countdown = bytes_choice(b, 8);
    return fmi2OK;
}

int players_play(const uint8_t *data, size_t size, player_call *call)
{
    struct bytes b = {data, size};
    host_begin();
    memset(players, 0, sizeof players);
    blob_size = 0;
    for (int i = 0; i < CALLS_AT_MOST && b.left > 0; ++i) {
        struct player *player = &players[bytes_choice(&b, PLAYERS)];
        const bool heard = player->component != NULL && player->hears_all;
        const long messages = host.messages;
        host.told = player->component;
        const fmi2Status status = call(player, &b);
        host.told = NULL;
        CLAIM(status >= fmi2OK && status <= fmi2Error);
        CLAIM(status <= fmi2OK || !heard || !player->hears_all || host.messages > messages);
        CLAIM(player->component != NULL || status == fmi2Error || status == fmi2OK);
    }
    for (int i = 0; i < PLAYERS; ++i) {
        player_leave(&players[i]);
    }
    host_end();
    return 0;
}
