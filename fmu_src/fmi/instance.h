/* One FMU instance as all versions of the standard see it, around a model that knows nothing of FMI. */
#ifndef CONTACT_FMI_INSTANCE_H
#define CONTACT_FMI_INSTANCE_H

#include <stdbool.h>

#include "model/model.h"
#include "model/variable.h"

/*
 * Phases of an instance; nothing runs asynchronously, so a step is never "in progress" or "cancelled". A
 * discarded step leaves the phase alone: the importer may go on from the time reached, restore a state, reset
 * or terminate. The values are bits (masks) and stored in saved states.
 */
enum phase {
    PHASE_INSTANTIATED = 1 << 0,
    PHASE_INITIALIZATION = 1 << 1,
    PHASE_STEP = 1 << 2, /* between two communication steps */
    PHASE_TERMINATED = 1 << 3,
    PHASE_ERROR = 1 << 4,   /* a step failed for good: values, saved states and the reset remain */
    PHASE_FATAL = 1 << 5,   /* only freeing the instance remains */
    PHASE_TELLING = 1 << 6, /* beside one of the others: the logger is being called, see log.h */
    PHASE_EVENT = 1 << 7,   /* event mode: Model Exchange, and Co-Simulation of FMI 3.0 */
    PHASE_INTERMEDIATE =
        1 << 8, /* beside PHASE_STEP: the importer is told of an instant within a step, FMI 3.0 */
    PHASE_CONTINUOUS = 1 << 9 /* between the steps of an integrator outside, Model Exchange */
};

/* Of functions that only read: a logger may call them on the instance that is telling it something. */
#define PHASES_READ(phases) ((unsigned)(phases) | PHASE_TELLING)

struct experiment {
    double start_time; /* s */
    double stop_time;  /* s, +infinity where the importer names none */
    bool set_up;       /* the experiment was accepted */
};

struct state_block; /* state_list.h */
struct instance;

/* What the versions of the standard differ in. */
struct adapter {
    /* Hands a message over to the importer. */
    void (*send)(struct instance *instance, enum model_status status, const char *category, const char *text);
    const char *doubled;       /* characters that the importer's logger wants twice */
    const char *type_names[4]; /* by enum variable_type */
    const char *state_name;    /* of the argument that is a saved state */
    const char *seed_name;     /* of the argument that is a direction of inputs */
    uint32_t state_magic;      /* a saved state fits only the version of the standard that wrote it */
    /* in which a state can have been saved, of Co-Simulation and of Model Exchange */
    unsigned state_phases, exchange_phases;
    /* importers of Co-Simulation too may ask for derivatives of the states' rates */
    bool knows_states_in_steps;
};

struct instance {
    struct model *model;
    struct model_host host;
    const struct adapter *adapter;
    struct experiment experiment;
    enum phase phase;
    unsigned tuning_phases; /* in which tunable parameters may be set, besides those before the start */
    /* handed out and not freed, the newest first; a reset keeps them */
    struct state_block *states;
    enum model_status step_status; /* of the last step */
    unsigned log_categories;       /* bits of enum log_category */
    bool logger_given;             /* else nobody hears the messages */
    bool logging_on;               /* as instantiated; a reset returns to it */
    const char *name;              /* kept behind the adapter's struct, in the same allocation */
};

#endif
