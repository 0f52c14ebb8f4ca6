/*
 * Random sequences of FMI calls on several instances of Co-Simulation: any function at any time, arguments
 * that are missing, wrong or extreme, states that go from one instance to another, memory that runs out.
 * Every call must be answered: no crash, a known status, a message for a refusal, finite values, no leaks.
 */
#include "players.h"

static fmi2Status step(struct player *player, struct bytes *b)
{
    const unsigned odd = bytes_one(b);
    double time = 0.0;
    if (odd & 1) {
        time = bytes_real(b);
    } else if (fmi2GetRealStatus(player->instance, fmi2LastSuccessfulTime, &time) != fmi2OK) {
        time = 0.0;
    }
    const double size = odd & 2 ? bytes_real(b) : bytes_power(b, -4.0, 0.5);
    return fmi2DoStep(player->instance, time, size, (odd & 4) != 0);
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
        return fmi2GetStatus(player->instance, kind, null ? NULL : &status);
    case 1:
        return fmi2GetRealStatus(player->instance, kind, null ? NULL : &real);
    case 2:
        return fmi2GetIntegerStatus(player->instance, kind, null ? NULL : &integer);
    case 3:
        return fmi2GetBooleanStatus(player->instance, kind, null ? NULL : &integer);
    default:
        return fmi2GetStringStatus(player->instance, kind, null ? NULL : &string);
    }
}

static fmi2Status enter(struct player *player, struct bytes *b)
{
    (void)b;
    return fmi2EnterInitializationMode(player->instance);
}

static fmi2Status leave(struct player *player, struct bytes *b)
{
    (void)b;
    return fmi2ExitInitializationMode(player->instance);
}

static fmi2Status stop(struct player *player, struct bytes *b)
{
    return bytes_choice(b, 2) ? fmi2Terminate(player->instance) : fmi2CancelStep(player->instance);
}

static fmi2Status reset_or_fail(struct player *player, struct bytes *b)
{
    return bytes_choice(b, 2) ? player_reset(player, b) : player_fail_soon(player, b);
}

static const struct play play = {.count = 16,
                                 .calls = {{player_instantiate, player_leave, player_set_up, enter, leave,
                                            player_initialize, step, step, ask_status, arrays_call},
                                           {arrays_set_one, player_handle_state, player_debug_logging, stop,
                                            reset_or_fail, player_read_all}}};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return players_play(data, size, &play);
}
