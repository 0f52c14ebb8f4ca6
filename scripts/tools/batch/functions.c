#include "functions.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

static bool find(const struct functions *functions, void *function, const char *name, char *failure,
                 size_t size)
{
    void *found = dlsym(functions->library, name);
    if (!found) {
        snprintf(failure, size, "the FMU's library has no function %s", name);
        return false;
    }
    memcpy(function, &found, sizeof found); /* ISO C knows no cast from void * to a function */
    return true;
}

bool functions_load(struct functions *functions, const char *library, char *failure, size_t size)
{
    *functions = (struct functions){0};
    functions->library = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (!functions->library) {
        const char *reason = dlerror();
        snprintf(failure, size, "%s", reason ? reason : "the FMU's library cannot be loaded");
        return false;
    }
    const struct {
        void *function;
        const char *name;
    } wanted[] = {
        {&functions->instantiate, "fmi2Instantiate"},
        {&functions->free_instance, "fmi2FreeInstance"},
        {&functions->setup_experiment, "fmi2SetupExperiment"},
        {&functions->enter_initialization_mode, "fmi2EnterInitializationMode"},
        {&functions->exit_initialization_mode, "fmi2ExitInitializationMode"},
        {&functions->reset, "fmi2Reset"},
        {&functions->get_real, "fmi2GetReal"},
        {&functions->get_integer, "fmi2GetInteger"},
        {&functions->get_boolean, "fmi2GetBoolean"},
        {&functions->set_real, "fmi2SetReal"},
        {&functions->set_integer, "fmi2SetInteger"},
        {&functions->set_boolean, "fmi2SetBoolean"},
        {&functions->set_string, "fmi2SetString"},
        {&functions->do_step, "fmi2DoStep"},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        if (!find(functions, wanted[i].function, wanted[i].name, failure, size)) {
            return false;
        }
    }
    return true;
}

void functions_unload(struct functions *functions)
{
    if (functions->library) {
        dlclose(functions->library);
        functions->library = NULL;
    }
}
