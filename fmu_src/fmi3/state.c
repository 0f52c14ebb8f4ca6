/* Saved states by the names of FMI 3.0. */
#include "fmi/state_block.h"
#include "fmi3/call_order.h"

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *FMUState)
{
    return fmi3_status(state_block_get(c, CALL3(GetFMUState), FMUState));
}

/* A state of another instance of Co-Simulation may be one of event mode, which this one may not have. */
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState FMUState)
{
    struct fmi3_instance *own = c;
    const enum model_status status = state_block_set(c, CALL3(SetFMUState), FMUState);
    if (status <= MODEL_WARNING && own->shared.phase == PHASE_EVENT && !own->shared.host.exchange &&
        !own->event_mode_used) {
        own->shared.phase = PHASE_STEP;
    }
    return fmi3_status(status);
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *FMUState)
{
    return fmi3_status(state_block_free(c, CALL3(FreeFMUState), FMUState));
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState FMUState, size_t *size)
{
    return fmi3_status(state_block_size(c, CALL3(SerializedFMUStateSize), FMUState, size));
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState FMUState, fmi3Byte serializedState[],
                                 size_t size)
{
    return fmi3_status(state_block_serialize(c, CALL3(SerializeFMUState), FMUState, serializedState, size));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte serializedState[], size_t size,
                                   fmi3FMUState *FMUState)
{
    return fmi3_status(
        state_block_deserialize(c, CALL3(DeserializeFMUState), serializedState, size, FMUState));
}
