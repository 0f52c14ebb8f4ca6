/*
 * What an FMU costs: cost_host LIBRARY TOKEN RESOURCES 2|3 lives COUNT
 *                    cost_host LIBRARY TOKEN RESOURCES 2|3 steps COUNT VALUE_REFERENCE
 *
 * lives   instances made, initialized and freed
 * steps   of 0.001 s in one instance, the source's centre, whose (first) value reference is given, 1e6 m away
 *
 * Instructions are counted in life() and step(), by callgrind's --toggle-collect.
 */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"
#include "fmi3FunctionTypes.h"

static const double STEP = 1e-3;           /* [s] */
static const double AWAY[3] = {1e6, 0, 0}; /* [m] */

static void *library;
static const char *token, *resources;

static void *symbol(const char *name)
{
    void *found = dlsym(library, name);
    if (found == NULL) {
        fprintf(stderr, "cost_host: there is no %s\n", name);
        exit(2);
    }
    return found;
}

static void check(int status, const char *what)
{
    if (status != 0) {
        fprintf(stderr, "cost_host: %s: status %d\n", what, status);
        exit(3);
    }
}

static void say2(fmi2ComponentEnvironment who, fmi2String name, fmi2Status status, fmi2String category,
                 fmi2String message, ...)
{
    (void)who, (void)name, (void)status, (void)category;
    fprintf(stderr, "%s\n", message);
}

static void say3(fmi3InstanceEnvironment who, fmi3Status status, fmi3String category, fmi3String message)
{
    (void)who, (void)status, (void)category;
    fprintf(stderr, "%s\n", message);
}

static const fmi2CallbackFunctions callbacks2 = {say2, calloc, free, NULL, NULL};

/* The functions of one version of FMI that are called here, under names of both. */
struct functions {
    void *instantiate, *setup, *enter, *leave, *set, *step, *end;
};

static struct functions functions_of(int version)
{
    if (version == 2) {
        return (struct functions){symbol("fmi2Instantiate"),
                                  symbol("fmi2SetupExperiment"),
                                  symbol("fmi2EnterInitializationMode"),
                                  symbol("fmi2ExitInitializationMode"),
                                  symbol("fmi2SetReal"),
                                  symbol("fmi2DoStep"),

                                  symbol("fmi2FreeInstance")};
    }
    return (struct functions){symbol("fmi3InstantiateCoSimulation"),
                              NULL,
                              symbol("fmi3EnterInitializationMode"),
                              symbol("fmi3ExitInitializationMode"),
                              symbol("fmi3SetFloat64"),
                              symbol("fmi3DoStep"),

                              symbol("fmi3FreeInstance")};
}

/* away: a value reference, or below 0 to leave the source where it is */
static void *begin2(const struct functions *f, long away)
{
    void *c = ((fmi2InstantiateTYPE *)f->instantiate)("cost", fmi2CoSimulation, token, resources, &callbacks2,
                                                      fmi2False, fmi2False);
    check(c == NULL, "fmi2Instantiate");
    if (away >= 0) {
        const fmi2ValueReference vr[] = {(unsigned)away, (unsigned)away + 1, (unsigned)away + 2};
        check(((fmi2SetRealTYPE *)f->set)(c, vr, 3, AWAY), "fmi2SetReal");
    }
    check(((fmi2SetupExperimentTYPE *)f->setup)(c, fmi2False, 0, 0, fmi2False, 0), "fmi2SetupExperiment");
    check(((fmi2EnterInitializationModeTYPE *)f->enter)(c), "fmi2EnterInitializationMode");
    check(((fmi2ExitInitializationModeTYPE *)f->leave)(c), "fmi2ExitInitializationMode");
    return c;
}

static void *begin3(const struct functions *f, long away)
{
    void *c = ((fmi3InstantiateCoSimulationTYPE *)f->instantiate)(
        "cost", token, resources, fmi3False, fmi3False, fmi3False, fmi3False, NULL, 0, NULL, say3, NULL);
    check(c == NULL, "fmi3InstantiateCoSimulation");
    if (away >= 0) {
        const fmi3ValueReference vr = (unsigned)away;
        check(((fmi3SetFloat64TYPE *)f->set)(c, &vr, 1, AWAY, 3), "fmi3SetFloat64");
    }
    check(((fmi3EnterInitializationModeTYPE *)f->enter)(c, fmi3False, 0, 0, fmi3False, 0),
          "fmi3EnterInitializationMode");
    check(((fmi3ExitInitializationModeTYPE *)f->leave)(c), "fmi3ExitInitializationMode");
    return c;
}

static void *begin(const struct functions *f, int version, long away)
{
    return version == 2 ? begin2(f, away) : begin3(f, away);
}

static void end(const struct functions *f, int version, void *c)
{
    if (version == 2) {
        ((fmi2FreeInstanceTYPE *)f->end)(c);
    } else {
        ((fmi3FreeInstanceTYPE *)f->end)(c);
    }
}

__attribute__((noinline)) void life(const struct functions *f, int version);
__attribute__((noinline)) void step(const struct functions *f, int version, void *c, double time);

void life(const struct functions *f, int version)
{
    end(f, version, begin(f, version, -1));
}

void step(const struct functions *f, int version, void *c, double time)
{
    if (version == 2) {
        check(((fmi2DoStepTYPE *)f->step)(c, time, STEP, fmi2True), "fmi2DoStep");
        return;
    }
    fmi3Boolean event, ended, early;
    fmi3Float64 last;
    check(((fmi3DoStepTYPE *)f->step)(c, time, STEP, fmi3True, &event, &ended, &early, &last), "fmi3DoStep");
}

int main(int argc, char **argv)
{
    if (argc < 7) {
        fprintf(stderr, "cost_host: too few arguments\n");
        return 2;
    }
    library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        fprintf(stderr, "cost_host: %s\n", dlerror());
        return 2;
    }
    token = argv[2];
    resources = argv[3];
    const int version = atoi(argv[4]);
    const long count = atol(argv[6]);
    const struct functions f = functions_of(version);
    if (strcmp(argv[5], "lives") == 0) {
        for (long k = 0; k < count; k++) {
            life(&f, version);
        }
        return 0;
    }
    void *c = begin(&f, version, atol(argv[7]));
    for (long k = 0; k < count; k++) {
        step(&f, version, c, (double)k * STEP);
    }
    end(&f, version, c);
    return 0;
}
