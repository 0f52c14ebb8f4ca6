/*
 * A scene is integrated phase by phase. All methods have one interface: a method integrates within fixed
 * regimes of the contacts (a smooth problem) and stops at the first change of regime. integrator_run joins
 * these phases.
 *
 *   flight/          no contact transmits a force: closed form, for every method
 *   touch/           event_driven, contact pairs, chains and islands: closed form, series, collocation;
 *                    bodies that turn or rub only in pairs that touch/rubbing.h allows
 *   general.c        event_driven, everything else in contact: Radau IIA
 *   cvode.c          SUNDIALS CVODE, BDF with an analytic Jacobian or Adams
 *   prescribed/      neither body of a contact is free: quadratures along the prescribed motion
 */
#ifndef CONTACT_INTEGRATOR_PHASES_H
#define CONTACT_INTEGRATOR_PHASES_H

#include <stddef.h>

#include "integrator/step_request.h"
#include "scene/transition.h"

/* An advance integrates one phase within fixed regimes, up to a clock or to the first change of a regime. */

/* This enumeration tells why an advance or a whole step ended. */
enum advance_result {
    ADVANCE_REACHED,    /* the end */
    ADVANCE_EVENT,      /* a change of a regime, which ends no step */
    ADVANCE_STEP_LIMIT, /* solver.max_internal_steps; q holds the time and state so far */
    ADVANCE_STALLED,    /* contacts change without end, or nearly so; q holds the time and state so far */
    ADVANCE_FAILED      /* the method gave up; q holds the last good state, integrator.message says why */
};

struct advance {
    double start;       /* in: the time at which the communication step began [s] */
    double passed;      /* in: the clock at that time [s], for which no input and no regime has changed */
    double clock_end;   /* in: the advance ends at this clock at the latest [s] */
    double clock_limit; /* in: no end of the phase is foreseen before this clock [s] */
    long budget;        /* in: most internal steps allowed; out: the number left */
    long work;          /* in: most work allowed, in the units below; out: the work left */
    struct scene_instant now;   /* the present instant, if `is_now`; see advance_now */
    bool is_now;                /* whether `now` is valid: code that moves the bodies clears it */
    int contact;                /* out, ADVANCE_EVENT: the contact whose regime changes at q->clock */
    enum contact_regime regime; /* out, ADVANCE_EVENT: its next regime */
    int event; /* out, ADVANCE_EVENT: its event function (scene/ode.h); 0, 1: only the regime changes */
};

/*
 * Work is counted in units of some 3,000 instructions. An internal step in closed form or an event takes one
 * unit; segment.work is the work of any other segment. An evaluation of forces by the general segment takes
 * 9,000 to 20,000 instructions, and a step of CVODE takes 50,000 to 300,000. A panel of the quadrature of a
 * prescribed contact takes 100,000 instructions.
 */
enum { EVALUATION_WORK = 6, CVODE_STEP_WORK = 25, PANEL_WORK = 35 };

/* Subtracts internal steps and units of work from the budget. */
static inline void advance_spend(struct advance *step, long steps, long work)
{
    step->budget -= steps;
    step->work -= work;
}

static inline bool advance_is_spent(const struct advance *step)
{
    return step->budget <= 0 || step->work <= 0;
}

/* Ends an advance by the event function with this index (scene/ode.h). */
static inline enum advance_result advance_to_event(struct advance *step, const struct scene_state *q,
                                                   int event)
{
    step->contact = event / ODE_EVENTS_EACH;
    step->event = event % ODE_EVENTS_EACH;
    step->regime = ode_regime_after(q, step->contact, step->event);
    return ADVANCE_EVENT;
}

enum { INTEGRATOR_MESSAGE_SIZE = 256 };

/* The functions by which the methods allocate and release their memory. */
struct integrator_memory {
    void *(*allocate)(size_t count, size_t size); /* zeroed, as calloc */
    void (*release)(void *memory);
};

/* This struct is the memory of the methods. It need not be saved: values and motion suffice to rebuild it. */
struct integrator {
    struct pair_phase *pairs;
    void (*release)(void *memory); /* of `pairs` */
    struct cvode *cvode;
    struct general *general;
    char message[INTEGRATOR_MESSAGE_SIZE];
};

/* Prepares the memory for the scene's method; returns false when out of memory or where this FMU lacks the
 * method. A further call adapts the memory to changed values. */
bool integrator_open(struct integrator *s, const struct scene_values *v,
                     const struct integrator_memory *memory);

void integrator_close(struct integrator *s);

/* Integrates to the end of the step, through as many phases as there are. The tolerances are taken from q->v.
 * Deferred steps may have gone before. */
enum advance_result integrator_run(struct integrator *s, struct scene_state *q,
                                   const struct step_request *request);

/* Computes the motion of deferred steps, in which only the clock has advanced, and if `sums` the means and
 * peaks over the last of them. Steps can be deferred in flight (flight.h), within a phase of contact pairs,
 * whose motion is a function of its start and of the clock, and within a step of the general segment, which
 * has a polynomial. */
void integrator_catch_up(struct integrator *s, struct scene_state *q, bool sums);

#endif
