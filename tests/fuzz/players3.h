/*
 * Instances of FMI 3.0 that are called at random: what the fuzzers of Co-Simulation and of Model Exchange
 * share. Every function makes one call, or a few, with arguments that are missing, wrong or extreme.
 */
#ifndef FUZZ_PLAYERS3_H
#define FUZZ_PLAYERS3_H

#include <fmi3Functions.h>

#include "bytes.h"
#include "claim.h"

/* The steps of bodies that turn and rub take a millisecond each with sanitizers: a few of them must do. */
enum { PLAYERS = 3, STATES = 2, MOST_INTERNAL_STEPS = 30 };

struct player3 {
    fmi3Instance instance;
    fmi3FMUState states[STATES];
    bool exchange;  /* of Model Exchange */
    bool hears_all; /* every refusal has to come with a message */
};

extern struct player3 players3[PLAYERS];

/* A new instance, seldom of the other kind; nothing where there is one already. */
void player3_instantiate(struct player3 *player, struct bytes *b, bool exchange);
void player3_leave(struct player3 *player);

/* From instantiated to initialization mode; to the end of it. */
fmi3Status player3_enter(struct player3 *player, struct bytes *b);
fmi3Status player3_initialize(struct player3 *player, struct bytes *b);
fmi3Status player3_reset(struct player3 *player);

/* Saves, restores and frees states, changes their bytes, and gives them to other instances. */
fmi3Status player3_handle_state(struct player3 *player, struct bytes *b);
fmi3Status player3_debug_logging(struct player3 *player, struct bytes *b);

/* One random call; fmi3OK where there was none. */
typedef fmi3Status player3_call(struct player3 *player, struct bytes *b);

/* A whole input: whatever is asked is answered with a known status, a message comes with every refusal. */
int players3_play(const uint8_t *data, size_t size, player3_call *call);

/* arrays3.c: one of the functions that take arrays, of any references, types, lengths and values. */
fmi3Status arrays3_call(fmi3Instance c, struct bytes *b);

/* One variable that exists, a value within its range as far as chance goes. */
fmi3Status arrays3_set_one(fmi3Instance c, struct bytes *b);

#endif
