/*
 * The saved states an instance has handed out and the importer has not freed: a list through the blocks
 * themselves. What the importer holds is the address of such a block. What the importer brings is looked up
 * by comparing addresses and never read before it is found: it may be uninitialised, freed, or another
 * instance's.
 */
#ifndef CONTACT_FMI_STATE_LIST_H
#define CONTACT_FMI_STATE_LIST_H

#include <stddef.h>

#include "fmi/instance.h"

struct state_block {
    struct state_block *next;
    _Alignas(double) unsigned char bytes[]; /* a header and the model's state, see state_block.c */
};

/* The block at an address, or NULL when this instance has none there. */
struct state_block *state_list_find(const struct instance *instance, const void *address);

/* A new block with room for that many bytes, or NULL when the importer's memory is exhausted. */
struct state_block *state_list_add(struct instance *instance, size_t size);

/* Gives a block of the list back to the importer's memory. */
void state_list_remove(struct instance *instance, struct state_block *block);

/* Gives all blocks back. */
void state_list_clear(struct instance *instance);

#endif
