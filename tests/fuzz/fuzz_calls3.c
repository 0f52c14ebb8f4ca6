/*
 * Random sequences of FMI 3.0 calls on several instances of Co-Simulation, with and without event mode, early
 * return and intermediate update: any function at any time, arguments that are missing, wrong or extreme,
 * states that go from one instance to another or that somebody changed. Whatever is asked must be answered:
 * no crash, a known status, a message for every refusal, finite values.
 */
#include "players.h"
#include "scene.h"

static fmi3Status step(struct player *player, struct bytes *b)
{
    const unsigned odd = bytes_one(b);
    const fmi3ValueReference clock = 0;
    fmi3Boolean event = false, terminate = true, early = false;
    fmi3Float64 time = 0.0, reached = (double)NAN;
    if (fmi3GetFloat64(player->instance, &clock, 1, &time, 1) > fmi3Warning || (odd & 33) == 33) {
        time = bytes_real(b);
    }
    const double size = (odd & 6) == 6 ? bytes_real(b) : bytes_power(b, -4.0, 0.5);
    host.stepped = player->instance;
    host.told = NULL; /* a step that reports a change lets the logger be, the update calls back */
    host.early = (odd & 8) != 0;
    host.early_after = odd & 16 ? bytes_real(b) : 0.0;
    const fmi3Status status =
        fmi3DoStep(player->instance, time, size, fmi3True, &event, odd == 255 ? NULL : &terminate, &early,
                   odd == 254 ? NULL : &reached);
    host.stepped = NULL;
    if (status <= fmi3Warning) {
        CLAIM(!terminate && isfinite(reached) && reached > time - 1e-6 * size);
        CLAIM(early || fabs(reached - (time + size)) <= 1e-6 * size);
    }
    return status;
}

/* In Co-Simulation nothing is left to be done in event mode. */
static fmi3Status handle_event(const struct player *player, struct bytes *b)
{
    fmi3Instance c = player->instance;
    fmi3Boolean flags[5] = {true, true, true, true, true};
    fmi3Float64 next = 0.0;
    const fmi3Status status = fmi3UpdateDiscreteStates(
        c, &flags[0], &flags[1], &flags[2], bytes_one(b) == 255 ? NULL : &flags[3], &flags[4], &next);
    CLAIM(status > fmi3Warning || !(flags[1] || flags[2]));
    CLAIM(status > fmi3Warning || player->exchange || !(flags[0] || flags[3] || flags[4]));
    return status <= fmi3Warning && bytes_choice(b, 4) ? fmi3EnterStepMode(c) : status;
}

/* Between the modes, and what these FMUs do not have. */
static fmi3Status change_mode(struct player *player, struct bytes *b)
{
    fmi3Instance c = player->instance;
    size_t number = 0;
    fmi3Float64 state = 0.0;
    switch (bytes_choice(b, 9)) {
    case 0:
        return fmi3EnterEventMode(c);
    case 1:
        return fmi3EnterStepMode(c);
    case 2:
    case 3:
        return handle_event(player, b);
    case 4:
        return bytes_one(b) == 255 ? fmi3Terminate(c) : fmi3EnterEventMode(c);
    case 5:
        return fmi3SetTime(c, bytes_real(b));
    case 6:
        return fmi3GetNumberOfContinuousStates(c, &number);
    case 7:
        return fmi3GetContinuousStates(c, &state, 1);
    default:
        return fmi3EnterConfigurationMode(c);
    }
}

static fmi3Status leave(struct player *player, struct bytes *b)
{
    (void)b;
    return fmi3ExitInitializationMode(player->instance);
}

static const struct play play = {.count = 16,
                                 .calls = {{player_instantiate, player_may_leave, player_set_up, leave,
                                            player_initialize, step, step, step, change_mode, arrays_call},
                                           {arrays_call, arrays_set_one, arrays_set_one, player_handle_state,
                                            player_log_or_reset, player_read_all}}};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return players_play(data, size, &play);
}
