/* What arrays.c and arrays3.c share: room for an array, references of any kind, numbers that are finite. */
#ifndef FUZZ_ARRAYS_H
#define FUZZ_ARRAYS_H

#include <stdlib.h>

#include "model/variable.h"
#include "players.h"
#include "scene.h"

enum { LONGEST_ARRAY = 6 };

/* Seldom none. */
static void *room(struct bytes *b, size_t count, size_t size)
{
    return bytes_one(b) == 255 ? NULL : calloc(count > 0 ? count : 1, size);
}

static FMI(ValueReference) any_reference(struct bytes *b)
{
    const unsigned index = bytes_one(b);
    return index < (unsigned)scene_variable_count ? scene_variables[index].reference : bytes_word(b);
}

static void claim_numbers(fmi_status status, const double *values, size_t count)
{
    for (size_t i = 0; i < count && status <= FMI(Warning); ++i) {
        CLAIM(isfinite(values[i]));
    }
}

#endif
