/*
 * As fuzz_exchange.c, with instances of FMI 3.0: an integrator that steps and handles events, states set one
 * by one or as a vector, both kinds of derivatives, arrays of wrong lengths.
 */
#include "outside.h"
#include "players.h"
#include "scene.h"

/* Event mode until nothing changes any more, and out of it. */
static fmi3Status handle_event(fmi3Instance c)
{
    fmi3Boolean again = true, terminate = false, nominals = false, values = false, scheduled = false;
    const fmi3ValueReference clock = 0;
    fmi3Float64 next = 0.0, time = 0.0;
    fmi3Status status = fmi3GetFloat64(c, &clock, 1, &time, 1);
    for (int i = 0; status <= fmi3Warning && again; ++i) {
        CLAIM(i < ITERATIONS_AT_MOST);
        status = fmi3UpdateDiscreteStates(c, &again, &terminate, &nominals, &values, &scheduled, &next);
        CLAIM(!terminate && !nominals);
        CLAIM(!scheduled || (next > time && isfinite(next)));
    }
    return status <= fmi3Warning ? fmi3EnterContinuousTimeMode(c) : status;
}

static fmi3Status numbers(fmi3Instance c, struct bytes *b)
{
    size_t states = SIZE_MAX, indicators = SIZE_MAX;
    fmi3Status status = fmi3GetNumberOfContinuousStates(c, bytes_one(b) == 255 ? NULL : &states);
    CLAIM(status > fmi3Warning || states == SCENE_STATES);
    if (status <= fmi3Warning) {
        status = fmi3GetNumberOfEventIndicators(c, &indicators);
        CLAIM(status > fmi3Warning || indicators == SCENE_INDICATORS);
    }
    return status;
}

/* Any of the calls between the modes; places for answers may be missing. */
static fmi3Status change_mode(struct player *player, struct bytes *b)
{
    fmi3Instance c = player->instance;
    fmi3Boolean flags[5] = {false};
    fmi3Float64 next = 0.0;
    switch (bytes_choice(b, 9)) {
    case 0:
        return fmi3EnterEventMode(c);
    case 1:
        return fmi3EnterContinuousTimeMode(c);
    case 2:
        return fmi3UpdateDiscreteStates(c, &flags[0], &flags[1], &flags[2], &flags[3],
                                        bytes_one(b) == 255 ? NULL : &flags[4], &next);
    case 3:
        return fmi3CompletedIntegratorStep(c, true, &flags[0], bytes_one(b) == 255 ? NULL : &flags[1]);
    case 4:
        return fmi3SetTime(c, bytes_real(b));
    case 5:
        return handle_event(c);
    case 6:
        return bytes_one(b) == 255 ? fmi3Terminate(c) : fmi3EnterEventMode(c);
    case 7:
        return numbers(c, b);
    default:
        return bytes_choice(b, 2) ? fmi3EnterStepMode(c)
                                  : fmi3DoStep(c, 0.0, 0.1, true, &flags[0], &flags[1], &flags[2], &next);
    }
}

static fmi3Status enter_or_leave(struct player *player, struct bytes *b)
{
    return bytes_choice(b, 2) ? player_set_up(player, b) : fmi3ExitInitializationMode(player->instance);
}

static const struct play play = {.exchange = true,
                                 .count = 20,
                                 .calls = {player_instantiate,
                                           player_may_leave,
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
                                           arrays_call,
                                           arrays_set_one,
                                           arrays_set_one,
                                           player_handle_state,
                                           player_handle_state,
                                           player_log_or_reset,
                                           player_read_all}};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return players_play(data, size, &play);
}
