/* What an instance of CVODE consists of; for cvode.c, cvode_start.c and cvode_memory.c only. */
#ifndef CONTACT_INTEGRATOR_CVODE_MEMORY_H
#define CONTACT_INTEGRATOR_CVODE_MEMORY_H

#include "integrator/cvode.h"

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_nonlinearsolver.h>

#include "integrator/cvode_problem.h"

struct cvode {
    SUNContext context;
    N_Vector y;
    SUNMatrix jacobian;
    SUNLinearSolver linear;
    SUNNonlinearSolver nonlinear;
    void *memory;
    struct cvode_problem problem;
    enum solver_method method;
    int size;
    double longest_step;               /* of the phase [s]; 0: no bound */
    long steps, evaluations, rejected; /* CVODE's counters already booked in the motion's */
    void (*release)(void *memory);     /* of this struct */
    char *message;                     /* the solver's, INTEGRATOR_MESSAGE_SIZE bytes */
};

#endif
