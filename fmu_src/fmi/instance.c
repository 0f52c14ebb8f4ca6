#include "fmi/instance.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "math/checksum.h"
#include "scene.h"

bool step_plainly_in_order(const struct instance *instance, double point, double size)
{
    const double time = model_time(instance->model);
    const double end = point + size;
    return instance->experiment.phase == PHASE_STEP && instance->step_status == MODEL_OK &&
           fabs(point - time) <= STEP_SLACK * size && end > time && end <= instance->experiment.stop_time;
}

/* Bytes of the longest message and of the longest instance name in it; longer ones are cut. */
#define MESSAGE_SIZE 1024
#define NAME_SHOWN 200

/* The status of a category's messages is the index of its name. The last name stands for all categories. */
static const char *const category_names[] = {
    [MODEL_OK] = "logEvents",
    [MODEL_WARNING] = "logStatusWarning",
    [MODEL_DISCARD] = "logStatusDiscard",
    [MODEL_ERROR] = "logStatusError",
    [MODEL_FATAL] = "logStatusFatal",
    [MODEL_FATAL + 1] = "logAll",
};

/* Returns the bits of a named category, or 0 where there is no such category. */
static unsigned category_bits(const char *name)
{
    for (unsigned i = 0; i < sizeof category_names / sizeof category_names[0]; ++i) {
        if (strcmp(category_names[i], name) == 0) {
            return i <= MODEL_FATAL ? 1u << i : (unsigned)LOG_ALL;
        }
    }
    return 0;
}

/* Returns the number of bytes of the UTF-8 character at the start of a text, or 0 where no whole character is
 * there. */
static size_t character_length(const char *text)
{
    const unsigned char first = (unsigned char)text[0];
    const size_t length = first < 0x80u ? 1 : first < 0xC2u ? 0 : first < 0xE0u ? 2 : first < 0xF0u ? 3 : 4;
    for (size_t i = 1; i < length; ++i) {
        if (((unsigned char)text[i] & 0xC0u) != 0x80u) {
            return 0;
        }
    }
    return first < 0xF5u ? length : 0;
}

/* Copies a text. Bytes that are not UTF-8, such as those of a character cut in two, become question marks.
 * Characters in `doubled` are written twice. */
static void escape_message(const char *text, const char *doubled, char *escaped)
{
    while (*text != '\0') {
        const size_t length = character_length(text);
        const size_t bytes = length > 0 ? length : 1;
        if (strchr(doubled, *text) != NULL) {
            *escaped++ = *text;
        }
        memcpy(escaped, length > 0 ? text : "?", bytes);
        escaped += bytes;
        text += bytes;
    }
    *escaped = '\0';
}

/* Sends "ball at 0.25 s: " followed by a message that is heard; serves as struct model_host.log too. */
static void send_message(void *context, enum model_status status, const char *message)
{
    struct instance *instance = context;
    char text[MESSAGE_SIZE];
    char escaped[2 * MESSAGE_SIZE];
    if (instance->model != NULL) {
        (void)snprintf(text, sizeof text, "%.*s at %.12g s: %s", NAME_SHOWN, instance->name,
                       model_time(instance->model), message);
    } else {
        (void)snprintf(text, sizeof text, "%.*s: %s", NAME_SHOWN, instance->name, message);
    }
    escape_message(text, instance->adapter->doubled, escaped);
    const enum phase phase = instance->experiment.phase;
    const struct call *call = instance->call;
    instance->experiment.phase = (enum phase)(phase | PHASE_TELLING);
    instance->adapter->send(instance, status, category_names[status], escaped);
    instance->experiment.phase = phase;
    instance->call = call;
}

/* Whether messages with a status are sent to the importer. None is sent while its logger runs, since a logger
 * whose calls are wrong could recurse for ever. `context` is the instance (struct model_host). */
static bool is_heard(void *context, enum model_status status)
{
    const struct instance *instance = context;
    return instance->logger_given && (instance->experiment.phase & PHASE_TELLING) == 0 &&
           (instance->log_categories & (1u << status)) != 0;
}

enum model_status log_report(struct instance *instance, enum model_status status, const char *format, ...)
{
    if (is_heard(instance, status)) {
        char message[MESSAGE_SIZE];
        const int length = snprintf(message, sizeof message, "%s", instance->call->name);
        va_list arguments;
        va_start(arguments, format);
        (void)vsnprintf(message + length, sizeof message - (size_t)length, format, arguments);
        va_end(arguments);
        send_message(instance, status, message);
    }
    return status;
}

/* The names stand in the order of the bits of enum phase; PHASE_TELLING has none. */
static const char *const phase_names[] = {
    "instantiated", "initialization mode",      "step mode",           "terminated", "error", "fatal", NULL,
    "event mode",   "intermediate update mode", "continuous-time mode"};

/* Bytes for the names of all phases, with the commas between them. */
enum { PHASE_NAMES_SIZE = 160 };

/* Returns the names of all phases of a mask, separated by commas. */
static const char *name_phases(unsigned phases, char text[PHASE_NAMES_SIZE])
{
    size_t length = 0;
    text[0] = '\0';
    for (size_t i = 0; i < sizeof phase_names / sizeof phase_names[0]; ++i) {
        if ((phases & 1u << i) != 0 && phase_names[i] != NULL && length < PHASE_NAMES_SIZE) {
            length += (size_t)snprintf(text + length, PHASE_NAMES_SIZE - length, "%s%s",
                                       length > 0 ? ", " : "", phase_names[i]);
        }
    }
    return text;
}

static const char *const kind_names[] = {[CALL_STEPS] = "Co-Simulation", [CALL_EXCHANGE] = "Model Exchange"};

/* Reports that the present call is not allowed. */
CONTACT_NOINLINE static bool report_call(struct instance *instance)
{
    const struct call *call = instance->call;
    const enum call_kind kind = instance->host.exchange ? CALL_EXCHANGE : CALL_STEPS;
    char now[PHASE_NAMES_SIZE];
    char allowed[PHASE_NAMES_SIZE];
    if (call->kind != CALL_ANY && call->kind != kind) {
        log_report(instance, MODEL_ERROR, " called on an instance of %s, allowed: of %s", kind_names[kind],
                   kind_names[call->kind]);
    } else if (call->absent != NULL) {
        log_report(instance, MODEL_ERROR, " called in phase %s: %s",
                   name_phases(instance->experiment.phase, now), call->absent);
    } else {
        log_report(instance, MODEL_ERROR, " called in phase %s, allowed in: %s",
                   name_phases(instance->experiment.phase, now), name_phases(call->phases, allowed));
    }
    return false;
}

CONTACT_NOINLINE bool call_begin(struct instance *instance, const struct call *call)
{
    if (instance == NULL) {
        return false;
    }
    instance->call = call;
    const bool of_kind = call->kind == CALL_ANY || (call->kind == CALL_EXCHANGE) == instance->host.exchange;
    return of_kind && ((unsigned)instance->experiment.phase & ~call->phases) == 0 ? true
                                                                                  : report_call(instance);
}

bool array_given(struct instance *instance, const char *argument, const void *array, size_t count)
{
    if (array == NULL && count > 0) {
        log_report(instance, MODEL_ERROR, ": %s is a null pointer, expected %lu elements", argument,
                   (unsigned long)count);
        return false;
    }
    return true;
}

/*
 * This part finds variables by value reference. FMI 2.0 has only scalars. In FMI 3.0 a vector is one variable
 * with the reference of its first component, and time is a variable too.
 */

static bool has_vectors(const struct instance *instance)
{
    return instance->adapter->version >= 3;
}

static struct variable_list list_of(const struct instance *instance, const uint32_t *references, size_t count)
{
    return (struct variable_list){references, count, has_vectors(instance)};
}

enum { ANY_TYPE = (2 << VARIABLE_ENUMERATION) - 1 }; /* VARIABLE_ENUMERATION is the last type */

/* Returns the variable of a reference if it has one of the types, for a vector its first component; else
 * NULL after a message. */
static inline const struct variable *find_variable(struct instance *instance, uint32_t reference,
                                                   unsigned types)
{
    const struct variable_list list = list_of(instance, NULL, 0);
    const struct variable *variable = listed_variable(&list, reference);
    if (variable == NULL) {
        log_report(instance, MODEL_ERROR, ": unknown value reference %u", (unsigned)reference);
    } else if ((types & (1u << variable->type)) == 0) {
        log_report(instance, MODEL_ERROR, ": value reference %u is %s, which is of type %s",
                   (unsigned)reference, variable->name, instance->adapter->type_names[variable->type]);
        return NULL;
    }
    return variable;
}

/* Returns MODEL_OK if the present call may use a variable, to read or to set it by the name of the check.
 * Otherwise it sends a message. */
typedef enum model_status variable_check(struct instance *instance, const struct variable *variable);

/* Before initialization mode only parameters and inputs may be read, since the other variables are not
 * computed yet. */
static inline enum model_status check_readable(struct instance *instance, const struct variable *variable)
{
    const enum variable_causality role = (enum variable_causality)variable->causality;
    return (instance->experiment.phase & PHASE_INSTANTIATED) == 0 || role == VARIABLE_PARAMETER ||
                   role == VARIABLE_INPUT || role == VARIABLE_INDEPENDENT
               ? MODEL_OK
               : log_report(instance, MODEL_ERROR, ": %s has no value before initialization mode",
                            variable->name);
}

/* Parameters may be set until the end of initialization, tunable ones also at communication points or events,
 * and inputs always. */
static inline enum model_status check_settable(struct instance *instance, const struct variable *variable)
{
    const enum variable_causality role = (enum variable_causality)variable->causality;
    const enum phase phase = instance->experiment.phase;
    const unsigned before = PHASE_INSTANTIATED | PHASE_INITIALIZATION;
    const unsigned phases = variable->tunable ? before | instance->tuning_phases : before;
    /* Model Exchange of FMI 3.0 may set states, in event mode only those that events do not make jump
     * (FMI 3.0.2, sections 2.3.5 and 3.2.1) */
    const bool sets_state = instance->host.exchange && has_vectors(instance) &&
                            (phase == PHASE_CONTINUOUS || (phase == PHASE_EVENT && !variable->reinit));
    if (role == VARIABLE_INPUT || (role == VARIABLE_PARAMETER && (phase & phases) != 0) ||
        (role == VARIABLE_STATE && sets_state)) {
        return MODEL_OK;
    }
    return log_report(instance, MODEL_ERROR, ": %s %s", variable->name,
                      role == VARIABLE_INDEPENDENT ? "is the independent variable and cannot be set"
                      : role != VARIABLE_PARAMETER ? "is calculated and cannot be set"
                      : !variable->tunable         ? "is a parameter, fixed after initialization"
                                                   : "is a tunable parameter, to be set in event mode");
}

static enum model_status check_real(struct instance *instance, const struct variable *variable,
                                    enum variable_causality causality)
{
    return variable->type == VARIABLE_REAL && variable->causality == causality
               ? MODEL_OK
               : log_report(instance, MODEL_ERROR, ": value reference %u is %s, which is no %s %s",
                            (unsigned)variable->reference, variable->name,
                            instance->adapter->type_names[VARIABLE_REAL],
                            causality == VARIABLE_INPUT ? "input" : "output");
}

const struct variable *find_real(struct instance *instance, uint32_t reference,
                                 enum variable_causality causality)
{
    const struct variable *variable = find_variable(instance, reference, ANY_TYPE);
    return variable != NULL && check_real(instance, variable, causality) == MODEL_OK ? variable : NULL;
}

/* Checks that the call may use all variables of a list and that they have as many components as the importer
 * counts. */
static enum model_status check_list(struct instance *instance, variable_check *check, unsigned types,
                                    const struct variable_list *list, const char *name, size_t given)
{
    enum model_status status = MODEL_OK;
    size_t components = 0;
    for (size_t i = 0; i < list->count && status == MODEL_OK; ++i) {
        const struct variable *first = find_variable(instance, list->references[i], types);
        status = first != NULL ? check(instance, first) : MODEL_ERROR;
        components += first != NULL && list->vectors ? first->length : 1;
    }
    return given == components || status != MODEL_OK
               ? status
               : log_report(instance, MODEL_ERROR, ": %s = %lu, expected %lu for the value references", name,
                            (unsigned long)given, (unsigned long)components);
}

/* Checks the references of a call that gets or sets values as check_list does, and that the importer has
 * given both arrays. */
static enum model_status check_values(struct instance *instance, variable_check *check, unsigned types,
                                      const struct variable_list *list, const void *values, size_t count)
{
    return array_given(instance, "valueReferences", list->references, list->count) &&
                   array_given(instance, "values", values, count)
               ? check_list(instance, check, types, list, "nValues", count)
               : MODEL_ERROR;
}

/*
 * This part gets and sets values. An element of the importer's arrays has adapter.value_sizes bytes, by the
 * type of the variable: 1 byte is a bool, 4 bytes are an int32_t, and 8 bytes a double or an int64_t.
 */

static inline size_t value_size(const struct instance *instance, const struct variable *variable)
{
    return instance->adapter->value_sizes[variable->type];
}

/* Returns the importer's value as a number. */
static inline double number_from(const struct instance *instance, const struct variable *variable,
                                 const void *from)
{
    switch (value_size(instance, variable)) {
    case sizeof(bool):
        return *(const bool *)from;
    case sizeof(int32_t):
        return *(const int32_t *)from;
    default:
        return variable->type == VARIABLE_REAL ? *(const double *)from : (double)*(const int64_t *)from;
    }
}

static enum model_status check_value(struct instance *instance, const struct variable *variable,
                                     const void *from)
{
    if (value_size(instance, variable) == sizeof(int64_t) && variable->type == VARIABLE_ENUMERATION) {
        const int64_t given = *(const int64_t *)from;
        if (given < INT32_MIN || given > INT32_MAX) { /* a double may not hold all digits of the integer */
            return log_report(instance, MODEL_DISCARD,
                              "%s = %lld refused (allowed: %.10g .. %.10g); it stays as it was.",
                              variable->name, (long long)given, variable->min, variable->max);
        }
    }
    return model_check(instance->model, variable, number_from(instance, variable, from));
}

/* Writes a number as the importer's value. */
static inline void number_to(const struct instance *instance, const struct variable *variable, double number,
                             void *to)
{
    const size_t size = value_size(instance, variable);
    if (variable->type == VARIABLE_REAL) {
        *(double *)to = number;
    } else if (size == sizeof(bool)) {
        *(bool *)to = number != 0.0;
    } else if (size == sizeof(int32_t)) {
        *(int32_t *)to = (int32_t)number;
    } else {
        *(int64_t *)to = (int64_t)number;
    }
}

CONTACT_NOINLINE enum model_status instance_get_values(struct instance *instance, unsigned types,
                                                       const uint32_t *references, size_t reference_count,
                                                       void *values, size_t count)
{
    const struct variable_list list = list_of(instance, references, reference_count);
    const bool is_quick = types == 1u << VARIABLE_REAL && instance->experiment.phase == PHASE_STEP;
    if (is_quick && references != NULL && values != NULL &&
        model_get_reals(instance->model, &list, count, values)) {
        return MODEL_OK;
    }
    size_t place = 0;
    char *to = values;
    enum model_status status = check_values(instance, check_readable, types, &list, values, count);
    for (const struct variable *one = NULL;
         to != NULL && status == MODEL_OK && (one = next_variable(&list, one, &place)) != NULL;) {
        double number = model_time(instance->model);
        if (one->causality != VARIABLE_INDEPENDENT) {
            status = model_read(instance->model, one, &number);
        }
        if (status == MODEL_OK) {
            number_to(instance, one, number, to);
        }
        to += value_size(instance, one);
    }
    return status;
}

enum model_status instance_set_values(struct instance *instance, unsigned types, const uint32_t *references,
                                      size_t reference_count, const void *values, size_t count)
{
    const struct variable_list list = list_of(instance, references, reference_count);
    enum model_status status = check_values(instance, check_settable, types, &list, values, count);
    for (int setting = 0; setting < 2; ++setting) { /* all values are checked before any is set */
        size_t place = 0;
        const char *from = values;
        for (const struct variable *one = NULL;
             status == MODEL_OK && (one = next_variable(&list, one, &place)) != NULL;) {
            if (!setting) {
                status = check_value(instance, one, from);
            } else if (one->causality == VARIABLE_STATE) {
                model_exchange_set_state(instance->model, one, number_from(instance, one, from));
            } else {
                model_set(instance->model, one, number_from(instance, one, from));
            }
            from += value_size(instance, one);
        }
    }
    return status;
}

enum { LOWEST_ORDER = 1, HIGHEST_ORDER = 2 }; /* maxOutputDerivativeOrder of the model description */

enum model_status check_order(struct instance *instance, const struct variable *variable, int order)
{
    if (order < LOWEST_ORDER || order > HIGHEST_ORDER) {
        return log_report(instance, MODEL_DISCARD,
                          ": derivative of order %d of %s refused, allowed: %d to %d", order, variable->name,
                          LOWEST_ORDER, HIGHEST_ORDER);
    }
    return MODEL_OK;
}

static enum model_status check_output(struct instance *instance, const struct variable *variable)
{
    const enum model_status status = check_real(instance, variable, VARIABLE_OUTPUT);
    return status != MODEL_OK || model_has_derivatives(variable)
               ? status
               : log_report(instance, MODEL_DISCARD,
                            ": %s sums up the last step; its derivatives are not provided, allowed: those of "
                            "the other %s outputs",
                            variable->name, instance->adapter->type_names[VARIABLE_REAL]);
}

enum model_status instance_output_derivatives(struct instance *instance, const uint32_t *references,
                                              const int *orders, size_t reference_count, double *values,
                                              size_t count)
{
    const struct variable_list list = list_of(instance, references, reference_count);
    enum model_status status = check_values(instance, check_output, ANY_TYPE, &list, values, count);
    if (status == MODEL_OK && !array_given(instance, "orders", orders, reference_count)) {
        return MODEL_ERROR;
    }
    for (size_t i = 0; i < reference_count && status == MODEL_OK; ++i) {
        status = check_order(instance, listed_variable(&list, references[i]), orders[i]);
    }
    return status == MODEL_OK ? model_get_output_derivatives(instance->model, &list, orders, values) : status;
}

/* Whether the importer knows of states. Co-Simulation of FMI 2.0 has none. */
static bool has_states(const struct instance *instance)
{
    return instance->host.exchange || has_vectors(instance);
}

/* Knowns are the inputs, and after initialization the states. */
static enum model_status check_known(struct instance *instance, const struct variable *variable)
{
    const bool starting = (instance->experiment.phase & PHASE_INITIALIZATION) != 0;
    if (variable->causality == VARIABLE_STATE && has_states(instance) && !starting) {
        return MODEL_OK;
    }
    return starting && variable->causality == VARIABLE_PARAMETER && variable->type == VARIABLE_REAL
               ? log_report(instance, MODEL_DISCARD,
                            ": derivatives with respect to the parameter %s are not provided, allowed: with "
                            "respect to %s inputs",
                            variable->name, instance->adapter->type_names[VARIABLE_REAL])
               : check_real(instance, variable, VARIABLE_INPUT);
}

/* Unknowns are the outputs and the rates of the states. In initialization mode the calculated parameters and
 * the states are unknowns too (ModelStructure: initial unknowns). */
static enum model_status check_unknown(struct instance *instance, const struct variable *variable)
{
    const bool starting = (instance->experiment.phase & PHASE_INITIALIZATION) != 0;
    const enum variable_causality role = (enum variable_causality)variable->causality;
    return (role == VARIABLE_STATE && has_states(instance) && starting) ||
                   (role == VARIABLE_RATE && has_states(instance)) ||
                   (role == VARIABLE_CALCULATED_PARAMETER && starting)
               ? MODEL_OK
               : check_real(instance, variable, VARIABLE_OUTPUT);
}

enum model_status instance_product(struct instance *instance, const struct product *p, size_t seed_count,
                                   size_t sensitivity_count)
{
    enum model_status status = MODEL_OK;
    for (int knowns = 0; knowns < 2 && status == MODEL_OK; ++knowns) {
        const struct variable_list *list = knowns ? &p->knowns : &p->unknowns;
        const bool has_seeds = knowns != p->adjoint;
        const size_t components = has_seeds ? seed_count : sensitivity_count;
        if (!array_given(instance, knowns ? "knowns" : "unknowns", list->references, list->count) ||
            !array_given(instance, has_seeds ? "seed" : "sensitivity", has_seeds ? p->seed : p->sensitivity,
                         components)) {
            return MODEL_ERROR;
        }
        status = check_list(instance, knowns ? check_known : check_unknown, ANY_TYPE, list,
                            has_seeds ? "nSeed" : "nSensitivity", components);
    }
    const struct variable_list *seeded = p->adjoint ? &p->unknowns : &p->knowns;
    const double *seed = p->seed;
    size_t place = 0;
    for (const struct variable *one = NULL;
         status == MODEL_OK && (one = next_variable(seeded, one, &place)) != NULL; ++seed) {
        if (!isfinite(*seed)) {
            status = log_report(instance, MODEL_DISCARD, ": seed of %s = %g refused, allowed: finite",
                                one->name, *seed);
        }
    }
    return status == MODEL_OK ? model_product(instance->model, p) : status;
}

/*
 * Returns by how much two times that should be equal may differ [s], since importers round when they add up
 * step sizes. The larger of two bounds counts: 1e-6 of the step size h [s], and a few roundings of the time
 * t [s].
 */
static double time_slack(double t, double h)
{
    return fmax(STEP_SLACK * h, 4.0 * DBL_EPSILON * fabs(t));
}

/* Checks that a step of `size` [s] does not end past the stop time. */
static enum model_status check_end(struct instance *instance, double end, double size)
{
    const double stop = instance->experiment.stop_time;
    return end <= stop + time_slack(stop, size)
               ? MODEL_OK
               : log_report(instance, MODEL_ERROR, ": step to %s s goes past stopTime = %s s",
                            shortest_digits(end).text, shortest_digits(stop).text);
}

static enum model_status check_step(struct instance *instance, double point, double size, double end)
{
    const double time = model_time(instance->model);
    /* A NaN is refused by each of these conditions; no step without a size has a point to begin at. */
    if (size > 0.0 && !(fabs(point - time) <= time_slack(time, size))) {
        return log_report(instance, MODEL_ERROR,
                          ": currentCommunicationPoint = %s s, expected the time reached, %s s",
                          shortest_digits(point).text, shortest_digits(time).text);
    }
    if (!(size > 0.0 && end > time && end <= DBL_MAX)) {
        return log_report(instance, MODEL_DISCARD,
                          ": communicationStepSize = %s s, allowed: finite and large enough to change the "
                          "time %s s, that is more than %.3g s",
                          shortest_digits(size).text, shortest_digits(time).text, DBL_EPSILON * fabs(time));
    }
    return check_end(instance, end, size);
}

enum model_status instance_step(struct instance *instance, double point, double size,
                                const struct step_request *request)
{
    enum model_status status = check_step(instance, point, size, request->end_time);
    instance->asked_end = request->end_time;
    if (status == MODEL_OK) {
        status = model_step(instance->model, request);
        if (status >= MODEL_ERROR) {
            instance->experiment.phase = status == MODEL_ERROR ? PHASE_ERROR : PHASE_FATAL;
        }
    }
    instance->step_status = status;
    return status;
}

double instance_time_reached(const struct instance *instance)
{
    const double time = model_time(instance->model);
    return fabs(instance->asked_end - time) <= 4.0 * DBL_EPSILON * fabs(time) ? instance->asked_end : time;
}

/* An integrator of variable step may try steps past the stop time; only an accepted one is an error. */
enum model_status exchange_accept_step(struct instance *instance, void *enters_events, void *terminates,
                                       size_t size)
{
    if (!array_given(instance, "enterEventMode", enters_events, 1) ||
        !array_given(instance, "terminateSimulation", terminates, 1)) {
        return MODEL_ERROR;
    }
    memset(enters_events, 0, size);
    memset(terminates, 0, size);
    const enum model_status status = check_end(instance, model_time(instance->model), 0.0);
    return status == MODEL_OK ? model_exchange_accept(instance->model) : status;
}

bool numbers_ready(struct instance *instance, const double *values, size_t count, size_t expected)
{
    if (count != expected) {
        log_report(instance, MODEL_ERROR, ": %lu values, expected %lu", (unsigned long)count,
                   (unsigned long)expected);
        return false;
    }
    return array_given(instance, "the array of values", values, count);
}

/*
 * Saved states follow. The blocks given to the importer and not freed form a linked list; the importer holds
 * the address of a block. An address from the importer may be uninitialised, freed, or another instance's.
 * Therefore it is searched in the list before anything is read from it.
 */

/* The version is raised whenever the layout or meaning of the header or of the model's state (struct
 * model_state, struct scene_state, struct scene_values) changes. */
#define BLOCK_VERSION 10u

struct block_header {
    uint32_t magic; /* the adapter's; a block of the other byte order does not match */
    uint32_t version;
    uint32_t scene;    /* SCENE_HASH: states fit only the FMU that wrote them */
    uint32_t checksum; /* checksum of all bytes behind this field */
    uint64_t size;     /* bytes of the whole block */
    struct experiment experiment;
};

_Static_assert(sizeof(struct block_header) == 48, "no padding, and the model's bytes stay aligned to 8");

struct state_block {
    struct state_block *next;
    struct block_header header; /* the bytes that the importer may copy begin here */
    _Alignas(double) unsigned char model[];
};
_Static_assert(offsetof(struct state_block, model) ==
                   offsetof(struct state_block, header) + sizeof(struct block_header),
               "the bytes of the model follow those of the header");

#define CHECKED_FROM (offsetof(struct block_header, checksum) + sizeof(uint32_t))

/* Returns the link of the list that points to the block at an address, or the last link, which is NULL. */
static struct state_block **link_of(struct instance *instance, const void *address)
{
    struct state_block **link = &instance->states;
    while (*link != NULL && *link != address) {
        link = &(*link)->next;
    }
    return link;
}

/* Takes the block that a link points to out of the list and frees it. */
static void remove_block(struct instance *instance, struct state_block **link)
{
    struct state_block *block = *link;
    *link = block->next;
    instance->host.release(block);
}

static size_t block_size(void)
{
    return sizeof(struct block_header) + model_state_size();
}

static uint32_t block_checksum(const void *block)
{
    return checksum_of(CHECKSUM_START, (const unsigned char *)block + CHECKED_FROM,
                       block_size() - CHECKED_FROM);
}

/* Returns the header of a state that this instance saves now, without its checksum. */
static struct block_header new_header(const struct instance *instance)
{
    return (struct block_header){.magic = instance->adapter->state_magic,
                                 .version = BLOCK_VERSION,
                                 .scene = SCENE_HASH,
                                 .size = block_size(),
                                 .experiment = instance->experiment};
}

static bool plausible_experiment(const struct instance *instance, const struct experiment *experiment)
{
    /* Only FMI 3.0 has an event mode in Co-Simulation. */
    const unsigned others = instance->host.exchange           ? PHASE_STEP
                            : instance->adapter->version >= 3 ? PHASE_CONTINUOUS
                                                              : PHASES_EXCHANGED;
    const unsigned allowed = (PHASES_ALL | PHASE_FATAL) & ~others;
    const unsigned phase = experiment->phase;
    const bool is_one_phase = phase != 0 && (phase & (phase - 1)) == 0;
    return is_one_phase && (phase & ~allowed) == 0 && experiment->set_up <= 1 &&
           isfinite(experiment->start_time) && experiment->stop_time >= experiment->start_time;
}

/* Whether a block of `size` bytes is a whole state of this FMU. Nothing is read beyond `size`. */
static enum model_status check_block(struct instance *instance, const void *block, size_t size)
{
    const struct block_header right = new_header(instance);
    struct block_header header = right; /* a block that is too short for a header only has a wrong size */
    memcpy(&header, block, size < sizeof header ? 0 : sizeof header);
    const uint32_t sum = size == right.size ? block_checksum(block) : header.checksum;
    const struct {
        const char *what;
        uint64_t got, expected;
    } rows[] = {{"magic number", header.magic, right.magic},
                {"version", header.version, right.version},
                {"model", header.scene, right.scene},
                {"size", size, right.size},
                {"size in the header", header.size, right.size},
                {"checksum", sum, header.checksum}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        if (rows[i].got != rows[i].expected) {
            const unsigned long got = (unsigned long)rows[i].got, expected = (unsigned long)rows[i].expected;
            return log_report(instance, MODEL_ERROR, ": state has %s %lu (0x%lX), expected %lu (0x%lX)",
                              rows[i].what, got, got, expected, expected);
        }
    }
    return plausible_experiment(instance, &header.experiment)
               ? MODEL_OK
               : log_report(instance, MODEL_ERROR, ": state has a header out of range");
}

/* Returns the block of an importer's state, or NULL, after a message, where the state is unknown. */
static struct state_block *given_block(struct instance *instance, void *state)
{
    if (!array_given(instance, "FMUState", state, 1)) {
        return NULL;
    }
    struct state_block *block = *link_of(instance, state);
    if (block == NULL) {
        log_report(instance, MODEL_ERROR,
                   ": FMUState is unknown, expected a state that this instance gave and that is not freed");
    }
    return block;
}

/*
 * Returns the block to write for an importer's state pointer: the block it points to if that is in the list,
 * else a new one. Some importers never initialise the pointer. NULL: memory is exhausted, after a message.
 */
static struct state_block *block_to_write(struct instance *instance, void **state)
{
    struct state_block *block = *link_of(instance, *state);
    if (block != NULL) {
        return block;
    }
    block = instance->host.allocate(1, sizeof *block + block_size());
    if (block == NULL) {
        log_report(instance, MODEL_ERROR, ": no memory for %lu bytes", (unsigned long)block_size());
        return NULL;
    }
    block->next = instance->states;
    instance->states = block;
    *state = block;
    return block;
}

enum model_status state_block_get(struct instance *instance, void **state)
{
    if (!array_given(instance, "FMUState", state, 1)) {
        return MODEL_ERROR;
    }
    struct state_block *block = block_to_write(instance, state);
    if (block == NULL) {
        return MODEL_ERROR;
    }
    model_save(instance->model, block->model);
    block->header = new_header(instance);
    block->header.checksum = block_checksum(&block->header);
    return MODEL_OK;
}

enum model_status state_block_set(struct instance *instance, void *state)
{
    struct state_block *block = given_block(instance, state);
    if (block == NULL || check_block(instance, &block->header, block_size()) != MODEL_OK) {
        return MODEL_ERROR;
    }
    const enum model_status status = model_restore(instance->model, block->model);
    if (status <= MODEL_WARNING) {
        instance->experiment = block->header.experiment;
    }
    return status;
}

enum model_status state_block_free(struct instance *instance, void **state)
{
    if (state == NULL || *state == NULL) {
        return MODEL_OK;
    }
    struct state_block *block = given_block(instance, *state);
    if (block == NULL) {
        return MODEL_ERROR;
    }
    remove_block(instance, link_of(instance, block));
    *state = NULL;
    return MODEL_OK;
}

enum model_status state_block_size(struct instance *instance, void *state, size_t *size)
{
    if (given_block(instance, state) == NULL || !array_given(instance, "size", size, 1)) {
        return MODEL_ERROR;
    }
    *size = block_size();
    return MODEL_OK;
}

enum model_status state_block_serialize(struct instance *instance, void *state, void *bytes, size_t size)
{
    struct state_block *block = given_block(instance, state);
    if (block == NULL || !array_given(instance, "serializedState", bytes, block_size())) {
        return MODEL_ERROR;
    }
    if (size < block_size()) {
        return log_report(instance, MODEL_ERROR, ": room for %lu bytes, expected %lu", (unsigned long)size,
                          (unsigned long)block_size());
    }
    memcpy(bytes, &block->header, block_size());
    return MODEL_OK;
}

enum model_status state_block_deserialize(struct instance *instance, const void *bytes, size_t size,
                                          void **state)
{
    if (!array_given(instance, "serializedState", bytes, size) ||
        !array_given(instance, "FMUState", state, 1) || check_block(instance, bytes, size) != MODEL_OK) {
        return MODEL_ERROR;
    }
    struct state_block *block = block_to_write(instance, state);
    if (block == NULL) {
        return MODEL_ERROR;
    }
    memcpy(&block->header, bytes, size);
    return MODEL_OK;
}

static void forget_experiment(struct instance *instance)
{
    instance->experiment = (struct experiment){.stop_time = (double)INFINITY, .phase = PHASE_INSTANTIATED};
    instance->step_status = MODEL_OK;
    instance->log_categories = instance->logging_on ? LOG_ALL : LOG_STATUS_ALL;
}

bool instance_expects(struct instance *nobody, bool holds, const char *argument, const char *given,
                      const char *expected)
{
    if (!holds) {
        log_report(nobody, MODEL_ERROR, ": %s is \"%.300s\", expected \"%.300s\"", argument,
                   given == NULL ? "(null)" : given, expected);
    }
    return holds;
}

struct instance *instance_create(struct instance *nobody, size_t size, const char *token, bool logging_on)
{
    const struct adapter *adapter = nobody->adapter;
    const size_t name_size = strlen(nobody->name) + 1;
    if (!instance_expects(nobody, name_size > 1, "instanceName", nobody->name, "any name") ||
        !instance_expects(nobody, token != NULL && strcmp(token, adapter->token) == 0, adapter->token_name,
                          token, adapter->token)) {
        return NULL;
    }
    struct instance *instance = nobody->host.allocate(1, size + name_size);
    if (instance != NULL) {
        memcpy(instance, nobody, size);
        instance->name = memcpy((char *)instance + size, nobody->name, name_size);
        instance->host.context = instance;
        instance->host.log = send_message;
        instance->host.wants = is_heard;
        instance->logging_on = logging_on;
        instance->tuning_phases = PHASE_STEP | PHASE_EVENT;
        forget_experiment(instance);
        instance->model = model_create(&instance->host);
        if (instance->model != NULL) {
            return instance;
        }
        nobody->host.release(instance);
    }
    instance_expects(nobody, false, "memory", "exhausted", "room for an instance");
    return NULL;
}

void instance_free(struct instance *instance)
{
    if (instance != NULL && (instance->experiment.phase & (PHASE_TELLING | PHASE_INTERMEDIATE)) == 0) {
        void (*release)(void *) = instance->host.release;
        while (instance->states != NULL) { /* states that the importer has not freed */
            remove_block(instance, &instance->states);
        }
        model_destroy(instance->model);
        release(instance);
    }
}

enum model_status instance_set_logging(struct instance *instance, bool on, size_t count,
                                       const char *const *categories)
{
    unsigned named = count == 0 ? (unsigned)LOG_ALL : 0;
    if (!array_given(instance, "categories", (const void *)categories, count)) {
        return MODEL_ERROR;
    }
    for (size_t i = 0; i < count; ++i) {
        const char *name = categories[i] == NULL ? "(null)" : categories[i];
        if (category_bits(name) == 0) {
            return log_report(instance, MODEL_ERROR,
                              ": unknown category \"%.100s\" (allowed: logEvents, logStatusWarning, "
                              "logStatusDiscard, logStatusError, logStatusFatal, logAll)",
                              name);
        }
        named |= category_bits(name);
    }
    if (instance->adapter->version == 2) { /* with logging off, warnings and worse are still sent */
        instance->log_categories = on ? named : (unsigned)LOG_STATUS_ALL;
    } else { /* FMI 3.0.2, section 2.3.1 */
        instance->log_categories = on ? instance->log_categories | named : instance->log_categories & ~named;
    }
    return MODEL_OK;
}

enum model_status instance_set_up(struct instance *instance, bool tolerance_defined, double tolerance,
                                  double start_time, bool stop_time_defined, double stop_time)
{
    if (!isfinite(start_time)) {
        return log_report(instance, MODEL_ERROR, ": startTime = %s s, allowed: finite",
                          shortest_digits(start_time).text);
    }
    if (stop_time_defined && !(stop_time >= start_time && isfinite(stop_time))) {
        return log_report(instance, MODEL_ERROR,
                          ": stopTime = %s s, allowed: finite, from startTime = %s s on",
                          shortest_digits(stop_time).text, shortest_digits(start_time).text);
    }
    const enum model_status status = model_setup(instance->model, tolerance_defined, tolerance, start_time);
    if (status <= MODEL_WARNING) {
        instance->experiment.start_time = start_time;
        instance->experiment.stop_time = stop_time_defined ? stop_time : (double)INFINITY;
        instance->experiment.set_up = 1;
    }
    return status;
}

enum model_status instance_enter(struct instance *instance, enum model_status status, enum phase next)
{
    if (status <= MODEL_WARNING) {
        instance->experiment.phase = next;
        if (instance->host.exchange && (next & PHASES_EXCHANGED) != 0) {
            model_exchange_set_continuous(instance->model, next == PHASE_CONTINUOUS);
        }
    }
    return status;
}

enum model_status instance_reset(struct instance *instance)
{
    model_reset(instance->model);
    forget_experiment(instance);
    return MODEL_OK;
}
