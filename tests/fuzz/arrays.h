/* Arguments of the FMI functions that take arrays: any references and values, arrays that are missing. */
#ifndef FUZZ_ARRAYS_H
#define FUZZ_ARRAYS_H

#include <fmi2Functions.h>

#include "bytes.h"

/* What solver.max_internal_steps may be, so that an input ends. */
enum { MOST_INTERNAL_STEPS = 100 };

/* One of the functions that take arrays, with any arguments. */
fmi2Status arrays_call(fmi2Component c, struct bytes *b);

#endif
