/*
 * Random sequences of FMI calls on several instances: any function at any time, arguments that are
 * missing, wrong or extreme, states that go from one instance to another, memory that runs out. Whatever
 * is asked must be answered: no crash, a known status, a message for every refusal, finite values, all
 * memory back.
 */
#include <stdlib.h>

#include "arrays.h"
#include "bytes.h"
#include "host.h"
#include "scene.h"

enum { PLAYERS = 3, STATES = 2, CALLS_AT_MOST = 120 };

struct player {
    fmi2Component component;
    fmi2FMUstate states[STATES];
    bool hears_all; /* every refusal has to come with a message */
};

static struct player players[PLAYERS];

/* A saved state as bytes, for whoever deserializes next. */
static fmi2Byte blob[16384];
static size_t blob_size;

static void bound_work(fmi2Component c)
{
    (void)host_set_integer(c, ROW_solver_max_internal_steps, 0, MOST_INTERNAL_STEPS);
}

static void instantiate(struct player *player, struct bytes *b)
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
    const fmi2Type type = odd & 16 ? (fmi2Type)bytes_choice(b, 3) : fmi2CoSimulation;
    const char *name = odd & 32 ? NULL : "pl\xc3\xa4yer %s #r1#";
    const char *guid = odd & 64 ? "another" : SCENE_GUID;
    player->component =
        fmi2Instantiate(name, type, guid, NULL, odd == 128 ? NULL : &callbacks, fmi2False, (odd & 128) != 0);
    player->hears_all = callbacks.logger != NULL;
    if (player->component != NULL) {
        bound_work(player->component);
    }
}

static fmi2Status set_up(struct player *player, struct bytes *b)
{
    const unsigned odd = bytes_one(b);
    const double tolerance = odd & 2 ? bytes_real(b) : 1e-6;
    const double start = odd & 4 ? bytes_real(b) : 0.0;
    return fmi2SetupExperiment(player->component, odd & 1, tolerance, start, (odd & 8) != 0,
                               odd & 8 ? bytes_real(b) : 0.0);
}

static fmi2Status to_step_mode(struct player *player, struct bytes *b)
{
    fmi2Status status = set_up(player, b);
    if (status <= fmi2Warning) {
        status = fmi2EnterInitializationMode(player->component);
    }
    return status <= fmi2Warning ? fmi2ExitInitializationMode(player->component) : status;
}

static fmi2Status step(struct player *player, struct bytes *b)
{
    const unsigned odd = bytes_one(b);
    double time = 0.0;
    if (odd & 1) {
        time = bytes_real(b);
    } else if (fmi2GetRealStatus(player->component, fmi2LastSuccessfulTime, &time) != fmi2OK) {
        time = 0.0;
    }
    const double size = odd & 2 ? bytes_real(b) : bytes_power(b, -4.0, 0.5);
    return fmi2DoStep(player->component, time, size, (odd & 4) != 0);
}

static fmi2Status ask_status(struct player *player, struct bytes *b)
{
    const fmi2StatusKind kind = (fmi2StatusKind)bytes_choice(b, 5);
    fmi2Status status = fmi2OK;
    fmi2Real real = 0.0;
    fmi2Integer integer = 0;
    fmi2String string = "";
    const bool null = bytes_one(b) == 255;
    switch (bytes_choice(b, 5)) {
    case 0:
        return fmi2GetStatus(player->component, kind, null ? NULL : &status);
    case 1:
        return fmi2GetRealStatus(player->component, kind, null ? NULL : &real);
    case 2:
        return fmi2GetIntegerStatus(player->component, kind, null ? NULL : &integer);
    case 3:
        return fmi2GetBooleanStatus(player->component, kind, null ? NULL : &integer);
    default:
        return fmi2GetStringStatus(player->component, kind, null ? NULL : &string);
    }
}

/* One value that exists, within its range as far as chance goes. */
static fmi2Status set_one(struct player *player, struct bytes *b)
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

static fmi2Status handle_state(struct player *player, struct bytes *b)
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

static fmi2Status debug_logging(struct player *player, struct bytes *b)
{
    static const fmi2String names[] = {"logAll", "logEvents", "logStatusDiscard", "nonsense", NULL};
    const fmi2String chosen[2] = {names[bytes_choice(b, 5)], names[bytes_choice(b, 5)]};
    const unsigned count = bytes_choice(b, 3);
    player->hears_all = false;
    return fmi2SetDebugLogging(player->component, (fmi2Boolean)bytes_choice(b, 2), count,
                               bytes_one(b) == 255 ? NULL : chosen);
}

static fmi2Status reset(struct player *player)
{
    const fmi2Status status = fmi2Reset(player->component);
    if (status == fmi2OK) {
        bound_work(player->component);
    }
    return status;
}

static void leave(struct player *player)
{
    fmi2FreeInstance(player->component);
    memset(player, 0, sizeof *player);
}

static fmi2Status fail_soon(struct bytes *b)
{
    host.countdown = bytes_choice(b, 8);
    return fmi2OK;
}

/* The status of one random call; fmi2OK where there was none. */
static fmi2Status call(struct player *player, struct bytes *b)
{
    switch (bytes_choice(b, 16)) {
    case 0:
        instantiate(player, b);
        return fmi2OK;
    case 1:
        leave(player);
        return fmi2OK;
    case 2:
        return set_up(player, b);
    case 3:
        return fmi2EnterInitializationMode(player->component);
    case 4:
        return fmi2ExitInitializationMode(player->component);
    case 5:
        return to_step_mode(player, b);
    case 6:
    case 7:
        return step(player, b);
    case 8:
        return ask_status(player, b);
    case 9:
        return arrays_call(player->component, b);
    case 10:
        return set_one(player, b);
    case 11:
        return handle_state(player, b);
    case 12:
        return debug_logging(player, b);
    case 13:
        return bytes_choice(b, 2) ? fmi2Terminate(player->component) : fmi2CancelStep(player->component);
    case 14:
        return bytes_choice(b, 2) ? reset(player) : fail_soon(b);
    default:
        if (player->component != NULL) {
            host_read_all(player->component);
        }
        return fmi2OK;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
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
        leave(&players[i]);
    }
    host_end();
    return 0;
}
