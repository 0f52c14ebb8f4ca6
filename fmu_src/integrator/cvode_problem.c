#include "integrator/cvode_problem.h"

#include <sunmatrix/sunmatrix_dense.h>

int cvode_rhs(double clock, N_Vector y, N_Vector rate, void *problem)
{
    const struct cvode_problem *p = problem;
    ode_rates(&p->ode, clock, NV_DATA_S(y), NV_DATA_S(rate));
    return 0;
}

int cvode_jacobian(double clock, N_Vector y, N_Vector rate, SUNMatrix jacobian, void *problem,
                   N_Vector unused1, N_Vector unused2, N_Vector unused3)
{
    (void)rate, (void)unused1, (void)unused2, (void)unused3;
    const struct cvode_problem *p = problem;
    ode_jacobian(&p->ode, clock, NV_DATA_S(y), SM_DATA_D(jacobian));
    return 0;
}

int cvode_roots(double clock, N_Vector y, double *roots, void *problem)
{
    const struct cvode_problem *p = problem;
    ode_events(&p->ode, clock, NV_DATA_S(y), roots);
    return 0;
}

int cvode_weights(N_Vector y, N_Vector weights, void *problem)
{
    const struct cvode_problem *p = problem;
    double *out = NV_DATA_S(weights);
    ode_nominal(&p->ode, NV_DATA_S(y), out);
    for (int i = 0; i < ode_size(p->ode.values); ++i) {
        out[i] = 1.0 / (p->relative * out[i] + p->absolute);
    }
    return 0;
}
