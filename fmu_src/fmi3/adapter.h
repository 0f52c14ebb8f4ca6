/* What is FMI 3.0's own in messages, names and saved states. */
#ifndef CONTACT_FMI3_ADAPTER_H
#define CONTACT_FMI3_ADAPTER_H

#include "fmi/instance.h"

extern const struct adapter adapter_of_fmi3;

#endif
