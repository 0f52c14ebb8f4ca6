/* Idle: an FMI 2.0 co-simulation FMU that does nothing. A step only moves its time on, and its outputs are
 * numbers that it was made with. Phase and arguments are checked as the standard asks of every FMU,
 * nothing else happens: what a call costs here is what the call itself costs, the benchmark's measure
 * (scripts/bench.sh). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

/* Value references 0..5: position[1..3], velocity[1..3] of modelDescription.xml. */
enum { VALUES = 6 };
static const fmi2Real start_values[VALUES] = {0.0, 0.0, 1.0, 0.0, 0.0, 0.0};
static const char guid[] = "{5d3b8c0a-8a0e-4a52-9d0b-3c1f5a8e7b61}";

enum phase { INSTANTIATED, INITIALIZATION, STEPPING, TERMINATED };

struct idle {
    fmi2Real values[VALUES];
    fmi2Real time;
    enum phase phase;
    fmi2CallbackFreeMemory release;
};

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn)
{
    (void)instanceName;
    (void)fmuResourceLocation;
    (void)visible;
    (void)loggingOn;
    if (fmuType != fmi2CoSimulation || fmuGUID == NULL || strcmp(fmuGUID, guid) != 0) {
        return NULL;
    }
    fmi2CallbackAllocateMemory allocate =
        functions && functions->allocateMemory ? functions->allocateMemory : calloc;
    struct idle *idle = allocate(1, sizeof *idle);
    if (idle != NULL) {
        idle->release = functions && functions->allocateMemory ? functions->freeMemory : free;
        fmi2Reset(idle);
    }
    return idle;
}

void fmi2FreeInstance(fmi2Component c)
{
    struct idle *idle = c;
    if (idle != NULL && idle->release != NULL) {
        idle->release(idle);
    }
}

fmi2Status fmi2Reset(fmi2Component c)
{
    struct idle *idle = c;
    memcpy(idle->values, start_values, sizeof start_values);
    idle->time = 0.0;
    idle->phase = INSTANTIATED;
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    struct idle *idle = c;
    (void)toleranceDefined;
    (void)tolerance;
    (void)stopTimeDefined;
    (void)stopTime;
    if (idle->phase != INSTANTIATED) {
        return fmi2Error;
    }
    idle->time = startTime;
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    struct idle *idle = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (idle->phase != STEPPING || !(communicationStepSize > 0.0) ||
        !(fabs(currentCommunicationPoint - idle->time) <= 1e-6 * communicationStepSize)) {
        return fmi2Error;
    }
    idle->time = currentCommunicationPoint + communicationStepSize;
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    const struct idle *idle = c;
    if (idle->phase == INSTANTIATED || vr == NULL || value == NULL) {
        return fmi2Error;
    }
    for (size_t i = 0; i < nvr; ++i) {
        if (vr[i] >= VALUES) {
            return fmi2Error;
        }
        value[i] = idle->values[vr[i]];
    }
    return fmi2OK;
}

/* Its start values are fixed: setting one before the start is allowed, as the standard has it, and kept. */
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    struct idle *idle = c;
    if (idle->phase >= STEPPING || vr == NULL || value == NULL) {
        return fmi2Error;
    }
    for (size_t i = 0; i < nvr; ++i) {
        if (vr[i] >= VALUES) {
            return fmi2Error;
        }
        idle->values[vr[i]] = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    const struct idle *idle = c;
    *value = idle->time;
    return s == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

static fmi2Status go_on(struct idle *idle, enum phase from, enum phase to)
{
    if (idle->phase != from) {
        return fmi2Error;
    }
    idle->phase = to;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return go_on(c, INSTANTIATED, INITIALIZATION);
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return go_on(c, INITIALIZATION, STEPPING);
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    return go_on(c, STEPPING, TERMINATED);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    (void)c;
    (void)loggingOn;
    (void)nCategories;
    (void)categories;
    return fmi2OK;
}
