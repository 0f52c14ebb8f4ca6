#include "fmi/state_list.h"

struct state_block *state_list_find(const struct instance *instance, const void *address)
{
    struct state_block *block = instance->states;
    while (block != NULL && block != address) {
        block = block->next;
    }
    return block;
}

struct state_block *state_list_add(struct instance *instance, size_t size)
{
    struct state_block *block = instance->host.allocate(1, sizeof(struct state_block) + size);
    if (block != NULL) {
        block->next = instance->states;
        instance->states = block;
    }
    return block;
}

void state_list_remove(struct instance *instance, struct state_block *block)
{
    struct state_block **link = &instance->states;
    while (*link != block) {
        link = &(*link)->next;
    }
    *link = block->next;
    instance->host.release(block);
}

void state_list_clear(struct instance *instance)
{
    while (instance->states != NULL) {
        state_list_remove(instance, instance->states);
    }
}
