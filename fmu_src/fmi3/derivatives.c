/* Derivatives of outputs with respect to time. */
#include "fmi/derivatives.h"

#include "fmi3/call_order.h"
#include "fmi3/vectors.h"

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr,
                                    const fmi3Int32 orders[], fmi3Float64 values[], size_t count)
{
    struct instance *instance = c;
    const struct call *call = CALL3(GetOutputDerivatives);
    if (!call_allowed_in_steps(instance, call) ||
        !call_array_given(instance, call, "valueReferences", vr, nvr) ||
        !call_array_given(instance, call, "orders", orders, nvr) ||
        !call_array_given(instance, call, "values", values, count) ||
        !vectors_match(instance, call, vr, nvr, "nValues", count)) {
        return fmi3Error;
    }
    struct vector_walk walk = {vr, nvr, 0, 0};
    struct vector_chunk chunk;
    enum model_status status = MODEL_OK;
    for (size_t done = 0; done < count && status == MODEL_OK; done += chunk.count) {
        int order_of[VECTOR_CHUNK];
        vector_walk_next(&walk, &chunk);
        for (size_t i = 0; i < chunk.count; ++i) {
            order_of[i] = orders[chunk.origins[i]];
        }
        status = output_derivatives(instance, call, chunk.references, order_of, chunk.count, values + done);
    }
    return fmi3_status(status);
}
