/*
 * This file has the variables of an FMU as its adapter sees them. The table is generated from
 * modelDescription/variables.toml and the scene file (scene_variables.c); value references, ranges and order
 * are those of modelDescription.xml.
 */
#ifndef CONTACT_MODEL_VARIABLE_H
#define CONTACT_MODEL_VARIABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum variable_type { VARIABLE_REAL, VARIABLE_INTEGER, VARIABLE_BOOLEAN, VARIABLE_ENUMERATION };

struct scene_values;

enum variable_causality {
    VARIABLE_PARAMETER,
    VARIABLE_CALCULATED_PARAMETER,
    VARIABLE_INPUT,
    VARIABLE_OUTPUT,
    /* local variables follow, which Model Exchange needs and which are computed when they are read */
    VARIABLE_STATE,      /* of the importer's integrator */
    VARIABLE_RATE,       /* d/dt of a state */
    VARIABLE_INDICATOR,  /* an event where it changes its sign */
    VARIABLE_INDEPENDENT /* time, which no table of a model lists */
};

struct variable {
    const char *name;
    double min, max;    /* inclusive; for an enumeration the numbers of the first and last item */
    uint32_t reference; /* FMI value reference */
    /* position of the value in struct scene_values [bytes], 0 for local variables; the value is a double for
     * VARIABLE_REAL, else an int32_t */
    uint32_t offset;
    uint16_t row;          /* enum variable_row of scene.h; a rate has the row of its state */
    uint8_t type;          /* enum variable_type */
    uint8_t causality;     /* enum variable_causality */
    uint16_t element;      /* index of the body or contact, 0 for the rest */
    uint8_t component : 2; /* 0..3 in a vector, else 0 */
    uint8_t length : 3;    /* number of components of its vector, else 1; they follow each other */
    uint8_t reinit : 1;    /* for a state: whether events may make it jump */
    uint8_t tunable : 1;   /* 1: a parameter that may be set between steps, or a value that depends on one */
};

/* Read and write the value of a variable that is not local, as a number. */
double variable_value(const struct variable *variable, const struct scene_values *values);
void variable_put(const struct variable *variable, struct scene_values *values, double value);

/* Bits that tell what must be up to date before a Real variable can be read. They lie above the bits of an
 * offset. */
enum variable_source {
    VARIABLE_OFFSET = 0xffffff,
    VARIABLE_GIVEN = 0x1000000,    /* nothing, because the importer gave the value */
    VARIABLE_BODY = 0x4000000,     /* the motion of the bodies */
    VARIABLE_COMPUTED = 0x8000000, /* everything */
    VARIABLE_LENGTH = 28           /* a shift by so many bits leaves the number of components */
};

/* These tables give for each of the SCENE_REFERENCES value references the offset of its Real variable, the
 * bits of enum variable_source and the number of components of its vector, which only the first component
 * has; or 0 where the reference has no Real variable. */
extern const uint32_t scene_reals[];

extern const struct variable scene_variables[];
extern const int scene_variable_count;

/* The parameter that the importer's tolerance replaces; NULL: the scene has none. */
extern const struct variable *const scene_tolerance;

/* Returns the choices under which something would read the parameter at a position of scene_variables, as a
 * user writes them (`when` of variables.toml); NULL: something reads it. */
const char *scene_idle(const struct scene_values *v, int position);

/* Returns the format of the message on the first parameters that contradict each other (`refused` of
 * variables.toml), and sets the numbers that it tells by "%s"; NULL: none do. */
const char *scene_refusal(const struct scene_values *v, double numbers[2]);

/* These are the positions in scene_variables of the SCENE_STATES states, of their rates, and of the
 * SCENE_INDICATORS event indicators; then the nominal values of the states. */
extern const uint16_t scene_states[], scene_rates[], scene_indicators[];
extern const double scene_state_nominals[];

/* Returns the variable of a value reference, or NULL when the scene has none. The search takes the same time
 * for every reference. */
const struct variable *scene_variable(uint32_t reference);

/* Returns the first component of the vector, or the scalar, that a value reference names; else NULL. The
 * reference of a vector is that of its first component. */
const struct variable *vector_variable(uint32_t reference);

/* Variables that a caller names by their value references. */
struct variable_list {
    const uint32_t *references;
    size_t count;
    /* true: a reference stands for a whole vector or a scalar, and 0 for time; else for one number */
    bool vectors;
};

/* Returns the first variable, or the only one, that a reference of a list stands for; else NULL. */
const struct variable *listed_variable(const struct variable_list *list, uint32_t reference);

/* Returns the number after `last` of those that a list stands for, where *place is the index of the reference
 * after that of `last`; NULL at the end. A walk begins with NULL and *place = 0. All references must have
 * variables. */
const struct variable *next_variable(const struct variable_list *list, const struct variable *last,
                                     size_t *place);

#endif
