#include "fmi3/vectors.h"

#include "fmi/log.h"
#include "fmi/variables.h"

const struct variable *vector_variable(uint32_t reference)
{
    const struct variable *variable = scene_variable(reference);
    return variable != NULL && variable->component == 0 ? variable : NULL;
}

size_t vector_length(const struct variable *first)
{
    const struct variable *end = scene_variables + scene_variable_count;
    size_t length = 1;
    while (first + length < end && first[length].row == first->row &&
           first[length].element == first->element && first[length].component == length) {
        ++length;
    }
    return length;
}

bool vectors_match(struct instance *instance, const struct call *call, const uint32_t *references,
                   size_t count, const char *values_name, size_t values)
{
    size_t components = 0;
    for (size_t i = 0; i < count; ++i) {
        const struct variable *variable = vector_variable(references[i]);
        if (variable == NULL) {
            report_wrong_reference(instance, call, NULL, references[i]);
            return false;
        }
        components += vector_length(variable);
    }
    if (components != values) {
        log_report(instance, MODEL_ERROR, "%s: %s = %lu, expected %lu for the %lu value references",
                   call->name, values_name, (unsigned long)values, (unsigned long)components,
                   (unsigned long)count);
        return false;
    }
    return true;
}

void vector_walk_next(struct vector_walk *walk, struct vector_chunk *chunk)
{
    chunk->count = 0;
    while (walk->at < walk->count && chunk->count < VECTOR_CHUNK) {
        const struct variable *first = vector_variable(walk->references[walk->at]);
        chunk->references[chunk->count] = first[walk->component].reference;
        chunk->origins[chunk->count] = walk->at;
        chunk->count += 1;
        walk->component += 1;
        if (walk->component == vector_length(first)) {
            walk->component = 0;
            walk->at += 1;
        }
    }
}
