#include "host3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene.h"

struct host host;

void host_begin(void)
{
    memset(&host, 0, sizeof host);
    memset(&claim_context, 0, sizeof claim_context);
}

/* What only reads may be answered; what would change something is refused. */
static void call_back(fmi3Instance c)
{
    const struct variable *variable = &scene_variables[host.messages % scene_variable_count];
    const fmi3ValueReference reference = variable->reference;
    fmi3Float64 values[LONGEST_VECTOR] = {0.0};
    fmi3FMUState state = NULL;
    fmi3Boolean flag = fmi3False;
    fmi3Status status = fmi3GetFloat64(c, &reference, 1, values, 1);
    CLAIM(status >= fmi3OK && status <= fmi3Error);
    CLAIM(fmi3DoStep(c, 0.0, 1.0, fmi3True, &flag, &flag, &flag, values) == fmi3Error);
    CLAIM(fmi3SetFloat64(c, &reference, 1, values, 1) == fmi3Error);
    CLAIM(fmi3SetTime(c, 1.0) == fmi3Error);
    CLAIM(fmi3GetFMUState(c, &state) == fmi3Error && state == NULL);
    CLAIM(fmi3Reset(c) == fmi3Error);
    fmi3FreeInstance(c);
}

void host_hear(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
               fmi3String message)
{
    CLAIM(environment == &host);
    CLAIM(category != NULL && message != NULL && message[0] != '\0');
    CLAIM(status >= fmi3OK && status <= fmi3Fatal);
    CLAIM(strncmp(category, "log", 3) == 0);
    CLAIM(strlen(message) < sizeof claim_context.last_message);
    (void)snprintf(claim_context.last_message, sizeof claim_context.last_message, "%s", message);
    ++host.messages;
    if (host.told != NULL) {
        const long messages = host.messages;
        call_back(host.told);
        CLAIM(host.messages == messages);
    }
}

void host_update(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean set_requested,
                 fmi3Boolean get_allowed, fmi3Boolean finished, fmi3Boolean can_return,
                 fmi3Boolean *return_requested, fmi3Float64 *return_time)
{
    const fmi3ValueReference clock = 0;
    fmi3Float64 now = 0.0;
    CLAIM(environment == &host && isfinite(time));
    CLAIM(!set_requested && get_allowed && finished);
    if (host.stepped != NULL) {
        const fmi3Status status = fmi3GetFloat64(host.stepped, &clock, 1, &now, 1);
        CLAIM(status == fmi3OK && now == time);
        call_back(host.stepped);
        host_read_all(host.stepped);
    }
    *return_requested = host.early && can_return;
    *return_time = time + host.early_after;
}

void host_bound_work(fmi3Instance c, int most)
{
    const fmi3Int32 value = most;
    for (int i = 0; i < scene_variable_count; ++i) {
        if (scene_variables[i].row == ROW_solver_max_internal_steps) {
            (void)fmi3SetInt32(c, &scene_variables[i].reference, 1, &value, 1);
        }
    }
}

static void read_one(fmi3Instance c, const struct variable *variable, size_t length)
{
    const fmi3ValueReference reference = variable->reference;
    fmi3Float64 reals[LONGEST_VECTOR] = {0.0};
    fmi3Int64 items[LONGEST_VECTOR] = {0};
    fmi3Int32 integers[LONGEST_VECTOR] = {0};
    fmi3Boolean flags[LONGEST_VECTOR] = {false};
    CLAIM(length <= LONGEST_VECTOR);
    const fmi3Status status =
        variable->type == VARIABLE_REAL      ? fmi3GetFloat64(c, &reference, 1, reals, length)
        : variable->type == VARIABLE_INTEGER ? fmi3GetInt32(c, &reference, 1, integers, length)
        : variable->type == VARIABLE_BOOLEAN ? fmi3GetBoolean(c, &reference, 1, flags, length)
                                             : fmi3GetInt64(c, &reference, 1, items, length);
    for (size_t k = 0; status <= fmi3Warning && k < length; ++k) {
        CLAIM(isfinite(reals[k]) && integers[k] >= 0 && items[k] >= 0);
    }
}

void host_read_all(fmi3Instance c)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        if (scene_variables[i].component == 0) {
            read_one(c, &scene_variables[i], scene_variables[i].length);
        }
    }
}
