/* The scene's differential equations (scene/ode.h) as CVODE calls them. */
#ifndef CONTACT_INTEGRATOR_CVODE_PROBLEM_H
#define CONTACT_INTEGRATOR_CVODE_PROBLEM_H

#include <nvector/nvector_serial.h>
#include <sundials/sundials_matrix.h>

#include "scene/ode.h"

struct cvode_problem {
    struct scene_ode ode;
    double relative, absolute; /* tolerances [1], [m, m/s, ...] */
};

int cvode_rhs(double clock, N_Vector y, N_Vector rate, void *problem);
int cvode_jacobian(double clock, N_Vector y, N_Vector rate, SUNMatrix jacobian, void *problem, N_Vector,
                   N_Vector, N_Vector);
int cvode_roots(double clock, N_Vector y, double *roots, void *problem);

/* Error weights 1 / (relative size + absolute). */
int cvode_weights(N_Vector y, N_Vector weights, void *problem);

#endif
