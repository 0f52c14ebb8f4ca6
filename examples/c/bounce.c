/*
 * A ball that bounces on a fixed sphere, by the model without FMI: variables by name, steps, refusals. Names, units and
 * start values are those of SphereSphere.fmu.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/model.h"

/* Every refusal is a sentence: variable, value, allowed range. The rest tells of contacts that begin and end. */
static void tell(void *context, enum model_status status, const char *message)
{
    (void)context;
    if (status != MODEL_OK) {
        fprintf(stderr, "bounce: %s\n", message);
    }
}

static const struct variable *named(const char *name)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        if (strcmp(scene_variables[i].name, name) == 0) {
            return &scene_variables[i];
        }
    }
    fprintf(stderr, "bounce: no variable %s\n", name);
    exit(1);
}

/* Sets a number. A choice is the number of its item: 2 of contact.dashpot is unclamped. */
static void set(struct model *m, const char *name, double value)
{
    if (model_check(m, named(name), value) != MODEL_OK) {
        exit(1);
    }
    model_set(m, named(name), value);
}

static double real(struct model *m, const char *name)
{
    double value;
    if (model_read(m, named(name), &value) != MODEL_OK) {
        exit(1);
    }
    return value;
}

int main(void)
{
    const struct model_host host = {NULL, tell, NULL, calloc, free, false};
    struct model *m = model_create(&host);
    if (!m) {
        fprintf(stderr, "bounce: no memory\n");
        return 1;
    }
    set(m, "source.center[1]", 0.03); /* m, beside the top */
    set(m, "source.center[2]", 0.04);
    set(m, "contact.dashpot", 2);
    if (model_setup(m, true, 1e-10, 0.0) != MODEL_OK || model_exit_initialization(m) != MODEL_OK) {
        return 1;
    }
    for (int k = 1; k <= 12; ++k) {
        const struct step_request request = {.end_time = 0.125 * k};
        if (model_step(m, &request) != MODEL_OK) {
            return 1;
        }
        printf("%.3f s: height %.17g m, gap %.17g m\n", model_time(m), real(m, "source.position[3]"),
               real(m, "contact.gap"));
    }
    model_destroy(m);
    return 0;
}
