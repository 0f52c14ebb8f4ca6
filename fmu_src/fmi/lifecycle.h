/* Creating, setting up, starting, ending and resetting an instance, whatever the version of the standard. */
#ifndef CONTACT_FMI_LIFECYCLE_H
#define CONTACT_FMI_LIFECYCLE_H

#include "fmi/call_order.h"

/* Whether what an argument of the instantiation must satisfy holds; if not, says so through `nobody`, an
 * instance that lives only for messages. */
bool instance_expects(struct instance *nobody, const char *function, bool holds, const char *argument,
                      const char *given, const char *expected);

/* An instance with a model inside and nothing set up, zero up to `size` bytes, which begin with it; NULL when
 * out of memory. */
struct instance *instance_create(const struct adapter *adapter, const struct model_host *host, size_t size,
                                 const char *name, bool logging_on);

/* Nothing happens to one that is in the midst of something: its logger or another callback is at work. */
void instance_free(struct instance *instance);

/* Adds up the bits of named categories. */
enum model_status instance_categories(struct instance *instance, const struct call *call, size_t count,
                                      const char *const *categories, unsigned *chosen);

/* Start and stop time and the importer's tolerance. */
enum model_status instance_set_up(struct instance *instance, const struct call *call, bool tolerance_defined,
                                  double tolerance, double start_time, bool stop_time_defined,
                                  double stop_time);

/* What is refused here (contradictory parameters) leaves the phase, so that the importer can set better
 * values. */
enum model_status instance_exit_initialization(struct instance *instance, const struct call *call,
                                               enum phase next);

/* Goes over to another phase. */
enum model_status instance_enter(struct instance *instance, const struct call *call, enum phase next);

enum model_status instance_reset(struct instance *instance, const struct call *call);

#endif
