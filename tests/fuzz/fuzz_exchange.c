/*
 * Random sequences of FMI calls on several instances of Model Exchange: any function at any time, an
 * integrator that steps and handles events, states set one by one or as a vector, arrays of wrong lengths,
 * states that go from one instance to another or that somebody changed. Whatever is asked must be answered:
 * no crash, a known status, a message for every refusal, finite values, event iterations that end.
 */
#include "forge.h"
#include "outside.h"
#include "players.h"
#include "scene.h"

#if FUZZ_FMI == 3

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

static fmi_status update(fmi_instance c, bool missing)
{
    fmi3Boolean flags[5] = {false};
    fmi3Float64 next = 0.0;
    return fmi3UpdateDiscreteStates(c, &flags[0], &flags[1], &flags[2], &flags[3], missing ? NULL : &flags[4],
                                    &next);
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

/* What one version alone has, and calls of Co-Simulation. */
enum { CHANGES = 9 };

static fmi_status change_otherwise(fmi_instance c, struct bytes *b, unsigned which)
{
    fmi3Boolean flags[3] = {false};
    fmi3Float64 reached = 0.0;
    if (which == 7) {
        return numbers(c, b);
    }
    return bytes_choice(b, 2) ? fmi3EnterStepMode(c)
                              : fmi3DoStep(c, 0.0, 0.1, true, &flags[0], &flags[1], &flags[2], &reached);
}

static fmi_status enter_or_leave(struct player *player, struct bytes *b)
{
    return bytes_choice(b, 2) ? player_set_up(player, b) : fmi3ExitInitializationMode(player->instance);
}

#else

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

static fmi_status update(fmi_instance c, bool missing)
{
    fmi2EventInfo news = {.newDiscreteStatesNeeded = fmi2False};
    return fmi2NewDiscreteStates(c, missing ? NULL : &news);
}

/* A call of Co-Simulation. */
enum { CHANGES = 8 };

static fmi_status change_otherwise(fmi_instance c, struct bytes *b, unsigned which)
{
    (void)b, (void)which;
    return fmi2DoStep(c, 0.0, 0.1, fmi2True);
}

/* A state of its own with other bytes: taken over or refused. */
static fmi_status bring_forged(fmi_instance c, struct bytes *b)
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
    forge_checksum((uint8_t *)block, size);
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

#endif

/* Any of the calls between the modes; places for answers may be missing. */
static fmi_status change_mode(struct player *player, struct bytes *b)
{
    fmi_instance c = player->instance;
    FMI(Boolean) flag = false;
    const unsigned which = bytes_choice(b, CHANGES);
    switch (which) {
    case 0:
        return FMI(EnterEventMode)(c);
    case 1:
        return FMI(EnterContinuousTimeMode)(c);
    case 2:
        return update(c, bytes_one(b) == 255);
    case 3:
        return FMI(CompletedIntegratorStep)(c, true, &flag, bytes_one(b) == 255 ? NULL : &flag);
    case 4:
        return FMI(SetTime)(c, bytes_real(b));
    case 5:
        return handle_event(c);
    case 6:
        return bytes_one(b) == 255 ? FMI(Terminate)(c) : FMI(EnterEventMode)(c);
    default:
        return change_otherwise(c, b, which);
    }
}

static const struct play play = {
    .exchange = true,
    .count = 20,
#if FUZZ_FMI == 3
    .calls = {{player_instantiate, player_may_leave, enter_or_leave, player_initialize, player_initialize,
               march, march, march, change_mode, change_mode},
              {any_vector, any_vector, arrays_call, arrays_call, arrays_set_one, arrays_set_one,
               player_handle_state, player_handle_state, player_log_or_reset, player_read_all}}};
#else
    .calls = {{player_instantiate, player_may_leave, player_set_up, enter_or_leave, player_initialize,
               player_initialize, march, march, march, change_mode},
              {change_mode, any_vector, any_vector, arrays_call, arrays_set_one, arrays_set_one,
               player_handle_state, log_or_fail, forge_or_reset, player_read_all}}};
#endif

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return players_play(data, size, &play);
}
