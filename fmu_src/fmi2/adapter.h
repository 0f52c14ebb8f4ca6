/* What is FMI 2.0's own in messages, names and saved states. */
#ifndef CONTACT_FMI2_ADAPTER_H
#define CONTACT_FMI2_ADAPTER_H

#include "fmi/instance.h"

extern const struct adapter adapter_of_fmi2;

#endif
