/* Saved states by the names of FMI 2.0. */
#include "fmi/state_block.h"
#include "fmi2/call_order.h"

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return fmi2_status(state_block_get(c, CALL2(GetFMUstate), FMUstate));
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    return fmi2_status(state_block_set(c, CALL2(SetFMUstate), FMUstate));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return fmi2_status(state_block_free(c, CALL2(FreeFMUstate), FMUstate));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    return fmi2_status(state_block_size(c, CALL2(SerializedFMUstateSize), FMUstate, size));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[],
                                 size_t size)
{
    return fmi2_status(state_block_serialize(c, CALL2(SerializeFMUstate), FMUstate, serializedState, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    return fmi2_status(
        state_block_deserialize(c, CALL2(DeSerializeFMUstate), serializedState, size, FMUstate));
}
