#include "fmi3/call_order.h"

#define CALL_RULE(function, phases) {"fmi3" #function, phases},
const struct call calls_of_fmi3[] = {CALL_TABLE(CALL_RULE)};
#undef CALL_RULE
