/* One FMU instance as all versions of the standard see it, around a model that knows nothing of FMI. */
#ifndef CONTACT_FMI_INSTANCE_H
#define CONTACT_FMI_INSTANCE_H

#include <math.h>
#include <stdbool.h>

#include "model/exchange.h"
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

struct state_block; /* instance.h */
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

/* Which function may be called in which phase: one row, one mask a function. */

/* A function of the standard; the tables are those of the adapters. */
struct call {
    const char *name;
    unsigned phases; /* in which it may be called; 0: never */
};

/*
 * Whether the call is in order now; if not, says so through the logger. A null instance is never in order.
 */
bool call_allowed(struct instance *instance, const struct call *call);

/* The same for what only instances of Model Exchange have, or only those of Co-Simulation. */
bool call_allowed_in_exchange(struct instance *instance, const struct call *call);
bool call_allowed_in_steps(struct instance *instance, const struct call *call);

/* Refuses a call that is never in order: "fmi2CancelStep called in phase step mode: reason" */
enum model_status call_refuse(struct instance *instance, const struct call *call, const char *reason);

/* Whether an array of count elements was really given; if not, says which one. */
bool call_array_given(struct instance *instance, const struct call *call, const char *argument,
                      const void *array, size_t count);

/* Which variables a call may read and write, and when. */

/* Variable types as bits, so that a function can take more than one. */
enum type_bits {
    TYPES_NONE = 0,
    TYPES_REAL = 1 << VARIABLE_REAL,
    TYPES_INTEGER = 1 << VARIABLE_INTEGER,
    TYPES_BOOLEAN = 1 << VARIABLE_BOOLEAN,
    TYPES_ENUMERATION = 1 << VARIABLE_ENUMERATION
};

/* The variable of a reference, or NULL after a message. */
const struct variable *report_wrong_reference(struct instance *instance, const struct call *call,
                                              const struct variable *variable, uint32_t reference);
const struct variable *report_no_value(struct instance *instance, const struct call *call,
                                       const struct variable *variable);
const struct variable *report_not_settable(struct instance *instance, const struct call *call,
                                           const struct variable *variable);

static inline const struct variable *find_variable(struct instance *instance, const struct call *call,
                                                   uint32_t reference, unsigned types)
{
    const struct variable *variable = scene_variable(reference);
    return variable == NULL || (types & (1u << variable->type)) == 0
               ? report_wrong_reference(instance, call, variable, reference)
               : variable;
}

/* Whether a variable that was found may be read: what has no start value is not computed before
 * initialization mode. */
static inline const struct variable *find_readable(struct instance *instance, const struct call *call,
                                                   uint32_t reference, unsigned types)
{
    const struct variable *variable = find_variable(instance, call, reference, types);
    const bool early = variable != NULL && (instance->phase & PHASE_INSTANTIATED) != 0;
    return early && variable->causality != VARIABLE_PARAMETER && variable->causality != VARIABLE_INPUT
               ? report_no_value(instance, call, variable)
               : variable;
}

/*
 * As find_variable, for writing: parameters until the end of initialization, tunable ones at communication
 * points or events too, inputs always, the rest never.
 */
static inline const struct variable *find_settable(struct instance *instance, const struct call *call,
                                                   uint32_t reference, unsigned types)
{
    const struct variable *variable = find_variable(instance, call, reference, types);
    if (variable == NULL || variable->causality == VARIABLE_INPUT) {
        return variable;
    }
    const unsigned before = PHASE_INSTANTIATED | PHASE_INITIALIZATION;
    const unsigned phases = variable->tunable ? before | instance->tuning_phases : before;
    return variable->causality == VARIABLE_PARAMETER && (instance->phase & phases) != 0
               ? variable
               : report_not_settable(instance, call, variable);
}

/* Checked derivatives of outputs: with respect to time, and to inputs along a direction. Arrays are given. */

/* Highest order of derivatives with respect to time, maxOutputDerivativeOrder of the model description. */
enum { LOWEST_ORDER = 1, HIGHEST_ORDER = 2 };

/* The real variable of a reference with the wanted causality, or NULL after a message. */
const struct variable *find_real(struct instance *instance, const struct call *call, uint32_t reference,
                                 enum variable_causality causality);

enum model_status check_order(struct instance *instance, const struct call *call,
                              const struct variable *variable, int order);

enum model_status output_derivatives(struct instance *instance, const struct call *call,
                                     const uint32_t *references, const int *orders, size_t count,
                                     double *values);

enum model_status check_unknowns(struct instance *instance, const struct call *call, const uint32_t *unknowns,
                                 size_t count);
enum model_status check_known(struct instance *instance, const struct call *call, uint32_t reference);
enum model_status check_seed(struct instance *instance, const struct call *call, uint32_t reference,
                             double seed);

/* Whether a communication step is in order, and what its status leaves behind. */

/* Part of a step size by which two times that should agree may differ. */
#define STEP_SLACK 1e-6

/*
 * Whether a step is in order at first sight. What passes here passes in step_check, whose limits are wider;
 * what does not is left to it. A size of zero, below zero or NaN never passes; an infinite one does where
 * there is no stop time, but model_step_deferred goes no such way.
 */
static inline bool step_plainly_in_order(const struct instance *instance, double point, double size)
{
    const double time = model_time(instance->model);
    const double end = point + size;
    return instance->phase == PHASE_STEP && instance->step_status == MODEL_OK &&
           fabs(point - time) <= STEP_SLACK * size && end > time && end <= instance->experiment.stop_time;
}

/* Refuses a step of no length or from, or to, a wrong time. */
enum model_status step_check(struct instance *instance, const struct call *call, double point, double size);

/* Keeps the status of a step that was taken; after an error the instance is of little use any more. */
enum model_status step_end(struct instance *instance, enum model_status status);

/* Model Exchange, whatever the version of the standard: checked calls of model/exchange.h. */

/* Goes over to event mode, or to continuous-time mode. */
enum model_status exchange_enter(struct instance *instance, const struct call *call, enum phase next);

/* What an event has changed. */
struct exchange_news {
    bool again;        /* regimes have changed: another one may have to */
    bool jumped;       /* a state did */
    bool scheduled;    /* the next event is known, unless another one comes first ... */
    double event_time; /* ... and this is when [s], else 0 */
};

enum model_status exchange_update(struct instance *instance, const struct call *call,
                                  struct exchange_news *news);

enum model_status exchange_accept_step(struct instance *instance, const struct call *call);

enum model_status exchange_set_time(struct instance *instance, const struct call *call, double time);

/* `count` is what the importer believes that there are. */
enum model_status exchange_set_states(struct instance *instance, const struct call *call,
                                      const double *states, size_t count);
enum model_status exchange_get(struct instance *instance, const struct call *call, enum exchange_values which,
                               double *values, size_t count);
enum model_status exchange_get_nominals(struct instance *instance, const struct call *call, double *values,
                                        size_t count);

/* Creating, setting up, starting, ending and resetting an instance, whatever the version of the standard. */

/* Whether what an argument of the instantiation must satisfy holds; if not, says so through `nobody`, an
 * instance that lives only for messages. */
bool instance_expects(struct instance *nobody, const char *function, bool holds, const char *argument,
                      const char *given, const char *expected);

/* An instance with a model inside and nothing set up, zero up to `size` bytes, which begin with it; NULL when
 * out of memory. */
struct instance *instance_create(const struct adapter *adapter, const struct model_host *host, size_t size,
                                 const char *name, bool logging_on);

/* Nothing happens to one that is in the midst of something: its logger or another callback is at work. */
void instance_free(struct instance *instance);

/* Adds up the bits of named categories. */
enum model_status instance_categories(struct instance *instance, const struct call *call, size_t count,
                                      const char *const *categories, unsigned *chosen);

/* Start and stop time and the importer's tolerance. */
enum model_status instance_set_up(struct instance *instance, const struct call *call, bool tolerance_defined,
                                  double tolerance, double start_time, bool stop_time_defined,
                                  double stop_time);

/* What is refused here (contradictory parameters) leaves the phase, so that the importer can set better
 * values. */
enum model_status instance_exit_initialization(struct instance *instance, const struct call *call,
                                               enum phase next);

/* Goes over to another phase. */
enum model_status instance_enter(struct instance *instance, const struct call *call, enum phase next);

enum model_status instance_reset(struct instance *instance, const struct call *call);

/*
 * Saved states of an instance: got, set, freed, made bytes and made of bytes. An importer's state is a
 * pointer into the instance's list; what it brings is checked as a whole before it is used.
 */

enum model_status state_block_get(struct instance *instance, const struct call *call, void **state);
enum model_status state_block_set(struct instance *instance, const struct call *call, void *state);
enum model_status state_block_free(struct instance *instance, const struct call *call, void **state);

enum model_status state_block_size(struct instance *instance, const struct call *call, void *state,
                                   size_t *size);
enum model_status state_block_serialize(struct instance *instance, const struct call *call, void *state,
                                        void *bytes, size_t size);
enum model_status state_block_deserialize(struct instance *instance, const struct call *call,
                                          const void *bytes, size_t size, void **state);

#endif
