/* Arguments of the FMI 2.0 functions that take arrays: any references and values, arrays that are missing. */
#include "arrays.h"

/* Arrays of exactly the length they claim, or null pointers. */
struct arrays {
    size_t count;
    fmi2ValueReference *references;
    fmi2Integer *integers, *orders;
    fmi2Real *reals;
};

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

/* The next variable of that kind from a random one on; there is one in every scene. */
static fmi2ValueReference any_real_of(struct bytes *b, enum variable_causality causality)
{
    int i = bytes_one(b) % scene_variable_count;
    while (scene_variables[i].causality != causality || scene_variables[i].type != VARIABLE_REAL) {
        i = (i + 1) % scene_variable_count;
    }
    return scene_variables[i].reference;
}

/* Of outputs with respect to inputs, or of anything to anything; numbers where it is answered. */
static fmi2Status any_directional_derivative(fmi2Component c, const struct arrays *unknown, struct bytes *b)
{
    struct arrays known = any_arrays(b);
    const bool sensible = bytes_one(b) < 250;
    for (size_t i = 0; sensible && unknown->references != NULL && i < unknown->count; ++i) {
        unknown->references[i] = any_real_of(b, VARIABLE_OUTPUT);
    }
    for (size_t i = 0; sensible && known.references != NULL && i < known.count; ++i) {
        known.references[i] = any_real_of(b, VARIABLE_INPUT);
    }
    const fmi2Status status = fmi2GetDirectionalDerivative(
        c, unknown->references, unknown->count, known.references, known.count, known.reals, unknown->reals);
    claim_numbers(status, unknown->reals, unknown->count);
    free_arrays(&known);
    return status;
}

static fmi2Status array_call(fmi2Component c, unsigned function, struct arrays *a, struct bytes *b)
{
    fmi2String strings[LONGEST_ARRAY] = {"logAll", "logEvents", NULL, "log", "logStatusError", ""};
    switch (function) {
    case 0:
        return fmi2SetReal(c, a->references, a->count, a->reals);
    case 1:
        return fmi2SetInteger(c, a->references, a->count, a->integers);
    case 2:
        return fmi2SetBoolean(c, a->references, a->count, a->integers);
    case 3:
        return fmi2SetString(c, a->references, a->count, strings);
    case 4:
        return fmi2GetReal(c, a->references, a->count, a->reals);
    case 5:
        return fmi2GetInteger(c, a->references, a->count, a->integers);
    case 6:
        return fmi2GetBoolean(c, a->references, a->count, a->integers);
    case 7:
        return fmi2GetString(c, a->references, a->count, strings);
    case 8:
        return fmi2SetRealInputDerivatives(c, a->references, a->count, a->orders, a->reals);
    case 9:
        return fmi2GetRealOutputDerivatives(c, a->references, a->count, a->orders, a->reals);
    default:
        return any_directional_derivative(c, a, b);
    }
}

fmi_status arrays_call(struct player *player, struct bytes *b)
{
    fmi2Component c = player->instance;
    const unsigned function = bytes_choice(b, 11);
    struct arrays a = any_arrays(b);
    const fmi2Status status = array_call(c, function, &a, b);
    if (function == 9) {
        claim_numbers(status, a.reals, a.count);
    }
    free_arrays(&a);
    return status;
}

fmi_status arrays_set_one(struct player *player, struct bytes *b)
{
    fmi2Component c = player->instance;
    const struct variable *variable = &scene_variables[bytes_one(b) % (unsigned)scene_variable_count];
    if (variable->type == VARIABLE_REAL) {
        const fmi2Real value = bytes_real(b);
        return fmi2SetReal(c, &variable->reference, 1, &value);
    }
    const fmi2Integer value = (fmi2Integer)bytes_choice(b, 5);
    return variable->type == VARIABLE_BOOLEAN ? fmi2SetBoolean(c, &variable->reference, 1, &value)
                                              : fmi2SetInteger(c, &variable->reference, 1, &value);
}
