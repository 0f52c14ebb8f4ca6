#include "integrator/cvode_memory.h"

#include <cvode/cvode.h>
#include <stdio.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

/* SUNDIALS reports here instead of printing. */
#if SUNDIALS_VERSION_MAJOR >= 7
static void keep_message(int line, const char *function, const char *file, const char *text, SUNErrCode code,
                         void *data, SUNContext context)
{
    (void)line, (void)file, (void)code, (void)context;
    snprintf(data, INTEGRATOR_MESSAGE_SIZE, "%s: %s", function, text ? text : "");
}
#else
static void keep_message(int code, const char *module, const char *function, char *text, void *data)
{
    (void)code, (void)module;
    snprintf(data, INTEGRATOR_MESSAGE_SIZE, "%s: %s", function, text);
}
#endif

static bool create_context(SUNContext *context)
{
#if SUNDIALS_VERSION_MAJOR >= 7
    return SUNContext_Create(SUN_COMM_NULL, context) == 0;
#else
    return SUNContext_Create(NULL, context) == 0;
#endif
}

static bool silence(struct cvode *c)
{
#if SUNDIALS_VERSION_MAJOR >= 7
    return SUNContext_ClearErrHandlers(c->context) == 0 &&
           SUNContext_PushErrHandler(c->context, keep_message, c->message) == 0;
#else
    return CVodeSetErrHandlerFn(c->memory, keep_message, c->message) == CV_SUCCESS;
#endif
}

/* The scene's differential equations (scene/ode.h) as CVODE calls them. */
static int rates_of(double clock, N_Vector y, N_Vector rate, void *problem)
{
    const struct cvode_problem *p = problem;
    ode_rates(&p->ode, clock, NV_DATA_S(y), NV_DATA_S(rate));
    return 0;
}

static int events_of(double clock, N_Vector y, double *roots, void *problem)
{
    const struct cvode_problem *p = problem;
    ode_events(&p->ode, clock, NV_DATA_S(y), roots);
    return 0;
}

/* Error weights 1 / (relative size + absolute). */
static int weights_of(N_Vector y, N_Vector weights, void *problem)
{
    const struct cvode_problem *p = problem;
    double *out = NV_DATA_S(weights);
    ode_nominal(&p->ode, NV_DATA_S(y), out);
    for (int i = 0; i < ode_size(p->ode.values); ++i) {
        out[i] = 1.0 / (p->relative * out[i] + p->absolute);
    }
    return 0;
}

/* The Newton matrix I - gamma J, made in place: CVODE's own way keeps a copy of J that it allocates in the
 * first step. */
static int newton_matrix(double clock, N_Vector y, N_Vector rate, SUNMatrix matrix, int jacobian_ok,
                         int *jacobian_now, double gamma, void *problem, N_Vector unused1, N_Vector unused2,
                         N_Vector unused3)
{
    (void)rate, (void)jacobian_ok, (void)unused1, (void)unused2, (void)unused3;
    const struct cvode_problem *p = problem;
    *jacobian_now = 1;
    ode_jacobian(&p->ode, clock, NV_DATA_S(y), SM_DATA_D(matrix));
    return SUNMatScaleAddI(-gamma, matrix);
}

static bool attach_newton(struct cvode *c)
{
    c->jacobian = SUNDenseMatrix(c->size, c->size, c->context);
    c->linear = c->jacobian ? SUNLinSol_Dense(c->y, c->jacobian, c->context) : NULL;
    return c->linear && CVodeSetLinearSolver(c->memory, c->linear, c->jacobian) == CV_SUCCESS &&
           CVodeSetLinSysFn(c->memory, newton_matrix) == CV_SUCCESS;
}

static bool attach_fixed_point(struct cvode *c)
{
    c->nonlinear = SUNNonlinSol_FixedPoint(c->y, 0, c->context);
    return c->nonlinear && CVodeSetNonlinearSolver(c->memory, c->nonlinear) == CV_SUCCESS;
}

static bool configure(struct cvode *c)
{
    /* Event functions matter where they fall, see scene/ode.h. */
    int falling[ODE_EVENTS];
    for (int i = 0; i < ODE_EVENTS; ++i) {
        falling[i] = -1;
    }
    return silence(c) && CVodeInit(c->memory, rates_of, 0.0, c->y) == CV_SUCCESS &&
           CVodeSetUserData(c->memory, &c->problem) == CV_SUCCESS &&
           CVodeWFtolerances(c->memory, weights_of) == CV_SUCCESS &&
           (c->method != SOLVER_METHOD_CVODE_ADAMS ? attach_newton(c) : attach_fixed_point(c)) &&
           CVodeRootInit(c->memory, ODE_EVENTS, events_of) == CV_SUCCESS &&
           CVodeSetRootDirection(c->memory, falling) == CV_SUCCESS &&
           CVodeSetNoInactiveRootWarn(c->memory) == CV_SUCCESS;
}

static bool create(struct cvode *c, const struct scene_values *v)
{
    c->size = ode_size(v);
    c->method = (enum solver_method)solver_method(v);
    if (!create_context(&c->context)) {
        return false;
    }
    c->y = N_VNew_Serial(c->size, c->context);
    if (!c->y) {
        return false;
    }
    N_VConst(0.0, c->y);
    c->memory = CVodeCreate(c->method != SOLVER_METHOD_CVODE_ADAMS ? CV_BDF : CV_ADAMS, c->context);
    return c->memory && configure(c);
}

bool cvode_open(struct cvode **slot, const struct scene_values *v, const struct integrator_memory *memory,
                char *message)
{
    if (*slot && (*slot)->method == (enum solver_method)solver_method(v) && (*slot)->size == ode_size(v)) {
        return true;
    }
    struct cvode *c = memory->allocate(1, sizeof *c);
    if (c) {
        c->message = message;
        c->release = memory->release;
        if (create(c, v)) {
            cvode_close(slot);
            *slot = c;
            return true;
        }
        cvode_close(&c);
    }
    snprintf(message, INTEGRATOR_MESSAGE_SIZE, "the integrator's memory could not be had");
    return false;
}

void cvode_close(struct cvode **slot)
{
    struct cvode *c = *slot;
    if (!c) {
        return;
    }
    if (c->memory) {
        CVodeFree(&c->memory);
    }
    if (c->linear) {
        SUNLinSolFree(c->linear);
    }
    if (c->nonlinear) {
        SUNNonlinSolFree(c->nonlinear);
    }
    if (c->jacobian) {
        SUNMatDestroy(c->jacobian);
    }
    if (c->y) {
        N_VDestroy(c->y);
    }
    if (c->context) {
        SUNContext_Free(&c->context);
    }
    c->release(c);
    *slot = NULL;
}
