/* One FMU: its library, its functions, an instance of it and what it logged. */
#ifndef FMU_HOST_SLAVE_H
#define FMU_HOST_SLAVE_H

#include <stdbool.h>

#include "fmi2FunctionTypes.h"
#include "options.h"

enum { MESSAGE_SIZE = 1000 };

struct slave {
    const char *name; /* of the case */
    void *library;
    fmi2Component instance;
    fmi2CallbackFunctions callbacks; /* lives as long as the instance */
    char message[MESSAGE_SIZE];      /* what it logged during the present call */
    char failure[2 * MESSAGE_SIZE];  /* why the case failed */

    fmi2GetTypesPlatformTYPE *get_types_platform;
    fmi2GetVersionTYPE *get_version;
    fmi2InstantiateTYPE *instantiate;
    fmi2FreeInstanceTYPE *free_instance;
    fmi2SetupExperimentTYPE *setup_experiment;
    fmi2EnterInitializationModeTYPE *enter_initialization_mode;
    fmi2ExitInitializationModeTYPE *exit_initialization_mode;
    fmi2TerminateTYPE *terminate;
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

/* These return false after a message on stderr, kept as `failure`, that names the case and what the FMU
 * said. */
bool slave_load(struct slave *slave, const struct experiment *experiment);
bool slave_instantiate(struct slave *slave, const struct experiment *experiment);
bool slave_check(struct slave *slave, fmi2Status status, const char *function);

void slave_free_instance(struct slave *slave);
void slave_unload(struct slave *slave); /* frees the instance too */

#endif
