/* Which function may be called in which phase: one row, one mask a function. */
#ifndef CONTACT_FMI_CALL_ORDER_H
#define CONTACT_FMI_CALL_ORDER_H

#include "fmi/instance.h"

/* A function of the standard; the tables are those of the adapters. */
struct call {
    const char *name;
    unsigned phases; /* in which it may be called; 0: never */
};

/*
 * Whether the call is in order now; if not, says so through the logger. A null instance is never in order.
 */
bool call_allowed(struct instance *instance, const struct call *call);

/* The same for what only instances of Model Exchange have, or only those of Co-Simulation. */
bool call_allowed_in_exchange(struct instance *instance, const struct call *call);
bool call_allowed_in_steps(struct instance *instance, const struct call *call);

/* Refuses a call that is never in order: "fmi2CancelStep called in phase step mode: reason" */
enum model_status call_refuse(struct instance *instance, const struct call *call, const char *reason);

/* Whether an array of count elements was really given; if not, says which one. */
bool call_array_given(struct instance *instance, const struct call *call, const char *argument,
                      const void *array, size_t count);

#endif
