/* One FMU instance for FMI 3.0. */
#ifndef CONTACT_FMI3_INSTANCE_H
#define CONTACT_FMI3_INSTANCE_H

#include <fmi3Functions.h>

#include "fmi/instance.h"

/* An fmi3Instance is the address of one. */
struct fmi3_instance {
    struct instance shared; /* comes first, so that both have one address */
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log_message;
    fmi3IntermediateUpdateCallback intermediate_update; /* NULL: none */
    bool event_mode_used;
    bool early_return_allowed;
    double event_time; /* of the last event in the last step [s]; NaN: there was none */
};

/* The model's statuses are fmi3Status values by another name. */
_Static_assert((int)MODEL_OK == (int)fmi3OK && (int)MODEL_WARNING == (int)fmi3Warning, "status order");
_Static_assert((int)MODEL_DISCARD == (int)fmi3Discard && (int)MODEL_ERROR == (int)fmi3Error, "status order");
_Static_assert((int)MODEL_FATAL == (int)fmi3Fatal, "status order");

static inline fmi3Status fmi3_status(enum model_status status)
{
    return (fmi3Status)status;
}

#endif
