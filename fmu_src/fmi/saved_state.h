/*
 * Saved states of an instance: got, set, freed, made bytes and made of bytes. An importer's state is a pointer
 * into the instance's list (state_list.h); what it brings is checked as a whole before it is used.
 */
#ifndef CONTACT_FMI_SAVED_STATE_H
#define CONTACT_FMI_SAVED_STATE_H

#include "fmi/call_order.h"

enum model_status saved_state_get(struct instance *instance, const struct call *call, void **state);
enum model_status saved_state_set(struct instance *instance, const struct call *call, void *state);
enum model_status saved_state_free(struct instance *instance, const struct call *call, void **state);

enum model_status saved_state_size(struct instance *instance, const struct call *call, void *state,
                                   size_t *size);
enum model_status saved_state_serialize(struct instance *instance, const struct call *call, void *state,
                                        void *bytes, size_t size);
enum model_status saved_state_deserialize(struct instance *instance, const struct call *call,
                                          const void *bytes, size_t size, void **state);

#endif
