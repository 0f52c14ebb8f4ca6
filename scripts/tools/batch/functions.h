/* The functions of an FMU's library that a run needs, and its messages. */
#ifndef CONTACT_BATCH_FUNCTIONS_H
#define CONTACT_BATCH_FUNCTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "fmi2FunctionTypes.h"

struct functions {
    void *library;
    fmi2InstantiateTYPE *instantiate;
    fmi2FreeInstanceTYPE *free_instance;
    fmi2SetupExperimentTYPE *setup_experiment;
    fmi2EnterInitializationModeTYPE *enter_initialization_mode;
    fmi2ExitInitializationModeTYPE *exit_initialization_mode;
    fmi2ResetTYPE *reset;
    fmi2GetRealTYPE *get_real;
    fmi2GetIntegerTYPE *get_integer;
    fmi2GetBooleanTYPE *get_boolean;
    fmi2SetRealTYPE *set_real;
    fmi2SetIntegerTYPE *set_integer;
    fmi2SetBooleanTYPE *set_boolean;
    fmi2SetStringTYPE *set_string;
    fmi2DoStepTYPE *do_step;
};

/* False with the reason in `failure`; functions_unload() in either case. */
bool functions_load(struct functions *functions, const char *library, char *failure, size_t size);
void functions_unload(struct functions *functions);

#endif
