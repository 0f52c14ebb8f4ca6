/* How CVODE begins a phase: its tolerances, its longest step, what keeps its roots above zero, and where n leads to from d = 0. */
#ifndef CONTACT_CVODE_START_H
#define CONTACT_CVODE_START_H

#include "solver/cvode.h"

#if SCENE_ANY_FREE

/* Starts from the motion; false where CVODE refuses. c->problem knows values and motion. */
bool cvode_start(struct cvode *c, const struct scene_values *v, struct motion *q);

#endif
#endif
