/* One FMU instance: what the FMI 2.0 standard asks to remember, around a model that knows nothing of FMI. */
#ifndef CONTACT_FMI2_INSTANCE_H
#define CONTACT_FMI2_INSTANCE_H

#include <stdbool.h>

#include <fmi2Functions.h>

#include "model/model.h"
#include "model/variable.h"

/*
 * Phases of a co-simulation slave; nothing runs asynchronously, so a step is never "in progress" or
 * "cancelled". A discarded step leaves the phase alone: the values are those of the last successful time, and
 * the importer may go on from there, restore a state, reset or terminate. The values are bits (masks) and
 * stored in saved states.
 */
enum phase {
    PHASE_INSTANTIATED = 1 << 0,
    PHASE_INITIALIZATION = 1 << 1,
    PHASE_STEP = 1 << 2, /* between two communication steps */
    PHASE_TERMINATED = 1 << 3,
    PHASE_ERROR = 1 << 4,  /* a step failed for good: values, saved states and fmi2Reset remain */
    PHASE_FATAL = 1 << 5,  /* only fmi2FreeInstance remains */
    PHASE_TELLING = 1 << 6 /* beside one of the others: the logger is being called, see log.h */
};

struct experiment {
    double start_time; /* s */
    double stop_time;  /* s, +infinity where the importer names none */
    bool set_up;       /* fmi2SetupExperiment was accepted */
};

struct state_block; /* state_list.h */

struct instance {
    struct model *model;
    struct model_host host;
    fmi2CallbackFunctions callbacks;
    struct experiment experiment;
    enum phase phase;
    /* handed out and not freed, the newest first; fmi2Reset keeps them */
    struct state_block *states;
    fmi2Status step_status;  /* of the last fmi2DoStep */
    unsigned log_categories; /* bits of enum log_category */
    bool logging_on;         /* as instantiated; fmi2Reset returns to it */
    const char *name;        /* kept behind the struct, in the same allocation */
};

/* The model's statuses are fmi2Status values by another name. */
_Static_assert((int)MODEL_OK == (int)fmi2OK && (int)MODEL_WARNING == (int)fmi2Warning, "status order");
_Static_assert((int)MODEL_DISCARD == (int)fmi2Discard && (int)MODEL_ERROR == (int)fmi2Error, "status order");
_Static_assert((int)MODEL_FATAL == (int)fmi2Fatal, "status order");

static inline fmi2Status status_of(enum model_status status)
{
    return (fmi2Status)status;
}

#endif
