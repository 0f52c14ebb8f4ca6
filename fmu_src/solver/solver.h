/*
 * Moves a scene through time. One interface for every method: a method integrates within fixed regimes of the contacts
 * (a smooth problem) and stops at the first change of regime; solver_run strings these phases together.
 *
 *   flight.c        no contact transmits a force: closed form (in dynamics/), whatever the method
 *   event_driven.c  pairs press: exponential collocation and power series (piece.h)
 *   cvode.c         bodies press: SUNDIALS CVODE, BDF with an analytic Jacobian or Adams
 *   sampled.c       neither body of a contact is free: the motion is given, only the integrals over it are needed
 */
#ifndef CONTACT_SOLVER_H
#define CONTACT_SOLVER_H

#include <stddef.h>

#include "dynamics/events.h"

#if SCENE_ANY_FREE

enum solver_status {
    SOLVER_DONE,       /* arrived at the end time */
    SOLVER_STEP_LIMIT, /* solver.max_internal_steps reached; q holds the time and state so far */
    SOLVER_FAILED      /* the method gave up; q holds the last good state, solver_message says why */
};

enum { SOLVER_MESSAGE_SIZE = 256 };

/* Where the methods get their memory from. */
struct solver_memory {
    void *(*allocate)(size_t count, size_t size); /* zeroed, as calloc */
    void (*release)(void *memory);
};

/* Memory of the methods. Holds nothing that must be saved: everything can be rebuilt from scene_values and motion. */
struct solver {
    struct cvode *cvode;
    char message[SOLVER_MESSAGE_SIZE];
};

/* What one advance of a method ended with. */
enum advance_result { ADVANCE_REACHED, ADVANCE_EVENT, ADVANCE_STEP_LIMIT, ADVANCE_FAILED };

struct advance {
    double clock_end;           /* in: not beyond this clock */
    long budget;                /* in: at most so many internal steps; out: what is left of it */
    struct system_instant now;  /* what advance_now knows; */
    bool is_now;                /* to be cleared by whoever moves the bodies */
    int contact;                /* out, ADVANCE_EVENT: which contact changes its regime at q->clock */
    enum contact_regime regime; /* out, ADVANCE_EVENT: and into which */
};

/* The present instant, without accelerations and forces: computed once, however many ask for it. */
const struct system_instant *advance_now(struct advance *step, const struct scene_values *v,
                                         const struct motion *q);

/* Prepares the memory for the scene's method; false when out of memory. Called again it adapts to changed values. */
bool solver_open(struct solver *s, const struct scene_values *v, const struct solver_memory *memory);

void solver_close(struct solver *s);

/* Integrates to end_time [s], through as many phases as there are. `tolerance` relative and absolute come from v; bodies must
 * have arrived (flight.h). */
enum solver_status solver_run(struct solver *s, const struct scene_values *v, struct motion *q,
                              double end_time);

#endif
#endif
