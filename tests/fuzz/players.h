/*
 * The fuzzers of Co-Simulation and of Model Exchange share these players: instances of either version of FMI
 * whose functions are called at random, with arguments that are missing, wrong or extreme.
 */
#ifndef FUZZ_PLAYERS_H
#define FUZZ_PLAYERS_H

#include "bytes.h"
#include "claim.h"
#include "fmi.h"
#if FUZZ_FMI == 3
#include "host3.h"
#else
#include "host.h"
#endif

/* The steps of bodies that turn and rub take a millisecond each with sanitizers: a few of them must do. */
enum { PLAYERS = 3, STATES = 2, MOST_INTERNAL_STEPS = FUZZ_FMI == 3 ? 30 : 100 };

struct player {
    fmi_instance instance;
    fmi_state states[STATES];
    bool exchange;  /* of Model Exchange */
    bool hears_all; /* every refusal has to come with a message */
};

/* One random call; fmi2OK where there was none. All below are such calls. */
typedef fmi_status player_call(struct player *player, struct bytes *b);

/* A new instance, seldom of another kind than usual; nothing where there is one already. */
player_call player_instantiate;
player_call player_leave;
player_call player_may_leave;

/* FMI 2.0: fmi2SetupExperiment; FMI 3.0: into initialization mode. */
player_call player_set_up;

/* From instantiated to the end of initialization. */
player_call player_initialize;
player_call player_reset;

/* Saves, restores and frees states, of FMI 3.0 changes their bytes, and gives them to other instances. */
player_call player_handle_state;
player_call player_debug_logging;
player_call player_log_or_reset;

/* Reads every variable. */
player_call player_read_all;

/* Memory runs out soon; of FMI 2.0. */
player_call player_fail_soon;

/* arrays.c, arrays3.c: a function that takes arrays, with any references, types, lengths and values. */
player_call arrays_call;

/* One variable that exists, a value within its range as far as chance goes. */
player_call arrays_set_one;

/* What is called, each as often as it is listed in both rows, and whether instances are of Model Exchange. */
struct play {
    bool exchange;
    unsigned count;
    player_call *calls[2][10];
};

/* A whole input: every call has a known status, every refusal a message, and all memory is back. */
int players_play(const uint8_t *data, size_t size, const struct play *play);

#endif
