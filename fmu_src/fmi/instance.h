/*
 * This file describes one FMU instance, around a model that knows nothing of FMI. What FMI 2.0 and FMI 3.0
 * have in common is done here; fmi2.c and fmi3.c give it the names and types of their version.
 */
#ifndef CONTACT_FMI_INSTANCE_H
#define CONTACT_FMI_INSTANCE_H

#include <math.h>
#include <stdbool.h>

#include "math/compiler.h"
#include "model/model.h"
#include "model/variable.h"

/*
 * These are the phases of an instance. Nothing runs asynchronously, so no step is ever "in progress" or
 * "cancelled". A discarded step does not change the phase: the importer may go on from the time reached,
 * restore a state, reset or terminate. The values are bits of masks, and saved states hold them.
 */
enum phase {
    PHASE_INSTANTIATED = 1 << 0,
    PHASE_INITIALIZATION = 1 << 1,
    PHASE_STEP = 1 << 2, /* between two communication steps */
    PHASE_TERMINATED = 1 << 3,
    PHASE_ERROR = 1 << 4,        /* a step failed for good: values, saved states and the reset remain */
    PHASE_FATAL = 1 << 5,        /* only freeing the instance remains */
    PHASE_TELLING = 1 << 6,      /* beside another phase: the logger is being called, see log_report */
    PHASE_EVENT = 1 << 7,        /* event mode: Model Exchange, and Co-Simulation of FMI 3.0 */
    PHASE_INTERMEDIATE = 1 << 8, /* FMI 3.0, beside PHASE_STEP: the intermediate update callback is running */
    PHASE_CONTINUOUS = 1 << 9    /* Model Exchange: between the steps of the importer's integrator */
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

/* The kind of instance on which a function of the standard may be called. */
enum call_kind { CALL_ANY, CALL_STEPS /* Co-Simulation */, CALL_EXCHANGE /* Model Exchange */ };

/* A row of an adapter's table names one function of the standard and the phases in which it may be called. */
struct call {
    const char *name;
    enum call_kind kind;
    unsigned phases;    /* mask of enum phase; 0: never */
    const char *absent; /* why the function may never be called, else NULL */
};

struct instance;

/* This struct holds the differences between the versions of the standard. */
struct adapter {
    int version;                    /* 2 or 3 */
    const char *token_name, *token; /* by which an importer tells that it means this FMU */
    /* Hands a message over to the importer. */
    void (*send)(struct instance *instance, enum model_status status, const char *category, const char *text);
    const char *doubled;       /* characters that a message to the importer's logger has to double */
    const char *type_names[4]; /* by enum variable_type */
    uint8_t value_sizes[4];    /* bytes of a value in the importer's arrays, by enum variable_type */
    uint32_t state_magic;      /* a saved state fits only the version of the standard that wrote it */
};

/* This struct holds what an instance knows of its run. Saved states hold it too. */
struct experiment {
    double start_time; /* s */
    double stop_time;  /* s; infinite where the importer names none */
    uint32_t set_up;   /* 1: start and stop time were accepted */
    enum phase phase;
};

struct state_block; /* a saved state, instance.c */

struct instance {
    struct model *model;
    struct model_host host;
    const struct adapter *adapter;
    const struct call *call; /* the function that the importer has called, for messages */
    struct experiment experiment;
    unsigned tuning_phases;        /* phases after initialization in which tunable parameters may be set */
    struct state_block *states;    /* given to the importer and not freed, newest first; kept at a reset */
    double asked_end;              /* end of the last step that the importer asked for [s] */
    enum model_status step_status; /* of the last step */
    unsigned log_categories;       /* see enum log_categories */
    bool logger_given;             /* false: no message is sent */
    bool logging_on;               /* the setting at instantiation, to which a reset returns */
    const char *name;              /* stored behind the adapter's struct, in one allocation with it */
};

/*
 * Messages go to the importer's logger. Warnings and worse are always told, unless the importer named
 * categories that leave them out; events are told only while logging is on. A category is a bit, 1 << the
 * status of its messages; events have the status MODEL_OK, and MODEL_FATAL is the last status.
 */
enum log_categories { LOG_ALL = (2 << MODEL_FATAL) - 1, LOG_STATUS_ALL = LOG_ALL & ~(1 << MODEL_OK) };

/*
 * Sends a message to the importer's logger and returns `status`, so that a caller can write `return
 * log_report(...)`. The message begins with the name of the function that the importer has called. While the
 * logger runs, only functions that read may be called on the instance. All other functions then return an
 * error, change nothing and send no message; freeing the instance does nothing.
 */
enum model_status log_report(struct instance *instance, enum model_status status, const char *format, ...)
    CONTACT_PRINTF_LIKE(3, 4);

/* Defines a function of version V of the standard, 2 or 3. It evaluates `result` where it may be called now;
 * `absent` says why it never may, or is NULL. */
#define CALL_OF(V, function, kind, phases, absent, parameters, result)                                       \
    CONTACT_EXPORTED fmi##V##Status fmi##V##function parameters                                              \
    {                                                                                                        \
        static const struct call call = {"fmi" #V #function, CALL_##kind, phases, absent};                   \
        struct instance *instance = c;                                                                       \
        return (fmi##V##Status)(call_begin(instance, &call) ? (result) : MODEL_ERROR);                       \
    }

/* Defines a function of version V that reads `count` numbers of Model Exchange. */
#define NUMBERS_OF(V, function, which, number, phases)                                                       \
    CALL_OF(V, function, EXCHANGE, PHASES_READ(phases), NULL, (void *c, double x[], size_t count),           \
            numbers_ready(instance, x, count, number) ? model_exchange_get(instance->model, which, x)        \
                                                      : MODEL_ERROR)

/* Defines the functions that both versions have with the same arguments, but for those whose phases differ.
 * `State` and `Deserialize` are parts of names as version V spells them. CompletedIntegratorStep ignores
 * noSetFMUStatePriorToCurrentPoint, because states are saved only on request. */
#define CALLS_OF_BOTH(V, State, Deserialize)                                                                 \
    CALL_OF(V, SetDebugLogging, ANY, PHASES_ALL, NULL,                                                       \
            (void *c, fmi##V##Boolean on, size_t count, const fmi##V##String categories[]),                  \
            instance_set_logging(instance, on != 0, count, categories))                                      \
    CALL_OF(V, Terminate, ANY, PHASE_STEP | PHASES_EXCHANGED, NULL, (void *c),                               \
            instance_enter(instance, MODEL_OK, PHASE_TERMINATED))                                            \
    CALL_OF(V, Reset, ANY, PHASES_ALL, NULL, (void *c), instance_reset(instance))                            \
    CALL_OF(V, CompletedIntegratorStep, EXCHANGE, PHASE_CONTINUOUS, NULL,                                    \
            (void *c, fmi##V##Boolean unused, fmi##V##Boolean *enters_events, fmi##V##Boolean *terminates),  \
            ((void)unused, exchange_accept_step(instance, enters_events, terminates, sizeof *terminates)))   \
    CALL_OF(V, EnterContinuousTimeMode, EXCHANGE, PHASE_EVENT, NULL, (void *c),                              \
            instance_enter(instance, MODEL_OK, PHASE_CONTINUOUS))                                            \
    CALL_OF(V, SetContinuousStates, EXCHANGE, PHASE_CONTINUOUS, NULL,                                        \
            (void *c, const double x[], size_t count),                                                       \
            numbers_ready(instance, x, count, SCENE_STATES) ? model_exchange_set_states(instance->model, x)  \
                                                            : MODEL_ERROR)                                   \
    NUMBERS_OF(V, GetEventIndicators, EXCHANGE_INDICATORS, SCENE_INDICATORS, PHASES_OF_STATES)               \
    NUMBERS_OF(V, GetContinuousStates, EXCHANGE_STATES, SCENE_STATES, PHASES_OF_STATES)                      \
    CALL_OF(V, GetFMU##State, ANY, PHASES_ALL, NULL, (void *c, void **state),                                \
            state_block_get(instance, state))                                                                \
    CALL_OF(V, FreeFMU##State, ANY, PHASES_ALL, NULL, (void *c, void **state),                               \
            state_block_free(instance, state))                                                               \
    CALL_OF(V, SerializedFMU##State##Size, ANY, PHASES_READ(PHASES_ALL), NULL,                               \
            (void *c, void *state, size_t *size), state_block_size(instance, state, size))                   \
    CALL_OF(V, SerializeFMU##State, ANY, PHASES_READ(PHASES_ALL), NULL,                                      \
            (void *c, void *state, fmi##V##Byte bytes[], size_t size),                                       \
            state_block_serialize(instance, state, bytes, size))                                             \
    CALL_OF(V, Deserialize##FMU##State, ANY, PHASES_ALL, NULL,                                               \
            (void *c, const fmi##V##Byte bytes[], size_t size, void **state),                                \
            state_block_deserialize(instance, bytes, size, state))

/* Begins a call of a function of the standard. Whether it is allowed now; if not, a message says why. For a
 * null instance it returns false without a message. The functions below are called within an allowed call. */
bool call_begin(struct instance *instance, const struct call *call);

/* Whether an array that must have `count` elements was given; if not, a message says so, which names the
 * argument as FMI 3.0 does. With no elements it may be missing. */
bool array_given(struct instance *instance, const char *argument, const void *array, size_t count);

/*
 * These functions get and set values. Each reference must name a variable of one of the types (bits 1 << enum
 * variable_type) that may be read or set now. All values are checked before any is set. `count` is the number
 * of elements of `values`: with FMI 2.0 one for each reference, with FMI 3.0 one for each component.
 */
enum model_status instance_get_values(struct instance *instance, unsigned types, const uint32_t *references,
                                      size_t reference_count, void *values, size_t count);
enum model_status instance_set_values(struct instance *instance, unsigned types, const uint32_t *references,
                                      size_t reference_count, const void *values, size_t count);

/* Returns the real variable of a reference with the wanted causality, or NULL after a message. */
const struct variable *find_real(struct instance *instance, uint32_t reference,
                                 enum variable_causality causality);

/* Refuses orders of derivatives with respect to time other than 1 and 2. */
enum model_status check_order(struct instance *instance, const struct variable *variable, int order);

/* Computes derivatives of outputs with respect to time; orders[i] is the order for references[i]. */
CONTACT_COLD enum model_status instance_output_derivatives(struct instance *instance,
                                                           const uint32_t *references, const int *orders,
                                                           size_t reference_count, double *values,
                                                           size_t count);

/* Computes a product with the derivatives of unknowns with respect to knowns. The counts are those of the
 * importer's arrays. */
CONTACT_COLD enum model_status instance_product(struct instance *instance, const struct product *product,
                                                size_t seed_count, size_t sensitivity_count);

/* This is the allowed difference of two times that should be equal, divided by the step size. */
#define STEP_SLACK 1e-6

/*
 * Whether a step of `size` [s] from `point` [s] passes a quick check. Each such step also passes in
 * instance_step, whose limits are wider. A size of zero, below zero or NaN never passes. An infinite size
 * passes where there is no stop time, but model_step_deferred refuses it.
 */
bool step_plainly_in_order(const struct instance *instance, double point, double size);

/* Takes a communication step of `size` [s] from `point` to the end_time of `request` [s]. A step of no
 * length, from a wrong time or past the stop time is refused. */
enum model_status instance_step(struct instance *instance, double point, double size,
                                const struct step_request *request);

/* Returns the time reached [s]. The model's time is a sum and may differ from the end of a step by rounding.
 * The end that the importer asked for is then returned, because importers compare it with their stop time. */
double instance_time_reached(const struct instance *instance);

/* Is called when the importer's integrator has accepted a step. Sets both answers, of `size` bytes, to
 * false. */
enum model_status exchange_accept_step(struct instance *instance, void *enters_events, void *terminates,
                                       size_t size);

/* Whether the importer has given an array for `expected` numbers and `count` is as many; if not, a message
 * says so. */
bool numbers_ready(struct instance *instance, const double *values, size_t count, size_t expected);

/* Checks an argument of the instantiation; if it is wrong, says so through `nobody`, an instance that lives
 * only for messages. */
bool instance_expects(struct instance *nobody, bool holds, const char *argument, const char *given,
                      const char *expected);

/* Returns a new instance with its own model, copied from `nobody`, which begins a struct of `size` bytes.
 * NULL: the instance has no name, the importer's token is not that of this FMU, or memory is exhausted, and a
 * message has said so. */
CONTACT_COLD struct instance *instance_create(struct instance *nobody, size_t size, const char *token,
                                              bool logging_on);

/* Frees an instance; does nothing while the instance's logger or another callback runs. */
void instance_free(struct instance *instance);

/* Switches logging on or off. With FMI 2.0 the named categories are the only ones from then on, with FMI 3.0
 * the others stay as they are. Without names all categories are meant. */
enum model_status instance_set_logging(struct instance *instance, bool on, size_t count,
                                       const char *const *categories);

/* Takes over start time [s], stop time [s] and the importer's relative tolerance. */
CONTACT_COLD enum model_status instance_set_up(struct instance *instance, bool tolerance_defined,
                                               double tolerance, double start_time, bool stop_time_defined,
                                               double stop_time);

/* Enters the phase `next` unless `status` is worse than a warning, and returns `status`. In Model Exchange
 * the model is told of event mode and of continuous-time mode. */
enum model_status instance_enter(struct instance *instance, enum model_status status, enum phase next);

enum model_status instance_reset(struct instance *instance);

/* These functions handle saved states. The importer holds a state as a pointer into the instance's list.
 * Bytes that the importer brings are checked as a whole before they are used. */
enum model_status state_block_get(struct instance *instance, void **state);
enum model_status state_block_set(struct instance *instance, void *state);
enum model_status state_block_free(struct instance *instance, void **state);
enum model_status state_block_size(struct instance *instance, void *state, size_t *size);
enum model_status state_block_serialize(struct instance *instance, void *state, void *bytes, size_t size);
enum model_status state_block_deserialize(struct instance *instance, const void *bytes, size_t size,
                                          void **state);

#endif
