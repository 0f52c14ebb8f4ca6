/* The command line of fmu_host, parsed and checked. */
#ifndef FMU_HOST_OPTIONS_H
#define FMU_HOST_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "fmi2TypesPlatform.h"

enum value_type { TYPE_REAL, TYPE_INTEGER, TYPE_BOOLEAN, TYPE_STRING, TYPE_COUNT };

struct start_value {
    enum value_type type;
    fmi2ValueReference reference;
    fmi2Real real;
    fmi2Integer integer; /* Boolean too */
    fmi2String string;   /* part of the command line */
};

/* Places in the list of --states */
enum { STATES_ALL, STATES_INDICATORS, STATES_PLACES, STATES_FIRST };

/* What one call of fmi2GetReal asks for, or what is read of one type at the end. */
struct references {
    size_t count;
    fmi2ValueReference *items;
};

/* One experiment on one FMU. */
struct experiment {
    const char *name, *library, *guid, *resources;
    double start_time, stop_time, tolerance;
    double absolute_tolerance; /* of an integrator */
    bool tolerance_defined;
    long steps;
    size_t start_count, get_count;
    struct start_value *start;
    struct references *get;              /* read after each communication step */
    struct references read[TYPE_STRING]; /* read at the end: Real, Integer, Boolean */
    const char *integrator;              /* of Model Exchange; NULL: co-simulation */
    struct references states;            /* see --states in options_usage */
};

struct options {
    long repeat;   /* turns of each case */
    long burst;    /* runs in a turn */
    double budget; /* s; a case that has stepped as long is not run again */
    bool fresh;    /* a new instance for each run instead of fmi2Reset */
    bool help;
    size_t count;
    struct experiment *cases;
};

extern const char options_usage[];

/* Returns false after a message on stderr; options_free() in either case. */
bool options_parse(struct options *options, int count, char **arguments);
void options_free(struct options *options);

#endif
