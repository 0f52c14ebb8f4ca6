/* Adjoint derivatives, column by column of the directional ones: there are few inputs, and each column costs
 * as much as reading all outputs. */
#include <math.h>

#include "model/state.h"

/* J's column of one known, multiplied by the seed. */
static enum model_status add_column(struct model *m, const uint32_t *unknowns, size_t unknown_count,
                                    const uint32_t *known, const double *seed, double *value)
{
    const double one = 1.0;
    double column[MODEL_ADJOINT_MOST];
    const enum model_status status =
        model_get_directional_derivative(m, unknowns, unknown_count, known, 1, &one, column);
    *value = 0.0;
    for (size_t i = 0; i < unknown_count && status == MODEL_OK; ++i) {
        *value += seed[i] * column[i];
    }
    return status == MODEL_OK && !isfinite(*value)
               ? model_report(m, MODEL_DISCARD,
                              "An adjoint derivative with respect to %s is beyond the range of numbers "
                              "(allowed: finite).",
                              scene_variable(*known)->name)
               : status;
}

enum model_status model_get_adjoint_derivative(struct model *m, const uint32_t *unknowns,
                                               size_t unknown_count, const uint32_t *knowns,
                                               size_t known_count, const double *seed, double *values)
{
    enum model_status status = MODEL_OK;
    for (size_t i = 0; i < known_count && status == MODEL_OK; ++i) {
        status = add_column(m, unknowns, unknown_count, knowns + i, seed, values + i);
    }
    return status;
}
