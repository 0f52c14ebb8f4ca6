/*
 * Saved states of an instance: got, set, freed, made bytes and made of bytes. An importer's state is a
 * pointer into the instance's list (state_list.h); what it brings is checked as a whole before it is used.
 */
#ifndef CONTACT_FMI_STATE_BLOCK_H
#define CONTACT_FMI_STATE_BLOCK_H

#include "fmi/call_order.h"

enum model_status state_block_get(struct instance *instance, const struct call *call, void **state);
enum model_status state_block_set(struct instance *instance, const struct call *call, void *state);
enum model_status state_block_free(struct instance *instance, const struct call *call, void **state);

enum model_status state_block_size(struct instance *instance, const struct call *call, void *state,
                                   size_t *size);
enum model_status state_block_serialize(struct instance *instance, const struct call *call, void *state,
                                        void *bytes, size_t size);
enum model_status state_block_deserialize(struct instance *instance, const struct call *call,
                                          const void *bytes, size_t size, void **state);

#endif
