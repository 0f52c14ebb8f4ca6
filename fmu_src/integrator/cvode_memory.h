/* What an instance of CVODE consists of; for cvode.c and cvode_memory.c only. */
#ifndef CONTACT_INTEGRATOR_CVODE_MEMORY_H
#define CONTACT_INTEGRATOR_CVODE_MEMORY_H

#include "integrator/cvode.h"

#include <nvector/nvector_serial.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nonlinearsolver.h>

#include "scene/ode.h"
#include "segment/scene_output.h"

struct cvode_problem {
    struct scene_ode ode;
    double relative, absolute; /* tolerances [1], [m, m/s, ...] */
};

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
    struct scene_output output[SCENE_CONTACTS]; /* of the phase */
    double longest_step;                        /* of the phase [s]; 0: no bound */
    double reached; /* end of the last step, or its root: at or beyond the scene's clock [s] */
    int flag;       /* what CVODE returned there */
    double y_clock; /* when y is the state [s] */
    long steps, evaluations, rejected; /* CVODE's counters already booked in the motion's */
    void (*release)(void *memory);     /* of this struct */
    char *message;                     /* the solver's, INTEGRATOR_MESSAGE_SIZE bytes */
};

#endif
