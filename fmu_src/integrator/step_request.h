/* What is asked of a step. */
#ifndef CONTACT_INTEGRATOR_STEP_REQUEST_H
#define CONTACT_INTEGRATOR_STEP_REQUEST_H

#include <stdbool.h>

struct step_request {
    double end_time; /* [s] */
    /* Asked at each instant within the step at which a contact begins or ends: when shall the step end [s]?
     * At once, where the answer is not later than the present. NULL: nobody is asked. */
    double (*at_event)(void *context, double end_time);
    void *context;
    bool whole; /* a step that solver.max_internal_steps ends early is undone */
};

#endif
