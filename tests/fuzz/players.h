/*
 * Instances of either version of the standard that are called at random: what the fuzzers of Co-Simulation
 * and of Model Exchange share. Every function makes one call, or a few, with arguments that are missing,
 * wrong or extreme.
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

/* A new instance, seldom of the other kind; nothing where there is one already. */
void player_instantiate(struct player *player, struct bytes *b, bool exchange);
void player_leave(struct player *player);

/* FMI 2.0: fmi2SetupExperiment; FMI 3.0: into initialization mode. */
fmi_status player_set_up(struct player *player, struct bytes *b);

/* From instantiated to the end of initialization. */
fmi_status player_initialize(struct player *player, struct bytes *b);
fmi_status player_reset(struct player *player);

/* Saves, restores and frees states, of FMI 3.0 changes their bytes, and gives them to other instances. */
fmi_status player_handle_state(struct player *player, struct bytes *b);
fmi_status player_debug_logging(struct player *player, struct bytes *b);

/* Memory runs out soon; of FMI 2.0. */
fmi_status player_fail_soon(struct bytes *b);

/* One random call; fmi2OK where there was none. */
typedef fmi_status player_call(struct player *player, struct bytes *b);

/* A whole input: whatever is asked is answered with a known status, a message comes with every refusal, and
 * in the end all memory is back. */
int players_play(const uint8_t *data, size_t size, player_call *call);

/* arrays.c, arrays3.c: a function that takes arrays, with any references, types, lengths and values. */
fmi_status arrays_call(fmi_instance c, struct bytes *b);

/* One variable that exists, a value within its range as far as chance goes. */
fmi_status arrays_set_one(fmi_instance c, struct bytes *b);

#endif
