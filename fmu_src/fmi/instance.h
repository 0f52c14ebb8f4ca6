/*
 * One FMU instance, around a model that knows nothing of FMI. What FMI 2.0 and FMI 3.0 have in common is done
 * here; fmi2.c and fmi3.c give it the names and types of their version.
 */
#ifndef CONTACT_FMI_INSTANCE_H
#define CONTACT_FMI_INSTANCE_H

#include <math.h>
#include <stdbool.h>

#include "math/compiler.h"
#include "model/model.h"
#include "model/variable.h"

/*
 * Phases of an instance. Nothing runs asynchronously, so no step is ever "in progress" or "cancelled". A
 * discarded step leaves the phase alone: the importer may go on from the time reached, restore a state, reset
 * or terminate. The values are bits of masks, and saved states hold them.
 */
enum phase {
    PHASE_INSTANTIATED = 1 << 0,
    PHASE_INITIALIZATION = 1 << 1,
    PHASE_STEP = 1 << 2, /* between two communication steps */
    PHASE_TERMINATED = 1 << 3,
    PHASE_ERROR = 1 << 4,   /* a step failed for good: values, saved states and the reset remain */
    PHASE_FATAL = 1 << 5,   /* only freeing the instance remains */
    PHASE_TELLING = 1 << 6, /* beside another phase: the logger is being called, see log_report */
    PHASE_EVENT = 1 << 7,   /* event mode: Model Exchange, and Co-Simulation of FMI 3.0 */
    PHASE_INTERMEDIATE =
        1 << 8,               /* FMI 3.0, beside PHASE_STEP: the importer is told of an instant in a step */
    PHASE_CONTINUOUS = 1 << 9 /* Model Exchange: between the steps of the importer's integrator */
};

#define PHASES_STEPPED (PHASE_STEP | PHASE_TERMINATED | PHASE_ERROR)
#define PHASES_EXCHANGED (PHASE_EVENT | PHASE_CONTINUOUS)
#define PHASES_INITIALIZED (PHASE_INITIALIZATION | PHASES_EXCHANGED | PHASES_STEPPED)
#define PHASES_ALL (PHASE_INSTANTIATED | PHASES_INITIALIZED)
#define PHASES_SETTABLE (PHASE_INSTANTIATED | PHASE_INITIALIZATION | PHASE_STEP | PHASE_EVENT)
/* In these phases the state vector of Model Exchange can be read. */
#define PHASES_OF_STATES (PHASE_INITIALIZATION | PHASES_EXCHANGED | PHASE_TERMINATED | PHASE_ERROR)
/* A logger may call functions that only read on the instance that is telling it something. */
#define PHASES_READ(phases) ((unsigned)(phases) | PHASE_TELLING)

/* Which instances have a function of the standard. */
enum call_kind { CALL_ANY, CALL_STEPS /* Co-Simulation */, CALL_EXCHANGE /* Model Exchange */ };

/* A row of an adapter's table: a function of the standard and when it may be called. */
struct call {
    const char *name;
    enum call_kind kind;
    unsigned phases;    /* mask of enum phase; 0: never */
    const char *absent; /* why it may never be called, else NULL */
};

/* Names of arguments in messages; the two versions of the standard name them differently. */
enum argument_name {
    ARGUMENT_REFERENCES,
    ARGUMENT_VALUES,
    ARGUMENT_ORDERS,
    ARGUMENT_UNKNOWNS,
    ARGUMENT_KNOWNS,
    ARGUMENT_SEED,
    ARGUMENT_SENSITIVITY,
    ARGUMENT_STATE,
    ARGUMENT_NAMES
};

struct instance;

/* The differences between the versions of the standard. */
struct adapter {
    int version; /* 2 or 3 */
    /* Hands a message over to the importer. */
    void (*send)(struct instance *instance, enum model_status status, const char *category, const char *text);
    const char *doubled; /* characters that the importer's logger wants twice */
    const char *arguments[ARGUMENT_NAMES];
    const char *type_names[4]; /* by enum variable_type */
    uint8_t value_sizes[4];    /* bytes of a value in the importer's arrays, by enum variable_type */
    uint32_t state_magic;      /* a saved state fits only the version of the standard that wrote it */
};

struct experiment {
    double start_time; /* s */
    double stop_time;  /* s; infinite where the importer names none */
    bool set_up;       /* the experiment was accepted */
};

struct state_block; /* a saved state, instance.c */

struct instance {
    struct model *model;
    struct model_host host;
    const struct adapter *adapter;
    struct experiment experiment;
    enum phase phase;
    unsigned tuning_phases;        /* in which tunable parameters may be set after initialization */
    struct state_block *states;    /* handed out and not freed, the newest first; a reset keeps them */
    double asked_end;              /* of the last step, as the importer asked for it [s] */
    enum model_status step_status; /* of the last step */
    unsigned log_categories;       /* bits of enum log_category */
    bool logger_given;             /* else nobody hears the messages */
    bool logging_on;               /* as instantiated; a reset returns to it */
    const char *name;              /* kept behind the adapter's struct, in the same allocation */
};

/*
 * Messages to the importer's logger. Warnings and worse are always told, unless the importer named categories
 * that leave them out; events are told only while logging is on.
 */
enum log_category {
    LOG_EVENTS = 1 << 0,
    LOG_STATUS_WARNING = 1 << 1,
    LOG_STATUS_DISCARD = 1 << 2,
    LOG_STATUS_ERROR = 1 << 3,
    LOG_STATUS_FATAL = 1 << 4,
    LOG_STATUS_ALL = LOG_STATUS_WARNING | LOG_STATUS_DISCARD | LOG_STATUS_ERROR | LOG_STATUS_FATAL,
    LOG_ALL = LOG_EVENTS | LOG_STATUS_ALL
};

/* The categories in force for loggingOn without named categories. */
unsigned log_default_categories(bool logging_on);

/*
 * Tells the importer, and returns the status so that a caller can say `return log_report(...)`. While the
 * logger is at work the instance answers functions that only read; all others give an error, change nothing
 * and are not reported. Freeing the instance does nothing then.
 */
enum model_status log_report(struct instance *instance, enum model_status status, const char *format, ...)
    CONTACT_PRINTF_LIKE(3, 4);

/* An array that a call got from the importer. */
struct argument {
    const char *name;
    const void *array;
    size_t count; /* elements that it must have; 0: it may be missing */
};

/* Arguments for call_ready, ended by one without a name. */
#define ARGUMENTS(...)                                                                                       \
    (const struct argument[])                                                                                \
    {                                                                                                        \
        __VA_ARGS__,                                                                                         \
        {                                                                                                    \
            NULL, NULL, 0                                                                                    \
        }                                                                                                    \
    }
#define NO_ARGUMENTS ((const struct argument[]){{NULL, NULL, 0}})

/* Whether the call is in order now and its arrays were given; if not, it says so through the logger. A null
 * instance is never in order, and nobody is told. */
bool call_ready(struct instance *instance, const struct call *call, const struct argument *arguments);

/*
 * Getting and setting values: each reference must be known and of one of the types (bits of enum type_bits),
 * and each variable readable or settable now. All values are checked before any is written. `count` is the
 * number of elements of `values`: with FMI 2.0 one for each reference, with FMI 3.0 one for each component.
 */
enum type_bits {
    TYPES_NONE = 0,
    TYPES_REAL = 1 << VARIABLE_REAL,
    TYPES_INTEGER = 1 << VARIABLE_INTEGER,
    TYPES_BOOLEAN = 1 << VARIABLE_BOOLEAN,
    TYPES_ENUMERATION = 1 << VARIABLE_ENUMERATION
};
enum model_status instance_get_values(struct instance *instance, const struct call *call, unsigned types,
                                      const uint32_t *references, size_t reference_count, void *values,
                                      size_t count);
enum model_status instance_set_values(struct instance *instance, const struct call *call, unsigned types,
                                      const uint32_t *references, size_t reference_count, const void *values,
                                      size_t count);

/* The real variable of a reference with the wanted causality; NULL after a message. */
const struct variable *find_real(struct instance *instance, const struct call *call, uint32_t reference,
                                 enum variable_causality causality);

/* Refuses orders of derivatives with respect to time other than 1 and 2. */
enum model_status check_order(struct instance *instance, const struct call *call,
                              const struct variable *variable, int order);

/* Derivatives of outputs with respect to time: orders[i] is that of references[i]. */
CONTACT_COLD enum model_status instance_output_derivatives(struct instance *instance, const struct call *call,
                                                           const uint32_t *references, const int *orders,
                                                           size_t reference_count, double *values,
                                                           size_t count);

/* A product with the matrix J of the derivatives of unknowns with respect to knowns. */
struct product {
    bool adjoint; /* seed J, with a seed for each unknown; else J seed, with one for each known */
    const uint32_t *unknowns, *knowns;
    size_t unknown_count, known_count;           /* references */
    size_t unknown_components, known_components; /* as the importer counts them */
    const double *seed;
    double *sensitivity;
};
CONTACT_COLD enum model_status instance_product(struct instance *instance, const struct call *call,
                                                const struct product *product);

/* Part of a step size by which two times that should agree may differ. */
#define STEP_SLACK 1e-6

/*
 * Whether a step is in order at first sight. What passes here passes in instance_step, whose limits are
 * wider. A size of zero, below zero or NaN never passes. An infinite one passes where there is no stop time,
 * but model_step_deferred refuses it.
 */
bool step_plainly_in_order(const struct instance *instance, double point, double size);

/* Takes a communication step from `point` to `point + size`, or refuses one of no length or from or to a
 * wrong time. `request` says how, all but end_time. */
enum model_status instance_step(struct instance *instance, const struct call *call, double point, double size,
                                const struct step_request *request);

/* The time reached [s]. The model's time is a sum and may differ from the end of a step by a rounding:
 * then this is the end that the importer asked for, as importers compare it with their own stop time. */
double instance_time_reached(const struct instance *instance);

/* What an event has changed. */
struct exchange_news {
    bool again;        /* regimes have changed, and another one may have to */
    bool jumped;       /* a state has */
    bool scheduled;    /* the time of the next event is known, unless another one comes first */
    double event_time; /* s, of that event; 0 where it is not known */
};
enum model_status exchange_update(struct instance *instance, struct exchange_news *news);

/* The importer's integrator has accepted a step. Both answers, of `size` bytes, become false. */
enum model_status exchange_accept_step(struct instance *instance, const struct call *call,
                                       void *enters_events, void *terminates, size_t size);

enum model_status exchange_set_time(struct instance *instance, const struct call *call, double time);

/* `count` is the number of values that the importer expects. */
enum model_status exchange_set_states(struct instance *instance, const struct call *call,
                                      const double *states, size_t count);
enum model_status exchange_get(struct instance *instance, const struct call *call, enum exchange_values which,
                               double *values, size_t count);

/* Checks an argument of the instantiation; if it is wrong, says so through `nobody`, an instance that lives
 * only for messages. */
bool instance_expects(struct instance *nobody, const char *function, bool holds, const char *argument,
                      const char *given, const char *expected);

/* Checks the name of an instance and the token by which the importer names the FMU. */
bool instance_identified(struct instance *nobody, const char *function, const char *name,
                         const char *token_name, const char *token, const char *expected);

/* A new instance like `nobody`, which begins a struct of `size` bytes, with a model inside and nothing set
 * up; NULL after a message where memory is exhausted. */
CONTACT_COLD struct instance *instance_create(struct instance *nobody, const char *function, size_t size,
                                              bool logging_on);

/* Does nothing while the instance's logger or another callback is at work. */
void instance_free(struct instance *instance);

/* Adds up the bits of named categories. */
enum model_status instance_categories(struct instance *instance, const struct call *call, size_t count,
                                      const char *const *categories, unsigned *chosen);

/* Takes start time, stop time and the importer's tolerance. */
CONTACT_COLD enum model_status instance_set_up(struct instance *instance, const struct call *call,
                                               bool tolerance_defined, double tolerance, double start_time,
                                               bool stop_time_defined, double stop_time);

/* Contradictory parameters are refused here. The phase stays then, so that better values can be set. */
enum model_status instance_exit_initialization(struct instance *instance, const struct call *call,
                                               bool events);

/* Goes over to another phase; Model Exchange tells the model of event mode and of continuous-time mode. */
enum model_status instance_enter(struct instance *instance, const struct call *call, enum phase next);

enum model_status instance_reset(struct instance *instance, const struct call *call);

/* Saved states. A state of the importer is a pointer into the instance's list; bytes that the importer brings
 * are checked as a whole before they are used. */
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
