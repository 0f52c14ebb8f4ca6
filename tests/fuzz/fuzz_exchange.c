/*
 * Random sequences of FMI calls on several instances of Model Exchange: any function at any time, an
 * integrator that steps and handles events, arrays of wrong lengths, states that go from one instance to
 * another or that somebody changed. Whatever is asked must be answered: no crash, a known status, a message
 * for every refusal, finite values, event iterations that end.
 */
#include "forge.h"
#include "outside.h"
#include "players.h"
#include "scene.h"

/* Event mode until nothing changes any more, and out of it. */
static fmi2Status handle_event(fmi2Component c)
{
    fmi2EventInfo news = {.newDiscreteStatesNeeded = fmi2True};
    fmi2Status status = fmi2OK;
    for (int i = 0; status <= fmi2Warning && news.newDiscreteStatesNeeded; ++i) {
        CLAIM(i < ITERATIONS_AT_MOST);
        status = fmi2NewDiscreteStates(c, &news);
        CLAIM(!news.terminateSimulation && !news.nominalsOfContinuousStatesChanged);
        CLAIM(!news.nextEventTimeDefined || isfinite(news.nextEventTime));
    }
    return status <= fmi2Warning ? fmi2EnterContinuousTimeMode(c) : status;
}

/* Any of the calls between the modes; places for answers may be missing. */
static fmi2Status change_mode(struct player *player, struct bytes *b)
{
    fmi2Component c = player->instance;
    fmi2EventInfo news = {.newDiscreteStatesNeeded = fmi2False};
    fmi2Boolean flag = fmi2False;
    switch (bytes_choice(b, 8)) {
    case 0:
        return fmi2EnterEventMode(c);
    case 1:
        return fmi2EnterContinuousTimeMode(c);
    case 2:
        return fmi2NewDiscreteStates(c, bytes_one(b) == 255 ? NULL : &news);
    case 3:
        return fmi2CompletedIntegratorStep(c, fmi2True, &flag, bytes_one(b) == 255 ? NULL : &flag);
    case 4:
        return fmi2SetTime(c, bytes_real(b));
    case 5:
        return handle_event(c);
    case 6:
        return bytes_one(b) == 255 ? fmi2Terminate(c) : fmi2EnterEventMode(c);
    default:
        return fmi2DoStep(c, 0.0, 0.1, fmi2True);
    }
}

/* A state of its own with other bytes: taken over or refused. */
static fmi2Status bring_forged(fmi2Component c, struct bytes *b)
{
    static fmi2Byte block[LARGEST_BLOCK];
    fmi2FMUstate state = NULL;
    size_t size = 0;
    fmi2Status status = fmi2GetFMUstate(c, &state);
    if (status > fmi2Warning) {
        return status;
    }
    status = fmi2SerializedFMUstateSize(c, state, &size);
    CLAIM(status == fmi2OK && size <= sizeof block);
    status = fmi2SerializeFMUstate(c, state, block, size);
    CLAIM(status == fmi2OK);
    uint8_t row[12]; /* for the changes; the rest is for other calls */
    bytes_copy(b, row, sizeof row);
    struct bytes some = {row, sizeof row};
    forge_changes((uint8_t *)block, size, &some);
    forge_bound_work((uint8_t *)block, MOST_INTERNAL_STEPS);
    forge_checksums((uint8_t *)block, size);
    status = fmi2DeSerializeFMUstate(c, block, size, &state);
    if (status == fmi2OK) {
        status = fmi2SetFMUstate(c, state);
    }
    const fmi2Status freed = fmi2FreeFMUstate(c, &state);
    CLAIM(freed == fmi2OK || (freed == fmi2Error && status == fmi2OK)); /* a fatal phase was forged */
    return status;
}

static fmi2Status enter_or_leave(struct player *player, struct bytes *b)
{
    return bytes_choice(b, 2) ? fmi2EnterInitializationMode(player->instance)
                              : fmi2ExitInitializationMode(player->instance);
}

static fmi2Status log_or_fail(struct player *player, struct bytes *b)
{
    return bytes_choice(b, 2) ? player_debug_logging(player, b) : player_fail_soon(player, b);
}

static fmi2Status forge_or_reset(struct player *player, struct bytes *b)
{
    return bytes_one(b) < 128 && player->instance != NULL ? bring_forged(player->instance, b)
                                                          : player_reset(player, b);
}

static const struct play play = {.exchange = true,
                                 .count = 20,
                                 .calls = {player_instantiate,
                                           player_may_leave,
                                           player_set_up,
                                           enter_or_leave,
                                           player_initialize,
                                           player_initialize,
                                           march,
                                           march,
                                           march,
                                           change_mode,
                                           change_mode,
                                           any_vector,
                                           any_vector,
                                           arrays_call,
                                           arrays_set_one,
                                           arrays_set_one,
                                           player_handle_state,
                                           log_or_fail,
                                           forge_or_reset,
                                           player_read_all}};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return players_play(data, size, &play);
}
