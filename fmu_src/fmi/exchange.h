/* Model Exchange, whatever the version of the standard: checked calls of model/exchange.h. */
#ifndef CONTACT_FMI_EXCHANGE_H
#define CONTACT_FMI_EXCHANGE_H

#include "fmi/call_order.h"
#include "model/exchange.h"

/* Goes over to event mode, or to continuous-time mode. */
enum model_status exchange_enter(struct instance *instance, const struct call *call, enum phase next);

/* What an event has changed. */
struct exchange_news {
    bool again;        /* regimes have changed: another one may have to */
    bool jumped;       /* a state did */
    bool scheduled;    /* the next event is known, unless another one comes first ... */
    double event_time; /* ... and this is when [s], else 0 */
};

enum model_status exchange_update(struct instance *instance, const struct call *call,
                                  struct exchange_news *news);

enum model_status exchange_accept_step(struct instance *instance, const struct call *call);

enum model_status exchange_set_time(struct instance *instance, const struct call *call, double time);

/* `count` is what the importer believes that there are. */
enum model_status exchange_set_states(struct instance *instance, const struct call *call,
                                      const double *states, size_t count);
enum model_status exchange_get(struct instance *instance, const struct call *call, enum exchange_values which,
                               double *values, size_t count);
enum model_status exchange_get_nominals(struct instance *instance, const struct call *call, double *values,
                                        size_t count);

#endif
