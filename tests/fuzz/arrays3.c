/* Arguments of the FMI 3.0 functions that take arrays: any references, types, values and lengths */
#include "arrays.h"

/* Types by name, in the order in which they are chosen: those that variables have come first. */
#define TYPES(ROW)                                                                                           \
    ROW(Float64)                                                                                             \
    ROW(Int32)                                                                                               \
    ROW(Int64)                                                                                               \
    ROW(Boolean)                                                                                             \
    ROW(Float32)                                                                                             \
    ROW(Int8)                                                                                                \
    ROW(UInt8)                                                                                               \
    ROW(Int16)                                                                                               \
    ROW(UInt16)                                                                                              \
    ROW(UInt32)                                                                                              \
    ROW(UInt64)                                                                                              \
    ROW(String)
#define TYPE_NAME(Type) TYPE_##Type,
enum type { TYPES(TYPE_NAME) TYPE_COUNT };
#define TYPE_SIZE(Type) sizeof(fmi3##Type),
static const size_t type_sizes[] = {TYPES(TYPE_SIZE)};

static enum type type_of(const struct variable *variable)
{
    static const enum type types[] = {[VARIABLE_REAL] = TYPE_Float64,
                                      [VARIABLE_INTEGER] = TYPE_Int32,
                                      [VARIABLE_BOOLEAN] = TYPE_Boolean,
                                      [VARIABLE_ENUMERATION] = TYPE_Int64};
    return types[variable->type];
}

/* References, and an array of as many values as they have components, or of another length. */
struct arrays3 {
    size_t count, values_count;
    fmi3ValueReference *references;
    fmi3Int32 *orders;
    void *values;
};

/* The next variable of that type and causality from a random one on; any reference where there is none. */
static fmi3ValueReference any_of(struct bytes *b, enum variable_type type, unsigned causalities)
{
    const int first = bytes_one(b) % scene_variable_count;
    for (int k = 0; k < scene_variable_count; ++k) {
        const struct variable *variable = &scene_variables[(first + k) % scene_variable_count];
        if (variable->component == 0 && variable->type == (uint8_t)type &&
            (causalities >> variable->causality & 1u) != 0) {
            return variable->reference;
        }
    }
    return bytes_word(b);
}

/* Components of all references; one for a reference of nothing. */
static size_t components_of(const fmi3ValueReference *references, size_t count)
{
    size_t sum = 0;
    for (size_t i = 0; references != NULL && i < count; ++i) {
        const struct variable *first = vector_variable(references[i]);
        sum += first == NULL ? 1 : first->length;
    }
    return sum;
}

/* Of choices and counters the extremes are all below their range, so that no step is long. */
static void fill(struct bytes *b, enum type type, void *values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        switch (type) {
        case TYPE_Float64:
            ((fmi3Float64 *)values)[i] = bytes_real(b);
            break;
        case TYPE_Int32:
            ((fmi3Int32 *)values)[i] =
                bytes_choice(b, 4) == 3 ? INT32_MIN : (fmi3Int32)bytes_choice(b, MOST_INTERNAL_STEPS + 1);
            break;
        case TYPE_Int64:
            ((fmi3Int64 *)values)[i] = bytes_choice(b, 4) == 3
                                           ? (fmi3Int64)(bytes_real(b) < 0.0 ? INT64_MIN : INT64_MAX)
                                           : (fmi3Int64)bytes_choice(b, 5);
            break;
        case TYPE_Boolean:
            ((fmi3Boolean *)values)[i] = bytes_choice(b, 2) != 0;
            break;
        default:
            break; /* no variable has such a type; zeros */
        }
    }
}

/* Mostly variables of the type, and the right number of values. */
static struct arrays3 any_arrays(struct bytes *b, enum type type, unsigned causalities)
{
    static const enum variable_type types[] = {VARIABLE_REAL, VARIABLE_INTEGER, VARIABLE_ENUMERATION,
                                               VARIABLE_BOOLEAN};
    struct arrays3 a = {.count = bytes_choice(b, LONGEST_ARRAY)};
    const unsigned odd = bytes_one(b);
    a.references = room(b, a.count, sizeof *a.references);
    a.orders = calloc(LONGEST_ARRAY, sizeof *a.orders);
    for (size_t i = 0; a.references != NULL && i < a.count; ++i) {
        const bool sensible = odd < 200 && type <= TYPE_Boolean;
        a.references[i] = sensible ? any_of(b, types[type], causalities) : any_reference(b);
        a.orders[i] = (fmi3Int32)bytes_choice(b, 4);
    }
    a.values_count = odd % 8 == 7 ? bytes_choice(b, LONGEST_ARRAY) : components_of(a.references, a.count);
    a.values = room(b, a.values_count, type_sizes[type]);
    if (a.values != NULL) {
        fill(b, type, a.values, a.values_count);
    }
    return a;
}

static void free_arrays(struct arrays3 *a)
{
    free(a->references);
    free(a->orders);
    free(a->values);
}

#define GET_CASE(Type)                                                                                       \
    case TYPE_##Type:                                                                                        \
        return fmi3Get##Type(c, a->references, a->count, a->values, a->values_count);
#define SET_CASE(Type)                                                                                       \
    case TYPE_##Type:                                                                                        \
        return fmi3Set##Type(c, a->references, a->count, a->values, a->values_count);

static fmi3Status get(fmi3Instance c, enum type type, const struct arrays3 *a)
{
    switch (type) {
        TYPES(GET_CASE)
    default:
        return fmi3OK;
    }
}

static fmi3Status set(fmi3Instance c, enum type type, const struct arrays3 *a)
{
    switch (type) {
        TYPES(SET_CASE)
    default:
        return fmi3OK;
    }
}

/* Products with the matrix of derivatives, either way round. */
static fmi3Status product(fmi3Instance c, struct bytes *b)
{
    const unsigned unknown = 1u << VARIABLE_OUTPUT | 1u << VARIABLE_RATE;
    const unsigned known = 1u << VARIABLE_INPUT | 1u << VARIABLE_STATE;
    struct arrays3 rows = any_arrays(b, TYPE_Float64, unknown);
    struct arrays3 columns = any_arrays(b, TYPE_Float64, known);
    const bool adjoint = bytes_choice(b, 2) != 0;
    const struct arrays3 *result = adjoint ? &columns : &rows;
    const fmi3Status status =
        adjoint
            ? fmi3GetAdjointDerivative(c, rows.references, rows.count, columns.references, columns.count,
                                       rows.values, rows.values_count, columns.values, columns.values_count)
            : fmi3GetDirectionalDerivative(c, rows.references, rows.count, columns.references, columns.count,
                                           columns.values, columns.values_count, rows.values,
                                           rows.values_count);
    claim_numbers(status, result->values, result->values_count);
    free_arrays(&rows);
    free_arrays(&columns);
    return status;
}

static fmi3Status array_output_derivatives(fmi3Instance c, struct bytes *b)
{
    struct arrays3 a = any_arrays(b, TYPE_Float64, 1u << VARIABLE_OUTPUT);
    const fmi3Status status = fmi3GetOutputDerivatives(
        c, a.references, a.count, bytes_one(b) == 255 ? NULL : a.orders, a.values, a.values_count);
    claim_numbers(status, a.values, a.values_count);
    free_arrays(&a);
    return status;
}

static fmi3Status binaries(fmi3Instance c, struct bytes *b)
{
    fmi3Binary values[LONGEST_ARRAY] = {NULL};
    size_t sizes[LONGEST_ARRAY] = {0};
    const fmi3ValueReference references[1] = {any_reference(b)};
    const size_t count = bytes_choice(b, 2);
    return bytes_choice(b, 2) ? fmi3GetBinary(c, references, count, sizes, values, count)
                              : fmi3SetBinary(c, references, count, sizes, values, count);
}

fmi_status arrays_call(struct player *player, struct bytes *b)
{
    fmi3Instance c = player->instance;
    const unsigned which = bytes_choice(b, 12);
    if (which < 3) {
        return product(c, b);
    }
    if (which == 3) {
        return array_output_derivatives(c, b);
    }
    if (which == 4) {
        return binaries(c, b);
    }
    const unsigned kind = bytes_one(b);
    const enum type type = kind < 128 ? TYPE_Float64 : (enum type)(kind % TYPE_COUNT);
    struct arrays3 a = any_arrays(b, type, UINT32_MAX);
    const fmi3Status status = which < 8 ? get(c, type, &a) : set(c, type, &a);
    if (type == TYPE_Float64) {
        claim_numbers(which < 8 ? status : fmi3Error, a.values, a.values_count);
    }
    free_arrays(&a);
    return status;
}

fmi_status arrays_set_one(struct player *player, struct bytes *b)
{
    const struct variable *variable = &scene_variables[bytes_one(b) % (unsigned)scene_variable_count];
    variable -= variable->component;
    const fmi3ValueReference reference = variable->reference;
    fmi3Float64 room_for_values[LONGEST_VECTOR];
    const struct arrays3 a = {
        .count = 1,
        .values_count = variable->length,
        .references = (fmi3ValueReference *)&reference,
        .values = room_for_values,
    };
    fill(b, type_of(variable), room_for_values, a.values_count);
    return set(player->instance, type_of(variable), &a);
}
