#include "solver/cvode.h"

#if SCENE_ANY_FREE

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cvode/cvode.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "dynamics/flight.h"
#include "dynamics/projection.h"
#include "solver/cvode_problem.h"

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
    long steps, evaluations, rejected;   /* CVODE's counters already booked in the motion's */
    char *message;                       /* the solver's, SOLVER_MESSAGE_SIZE bytes */
};

/* SUNDIALS reports here instead of printing. */
#if SUNDIALS_VERSION_MAJOR >= 7
static void keep_message(int line, const char *function, const char *file, const char *text, SUNErrCode code,
                         void *data, SUNContext context)
{
    (void)line, (void)file, (void)code, (void)context;
    snprintf(data, SOLVER_MESSAGE_SIZE, "%s: %s", function, text ? text : "");
}
#else
static void keep_message(int code, const char *module, const char *function, char *text, void *data)
{
    (void)code, (void)module;
    snprintf(data, SOLVER_MESSAGE_SIZE, "%s: %s", function, text);
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

/* The Newton matrix I - gamma J, made in place: CVODE's own way keeps a copy of J that it allocates in the first step. */
static int newton_matrix(double clock, N_Vector y, N_Vector rate, SUNMatrix matrix, int jacobian_ok, int *jacobian_now,
                         double gamma, void *problem, N_Vector unused1, N_Vector unused2, N_Vector unused3)
{
    (void)jacobian_ok;
    *jacobian_now = 1;
    const int status = cvode_jacobian(clock, y, rate, matrix, problem, unused1, unused2, unused3);
    return status != 0 ? status : SUNMatScaleAddI(-gamma, matrix);
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
    /* -g, the margin and the force rate matter where they fall, see cvode_problem.h. */
    int falling[CVODE_ROOTS];
    for (int i = 0; i < CVODE_ROOTS; ++i) {
        falling[i] = -1;
    }
    return silence(c) && CVodeInit(c->memory, cvode_rhs, 0.0, c->y) == CV_SUCCESS &&
           CVodeSetUserData(c->memory, &c->problem) == CV_SUCCESS &&
           CVodeWFtolerances(c->memory, cvode_weights) == CV_SUCCESS &&
           (c->method == SOLVER_METHOD_CVODE_BDF ? attach_newton(c) : attach_fixed_point(c)) &&
           CVodeRootInit(c->memory, CVODE_ROOTS, cvode_roots) == CV_SUCCESS &&
           CVodeSetRootDirection(c->memory, falling) == CV_SUCCESS &&
           CVodeSetNoInactiveRootWarn(c->memory) == CV_SUCCESS;
}

static bool create(struct cvode *c, const struct scene_values *v)
{
    c->size = cvode_problem_size(v);
    c->method = (enum solver_method)solver_method(v);
    if (!create_context(&c->context)) {
        return false;
    }
    c->y = N_VNew_Serial(c->size, c->context);
    if (!c->y) {
        return false;
    }
    N_VConst(0.0, c->y);
    c->memory = CVodeCreate(c->method == SOLVER_METHOD_CVODE_BDF ? CV_BDF : CV_ADAMS, c->context);
    return c->memory && configure(c);
}

bool cvode_open(struct cvode **slot, const struct scene_values *v, char *message)
{
    if (*slot && (*slot)->method == (enum solver_method)solver_method(v) && (*slot)->size == cvode_problem_size(v)) {
        return true;
    }
    struct cvode *c = calloc(1, sizeof *c);
    if (c) {
        c->message = message;
        if (create(c, v)) {
            cvode_close(slot);
            *slot = c;
            return true;
        }
        cvode_close(&c);
    }
    snprintf(message, SOLVER_MESSAGE_SIZE, "the integrator's memory could not be had");
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
    free(c);
    *slot = NULL;
}

/* In contact the direction may turn by at most this angle [rad] in one internal step: parting and touching again within a
 * step would need it to turn by more. */
static const double LARGEST_TURN = 0.1;

/* Bound on the internal step [s]; 0: none. Speeds up to sqrt(w^2 + 4 a d) are reached within a turn around a body. */
static double largest_step(const struct scene_values *v, const struct motion *q, const struct system_instant *at)
{
    double bound = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime == REGIME_PRESSING || q->contact[j].regime == REGIME_RECEDING) {
            const double distance = at->geometry[j].distance;
            const struct vec3 pull = vec3_sub(path_at(q->path[contact_source(j)].force, 3, q->clock),
                                              path_at(q->path[contact_destination(j)].force, 3, q->clock));
            const double a = vec3_norm(gravity(v)) + vec3_norm(pull) / body_mass(v, contact_source(j));
            const double speed = sqrt(vec3_dot(at->rate[j], at->rate[j]) + 4.0 * a * distance);
            const double step = LARGEST_TURN * distance / speed;
            bound = step > 0.0 && isfinite(step) && (bound == 0.0 || step < bound) ? step : bound;
        }
    }
    return bound;
}

static double momentum_scale(const struct scene_values *v, const struct system_instant *at)
{
    double sum = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        sum += body_is_free(v, i) ? body_mass(v, i) * vec3_norm(at->velocity[i]) : 0.0;
    }
    return sum;
}

/* What the local error of one internal step may take of the tolerance: the errors of some hundred steps of a short
 * contact add up, BDF's all with the sign of its damping. With a tenth the end of ten bounces keeps to the tolerance
 * times a few hundred; without it BDF lost three times as much. */
static const double TOLERANCE_SHARE = 0.1;

/* Starts CVODE from the motion, whose clock has just been set to zero. */
static bool restart(struct cvode *c, const struct scene_values *v, struct motion *q)
{
    struct system_instant at;
    system_now(v, q, &at);
    c->problem.relative = TOLERANCE_SHARE * solver_relative_tolerance(v);
    c->problem.absolute = TOLERANCE_SHARE * solver_absolute_tolerance(v);
    c->problem.energy_scale = energy_kinetic_of(v, &at);
    c->problem.momentum_scale = momentum_scale(v, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        /* Twice: the gap at the start may be off by one. */
        c->problem.resolution[j] = 2.0 * system_gap_resolution(v, &at, j);
    }
    cvode_pack(&c->problem, c->y);
    c->steps = c->evaluations = c->rejected = 0;
    q->integrator_fresh = 0;
    return CVodeReInit(c->memory, q->clock, c->y) == CV_SUCCESS &&
           CVodeSetMaxStep(c->memory, largest_step(v, q, &at)) == CV_SUCCESS;
}

static void book_counters(struct cvode *c, struct motion *q, struct advance *step)
{
    long steps = 0, evaluations = 0, failures = 0, convergence_failures = 0;
    CVodeGetNumSteps(c->memory, &steps);
    CVodeGetNumRhsEvals(c->memory, &evaluations);
    CVodeGetNumErrTestFails(c->memory, &failures);
    CVodeGetNumNonlinSolvConvFails(c->memory, &convergence_failures);
    failures += convergence_failures;
    step->budget -= steps - c->steps;
    q->counters.steps += (int32_t)(steps - c->steps);
    q->counters.force_evaluations += (int32_t)(evaluations - c->evaluations);
    q->counters.rejected_steps += (int32_t)(failures - c->rejected);
    c->steps = steps;
    c->evaluations = evaluations;
    c->rejected = failures;
}

/* Which contact leaves its regime at the root just found; false when the root is only a peak. */
static bool root_event(struct cvode *c, const struct scene_values *v, const struct motion *q, struct advance *step)
{
    int found[CVODE_ROOTS];
    CVodeGetRootInfo(c->memory, found);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int *roots = found + CVODE_ROOTS_EACH * j;
        step->contact = j;
        if (roots[0]) {
            step->regime = REGIME_APART;
            return true;
        }
        if (roots[1]) {
            const bool clips = contact_dashpot(v, j) == DASHPOT_NON_ADHESIVE;
            step->regime = q->contact[j].regime == REGIME_RECEDING ? REGIME_PRESSING
                           : clips                                 ? REGIME_RELEASED
                                                                   : REGIME_RECEDING;
            return true;
        }
    }
    return false;
}

enum advance_result cvode_advance(struct cvode *c, const struct scene_values *v, struct motion *q,
                                  struct advance *step)
{
    /* CVODE must not look beyond the next closed-form change, nor beyond where one has been looked for. */
    double stop = q->horizon_clock;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        stop = fmin(stop, q->contact[j].change_clock);
    }
    c->problem.values = v;
    c->problem.motion = q;
    if (q->integrator_fresh && !restart(c, v, q)) {
        return ADVANCE_FAILED;
    }
    CVodeSetStopTime(c->memory, stop);
    for (;;) {
        double clock = q->clock;
        CVodeSetMaxNumSteps(c->memory, step->budget);
        const int flag = CVode(c->memory, step->clock_end, c->y, &clock, CV_NORMAL);
        book_counters(c, q, step);
        if (flag < 0 && flag != CV_TOO_MUCH_WORK) {
            return ADVANCE_FAILED;
        }
        cvode_unpack(v, q, c->y);
        q->clock = clock;
        if (flag == CV_TOO_MUCH_WORK) {
            return ADVANCE_STEP_LIMIT;
        }
        flight_restore_axial(v, q);
        if (flag != CV_ROOT_RETURN) {
            return ADVANCE_REACHED;
        }
        if (root_event(c, v, q, step)) {
            if (step->regime == REGIME_APART) {
                projection_close_gap(v, q, step->contact);
            }
            projection_restore_energy(v, q, step->contact);
            return ADVANCE_EVENT;
        }
        struct system_instant at;
        system_now(v, q, &at);
        event_note_peaks(q, &at);
        if (step->budget <= 0) {
            return ADVANCE_STEP_LIMIT;
        }
    }
}

#endif
