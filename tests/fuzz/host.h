/*
 * The importer that all fuzzers of FMI 2.0 share: a logger that reads every message as a printf format, and
 * memory functions that count and may fail.
 */
#ifndef FUZZ_HOST_H
#define FUZZ_HOST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <fmi2Functions.h>

#include "claim.h"
#include "model/variable.h"

struct host {
    long living;    /* blocks given and not returned */
    long countdown; /* allocations until one fails; negative: none does */
    long messages;
    fmi2Component told; /* where set, the logger calls back into this instance, which is the one that tells */
    fmi2Component shown; /* where set, a broken claim prints all its values */
};

/* One for all: the FMI gives memory functions no context. Each input starts with a fresh one. */
extern struct host host;

void host_begin(void);

/* Logger and memory functions; they stay valid. */
const fmi2CallbackFunctions *host_callbacks(void);

/* Every block came back. */
void host_end(void);

/* An instance with the right guid; claims that there is one. */
fmi2Component host_instance(void);

/* The first variable of that row for that body or contact; NULL where the scene has none. */
const struct variable *host_variable(int row, int element, int component);

/* Sets a value by its row; what the scene does not have is passed over. The worst status. */
fmi2Status host_set_real(fmi2Component c, int row, int element, int component, double value);
fmi2Status host_set_integer(fmi2Component c, int row, int element, int value);

/* A step has to end soon. */
void host_bound_work(fmi2Component c, int most);

double host_real(fmi2Component c, int row, int element, int component);
double host_length(fmi2Component c, int row, int element); /* of a vector */
int host_integer(fmi2Component c, int row, int element);

/* Reads every variable; claims that reals are finite and choices are known ones. */
void host_read_all(fmi2Component c);

#endif
