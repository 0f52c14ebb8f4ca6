/*
 * The importer that all fuzzers of FMI 3.0 share: its logger and intermediate update call back.
 */
#ifndef FUZZ_HOST3_H
#define FUZZ_HOST3_H

#include <fmi3Functions.h>

#include "claim.h"
#include "model/variable.h"

enum { LONGEST_VECTOR = 4 }; /* a quaternion */

struct host {
    long messages;
    fmi3Instance told;       /* where set, the logger calls back into this instance, which tells something */
    fmi3Instance stepped;    /* the same for the intermediate update */
    fmi3Boolean early;       /* there: ask for an early return ... */
    fmi3Float64 early_after; /* ... so long after [s] */
};

/* One for all, which is the instance environment too. Each input starts with a fresh one. */
extern struct host host;

void host_begin(void);

void host_hear(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
               fmi3String message);
void host_update(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean set_requested,
                 fmi3Boolean get_allowed, fmi3Boolean finished, fmi3Boolean can_return,
                 fmi3Boolean *return_requested, fmi3Float64 *return_time);

/* A step has to end soon. */
void host_bound_work(fmi3Instance c, int most);

/* Reads every variable; claims that reals are finite and choices are known ones. */
void host_read_all(fmi3Instance c);

#endif
