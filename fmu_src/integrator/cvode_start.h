/* Start of a phase for CVODE: tolerances, longest step, offsets of the event functions, and n at d = 0. */
#ifndef CONTACT_INTEGRATOR_CVODE_START_H
#define CONTACT_INTEGRATOR_CVODE_START_H

#include "integrator/cvode.h"

/* Starts from the motion; false where CVODE refuses. c->problem knows values and motion. */
bool cvode_start(struct cvode *c, const struct scene_values *v, struct scene_state *q);

#endif
