#include "fmi2/adapter.h"

#include "fmi2/call_order.h"

static void fmi2_send(struct instance *instance, enum model_status status, const char *category,
                      const char *text)
{
    const fmi2CallbackFunctions *callbacks = &((const struct fmi2_instance *)instance)->callbacks;
    callbacks->logger(callbacks->componentEnvironment, instance->name, fmi2_status(status), category, text);
}

const struct adapter adapter_of_fmi2 = {
    .send = fmi2_send,
    /* The logger takes a printf format in which '#' marks value references (FMI 2.0.5). */
    .doubled = "%#",
    .type_names = {[VARIABLE_REAL] = "Real",
                   [VARIABLE_INTEGER] = "Integer",
                   [VARIABLE_BOOLEAN] = "Boolean",
                   [VARIABLE_ENUMERATION] = "Enumeration (fmi2Integer)"},
    .state_name = "FMUstate",
    .seed_name = "dvKnown",
    .state_magic = 0x544E4F43u, /* "CONT" on a little-endian machine */
    .state_phases = (PHASES2_ALL | PHASE_FATAL) & ~PHASES2_EXCHANGED,
    .exchange_phases = (PHASES2_ALL | PHASE_FATAL) & ~PHASE_STEP,
};
