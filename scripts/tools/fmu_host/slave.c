#include "slave.h"

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const status_names[] = {"fmi2OK",    "fmi2Warning", "fmi2Discard",
                                           "fmi2Error", "fmi2Fatal",   "fmi2Pending"};

/* The component environment is the slave; several messages of one call are kept as one text. */
static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                        fmi2String category, fmi2String format, ...)
{
    struct slave *slave = environment;
    (void)instance;
    (void)category;
    if (status == fmi2OK || !format) {
        return;
    }
    size_t used = strlen(slave->message);
    if (used > 0 && used + 1 < MESSAGE_SIZE) {
        slave->message[used++] = ' ';
        slave->message[used] = '\0';
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(slave->message + used, MESSAGE_SIZE - used, format, arguments);
    va_end(arguments);
}

/* Always false, so that a caller can return it. */
static bool fail(struct slave *slave, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(slave->failure, sizeof slave->failure, format, arguments);
    va_end(arguments);
    fprintf(stderr, "fmu_host: case %s: %s\n", slave->name, slave->failure);
    return false;
}

static bool find(struct slave *slave, void *function, const char *name)
{
    void *found = dlsym(slave->library, name);
    if (!found) {
        return fail(slave, "the library has no function %s", name);
    }
    memcpy(function, &found, sizeof found); /* ISO C knows no cast from void * to a function */
    return true;
}

static bool find_all(struct slave *slave)
{
    return find(slave, &slave->get_types_platform, "fmi2GetTypesPlatform") &&
           find(slave, &slave->get_version, "fmi2GetVersion") &&
           find(slave, &slave->instantiate, "fmi2Instantiate") &&
           find(slave, &slave->free_instance, "fmi2FreeInstance") &&
           find(slave, &slave->setup_experiment, "fmi2SetupExperiment") &&
           find(slave, &slave->enter_initialization_mode, "fmi2EnterInitializationMode") &&
           find(slave, &slave->exit_initialization_mode, "fmi2ExitInitializationMode") &&
           find(slave, &slave->terminate, "fmi2Terminate") && find(slave, &slave->reset, "fmi2Reset") &&
           find(slave, &slave->get_real, "fmi2GetReal") &&
           find(slave, &slave->get_integer, "fmi2GetInteger") &&
           find(slave, &slave->get_boolean, "fmi2GetBoolean") &&
           find(slave, &slave->set_real, "fmi2SetReal") &&
           find(slave, &slave->set_integer, "fmi2SetInteger") &&
           find(slave, &slave->set_boolean, "fmi2SetBoolean") &&
           find(slave, &slave->set_string, "fmi2SetString") && find(slave, &slave->do_step, "fmi2DoStep");
}

bool slave_load(struct slave *slave, const struct experiment *experiment)
{
    *slave = (struct slave){.name = experiment->name};
    slave->library = dlopen(experiment->library, RTLD_NOW | RTLD_LOCAL);
    if (!slave->library) {
        return fail(slave, "%s", dlerror());
    }
    if (!find_all(slave)) {
        return false;
    }
    const char *version = slave->get_version(), *platform = slave->get_types_platform();
    if (strncmp(version, "2.", 2) != 0 || strcmp(platform, fmi2TypesPlatform) != 0) {
        return fail(slave, "FMI version %s with types '%s'; expected 2.0 with '%s'", version, platform,
                    fmi2TypesPlatform);
    }
    return true;
}

bool slave_instantiate(struct slave *slave, const struct experiment *experiment)
{
    slave->message[0] = '\0';
    slave->callbacks = (fmi2CallbackFunctions){
        .logger = log_message, .allocateMemory = calloc, .freeMemory = free, .componentEnvironment = slave};
    slave->instance = slave->instantiate(
        experiment->name, experiment->integrator ? fmi2ModelExchange : fmi2CoSimulation, experiment->guid,
        experiment->resources ? experiment->resources : "", &slave->callbacks, fmi2False, fmi2False);
    if (!slave->instance) {
        fprintf(stderr, "fmu_host: case %s: fmi2Instantiate gave no instance: %s\n", slave->name,
                slave->message);
        return false;
    }
    return true;
}

bool slave_check(struct slave *slave, fmi2Status status, const char *function)
{
    if (status == fmi2OK || status == fmi2Warning) {
        slave->message[0] = '\0';
        return true;
    }
    const char *name =
        (unsigned)status < sizeof status_names / sizeof *status_names ? status_names[status] : "?";
    return fail(slave, "%s returned %s: %s", function, name,
                slave->message[0] ? slave->message : "no message");
}

void slave_free_instance(struct slave *slave)
{
    if (slave->instance) {
        slave->free_instance(slave->instance);
        slave->instance = NULL;
    }
}

void slave_unload(struct slave *slave)
{
    slave_free_instance(slave);
    if (slave->library) {
        dlclose(slave->library);
        slave->library = NULL;
    }
}
