/* An integrator of others moves the states of a Model Exchange FMU: RADAU5 of Hairer and Wanner, or a diagonally
   implicit Runge-Kutta method of SUNDIALS' ARKODE. */
#ifndef FMU_HOST_EXCHANGE_H
#define FMU_HOST_EXCHANGE_H

#include "slave.h"

/* Returns why this program cannot use the integrator, or NULL. */
const char *exchange_lacks(const char *integrator);

/* Integrates from the start time, at the end of initialization, to the stop time. It returns false after a
 * message, see slave.h. */
bool exchange_run(struct slave *slave, const struct experiment *one);

#endif
