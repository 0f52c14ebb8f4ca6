#include "host3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/variable.h"

struct host3 host3;

void host3_begin(void)
{
    memset(&host3, 0, sizeof host3);
    memset(&claim_context, 0, sizeof claim_context);
}

/* What only reads may be answered; what would change something is refused. */
static void call_back(fmi3Instance c)
{
    const struct variable *variable = &scene_variables[host3.messages % scene_variable_count];
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

void host3_hear(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                fmi3String message)
{
    CLAIM(environment == &host3);
    CLAIM(category != NULL && message != NULL && message[0] != '\0');
    CLAIM(status >= fmi3OK && status <= fmi3Fatal);
    CLAIM(strncmp(category, "log", 3) == 0);
    CLAIM(strlen(message) < sizeof claim_context.last_message);
    (void)snprintf(claim_context.last_message, sizeof claim_context.last_message, "%s", message);
    ++host3.messages;
    if (host3.told != NULL) {
        const long messages = host3.messages;
        call_back(host3.told);
        CLAIM(host3.messages == messages);
    }
}

void host3_update(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean set_requested,
                  fmi3Boolean get_allowed, fmi3Boolean finished, fmi3Boolean can_return,
                  fmi3Boolean *return_requested, fmi3Float64 *return_time)
{
    const fmi3ValueReference clock = 0;
    fmi3Float64 now = 0.0;
    CLAIM(environment == &host3 && isfinite(time));
    CLAIM(!set_requested && get_allowed && finished);
    if (host3.stepped != NULL) {
        const fmi3Status status = fmi3GetFloat64(host3.stepped, &clock, 1, &now, 1);
        CLAIM(status == fmi3OK && now == time);
        call_back(host3.stepped);
        host3_read_all(host3.stepped);
    }
    *return_requested = host3.early && can_return;
    *return_time = time + host3.early_after;
}

static void read_one(fmi3Instance c, const struct variable *variable, size_t length)
{
    const fmi3ValueReference reference = variable->reference;
    fmi3Float64 reals[LONGEST_VECTOR] = {0.0};
    fmi3Int64 items[LONGEST_VECTOR] = {0};
    fmi3Int32 integers[LONGEST_VECTOR] = {0};
    fmi3Boolean flags[LONGEST_VECTOR] = {false};
    fmi3Status status = fmi3Error;
    CLAIM(length <= LONGEST_VECTOR);
    switch ((enum variable_type)variable->type) {
    case VARIABLE_REAL:
        status = fmi3GetFloat64(c, &reference, 1, reals, length);
        break;
    case VARIABLE_INTEGER:
        status = fmi3GetInt32(c, &reference, 1, integers, length);
        break;
    case VARIABLE_BOOLEAN:
        status = fmi3GetBoolean(c, &reference, 1, flags, length);
        break;
    case VARIABLE_ENUMERATION:
        status = fmi3GetInt64(c, &reference, 1, items, length);
        break;
    }
    for (size_t k = 0; status <= fmi3Warning && k < length; ++k) {
        CLAIM(isfinite(reals[k]) && integers[k] >= 0 && items[k] >= 0);
    }
}

void host3_read_all(fmi3Instance c)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        if (scene_variables[i].component == 0) {
            read_one(c, &scene_variables[i], vector_length(&scene_variables[i]));
        }
    }
}
