/* A Model Exchange FMU whose states an integrator of others moves: RADAU5 of Hairer and Wanner, or KenCarp4,
   the ESDIRK method ARK4(3)6L[2]SA of Kennedy and Carpenter, as ARKODE of SUNDIALS has it. */
#ifndef FMU_HOST_EXCHANGE_H
#define FMU_HOST_EXCHANGE_H

#include "slave.h"

/* Returns why this program cannot use the integrator, or NULL. */
const char *exchange_lacks(const char *integrator);

/* Integrates from the start time, at the end of initialization, to the stop time. It returns false after a
 * message, see slave.h. */
bool exchange_run(struct slave *slave, const struct experiment *one);

#endif
