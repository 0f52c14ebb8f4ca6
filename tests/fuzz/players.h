/*
 * Instances that are called at random: what the fuzzers of Co-Simulation and of Model Exchange share. Every
 * function makes one call, or a few, with arguments that are missing, wrong or extreme.
 */
#ifndef FUZZ_PLAYERS_H
#define FUZZ_PLAYERS_H

#include <fmi2Functions.h>

#include "bytes.h"
#include "claim.h"

enum { PLAYERS = 3, STATES = 2 };

struct player {
    fmi2Component component;
    fmi2FMUstate states[STATES];
    bool hears_all; /* every refusal has to come with a message */
};

extern struct player players[PLAYERS];

/* A new instance, seldom of another type than the usual one; nothing where there is one already. */
void player_instantiate(struct player *player, struct bytes *b, fmi2Type usual);
void player_leave(struct player *player);

fmi2Status player_set_up(struct player *player, struct bytes *b);

/* From instantiated to the end of initialization. */
fmi2Status player_initialize(struct player *player, struct bytes *b);
fmi2Status player_reset(struct player *player);

/* One value that exists, within its range as far as chance goes. */
fmi2Status player_set_one(struct player *player, struct bytes *b);

/* Saves, restores and frees states, and gives them to other instances. */
fmi2Status player_handle_state(struct player *player, struct bytes *b);
fmi2Status player_debug_logging(struct player *player, struct bytes *b);

/* Memory runs out soon. */
fmi2Status player_fail_soon(struct bytes *b);

/* One random call; fmi2OK where there was none. */
typedef fmi2Status player_call(struct player *player, struct bytes *b);

/* A whole input: whatever is asked is answered with a known status, a message comes with every refusal, and
 * in the end all memory is back. */
int players_play(const uint8_t *data, size_t size, player_call *call);

#endif
