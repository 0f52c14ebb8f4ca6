/* One FMU instance for FMI 2.0. */
#ifndef CONTACT_FMI2_INSTANCE_H
#define CONTACT_FMI2_INSTANCE_H

#include <fmi2Functions.h>

#include "fmi/instance.h"

/* An fmi2Component is the address of one. */
struct fmi2_instance {
    struct instance shared; /* comes first, so that both have one address */
    fmi2CallbackFunctions callbacks;
};

/* The model's statuses are fmi2Status values by another name. */
_Static_assert((int)MODEL_OK == (int)fmi2OK && (int)MODEL_WARNING == (int)fmi2Warning, "status order");
_Static_assert((int)MODEL_DISCARD == (int)fmi2Discard && (int)MODEL_ERROR == (int)fmi2Error, "status order");
_Static_assert((int)MODEL_FATAL == (int)fmi2Fatal, "status order");

static inline fmi2Status fmi2_status(enum model_status status)
{
    return (fmi2Status)status;
}

#endif
