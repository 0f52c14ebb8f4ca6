#include "fmi2/call_order.h"

#include "math/compiler.h"

#define CALL2_RULE(function, phases) {"fmi2" #function, phases},
const struct call calls_of_fmi2[] = {CALL2_TABLE(CALL2_RULE)};
#undef CALL2_RULE

/* All functions of the standard, and those without a row, since they have no instance yet or no more. */
#define CALL2_EXPORT(function, phases) CONTACT_EXPORTED fmi2##function##TYPE fmi2##function;
CALL2_TABLE(CALL2_EXPORT)
#undef CALL2_EXPORT
CONTACT_EXPORTED fmi2GetTypesPlatformTYPE fmi2GetTypesPlatform;
CONTACT_EXPORTED fmi2GetVersionTYPE fmi2GetVersion;
CONTACT_EXPORTED fmi2InstantiateTYPE fmi2Instantiate;
CONTACT_EXPORTED fmi2FreeInstanceTYPE fmi2FreeInstance;
