#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "fmi/instance.h"
#include "fmi/log.h"
#include "model/report.h"
#include "scene.h"

/*
 * The saved states an instance has handed out and the importer has not freed: a list through the blocks
 * themselves. What the importer holds is the address of such a block. What the importer brings is looked up
 * by comparing addresses and never read before it is found: it may be uninitialised, freed, or another
 * instance's.
 */

struct state_block {
    struct state_block *next;
    _Alignas(double) unsigned char bytes[]; /* a header and the model's state, see instance.c */
};

/* The block at an address, or NULL when this instance has none there. */
static struct state_block *state_list_find(const struct instance *instance, const void *address);

/* A new block with room for that many bytes, or NULL when the importer's memory is exhausted. */
static struct state_block *state_list_add(struct instance *instance, size_t size);

/* Gives a block of the list back to the importer's memory. */
static void state_list_remove(struct instance *instance, struct state_block *block);

/* Gives all blocks back. */
static void state_list_clear(struct instance *instance);

struct phase_name {
    unsigned phase;
    const char *name;
};

static const struct phase_name phase_names[] = {
    {PHASE_INSTANTIATED, "instantiated"},
    {PHASE_INITIALIZATION, "initialization mode"},
    {PHASE_STEP, "step mode"},
    {PHASE_TERMINATED, "terminated"},
    {PHASE_ERROR, "error"},
    {PHASE_FATAL, "fatal"},
    {PHASE_EVENT, "event mode"},
    {PHASE_INTERMEDIATE, "intermediate update mode"},
    {PHASE_CONTINUOUS, "continuous-time mode"},
};

#define PHASE_NAME_COUNT (sizeof phase_names / sizeof phase_names[0])

/* Names of all phases of a mask, separated by commas. The buffer holds all of them at once. */
static const char *name_phases(unsigned phases, char *text, size_t size)
{
    size_t length = 0;
    text[0] = '\0';
    for (size_t i = 0; i < PHASE_NAME_COUNT; ++i) {
        if ((phases & phase_names[i].phase) != 0 && length < size) {
            const char *separator = length > 0 ? ", " : "";
            length += (size_t)snprintf(text + length, size - length, "%s%s", separator, phase_names[i].name);
        }
    }
    return text;
}

/* Room for the names of all phases, with what separates them. */
enum { PHASE_NAMES_SIZE = 160 };

static void report_call_order(struct instance *instance, const struct call *call)
{
    char now[PHASE_NAMES_SIZE];
    char allowed[PHASE_NAMES_SIZE];
    log_report(instance, MODEL_ERROR, "%s called in phase %s, allowed in: %s", call->name,
               name_phases(instance->phase, now, sizeof now),
               name_phases(call->phases, allowed, sizeof allowed));
}

bool call_allowed(struct instance *instance, const struct call *call)
{
    if (instance == NULL) {
        return false;
    }
    if (((unsigned)instance->phase & ~call->phases) != 0) {
        report_call_order(instance, call);
        return false;
    }
    return true;
}

enum model_status call_refuse(struct instance *instance, const struct call *call, const char *reason)
{
    char now[PHASE_NAMES_SIZE];
    return instance == NULL ? MODEL_ERROR
                            : log_report(instance, MODEL_ERROR, "%s called in phase %s: %s", call->name,
                                         name_phases(instance->phase, now, sizeof now), reason);
}

static bool is_of_kind(struct instance *instance, const struct call *call, bool exchange)
{
    static const char *const interfaces[] = {"Co-Simulation", "Model Exchange"};
    if (instance == NULL) {
        return false;
    }
    if (instance->host.exchange != exchange) {
        log_report(instance, MODEL_ERROR, "%s called on an instance of %s, allowed: of %s", call->name,
                   interfaces[!exchange], interfaces[exchange]);
        return false;
    }
    return true;
}

bool call_allowed_in_exchange(struct instance *instance, const struct call *call)
{
    return is_of_kind(instance, call, true) && call_allowed(instance, call);
}

bool call_allowed_in_steps(struct instance *instance, const struct call *call)
{
    return is_of_kind(instance, call, false) && call_allowed(instance, call);
}

bool call_array_given(struct instance *instance, const struct call *call, const char *argument,
                      const void *array, size_t count)
{
    if (array == NULL && count > 0) {
        log_report(instance, MODEL_ERROR, "%s: %s is a null pointer, expected %lu elements", call->name,
                   argument, (unsigned long)count);
        return false;
    }
    return true;
}

const struct variable *report_wrong_reference(struct instance *instance, const struct call *call,
                                              const struct variable *variable, uint32_t reference)
{
    if (variable == NULL) {
        log_report(instance, MODEL_ERROR, "%s: unknown value reference %u", call->name, (unsigned)reference);
    } else {
        log_report(instance, MODEL_ERROR, "%s: value reference %u is %s, which is of type %s", call->name,
                   (unsigned)reference, variable->name, instance->adapter->type_names[variable->type]);
    }
    return NULL;
}

const struct variable *report_no_value(struct instance *instance, const struct call *call,
                                       const struct variable *variable)
{
    log_report(instance, MODEL_ERROR, "%s: %s has no value before initialization mode", call->name,
               variable->name);
    return NULL;
}

const struct variable *report_not_settable(struct instance *instance, const struct call *call,
                                           const struct variable *variable)
{
    const char *reason = variable->causality != VARIABLE_PARAMETER ? "is calculated and cannot be set"
                         : !variable->tunable ? "is a parameter, fixed after initialization"
                                              : "is a tunable parameter, to be set in event mode";
    log_report(instance, MODEL_ERROR, "%s: %s %s", call->name, variable->name, reason);
    return NULL;
}

const struct variable *find_real(struct instance *instance, const struct call *call, uint32_t reference,
                                 enum variable_causality causality)
{
    const struct variable *variable = scene_variable(reference);
    if (variable == NULL) {
        log_report(instance, MODEL_ERROR, "%s: unknown value reference %u", call->name, (unsigned)reference);
    } else if (variable->type != VARIABLE_REAL || variable->causality != causality) {
        log_report(instance, MODEL_ERROR, "%s: value reference %u is %s, which is no %s %s", call->name,
                   (unsigned)reference, variable->name, instance->adapter->type_names[VARIABLE_REAL],
                   causality == VARIABLE_INPUT ? "input" : "output");
    } else {
        return variable;
    }
    return NULL;
}

enum model_status check_order(struct instance *instance, const struct call *call,
                              const struct variable *variable, int order)
{
    if (order < LOWEST_ORDER || order > HIGHEST_ORDER) {
        return log_report(instance, MODEL_DISCARD,
                          "%s: derivative of order %d of %s refused, allowed: %d to %d", call->name, order,
                          variable->name, LOWEST_ORDER, HIGHEST_ORDER);
    }
    return MODEL_OK;
}

static enum model_status check_output_derivative(struct instance *instance, const struct call *call,
                                                 uint32_t reference, int order)
{
    const struct variable *variable = find_real(instance, call, reference, VARIABLE_OUTPUT);
    if (variable == NULL) {
        return MODEL_ERROR;
    }
    if (!model_has_derivatives(variable)) {
        return log_report(instance, MODEL_DISCARD,
                          "%s: %s sums up the last step; its derivatives are not provided, allowed: those of "
                          "the other %s outputs",
                          call->name, variable->name, instance->adapter->type_names[VARIABLE_REAL]);
    }
    return check_order(instance, call, variable, order);
}

enum model_status output_derivatives(struct instance *instance, const struct call *call,
                                     const uint32_t *references, const int *orders, size_t count,
                                     double *values)
{
    for (size_t i = 0; i < count; ++i) {
        const enum model_status status = check_output_derivative(instance, call, references[i], orders[i]);
        if (status != MODEL_OK) {
            return status;
        }
    }
    return model_get_output_derivatives(instance->model, references, orders, count, values);
}

/* Whether the states and their rates are unknowns and knowns of the importer. */
static bool knows_states(const struct instance *instance)
{
    return instance->host.exchange || instance->adapter->knows_states_in_steps;
}

/* Unknowns are the outputs and the rates of the states; in initialization mode the calculated parameters and
 * the states too (ModelStructure: initial unknowns). */
static bool is_unknown(struct instance *instance, const struct call *call, uint32_t reference)
{
    const struct variable *variable = scene_variable(reference);
    const bool starting = (instance->phase & PHASE_INITIALIZATION) != 0;
    if (variable != NULL && starting && variable->causality == VARIABLE_CALCULATED_PARAMETER) {
        return true;
    }
    if (variable != NULL && knows_states(instance) &&
        (variable->causality == VARIABLE_RATE || (starting && variable->causality == VARIABLE_STATE))) {
        return true;
    }
    return find_real(instance, call, reference, VARIABLE_OUTPUT) != NULL;
}

enum model_status check_unknowns(struct instance *instance, const struct call *call, const uint32_t *unknowns,
                                 size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        if (!is_unknown(instance, call, unknowns[i])) {
            return MODEL_ERROR;
        }
    }
    return MODEL_OK;
}

enum model_status check_known(struct instance *instance, const struct call *call, uint32_t reference)
{
    const struct variable *variable = scene_variable(reference);
    const bool starting = (instance->phase & PHASE_INITIALIZATION) != 0;
    if (variable != NULL && knows_states(instance) && !starting && variable->causality == VARIABLE_STATE) {
        return MODEL_OK;
    }
    if (variable != NULL && starting && variable->causality == VARIABLE_PARAMETER &&
        variable->type == VARIABLE_REAL) {
        return log_report(instance, MODEL_DISCARD,
                          "%s: derivatives with respect to the parameter %s are not provided, allowed: with "
                          "respect to %s inputs",
                          call->name, variable->name, instance->adapter->type_names[VARIABLE_REAL]);
    }
    return find_real(instance, call, reference, VARIABLE_INPUT) != NULL ? MODEL_OK : MODEL_ERROR;
}

enum model_status check_seed(struct instance *instance, const struct call *call, uint32_t reference,
                             double seed)
{
    return isfinite(seed)
               ? MODEL_OK
               : log_report(instance, MODEL_DISCARD, "%s: %s of %s = %g refused, allowed: finite", call->name,
                            instance->adapter->seed_name, scene_variable(reference)->name, seed);
}

/*
 * How far two times that should agree may differ: importers add up step sizes, which rounds. Part of a step
 * of size h, or a few units in the last place of the time t where steps are that small.
 */
static double time_slack(double t, double h)
{
    const double relative = 4.0 * DBL_EPSILON * fabs(t);
    return STEP_SLACK * h > relative ? STEP_SLACK * h : relative;
}

static enum model_status refuse_step_size(struct instance *instance, const struct call *call, double time,
                                          double size)
{
    return log_report(instance, MODEL_DISCARD,
                      "%s: communicationStepSize = %s s, allowed: finite and large enough to change the "
                      "time %s s, that is more than %.3g s",
                      call->name, shortest_digits(size).text, shortest_digits(time).text,
                      DBL_EPSILON * fabs(time));
}

enum model_status step_check(struct instance *instance, const struct call *call, double point, double size)
{
    const double time = model_time(instance->model);
    if (!(size > 0.0)) {
        return refuse_step_size(instance, call, time, size);
    }
    /* written so that a NaN is refused */
    if (!(fabs(point - time) <= time_slack(time, size))) {
        return log_report(instance, MODEL_ERROR,
                          "%s: currentCommunicationPoint = %s s, expected the time reached, %s s", call->name,
                          shortest_digits(point).text, shortest_digits(time).text);
    }
    const double end = point + size; /* infinite where the size is */
    if (!(end > time && end <= DBL_MAX)) {
        return refuse_step_size(instance, call, time, size);
    }
    const double stop = instance->experiment.stop_time;
    if (end > stop + time_slack(stop, size)) {
        return log_report(instance, MODEL_ERROR, "%s: step to %s s goes past stopTime = %s s", call->name,
                          shortest_digits(end).text, shortest_digits(stop).text);
    }
    return MODEL_OK;
}

enum model_status step_end(struct instance *instance, enum model_status status)
{
    if (status == MODEL_ERROR) {
        instance->phase = PHASE_ERROR;
    } else if (status == MODEL_FATAL) {
        instance->phase = PHASE_FATAL;
    }
    return status;
}

enum model_status exchange_enter(struct instance *instance, const struct call *call, enum phase next)
{
    if (!call_allowed_in_exchange(instance, call)) {
        return MODEL_ERROR;
    }
    instance->phase = next;
    model_exchange_set_continuous(instance->model, next == PHASE_CONTINUOUS);
    return MODEL_OK;
}

enum model_status exchange_update(struct instance *instance, const struct call *call,
                                  struct exchange_news *news)
{
    if (!call_allowed_in_exchange(instance, call)) {
        return MODEL_ERROR;
    }
    const enum model_status status = model_exchange_update(instance->model, &news->again, &news->jumped);
    if (status <= MODEL_WARNING && !news->again) {
        const double touch = model_exchange_next_touch(instance->model);
        news->scheduled = isfinite(touch);
        news->event_time = news->scheduled ? touch : 0.0;
    }
    return status;
}

/* Integrators of variable step look past the stop time and come back; a step that is accepted there is an
 * error. */
enum model_status exchange_accept_step(struct instance *instance, const struct call *call)
{
    if (!call_allowed_in_exchange(instance, call)) {
        return MODEL_ERROR;
    }
    const double time = model_time(instance->model);
    const double stop = instance->experiment.stop_time;
    if (time > stop + 4.0 * DBL_EPSILON * fabs(stop)) { /* importers add up step sizes, which rounds */
        return log_report(instance, MODEL_ERROR, "%s: step to %.17g s goes past stopTime = %.17g s",
                          call->name, time, stop);
    }
    return model_exchange_accept(instance->model);
}

enum model_status exchange_set_time(struct instance *instance, const struct call *call, double time)
{
    return call_allowed_in_exchange(instance, call) ? model_exchange_set_time(instance->model, time)
                                                    : MODEL_ERROR;
}

/* Whether the call is in order and an array of as many numbers as there are was given. */
static bool in_order(struct instance *instance, const struct call *call, const double *values, size_t count,
                     size_t expected)
{
    if (!call_allowed_in_exchange(instance, call)) {
        return false;
    }
    if (count != expected) {
        log_report(instance, MODEL_ERROR, "%s: %lu values, expected %lu", call->name, (unsigned long)count,
                   (unsigned long)expected);
        return false;
    }
    return call_array_given(instance, call, "the array of values", values, count);
}

enum model_status exchange_set_states(struct instance *instance, const struct call *call,
                                      const double *states, size_t count)
{
    return in_order(instance, call, states, count, model_exchange_states())
               ? model_exchange_set_states(instance->model, states)
               : MODEL_ERROR;
}

enum model_status exchange_get(struct instance *instance, const struct call *call, enum exchange_values which,
                               double *values, size_t count)
{
    const size_t expected =
        which == EXCHANGE_INDICATORS ? model_exchange_indicators() : model_exchange_states();
    return in_order(instance, call, values, count, expected)
               ? model_exchange_get(instance->model, which, values)
               : MODEL_ERROR;
}

enum model_status exchange_get_nominals(struct instance *instance, const struct call *call, double *values,
                                        size_t count)
{
    if (!in_order(instance, call, values, count, model_exchange_states())) {
        return MODEL_ERROR;
    }
    model_exchange_get_nominals(values);
    return MODEL_OK;
}

static void forget_experiment(struct instance *instance)
{
    instance->experiment =
        (struct experiment){.start_time = 0.0, .stop_time = (double)INFINITY, .set_up = false};
    instance->phase = PHASE_INSTANTIATED;
    instance->step_status = MODEL_OK;
    instance->log_categories = log_default_categories(instance->logging_on);
}

bool instance_expects(struct instance *nobody, const char *function, bool holds, const char *argument,
                      const char *given, const char *expected)
{
    if (!holds) {
        log_report(nobody, MODEL_ERROR, "%s: %s is \"%.300s\", expected \"%.300s\"", function, argument,
                   given == NULL ? "(null)" : given, expected);
    }
    return holds;
}

struct instance *instance_create(const struct adapter *adapter, const struct model_host *host, size_t size,
                                 const char *name, bool logging_on)
{
    const size_t name_size = strlen(name) + 1;
    struct instance *instance = host->allocate(1, size + name_size);
    if (instance == NULL) {
        return NULL;
    }
    memset(instance, 0, size);
    instance->name = memcpy((char *)instance + size, name, name_size);
    instance->adapter = adapter;
    instance->host = *host;
    instance->host.context = instance;
    instance->host.log = log_from_model;
    instance->host.wants = log_wanted_by_importer;
    instance->logging_on = logging_on;
    instance->tuning_phases = PHASE_STEP | PHASE_EVENT;
    forget_experiment(instance);
    instance->model = model_create(&instance->host);
    if (instance->model == NULL) {
        host->release(instance);
        return NULL;
    }
    return instance;
}

void instance_free(struct instance *instance)
{
    if (instance != NULL && (instance->phase & (PHASE_TELLING | PHASE_INTERMEDIATE)) == 0) {
        void (*release)(void *) = instance->host.release;
        state_list_clear(instance); /* what the importer forgot */
        model_destroy(instance->model);
        release(instance);
    }
}

enum model_status instance_categories(struct instance *instance, const struct call *call, size_t count,
                                      const char *const *categories, unsigned *chosen)
{
    if (!call_allowed(instance, call) ||
        !call_array_given(instance, call, "categories", (const void *)categories, count)) {
        return MODEL_ERROR;
    }
    for (size_t i = 0; i < count; ++i) {
        if (categories[i] == NULL || !log_category_bits(categories[i], chosen)) {
            return log_report(instance, MODEL_ERROR, "%s: unknown category \"%.100s\" (allowed: %s)",
                              call->name, categories[i] == NULL ? "(null)" : categories[i],
                              log_category_names());
        }
    }
    return MODEL_OK;
}

enum model_status instance_set_up(struct instance *instance, const struct call *call, bool tolerance_defined,
                                  double tolerance, double start_time, bool stop_time_defined,
                                  double stop_time)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    if (!isfinite(start_time)) {
        return log_report(instance, MODEL_ERROR, "%s: startTime = %s s, allowed: finite", call->name,
                          shortest_digits(start_time).text);
    }
    if (stop_time_defined && !(stop_time >= start_time && isfinite(stop_time))) {
        return log_report(instance, MODEL_ERROR,
                          "%s: stopTime = %s s, allowed: finite, from startTime = %s s on", call->name,
                          shortest_digits(stop_time).text, shortest_digits(start_time).text);
    }
    const enum model_status status = model_setup(instance->model, tolerance_defined, tolerance, start_time);
    if (status <= MODEL_WARNING) {
        instance->experiment.start_time = start_time;
        instance->experiment.stop_time = stop_time_defined ? stop_time : (double)INFINITY;
        instance->experiment.set_up = true;
    }
    return status;
}

enum model_status instance_exit_initialization(struct instance *instance, const struct call *call,
                                               enum phase next)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    const enum model_status status = model_exit_initialization(instance->model);
    if (status <= MODEL_WARNING) {
        instance->phase = next;
    }
    return status;
}

enum model_status instance_enter(struct instance *instance, const struct call *call, enum phase next)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    instance->phase = next;
    return MODEL_OK;
}

enum model_status instance_reset(struct instance *instance, const struct call *call)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    model_reset(instance->model);
    forget_experiment(instance);
    return MODEL_OK;
}

static struct state_block *state_list_find(const struct instance *instance, const void *address)
{
    struct state_block *block = instance->states;
    while (block != NULL && block != address) {
        block = block->next;
    }
    return block;
}

static struct state_block *state_list_add(struct instance *instance, size_t size)
{
    struct state_block *block = instance->host.allocate(1, sizeof(struct state_block) + size);
    if (block != NULL) {
        block->next = instance->states;
        instance->states = block;
    }
    return block;
}

static void state_list_remove(struct instance *instance, struct state_block *block)
{
    struct state_block **link = &instance->states;
    while (*link != block) {
        link = &(*link)->next;
    }
    *link = block->next;
    instance->host.release(block);
}

static void state_list_clear(struct instance *instance)
{
    while (instance->states != NULL) {
        state_list_remove(instance, instance->states);
    }
}

/*
 * Saved states: one flat row of bytes without pointers, a header of the adapter followed by the model's part.
 * What the importer serializes are these bytes as they stand; what it brings back is checked as a whole
 * before it is used. In memory they follow a link, by which the importer's pointers are
 * recognised.
 */

/* Raised whenever the header's or the model's layout or meaning changes. */
#define BLOCK_VERSION 1u

struct block_header {
    uint32_t magic; /* of the adapter; a block of the other byte order does not match */
    uint32_t version;
    uint32_t scene;    /* SCENE_HASH: states fit only the FMU that wrote them */
    uint32_t checksum; /* of everything behind this field */
    uint64_t size;     /* of the whole block, bytes */
    double start_time; /* s */
    double stop_time;  /* s */
    uint32_t set_up;
    uint32_t phase;
};

_Static_assert(sizeof(struct block_header) == 48, "no padding, and the model's bytes stay aligned to 8");

#define CHECKED_FROM (offsetof(struct block_header, checksum) + sizeof(uint32_t))

static size_t block_size(void)
{
    return sizeof(struct block_header) + model_state_size();
}

static unsigned char *model_bytes(void *block)
{
    return (unsigned char *)block + sizeof(struct block_header);
}

/* FNV-1a, 32 bit: every single flipped bit changes it. */
static uint32_t block_checksum(const void *block)
{
    const unsigned char *bytes = block;
    const size_t size = block_size();
    uint32_t hash = 2166136261u;
    for (size_t i = CHECKED_FROM; i < size; ++i) {
        hash = (hash ^ bytes[i]) * 16777619u;
    }
    return hash;
}

static void write_block(struct instance *instance, void *block)
{
    model_save(instance->model, model_bytes(block));
    struct block_header header = {
        .magic = instance->adapter->state_magic,
        .version = BLOCK_VERSION,
        .scene = SCENE_HASH,
        .size = block_size(),
        .start_time = instance->experiment.start_time,
        .stop_time = instance->experiment.stop_time,
        .set_up = instance->experiment.set_up ? 1 : 0,
        .phase = (uint32_t)instance->phase,
    };
    memcpy(block, &header, sizeof header);
    header.checksum = block_checksum(block);
    memcpy(block, &header, sizeof header);
}

static bool one_phase(uint32_t phase, unsigned allowed)
{
    return phase != 0 && (phase & (phase - 1)) == 0 && (phase & ~allowed) == 0;
}

static bool plausible_header(const struct instance *instance, const struct block_header *header)
{
    const unsigned phases =
        instance->host.exchange ? instance->adapter->exchange_phases : instance->adapter->state_phases;
    return one_phase(header->phase, phases) && header->set_up <= 1 && isfinite(header->start_time) &&
           header->stop_time >= header->start_time;
}

static enum model_status refuse_number(struct instance *instance, const struct call *call, const char *what,
                                       unsigned long got, unsigned long expected)
{
    return log_report(instance, MODEL_ERROR, "%s: state has %s %lu (0x%lX), expected %lu (0x%lX)", call->name,
                      what, got, got, expected, expected);
}

/* Whether a block of that many bytes is a whole state of this FMU. Never reads beyond size. */
static enum model_status check_block(struct instance *instance, const struct call *call, const void *block,
                                     size_t size)
{
    struct block_header header;
    if (size < sizeof header) {
        return refuse_number(instance, call, "size", (unsigned long)size, (unsigned long)block_size());
    }
    memcpy(&header, block, sizeof header);
    const uint32_t magic = instance->adapter->state_magic;
    if (header.magic != magic) {
        return refuse_number(instance, call, "magic number", header.magic, magic);
    }
    if (header.version != BLOCK_VERSION) {
        return refuse_number(instance, call, "version", header.version, BLOCK_VERSION);
    }
    if (header.scene != SCENE_HASH) {
        return refuse_number(instance, call, "model", header.scene, SCENE_HASH);
    }
    if (size != block_size() || header.size != size) {
        return refuse_number(instance, call, "size", (unsigned long)size, (unsigned long)block_size());
    }
    if (block_checksum(block) != header.checksum) {
        return refuse_number(instance, call, "checksum", block_checksum(block), header.checksum);
    }
    if (!plausible_header(instance, &header)) {
        return log_report(instance, MODEL_ERROR, "%s: state has a header out of range", call->name);
    }
    return MODEL_OK;
}

/* The block of an importer's state, or NULL after a message. */
static struct state_block *given_block(struct instance *instance, const struct call *call, void *state)
{
    if (!call_array_given(instance, call, instance->adapter->state_name, state, 1)) {
        return NULL;
    }
    struct state_block *block = state_list_find(instance, state);
    if (block == NULL) {
        log_report(instance, MODEL_ERROR,
                   "%s: %s is unknown, expected a state that this instance gave and that is not freed",
                   call->name, instance->adapter->state_name);
    }
    return block;
}

/*
 * The block to write for an importer's state pointer: the one it leads to, or a new one where it is null or,
 * from an importer that never initialised it, leads anywhere else. NULL after a message.
 */
static struct state_block *block_to_write(struct instance *instance, const struct call *call, void **state)
{
    struct state_block *block = state_list_find(instance, *state);
    if (block == NULL) {
        block = state_list_add(instance, block_size());
        if (block == NULL) {
            log_report(instance, MODEL_ERROR, "%s: no memory for %lu bytes", call->name,
                       (unsigned long)block_size());
            return NULL;
        }
        *state = block;
    }
    return block;
}

enum model_status state_block_get(struct instance *instance, const struct call *call, void **state)
{
    if (!call_allowed(instance, call) ||
        !call_array_given(instance, call, instance->adapter->state_name, state, 1)) {
        return MODEL_ERROR;
    }
    struct state_block *block = block_to_write(instance, call, state);
    if (block == NULL) {
        return MODEL_ERROR;
    }
    write_block(instance, block->bytes);
    return MODEL_OK;
}

enum model_status state_block_set(struct instance *instance, const struct call *call, void *state)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    struct state_block *block = given_block(instance, call, state);
    if (block == NULL || check_block(instance, call, block->bytes, block_size()) != MODEL_OK) {
        return MODEL_ERROR;
    }
    const enum model_status status =
        model_restore(instance->model, model_bytes(block->bytes), model_state_size());
    if (status <= MODEL_WARNING) {
        struct block_header header;
        memcpy(&header, block->bytes, sizeof header);
        instance->experiment.start_time = header.start_time;
        instance->experiment.stop_time = header.stop_time;
        instance->experiment.set_up = header.set_up != 0;
        instance->phase = (enum phase)header.phase;
    }
    return status;
}

enum model_status state_block_free(struct instance *instance, const struct call *call, void **state)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    if (state == NULL || *state == NULL) {
        return MODEL_OK;
    }
    struct state_block *block = given_block(instance, call, *state);
    if (block == NULL) {
        return MODEL_ERROR;
    }
    state_list_remove(instance, block);
    *state = NULL;
    return MODEL_OK;
}

enum model_status state_block_size(struct instance *instance, const struct call *call, void *state,
                                   size_t *size)
{
    if (!call_allowed(instance, call) || given_block(instance, call, state) == NULL ||
        !call_array_given(instance, call, "size", size, 1)) {
        return MODEL_ERROR;
    }
    *size = block_size();
    return MODEL_OK;
}

enum model_status state_block_serialize(struct instance *instance, const struct call *call, void *state,
                                        void *bytes, size_t size)
{
    if (!call_allowed(instance, call)) {
        return MODEL_ERROR;
    }
    struct state_block *block = given_block(instance, call, state);
    if (block == NULL || !call_array_given(instance, call, "serializedState", bytes, block_size())) {
        return MODEL_ERROR;
    }
    if (size < block_size()) {
        return log_report(instance, MODEL_ERROR, "%s: room for %lu bytes, expected %lu", call->name,
                          (unsigned long)size, (unsigned long)block_size());
    }
    memcpy(bytes, block->bytes, block_size());
    return MODEL_OK;
}

enum model_status state_block_deserialize(struct instance *instance, const struct call *call,
                                          const void *bytes, size_t size, void **state)
{
    if (!call_allowed(instance, call) || !call_array_given(instance, call, "serializedState", bytes, size) ||
        !call_array_given(instance, call, instance->adapter->state_name, state, 1) ||
        check_block(instance, call, bytes, size) != MODEL_OK) {
        return MODEL_ERROR;
    }
    struct state_block *block = block_to_write(instance, call, state);
    if (block == NULL) {
        return MODEL_ERROR;
    }
    memcpy(block->bytes, bytes, size);
    return MODEL_OK;
}
