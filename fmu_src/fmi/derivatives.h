/* Checked derivatives of outputs: with respect to time, and to inputs along a direction. Arrays are given. */
#ifndef CONTACT_FMI_DERIVATIVES_H
#define CONTACT_FMI_DERIVATIVES_H

#include "fmi/call_order.h"

/* Highest order of derivatives with respect to time, maxOutputDerivativeOrder of the model description. */
enum { LOWEST_ORDER = 1, HIGHEST_ORDER = 2 };

/* The real variable of a reference with the wanted causality, or NULL after a message. */
const struct variable *find_real(struct instance *instance, const struct call *call, uint32_t reference,
                                 enum variable_causality causality);

enum model_status check_order(struct instance *instance, const struct call *call,
                              const struct variable *variable, int order);

enum model_status output_derivatives(struct instance *instance, const struct call *call,
                                     const uint32_t *references, const int *orders, size_t count,
                                     double *values);

enum model_status check_unknowns(struct instance *instance, const struct call *call, const uint32_t *unknowns,
                                 size_t count);
enum model_status check_known(struct instance *instance, const struct call *call, uint32_t reference);
enum model_status check_seed(struct instance *instance, const struct call *call, uint32_t reference,
                             double seed);

#endif
