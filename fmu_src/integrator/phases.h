/*
 * Integrates a scene, phase by phase. All methods have one interface: a method integrates within fixed
 * regimes of the contacts (a smooth problem) and stops at the first change of regime; integrator_run strings
 * these phases together.
 *
 *   flight/          no contact transmits a force: closed form, for every method
 *   touch/           event_driven, contact pairs that share no free body: closed form, series, collocation
 *   general.c        event_driven, everything else in contact: Radau IIA
 *   cvode.c          SUNDIALS CVODE, BDF with an analytic Jacobian or Adams
 *   prescribed/      neither body of a contact is free: quadratures along the prescribed motion
 */
#ifndef CONTACT_INTEGRATOR_PHASES_H
#define CONTACT_INTEGRATOR_PHASES_H

#include <stddef.h>

#include "integrator/step_request.h"
#include "scene/transition.h"

/* One advance of a phase: within fixed regimes of the contacts, up to a clock or their first change. */

/* The end of an advance. */
enum advance_result { ADVANCE_REACHED, ADVANCE_EVENT, ADVANCE_STEP_LIMIT, ADVANCE_FAILED };

struct advance {
    double clock_end;           /* in: not beyond this clock */
    double clock_limit;         /* in: up to here nothing is known that would end the phase */
    long budget;                /* in: at most so many internal steps; out: what is left of it */
    long work;                  /* likewise work, in internal steps in closed form: see advance_spend */
    struct scene_instant now;   /* the present instant, if `is_now`; see advance_now */
    bool is_now;                /* to be cleared by whoever moves the bodies */
    int contact;                /* out, ADVANCE_EVENT: which contact changes its regime at q->clock */
    enum contact_regime regime; /* out, ADVANCE_EVENT: and into which */
    int event; /* out, ADVANCE_EVENT: by which of its event functions (scene/ode.h); 0, 1: by regime alone */
};

/*
 * Work, in units of some 3,000 instructions: an internal step in closed form or an event takes one unit, and
 * segment_make returns the work of other segments. An evaluation of forces by the general segment
 * takes 9,000 to 20,000, a step of CVODE 50,000 to 300,000, a panel of the quadrature of a prescribed contact
 * 100,000.
 */
enum { EVALUATION_WORK = 6, CVODE_STEP_WORK = 25, PANEL_WORK = 35 };

/* Subtracts internal steps and their work from the budget. */
static inline void advance_spend(struct advance *step, long steps, long work)
{
    step->budget -= steps;
    step->work -= work;
}

static inline bool advance_is_spent(const struct advance *step)
{
    return step->budget <= 0 || step->work <= 0;
}

enum integrator_status {
    INTEGRATOR_DONE,       /* arrived at the end time */
    INTEGRATOR_STEP_LIMIT, /* solver.max_internal_steps reached; q holds the time and state so far */
    INTEGRATOR_STALLED,    /* contacts change without end, or nearly so; q holds the time and state so far */
    INTEGRATOR_FAILED      /* the method gave up; q holds the last good state, integrator_message says why */
};

enum { INTEGRATOR_MESSAGE_SIZE = 256 };

/* Where the methods get their memory from. */
struct integrator_memory {
    void *(*allocate)(size_t count, size_t size); /* zeroed, as calloc */
    void (*release)(void *memory);
};

/* Memory of the methods. Holds nothing that must be saved: everything can be rebuilt from scene_values and
 * motion. */
struct integrator {
    struct cvode *cvode;
    struct general *general;
    char message[INTEGRATOR_MESSAGE_SIZE];
};

/* Prepares the memory for the scene's method; false when out of memory. Called again it adapts to changed
 * values. */
bool integrator_open(struct integrator *s, const struct scene_values *v,
                     const struct integrator_memory *memory);

void integrator_close(struct integrator *s);

/* Integrates to the end of the step, through as many phases as there are. Tolerances are those of v; a
 * deferred flight must have been caught up (flight.h). */
enum integrator_status integrator_run(struct integrator *s, const struct scene_values *v,
                                      struct scene_state *q, const struct step_request *request);

/* Goes on with a flight that could be deferred up to the horizon (flight.h): where no contact can begin
 * before the next horizon, the clock advances to the end of the step and the horizon to what a search would
 * make it, so that results have the same bits. False, and the motion as it was, where a search is needed. */
bool integrator_defer_further(const struct scene_values *v, struct scene_state *q, double end_time);

#endif
