/* This file describes a request for one step of the integrator. */
#ifndef CONTACT_INTEGRATOR_STEP_REQUEST_H
#define CONTACT_INTEGRATOR_STEP_REQUEST_H

#include <stdbool.h>

struct step_request {
    double end_time; /* end of the step [s] */
    /* Called at each instant within the step at which a contact begins or ends; returns when the step shall
     * end [s]. A time not later than the present ends it at once. NULL: the end stays as it is. */
    double (*at_event)(void *context, double end_time);
    void *context;
    bool whole; /* a step that solver.max_internal_steps ends early is undone */
};

#endif
