#include "players.h"

#include <stdlib.h>

#include "forge.h"
#include "scene.h"

enum { CALLS_AT_MOST = 120 };

static struct player players[PLAYERS];
static bool plays_exchange; /* of Model Exchange, usually */

/* A saved state as bytes, for whoever deserializes next. */
static uint8_t blob[LARGEST_BLOCK];
static size_t blob_size;

#if FUZZ_FMI == 3

static void instantiate(struct player *player, struct bytes *b)
{
    const unsigned odd = bytes_one(b), steps = bytes_one(b);
    const char *name = odd == 255 ? NULL : odd == 254 ? "" : "pl\xc3\xa4yer %s #r1#";
    const char *token = odd == 253 ? "another" : odd == 252 ? NULL : SCENE_TOKEN;
    const fmi3LogMessageCallback logger = odd == 251 ? NULL : host_hear;
    const fmi3Boolean logging = odd % 2 == 0;
    const fmi3ValueReference required[2] = {scene_variables[steps % (unsigned)scene_variable_count].reference,
                                            steps == 255 ? bytes_word(b) : 0};
    player->exchange = player->exchange != (odd >= 230 && odd < 250);
    if (player->exchange) {
        player->instance = fmi3InstantiateModelExchange(name, token, NULL, fmi3False, logging, &host, logger);
    } else {
        player->instance =
            fmi3InstantiateCoSimulation(name, token, NULL, fmi3False, logging, (steps & 1) != 0,
                                        (steps & 2) != 0, steps == 254 ? NULL : required, (steps >> 4) % 3,
                                        &host, logger, (steps & 4) != 0 ? host_update : NULL);
    }
    player->hears_all = logger != NULL;
}

fmi_status player_set_up(struct player *player, struct bytes *b)
{
    const unsigned odd = bytes_one(b);
    const double tolerance = odd & 2 ? bytes_real(b) : 1e-6;
    const double start = (odd & 12) == 12 ? bytes_real(b) : 0.0;
    const double stop = (odd & 48) == 48 ? bytes_real(b) : 10.0;
    return fmi3EnterInitializationMode(player->instance, odd & 1, tolerance, start, (odd & 16) != 0, stop);
}

fmi_status player_initialize(struct player *player, struct bytes *b)
{
    const fmi_status status = player_set_up(player, b);
    return status <= fmi3Warning ? fmi3ExitInitializationMode(player->instance) : status;
}

#else

static void instantiate(struct player *player, struct bytes *b)
{
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
    const fmi2Type usual = player->exchange ? fmi2ModelExchange : fmi2CoSimulation;
    const fmi2Type type = odd & 16 ? (fmi2Type)bytes_choice(b, 3) : usual;
    const char *name = odd & 32 ? NULL : "pl\xc3\xa4yer %s #r1#";
    const char *guid = odd & 64 ? "another" : SCENE_GUID;
    player->instance =
        fmi2Instantiate(name, type, guid, NULL, odd == 128 ? NULL : &callbacks, fmi2False, (odd & 128) != 0);
    player->hears_all = callbacks.logger != NULL;
}

fmi_status player_set_up(struct player *player, struct bytes *b)
{
    const unsigned odd = bytes_one(b);
    const double tolerance = odd & 2 ? bytes_real(b) : 1e-6;
    const double start = odd & 4 ? bytes_real(b) : 0.0;
    return fmi2SetupExperiment(player->instance, odd & 1, tolerance, start, (odd & 8) != 0,
                               odd & 8 ? bytes_real(b) : 0.0);
}

fmi_status player_initialize(struct player *player, struct bytes *b)
{
    fmi_status status = player_set_up(player, b);
    if (status <= fmi2Warning) {
        status = fmi2EnterInitializationMode(player->instance);
    }
    return status <= fmi2Warning ? fmi2ExitInitializationMode(player->instance) : status;
}

fmi_status player_fail_soon(struct player *player, struct bytes *b)
{
    (void)player;
    host.countdown = bytes_choice(b, 8);
    return fmi2OK;
}

#endif

fmi_status player_instantiate(struct player *player, struct bytes *b)
{
    if (player->instance == NULL) {
        player->exchange = plays_exchange;
        instantiate(player, b);
        if (player->instance != NULL) {
            host_bound_work(player->instance, MOST_INTERNAL_STEPS);
        }
    }
    return FMI(OK);
}

fmi_status player_reset(struct player *player, struct bytes *b)
{
    (void)b;
    const fmi_status status = FMI(Reset)(player->instance);
    if (status == FMI(OK)) {
        host_bound_work(player->instance, MOST_INTERNAL_STEPS);
    }
    return status;
}

fmi_status player_leave(struct player *player, struct bytes *b)
{
    (void)b;
    FMI(FreeInstance)(player->instance);
    memset(player, 0, sizeof *player);
    return FMI(OK);
}

fmi_status player_may_leave(struct player *player, struct bytes *b)
{
    return bytes_one(b) > 200 ? player_leave(player, b) : FMI(OK);
}

fmi_status player_read_all(struct player *player, struct bytes *b)
{
    (void)b;
    if (player->instance != NULL) {
        host_read_all(player->instance);
    }
    return FMI(OK);
}

static fmi_status serialize(struct player *player, fmi_state state, struct bytes *b)
{
    size_t size = 0;
    const unsigned odd = FUZZ_FMI == 3 ? bytes_one(b) : 0;
    fmi_status status = FMI_STATE_SIZE(player->instance, state, odd == 254 ? NULL : &size);
    if (status == FMI(OK)) {
        CLAIM(size <= sizeof blob);
        const size_t given = (FUZZ_FMI == 3 ? odd : bytes_one(b)) == 255 ? size / 2 : size;
        status = FMI_STATE(Serialize)(player->instance, state, odd == 253 ? NULL : (FMI(Byte) *)blob, given);
        blob_size = status == FMI(OK) ? size : blob_size;
    }
    return status;
}

/* As they are, cut short, or of FMI 3.0 changed with checksums that fit. */
static fmi_status deserialize(struct player *player, fmi_state *state, struct bytes *b)
{
    const unsigned odd = bytes_one(b);
    const size_t shorter = odd == 255 ? bytes_one(b) : 0;
    const size_t size = blob_size > shorter ? blob_size - shorter : 0;
    uint8_t *exact = malloc(size > 0 ? size : 1);
    CLAIM(exact != NULL);
    memcpy(exact, blob, size);
    if (FUZZ_FMI == 3 && odd < 100 && size > 0) {
        uint8_t row[12]; /* for the changes; the rest is for other calls */
        bytes_copy(b, row, sizeof row);
        struct bytes some = {row, sizeof row};
        forge_changes(exact, size, &some);
        forge_bound_work(exact, MOST_INTERNAL_STEPS);
        forge_checksum(exact, size);
    }
    const fmi_status status = FMI_DESERIALIZE(player->instance, (FMI(Byte) *)exact, size, state);
    free(exact);
    return status;
}

fmi_status player_handle_state(struct player *player, struct bytes *b)
{
    fmi_state *own = &player->states[bytes_choice(b, STATES)];
    fmi_state foreign = players[bytes_choice(b, PLAYERS)].states[0];
    fmi_state given = bytes_one(b) == 255 ? foreign : *own;
    static const uint8_t twice[] = {0, 0, 1, 1, 2, 3, 4, 5}; /* FMI 3.0 saves and restores more often */
    switch (FUZZ_FMI == 3 ? twice[bytes_choice(b, 8)] : bytes_choice(b, 6)) {
    case 0:
        return FMI_STATE(Get)(player->instance, own);
    case 1:
        return FMI_STATE(Set)(player->instance, given);
    case 2:
        return FMI_STATE(Free)(player->instance, own);
    case 3:
        return serialize(player, given, b);
    case 4:
        return deserialize(player, own, b);
    default:
        return FMI_STATE(Set)(player->instance, bytes_one(b) == 255 ? (fmi_state)blob : NULL);
    }
}

fmi_status player_debug_logging(struct player *player, struct bytes *b)
{
    static const FMI(String) names[] = {"logAll", "logEvents", "logStatusDiscard", "nonsense", NULL};
    const FMI(String) chosen[2] = {names[bytes_choice(b, 5)], names[bytes_choice(b, 5)]};
    const unsigned count = bytes_choice(b, 3);
    player->hears_all = false;
    return FMI(SetDebugLogging)(player->instance, bytes_choice(b, 2) != 0, count,
                                bytes_one(b) == 255 ? NULL : chosen);
}

fmi_status player_log_or_reset(struct player *player, struct bytes *b)
{
    return bytes_choice(b, 2) ? player_debug_logging(player, b) : player_reset(player, b);
}

int players_play(const uint8_t *data, size_t size, const struct play *play)
{
    struct bytes b = {data, size};
    host_begin();
    memset(players, 0, sizeof players);
    plays_exchange = play->exchange;
    blob_size = 0;
    for (int i = 0; i < CALLS_AT_MOST && b.left > 0; ++i) {
        struct player *player = &players[bytes_choice(&b, PLAYERS)];
        const bool heard = player->instance != NULL && player->hears_all;
        const long messages = host.messages;
        host.told = player->instance;
        const unsigned call = bytes_choice(&b, play->count);
        const fmi_status status = play->calls[call / 10][call % 10](player, &b);
        host.told = NULL;
        CLAIM(status >= FMI(OK) && status <= FMI(Error));
        CLAIM(status <= FMI(OK) || !heard || !player->hears_all || host.messages > messages);
        CLAIM(player->instance != NULL || status == FMI(Error) || status == FMI(OK));
    }
    for (int i = 0; i < PLAYERS; ++i) {
        (void)player_leave(&players[i], &b);
    }
#if FUZZ_FMI == 2
    host_end();
#endif
    return 0;
}
