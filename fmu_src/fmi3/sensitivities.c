/*
 * Derivatives of outputs with respect to inputs, along a direction of inputs and, adjoint, of outputs.
 * Vectors are taken apart into chunks of components on the stack, and the products of the chunks summed up.
 */
#include "fmi/derivatives.h"
#include "fmi3/call_order.h"
#include "fmi3/vectors.h"

/* The unknowns and knowns of a matrix J of derivatives, and what it is multiplied with and gives. */
struct product {
    bool adjoint; /* seed J, with a seed for each unknown; else J seed, with one for each known */
    const fmi3ValueReference *unknowns, *knowns;
    size_t unknown_count, known_count;           /* references */
    size_t unknown_components, known_components; /* as the importer counts them */
    const fmi3Float64 *seed;
    fmi3Float64 *sensitivity;
};

static bool arrays_in_order(struct instance *instance, const struct call *call, const struct product *p)
{
    const size_t seeds = p->adjoint ? p->unknown_components : p->known_components;
    const size_t sensitivities = p->adjoint ? p->known_components : p->unknown_components;
    return call_array_given(instance, call, "unknowns", p->unknowns, p->unknown_count) &&
           call_array_given(instance, call, "knowns", p->knowns, p->known_count) &&
           call_array_given(instance, call, "seed", p->seed, seeds) &&
           call_array_given(instance, call, "sensitivity", p->sensitivity, sensitivities) &&
           vectors_match(instance, call, p->unknowns, p->unknown_count, p->adjoint ? "nSeed" : "nSensitivity",
                         p->unknown_components) &&
           vectors_match(instance, call, p->knowns, p->known_count, p->adjoint ? "nSensitivity" : "nSeed",
                         p->known_components);
}

static enum model_status check_seeds(struct instance *instance, const struct call *call,
                                     const fmi3ValueReference references[], size_t count,
                                     const fmi3Float64 seed[])
{
    struct vector_walk walk = {references, count, 0, 0};
    struct vector_chunk chunk;
    enum model_status status = MODEL_OK;
    for (vector_walk_next(&walk, &chunk); chunk.count > 0; vector_walk_next(&walk, &chunk)) {
        for (size_t i = 0; i < chunk.count && status == MODEL_OK; ++i) {
            status = check_seed(instance, call, chunk.references[i], *seed++);
        }
    }
    return status;
}

static enum model_status check_product(struct instance *instance, const struct call *call,
                                       const struct product *p)
{
    enum model_status status = check_unknowns(instance, call, p->unknowns, p->unknown_count);
    for (size_t i = 0; i < p->known_count && status == MODEL_OK; ++i) {
        status = check_known(instance, call, p->knowns[i]);
    }
    if (status != MODEL_OK) {
        return status;
    }
    return p->adjoint ? check_seeds(instance, call, p->unknowns, p->unknown_count, p->seed)
                      : check_seeds(instance, call, p->knowns, p->known_count, p->seed);
}

/* Sets the first chunk's part of a sum, or adds a later one's: 0 + x would lose the sign of a zero. */
static void add_up(double *sum, const double *part, size_t count, bool first)
{
    for (size_t i = 0; i < count; ++i) {
        sum[i] = first ? part[i] : sum[i] + part[i];
    }
}

/* An importer's array from an element on; it may be missing where there are none. */
static const double *given_from(const double *array, size_t at)
{
    return at > 0 ? array + at : array;
}

static double *room_from(double *array, size_t at)
{
    return at > 0 ? array + at : array;
}

static enum model_status multiply(struct instance *instance, const struct product *p)
{
    struct vector_walk unknowns = {p->unknowns, p->unknown_count, 0, 0};
    struct vector_chunk unknown, known;
    enum model_status status = MODEL_OK;
    size_t row = 0;
    do {
        struct vector_walk knowns = {p->knowns, p->known_count, 0, 0};
        size_t column = 0;
        vector_walk_next(&unknowns, &unknown);
        do {
            double part[VECTOR_CHUNK];
            vector_walk_next(&knowns, &known);
            if (p->adjoint) {
                status = model_get_adjoint_derivative(instance->model, unknown.references, unknown.count,
                                                      known.references, known.count, given_from(p->seed, row),
                                                      part);
                add_up(room_from(p->sensitivity, column), part, known.count, row == 0);
            } else {
                status = model_get_directional_derivative(instance->model, unknown.references, unknown.count,
                                                          known.references, known.count,
                                                          given_from(p->seed, column), part);
                add_up(room_from(p->sensitivity, row), part, unknown.count, column == 0);
            }
            column += known.count;
        } while (status <= MODEL_WARNING && column < p->known_components);
        row += unknown.count;
    } while (status <= MODEL_WARNING && row < p->unknown_components);
    return status;
}

static fmi3Status product(struct instance *instance, const struct call *call, const struct product *p)
{
    if (!call_allowed(instance, call) || !arrays_in_order(instance, call, p)) {
        return fmi3Error;
    }
    const enum model_status status = check_product(instance, call, p);
    return fmi3_status(status == MODEL_OK ? multiply(instance, p) : status);
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                        const fmi3ValueReference knowns[], size_t nKnowns,
                                        const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[],
                                        size_t nSensitivity)
{
    const struct product p = {.adjoint = false,
                              .unknowns = unknowns,
                              .knowns = knowns,
                              .unknown_count = nUnknowns,
                              .known_count = nKnowns,
                              .unknown_components = nSensitivity,
                              .known_components = nSeed,
                              .seed = seed,
                              .sensitivity = sensitivity};
    return product(c, CALL3(GetDirectionalDerivative), &p);
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                    const fmi3ValueReference knowns[], size_t nKnowns,
                                    const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[],
                                    size_t nSensitivity)
{
    const struct product p = {.adjoint = true,
                              .unknowns = unknowns,
                              .knowns = knowns,
                              .unknown_count = nUnknowns,
                              .known_count = nKnowns,
                              .unknown_components = nSeed,
                              .known_components = nSensitivity,
                              .seed = seed,
                              .sensitivity = sensitivity};
    return product(c, CALL3(GetAdjointDerivative), &p);
}
