#include "fmi2/call_order.h"

#define CALL_RULE(function, phases) {"fmi2" #function, phases},
const struct call calls_of_fmi2[] = {CALL_TABLE(CALL_RULE)};
#undef CALL_RULE
