#include "fmi3/adapter.h"

#include "fmi3/call_order.h"

static void fmi3_send(struct instance *instance, enum model_status status, const char *category,
                      const char *text)
{
    const struct fmi3_instance *own = (const struct fmi3_instance *)instance;
    own->log_message(own->environment, fmi3_status(status), category, text);
}

const struct adapter adapter_of_fmi3 = {
    .send = fmi3_send,
    .doubled = "", /* the message is plain text */
    .type_names = {[VARIABLE_REAL] = "Float64",
                   [VARIABLE_INTEGER] = "Int32",
                   [VARIABLE_BOOLEAN] = "Boolean",
                   [VARIABLE_ENUMERATION] = "Enumeration (fmi3Int64)"},
    .state_name = "FMUState",
    .seed_name = "seed",
    .state_magic = 0x334E4F43u, /* "CON3" on a little-endian machine */
    .state_phases = (PHASES3_ALL | PHASE_FATAL) & ~PHASE_CONTINUOUS,
    .exchange_phases = (PHASES3_ALL | PHASE_FATAL) & ~PHASE_STEP,
    .knows_states_in_steps = true,
};
