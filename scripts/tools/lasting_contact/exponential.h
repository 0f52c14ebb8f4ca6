/* The FMU's exponential collocation (segment/collocation.h) with steps of one size. */
#ifndef LASTING_EXPONENTIAL_H
#define LASTING_EXPONENTIAL_H

#include "problem.h"

/* Whether every step's iteration converged. */
bool exponential_run(const struct problem *problem, struct outcome *outcome);

#endif
