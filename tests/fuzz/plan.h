/* A random scene for fuzz_run.c: parameters from bytes, and what is known of it. */
#ifndef CONTACT_FUZZ_PLAN_H
#define CONTACT_FUZZ_PLAN_H

#include "bytes.h"
#include "host.h"

enum { PLAN_INTERNAL_STEPS = 2000, PLAN_STEPS = 12, PLAN_EVENT_DRIVEN = 1 };

/* Part of a length that counts as none. */
static const double PLAN_SMALL = 1e-8;

struct plan {
    int method, steps, other_steps;
    double end;
    bool free;      /* some body moves by itself; else energies are sums over samples of the inputs */
    bool pushed;    /* the importer does work */
    bool has_ends;  /* a finite cylinder: a run may depend on the last digit of where it passes the end */
    bool balanced;  /* an unstable rest at the start: which way it is left may be rounding's choice */
    bool creeps;    /* a dashpot beyond critical: CVODE's tolerance may decide when such a contact ends */
    double longest; /* the longest radius or distance there is [m] */
    double driven;  /* the fastest that the importer moves a body [m/s] */
};

/* Sets the parameters of a fresh instance. */
struct plan plan_choose(fmi2Component c, struct bytes *b);

/* Completes the plan by what the instance says of it after initialization. */
void plan_look(fmi2Component c, struct plan *plan);

#endif
