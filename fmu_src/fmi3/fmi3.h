/*
 * Variables of FMI 3.0, of which a vector is one: its value reference is that of its first component. The
 * references of the other components are those of no variable.
 */
#ifndef CONTACT_FMI3_FMI3_H
#define CONTACT_FMI3_FMI3_H

#include "fmi/instance.h"

/* The variable of a reference, of a vector its first component; NULL where there is none. */
const struct variable *vector_variable(uint32_t reference);

/* How many components it has, 1 for a scalar; they follow each other in the table of variables. */
size_t vector_length(const struct variable *first);

/* Whether all references are known and their components, all in all, as many as the values given; says what
 * is wrong. The names are those of the two arguments. */
bool vectors_match(struct instance *instance, const struct call *call, const uint32_t *references,
                   size_t count, const char *values_name, size_t values);

/* Walks over the components of many variables. */
struct vector_walk {
    const uint32_t *references;
    size_t count;
    size_t at;        /* which reference is next */
    size_t component; /* and which of its components */
};

enum { VECTOR_CHUNK = 64 }; /* components taken at once: what is on the stack, never in the heap */

struct vector_chunk {
    uint32_t references[VECTOR_CHUNK]; /* of scalars, as in the table of variables */
    size_t origins[VECTOR_CHUNK];      /* position of their variables in the walk */
    size_t count;                      /* 0: the walk is over */
};

/* The next components; all references must be known. */
void vector_walk_next(struct vector_walk *walk, struct vector_chunk *chunk);

#endif
