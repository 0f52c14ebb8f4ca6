/* What the runs of a case gave, and the line of JSON that tells it. */
#ifndef FMU_HOST_RESULT_H
#define FMU_HOST_RESULT_H

#include <stdbool.h>

#include "options.h"

struct result {
    long runs;
    double *stepping, *initialization; /* s, one a run */
    double spent;                      /* s of stepping, all runs */
    fmi2Real *real;                    /* read at the end of the last run */
    fmi2Integer *integer;
    fmi2Boolean *boolean;
    fmi2Real *scratch; /* what --get reads */
    double *sorted;    /* room to find the median in */
    bool failed;
};

/* False when out of memory; result_release() in either case. */
bool result_prepare(struct result *result, const struct experiment *one, long most_runs);
void result_release(struct result *result);

/* One line on stdout; `failure` says why, when the case failed. */
void result_print(const struct experiment *one, const struct result *result, const char *failure);

#endif
