/* Many runs of one FMI 2.0 co-simulation FMU: one instance, reset before each run. A shared library that the
   sweeps of contact_fmus load (scripts/contact_fmus/sweep/native.py, which holds the same structs). */
#ifndef CONTACT_BATCH_H
#define CONTACT_BATCH_H

#include <stdint.h>

#include "fmi2FunctionTypes.h"

enum { BATCH_MESSAGE_SIZE = 160 }; /* bytes kept of what an FMU says of a run that failed, 0 at the end */

/* What becomes of a variable's values over a run. Integers and Booleans are counted as numbers. */
enum batch_reduction {
    BATCH_AT,  /* the value at one communication point */
    BATCH_MAX, /* over all communication points, the start among them */
    BATCH_MIN,
    BATCH_MEAN /* over time, by trapezoids between communication points */
};

/* Start values of one type: fmi2Real, or fmi2Integer for Integer, Enumeration and Boolean. */
struct batch_set {
    int64_t count;                        /* of references */
    int64_t varied;                       /* the first so many have a column each */
    const fmi2ValueReference *references; /* those that vary first */
    const void *columns;   /* `runs` values for each reference that varies, column after column */
    const void *constants; /* one value for each of the others */
};

struct batch_read {
    int64_t count;
    const fmi2ValueReference *references;
};

struct batch_output {
    int64_t source;    /* place among all values read: Real, then Integer, then Boolean */
    int64_t reduction; /* enum batch_reduction */
    int64_t point;     /* BATCH_AT: 0 is the start, i the end of communication step i */
};

struct batch {
    const char *library, *name;   /* file; of the instance, in its messages */
    const char *guid, *resources; /* of modelDescription.xml; URI of the folder resources */
    double start_time, tolerance;
    int64_t tolerance_defined;
    int64_t point_count;  /* communication steps */
    const double *points; /* s, where each ends */
    const uint8_t *reads; /* point_count + 1: whether values are read there */
    struct batch_set real, integer, boolean;
    int64_t string_count;
    const fmi2ValueReference *string_references;
    const fmi2String *strings;
    struct batch_read read_real, read_integer, read_boolean;
    int64_t output_count;
    const struct batch_output *outputs;
    int64_t runs;
    double
        *values; /* `runs` values for each output, column after column; not a number where the run failed */
    uint8_t *status;   /* of each run: an fmi2Status; fmi2Warning counts as fmi2OK */
    char *messages;    /* BATCH_MESSAGE_SIZE bytes for each run, empty where it went well */
    int32_t *warnings; /* messages of status fmi2Warning of each run */
};

/* Does all runs. 0: each has its status; 1: the library is none, and `messages` begins with the reason. */
__attribute__((visibility("default"))) int contact_batch_run(const struct batch *batch);

#endif
