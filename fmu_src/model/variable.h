/*
 * The variables of an FMU as its adapter sees them. The table is generated from
 * modelDescription/variables.toml and the scene file (scene_variables.c); value references, ranges and order
 * are those of modelDescription.xml.
 */
#ifndef MODEL_VARIABLE_H
#define MODEL_VARIABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum variable_type { VARIABLE_REAL, VARIABLE_INTEGER, VARIABLE_BOOLEAN, VARIABLE_ENUMERATION };

enum variable_causality {
    VARIABLE_PARAMETER,
    VARIABLE_CALCULATED_PARAMETER,
    VARIABLE_INPUT,
    VARIABLE_OUTPUT,
    /* local ones, which Model Exchange needs; computed when they are asked for */
    VARIABLE_STATE,    /* of the integrator outside */
    VARIABLE_RATE,     /* d/dt of a state */
    VARIABLE_INDICATOR /* an event where it changes its sign */
};

struct variable {
    const char *name;
    double min, max;    /* inclusive; of an enumeration the first and last item */
    uint32_t reference; /* FMI value reference */
    /* bytes into struct scene_values; a double for VARIABLE_REAL, else an int32_t; of local variables 0 */
    uint16_t offset;
    uint16_t row;      /* enum variable_row of scene.h */
    uint8_t type;      /* enum variable_type */
    uint8_t causality; /* enum variable_causality */
    uint8_t element;   /* index of the body or contact, 0 for the rest */
    uint8_t component; /* 0..2 in a vector, else 0 */
    uint8_t reinit;    /* of a state: whether events may make it jump */
    uint8_t tunable;   /* 1: a parameter that may be set between steps, or what follows from such */
};

static inline bool variable_is_local(const struct variable *variable)
{
    return variable->causality >= VARIABLE_STATE;
}

static inline size_t variable_size(const struct variable *variable)
{
    return variable->type == VARIABLE_REAL ? sizeof(double) : sizeof(int32_t);
}

/* The value that stands at `at`. */
static inline double variable_number(const struct variable *variable, const void *at)
{
    double real;
    int32_t integer;
    if (variable->type == VARIABLE_REAL) {
        memcpy(&real, at, sizeof real);
        return real;
    }
    memcpy(&integer, at, sizeof integer);
    return integer;
}

/* What has to be current for a value to be that of the present; bits above those of an offset. */
enum variable_source {
    VARIABLE_OFFSET = 0xffff,
    VARIABLE_GIVEN = 0x10000,    /* nothing: the importer gave it */
    VARIABLE_FIXED = 0x20000,    /* no variable has it, see enum outputs */
    VARIABLE_BODY = 0x40000,     /* the motion of the bodies */
    VARIABLE_COMPUTED = 0x80000, /* everything */
    VARIABLE_VECTOR = 0x100000   /* also: first of a vector, whose others follow */
};

/* All it takes to read a Real variable: its offset and its enum variable_source; 0 for a reference that has
 * none. By value reference, SCENE_REFERENCES of them. */
extern const uint32_t scene_reals[];

extern const struct variable scene_variables[];
extern const int scene_variable_count;

/* Whose choice it is: of the body or contact that has the variable, of that contact's bodies, or of any. */
enum use_whose { USE_OF_OWN, USE_OF_SOURCE, USE_OF_DESTINATION, USE_OF_ANY };

/* Something reads the parameters of a row only while a choice has one of some items: `when` of
 * variables.toml.
 * A parameter is in force where all that stands for one of its alternatives holds, or nothing stands. */
struct scene_use {
    uint16_t row, choice; /* enum variable_row; ROW_COUNT ends the table */
    uint8_t items;        /* a bit for the number of each */
    uint8_t whose;        /* enum use_whose */
    uint8_t alternative;  /* from 0, ascending within a row */
    uint8_t owners;       /* how many bodies or contacts there are to have that choice */
    char wanted[25];      /* the items by name */
};

extern const struct scene_use scene_uses[];

struct scene_values;

/* The number of a choice's item, of a body or contact; a constant where the scene pins it. */
int scene_choice(const struct scene_values *v, int row, int element);

/* Where in scene_variables the SCENE_STATES states are, their rates, the SCENE_INDICATORS event indicators;
 * and the nominal values of the states. */
extern const uint16_t scene_states[], scene_rates[], scene_indicators[];
extern const double scene_state_nominals[];

/* The variable of a value reference, NULL when the scene has none; takes the same time for every
 * reference. */
const struct variable *scene_variable(uint32_t reference);

/* The vector of a value reference, which is that of its first component, or a scalar; NULL for others. */
const struct variable *vector_variable(uint32_t reference);

/* The number of its components, 1 of a scalar; they follow each other in scene_variables. */
size_t vector_length(const struct variable *first);

/* Variables that a caller names by their value references. */
struct variable_list {
    const uint32_t *references;
    size_t count;
    bool vectors; /* each reference stands for a whole vector or a scalar; else for a scalar or a component */
};

#endif
