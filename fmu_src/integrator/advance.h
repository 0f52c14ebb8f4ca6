/* One advance of a method: within fixed regimes of the contacts, up to a clock or their first change. */
#ifndef CONTACT_INTEGRATOR_ADVANCE_H
#define CONTACT_INTEGRATOR_ADVANCE_H

#include <stdbool.h>

#include "scene/transition.h"

/* What it ended with. */
enum advance_result { ADVANCE_REACHED, ADVANCE_EVENT, ADVANCE_STEP_LIMIT, ADVANCE_FAILED };

struct advance {
    double clock_end;           /* in: not beyond this clock */
    double clock_limit;         /* in: up to here nothing is known that would end the phase */
    long budget;                /* in: at most so many internal steps; out: what is left of it */
    long evaluations;           /* likewise evaluations of forces by the general segment */
    struct scene_instant now;   /* the present instant, if `is_now`; see advance_now */
    bool is_now;                /* to be cleared by whoever moves the bodies */
    int contact;                /* out, ADVANCE_EVENT: which contact changes its regime at q->clock */
    enum contact_regime regime; /* out, ADVANCE_EVENT: and into which */
    int event; /* out, ADVANCE_EVENT: by which of its event functions (scene/ode.h); 0, 1: by regime alone */
};

/* The present instant, without accelerations and forces: computed once, however many ask for it. */
static inline const struct scene_instant *advance_now(struct advance *step, const struct scene_values *v,
                                                      const struct scene_state *q)
{
    if (!step->is_now) {
        scene_kinematics_now(v, q, &step->now);
        step->is_now = true;
    }
    return &step->now;
}

/* Event-driven integration of contact pairs, segment by segment (touch/segment.h). */

/*
 * Advances the contact pairs, and the kinematically driven contacts with them. ADVANCE_FAILED where contacts
 * share a free body; phases.c then lets the general segment take over and counts it.
 */
enum advance_result event_driven_advance(const struct scene_values *v, struct scene_state *q,
                                         struct advance *step);

/* Kinematically driven contacts: neither body is free. The motion is prescribed; impulse, dissipated energy,
 * external work and peaks are quadratures. */

/* Integrates such contacts over [q->clock, end], on which no regime changes, by adaptive Gauss-Legendre
 * quadrature to solver.relative_tolerance. Each panel takes one step of the budget, but does not count in
 * solver.steps. Returns the clock reached, before `end` where the budget ran out; does not change
 * q->clock. */
double prescribed_integrate(const struct scene_values *v, struct scene_state *q, double end, long *budget);

/* All there is to do in a scene without a free body. */
enum advance_result prescribed_advance(const struct scene_values *v, struct scene_state *q,
                                       struct advance *step);

#endif
