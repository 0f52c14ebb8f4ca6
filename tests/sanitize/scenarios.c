#include "scenarios.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/variable.h"
#include "scene.h"

static const double STEP = 1.0 / 64.0; /* s, exact */

static void demand(bool holds, const char *what, int index)
{
    if (!holds) {
        fprintf(stderr, "scenario %d: not so: %s\n", index, what);
        exit(1);
    }
}

static const struct variable *find(const char *name)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        if (strcmp(scene_variables[i].name, name) == 0) {
            return &scene_variables[i];
        }
    }
    demand(false, name, -1);
    return NULL;
}

static void set_real(fmi2Component c, const char *name, double value)
{
    demand(fmi2SetReal(c, &find(name)->reference, 1, &value) == fmi2OK, name, -1);
}

static void set_integer(fmi2Component c, const char *name, int value)
{
    demand(fmi2SetInteger(c, &find(name)->reference, 1, &value) == fmi2OK, name, -1);
}

/* Three methods, two laws, three dashpots; both free or the destination moved; a ball on or in a cylinder. */
static void choose(fmi2Component c, int index)
{
    const bool inside = index % 4 == 3;
    set_integer(c, "solver.method", 1 + index % 3);
    set_integer(c, "contact.method", 1 + index / 3 % 2);
    set_integer(c, "contact.dashpot", 1 + index / 6 % 3);
    set_integer(c, "destination.motion", 1 + index / 5 % 3);
    set_real(c, "contact.penalty_factor", 1e3 * (1 + index));
    set_real(c, "contact.viscous_penalty_factor", 2.0);
    set_real(c, "source.center[1]", inside ? 0.35 : 0.62);
    set_real(c, "source.center[3]", 0.0);
    set_real(c, "source.initial_velocity[1]", inside ? 1.0 : -1.0);
    set_real(c, "gravity[1]", -1.0);
    set_real(c, "gravity[3]", -0.01 * index);
}

static void log_nothing(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                        fmi2String category, fmi2String message, ...)
{
    (void)environment, (void)name, (void)status, (void)category, (void)message;
}

struct scenario scenario_begin(int index)
{
    static const fmi2CallbackFunctions callbacks = {.logger = log_nothing};
    struct scenario scenario = {.index = index, .digest = 14695981039346656037u};
    scenario.component =
        fmi2Instantiate("run", fmi2CoSimulation, SCENE_GUID, "", &callbacks, fmi2False, index % 2);
    fmi2Component c = scenario.component;
    demand(c != NULL, "an instance", index);
    choose(c, index);
    demand(fmi2SetupExperiment(c, fmi2True, 1e-8, 0.0, fmi2False, 0.0) == fmi2OK, "set up", index);
    demand(fmi2EnterInitializationMode(c) == fmi2OK, "enters initialization", index);
    demand(fmi2ExitInitializationMode(c) == fmi2OK, "initialized", index);
    return scenario;
}

static void digest_bits(struct scenario *scenario, const void *value, size_t size)
{
    const unsigned char *bytes = value;
    for (size_t i = 0; i < size; ++i) {
        scenario->digest = (scenario->digest ^ bytes[i]) * 1099511628211u;
    }
}

static void read_outputs(struct scenario *scenario)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        const struct variable *variable = &scene_variables[i];
        fmi2Component c = scenario->component;
        double real = 0.0;
        int integer = 0;
        fmi2Status status = fmi2OK;
        if (variable->type == VARIABLE_REAL) {
            status = fmi2GetReal(c, &variable->reference, 1, &real);
        } else if (variable->type == VARIABLE_BOOLEAN) {
            status = fmi2GetBoolean(c, &variable->reference, 1, &integer);
        } else {
            status = fmi2GetInteger(c, &variable->reference, 1, &integer);
        }
        demand(status == fmi2OK, variable->name, scenario->index);
        digest_bits(scenario, &real, sizeof real);
        digest_bits(scenario, &integer, sizeof integer);
    }
}

/* A state saved, freed and, in every other run, gone back to. */
static void save_and_restore(const struct scenario *scenario, double time)
{
    fmi2Component c = scenario->component;
    fmi2FMUstate state = NULL;
    demand(fmi2GetFMUstate(c, &state) == fmi2OK, "saved", scenario->index);
    if (scenario->index % 2) {
        demand(fmi2DoStep(c, time, STEP, fmi2False) == fmi2OK, "step", scenario->index);
        demand(fmi2SetFMUstate(c, state) == fmi2OK, "restored", scenario->index);
    }
    demand(fmi2FreeFMUstate(c, &state) == fmi2OK, "freed", scenario->index);
}

void scenario_step(struct scenario *scenario, int step)
{
    const double time = STEP * step;
    if (step == SCENARIO_STEPS / 2) {
        save_and_restore(scenario, time);
    }
    demand(fmi2DoStep(scenario->component, time, STEP, fmi2True) == fmi2OK, "step", scenario->index);
    read_outputs(scenario);
}

uint64_t scenario_end(struct scenario *scenario)
{
    fmi2FreeInstance(scenario->component);
    scenario->component = NULL;
    return scenario->digest;
}
