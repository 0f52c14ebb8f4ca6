#include "arrays.h"

#include <stdlib.h>

#include "model/variable.h"
#include "scene.h"

enum { LONGEST_ARRAY = 6 };

/* Arrays of exactly the length they claim, or null pointers. */
struct arrays {
    size_t count;
    fmi2ValueReference *references;
    fmi2Integer *integers, *orders;
    fmi2Real *reals;
};

static void *room(struct bytes *b, size_t count, size_t size)
{
    return bytes_one(b) == 255 ? NULL : calloc(count > 0 ? count : 1, size);
}

static fmi2ValueReference any_reference(struct bytes *b)
{
    const unsigned index = bytes_one(b);
    return index < (unsigned)scene_variable_count ? scene_variables[index].reference : bytes_word(b);
}

static fmi2Integer any_integer(struct bytes *b)
{
    return bytes_choice(b, 2) ? (fmi2Integer)bytes_word(b) : (fmi2Integer)bytes_choice(b, 5);
}

static struct arrays any_arrays(struct bytes *b)
{
    struct arrays a = {.count = bytes_choice(b, LONGEST_ARRAY)};
    a.references = room(b, a.count, sizeof *a.references);
    a.integers = room(b, a.count, sizeof *a.integers);
    a.orders = room(b, a.count, sizeof *a.orders);
    a.reals = room(b, a.count, sizeof *a.reals);
    for (size_t i = 0; i < a.count; ++i) {
        const fmi2ValueReference reference = any_reference(b);
        if (a.references != NULL) {
            a.references[i] = reference;
        }
        if (a.integers != NULL) {
            a.integers[i] = any_integer(b);
            const struct variable *variable = scene_variable(reference);
            if (variable != NULL && variable->row == ROW_solver_max_internal_steps &&
                a.integers[i] > MOST_INTERNAL_STEPS) {
                a.integers[i] = MOST_INTERNAL_STEPS; /* an input has to end */
            }
        }
        if (a.orders != NULL) {
            a.orders[i] = (fmi2Integer)bytes_choice(b, 4);
        }
        if (a.reals != NULL) {
            a.reals[i] = bytes_real(b);
        }
    }
    return a;
}

static void free_arrays(struct arrays *a)
{
    free(a->references);
    free(a->integers);
    free(a->orders);
    free(a->reals);
}

fmi2Status arrays_call(fmi2Component c, struct bytes *b)
{
    const unsigned function = bytes_choice(b, 11);
    struct arrays a = any_arrays(b);
    fmi2String strings[LONGEST_ARRAY] = {"logAll", "logEvents", NULL, "log", "logStatusError", ""};
    fmi2Status status = fmi2OK;
    switch (function) {
    case 0:
        status = fmi2SetReal(c, a.references, a.count, a.reals);
        break;
    case 1:
        status = fmi2SetInteger(c, a.references, a.count, a.integers);
        break;
    case 2:
        status = fmi2SetBoolean(c, a.references, a.count, a.integers);
        break;
    case 3:
        status = fmi2SetString(c, a.references, a.count, strings);
        break;
    case 4:
        status = fmi2GetReal(c, a.references, a.count, a.reals);
        break;
    case 5:
        status = fmi2GetInteger(c, a.references, a.count, a.integers);
        break;
    case 6:
        status = fmi2GetBoolean(c, a.references, a.count, a.integers);
        break;
    case 7:
        status = fmi2GetString(c, a.references, a.count, strings);
        break;
    case 8:
        status = fmi2SetRealInputDerivatives(c, a.references, a.count, a.orders, a.reals);
        break;
    case 9:
        status = fmi2GetRealOutputDerivatives(c, a.references, a.count, a.orders, a.reals);
        break;
    default:
        status =
            fmi2GetDirectionalDerivative(c, a.references, a.count, a.references, a.count, a.reals, a.reals);
        break;
    }
    free_arrays(&a);
    return status;
}
