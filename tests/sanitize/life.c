/*
 * Ten thousand instances come and go, left in every phase and with states that nobody freed; the memory in
 * use is what it was after the first hundred. Built with the address and undefined behaviour sanitizers,
 * whose leak check comes at the end.
 */
#include <stdio.h>

#include "scenarios.h"
#include "scene.h"

/* Of the sanitizer (clang: sanitizer/allocator_interface.h); gcc brings the function without the header. */
size_t __sanitizer_get_current_allocated_bytes(void);

enum { CYCLES = 10000, WARM = 100 };

static void log_nothing(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                        fmi2String category, fmi2String message, ...)
{
    (void)environment, (void)name, (void)status, (void)category, (void)message;
}

/* Freed just after fmi2Instantiate, in initialization mode or after a refused initialization. */
static int fresh(int phase)
{
    static const fmi2CallbackFunctions callbacks = {.logger = log_nothing};
    fmi2FMUstate forgotten = NULL;
    fmi2Component c =
        fmi2Instantiate("brief", fmi2CoSimulation, SCENE_GUID, NULL, &callbacks, fmi2False, fmi2True);
    int failures = c == NULL;
    if (phase > 0) {
        failures += fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) != fmi2OK;
        failures += fmi2EnterInitializationMode(c) != fmi2OK;
        failures += fmi2GetFMUstate(c, &forgotten) != fmi2OK;
    }
    if (phase > 1) {
        const fmi2ValueReference unknown = 999999;
        const fmi2Real value = 1.0;
        failures += fmi2SetReal(c, &unknown, 1, &value) != fmi2Error;
        failures += fmi2Reset(c) != fmi2OK;
    }
    fmi2FreeInstance(c);
    return failures;
}

/* Initialized, so that a solver was opened, and in some cycles run. */
static int used(int index)
{
    struct scenario run = scenario_begin(index % SCENARIOS);
    if (index % 50 == 0) {
        for (int step = 0; step < SCENARIO_STEPS; ++step) {
            scenario_step(&run, step);
        }
    }
    fmi2FMUstate forgotten = NULL;
    const int failures = fmi2GetFMUstate(run.component, &forgotten) != fmi2OK;
    scenario_end(&run);
    return failures;
}

int main(void)
{
    size_t before = 0;
    int failures = 0;
    for (int i = 0; i < CYCLES; ++i) {
        before = i == WARM ? __sanitizer_get_current_allocated_bytes() : before;
        failures += i % 4 < 3 ? fresh(i % 4) : used(i / 4);
    }
    const size_t after = __sanitizer_get_current_allocated_bytes();
    printf("%d instances: %d calls failed, %zu bytes in use after %d, %zu at the end\n", CYCLES, failures,
           before, WARM, after);
    return failures > 0 || after != before;
}
