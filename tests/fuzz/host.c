#include "host.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene.h"

struct host host;

/* A real or an integer, whichever the variable is. */
static fmi2Status read_value(fmi2Component c, const struct variable *variable, double *real, int *integer)
{
    if (variable->type == VARIABLE_REAL) {
        return fmi2GetReal(c, &variable->reference, 1, real);
    }
    return (variable->type == VARIABLE_BOOLEAN ? fmi2GetBoolean : fmi2GetInteger)(c, &variable->reference, 1,
                                                                                  integer);
}

/* Of the instance to be shown, if any. */
static void show_values(void)
{
    for (int i = 0; host.shown != NULL && i < scene_variable_count; ++i) {
        const struct variable *variable = &scene_variables[i];
        double real = 0.0;
        int integer = 0;
        if (read_value(host.shown, variable, &real, &integer) <= fmi2Warning) {
            fprintf(stderr, "%s = %.17g\n", variable->name,
                    variable->type == VARIABLE_REAL ? real : (double)integer);
        }
    }
}

static void *take(size_t count, size_t size)
{
    if (host.countdown == 0) {
        host.countdown = -1;
        return NULL;
    }
    host.countdown -= host.countdown > 0;
    void *memory = calloc(count, size);
    host.living += memory != NULL;
    return memory;
}

static void give_back(void *memory)
{
    host.living -= memory != NULL;
    free(memory);
}

/* What only reads may be answered; what would change something is refused, and nobody hears of it. */
static void call_back(fmi2Component c)
{
    const long messages = host.messages;
    const struct variable *variable = &scene_variables[host.messages % scene_variable_count];
    const double time = 0.0;
    double value = 0.0;
    fmi2FMUstate state = NULL;
    fmi2Status status = fmi2GetReal(c, &variable->reference, 1, &value);
    CLAIM(status >= fmi2OK && status <= fmi2Error);
    status = fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &value);
    CLAIM(status >= fmi2OK && status <= fmi2Error);
    CLAIM(fmi2DoStep(c, time, 1.0, fmi2True) == fmi2Error);
    CLAIM(fmi2SetReal(c, &variable->reference, 1, &value) == fmi2Error);
    CLAIM(fmi2GetFMUstate(c, &state) == fmi2Error && state == NULL);
    CLAIM(fmi2Reset(c) == fmi2Error);
    fmi2FreeInstance(c);
    CLAIM(host.messages == messages);
}

/* The message is a printf format without anything to fill in, but for doubled signs. */
static void hear(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                 fmi2String category, fmi2String message, ...)
{
    CLAIM(environment == &host);
    CLAIM(name != NULL && category != NULL && message != NULL);
    CLAIM(status >= fmi2OK && status <= fmi2Fatal);
    CLAIM(strncmp(category, "log", 3) == 0);
    va_list arguments;
    va_start(arguments, message);
    const int length =
        vsnprintf(claim_context.last_message, sizeof claim_context.last_message, message, arguments);
    va_end(arguments);
    CLAIM(length > 0 && length < (int)sizeof claim_context.last_message);
    CLAIM(strstr(claim_context.last_message, "(null)") == NULL || strstr(message, "(null)") != NULL);
    ++host.messages;
    if (host.told != NULL) {
        call_back(host.told);
    }
}

void host_begin(void)
{
    memset(&host, 0, sizeof host);
    memset(&claim_context, 0, sizeof claim_context);
    claim_context.show = show_values;
    host.countdown = -1;
}

void host_end(void)
{
    CLAIM(host.living == 0);
}

const fmi2CallbackFunctions *host_callbacks(void)
{
    static const fmi2CallbackFunctions callbacks = {
        .logger = hear, .allocateMemory = take, .freeMemory = give_back, .componentEnvironment = &host};
    return &callbacks;
}

fmi2Component host_instance(void)
{
    fmi2Component c =
        fmi2Instantiate("fuzzed", fmi2CoSimulation, SCENE_GUID, "", host_callbacks(), fmi2False, fmi2False);
    CLAIM(c != NULL);
    return c;
}

const struct variable *host_variable(int row, int element, int component)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        const struct variable *variable = &scene_variables[i];
        if (variable->row == row && variable->element == element && variable->component == component) {
            return variable;
        }
    }
    return NULL;
}

fmi2Status host_set_real(fmi2Component c, int row, int element, int component, double value)
{
    const struct variable *variable = host_variable(row, element, component);
    return variable == NULL ? fmi2OK : fmi2SetReal(c, &variable->reference, 1, &value);
}

fmi2Status host_set_integer(fmi2Component c, int row, int element, int value)
{
    const struct variable *variable = host_variable(row, element, 0);
    if (variable == NULL) {
        return fmi2OK;
    }
    return variable->type == VARIABLE_BOOLEAN ? fmi2SetBoolean(c, &variable->reference, 1, &value)
                                              : fmi2SetInteger(c, &variable->reference, 1, &value);
}

void host_bound_work(fmi2Component c, int most)
{
    (void)host_set_integer(c, ROW_solver_max_internal_steps, 0, most);
}

double host_real(fmi2Component c, int row, int element, int component)
{
    const struct variable *variable = host_variable(row, element, component);
    double value = 0.0;
    if (variable != NULL) {
        const fmi2Status status = fmi2GetReal(c, &variable->reference, 1, &value);
        CLAIM(status <= fmi2Warning);
    }
    return value;
}

double host_length(fmi2Component c, int row, int element)
{
    double square = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double part = host_real(c, row, element, k);
        square += part * part;
    }
    return sqrt(square);
}

int host_integer(fmi2Component c, int row, int element)
{
    const struct variable *variable = host_variable(row, element, 0);
    int value = 0;
    if (variable != NULL) {
        const fmi2Status status = fmi2GetInteger(c, &variable->reference, 1, &value);
        CLAIM(status <= fmi2Warning);
    }
    return value;
}

static void read_one(fmi2Component c, const struct variable *variable)
{
    double real = 0.0;
    int integer = 0;
    const fmi2Status status = read_value(c, variable, &real, &integer);
    if (status <= fmi2Warning && !(isfinite(real) && integer >= 0)) {
        fprintf(stderr, "%s = %g, %d\n", variable->name, real, integer);
        CLAIM(isfinite(real) && integer >= 0);
    }
}

void host_read_all(fmi2Component c)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        read_one(c, &scene_variables[i]);
    }
}
