#include "fmi3/call_order.h"

#include "math/compiler.h"

#define CALL3_RULE(function, phases) {"fmi3" #function, phases},
const struct call calls_of_fmi3[] = {CALL3_TABLE(CALL3_RULE)};
#undef CALL3_RULE

/* All functions of the standard, and those without a row, since they have no instance yet or no more. */
#define CALL3_EXPORT(function, phases) CONTACT_EXPORTED fmi3##function##TYPE fmi3##function;
CALL3_TABLE(CALL3_EXPORT)
#undef CALL3_EXPORT
CONTACT_EXPORTED fmi3GetVersionTYPE fmi3GetVersion;
CONTACT_EXPORTED fmi3InstantiateModelExchangeTYPE fmi3InstantiateModelExchange;
CONTACT_EXPORTED fmi3InstantiateCoSimulationTYPE fmi3InstantiateCoSimulation;
CONTACT_EXPORTED fmi3InstantiateScheduledExecutionTYPE fmi3InstantiateScheduledExecution;
CONTACT_EXPORTED fmi3FreeInstanceTYPE fmi3FreeInstance;
