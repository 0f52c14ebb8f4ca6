#include <cvode/cvode.h>
#include <float.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <string.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nonlinearsolver.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "flight/flight.h"
#include "integrator/cvode.h"
#include "scene/dense_output.h"
#include "scene/ode.h"

struct cvode {
    SUNContext context;
    N_Vector y;
    SUNMatrix jacobian;
    SUNLinearSolver linear;
    SUNNonlinearSolver nonlinear;
    void *memory;
    struct scene_ode ode;      /* the values and the motion, for CVODE's callbacks */
    double relative, absolute; /* tolerances [1], [m, m/s, ...] */
    enum solver_method method;
    struct scene_output output[SCENE_CONTACTS]; /* outputs of the phase */
    double longest_step;                        /* bound on internal steps of the phase [s]; 0: none */
    double reached;                /* end of the last step, or its root, not before the scene's clock [s] */
    int flag;                      /* CVODE's return value of that step */
    long counted[4];               /* CVODE's counts already added to the motion's (book_counters) */
    void (*release)(void *memory); /* frees this struct */
    char *message;                 /* the integrator's message, INTEGRATOR_MESSAGE_SIZE bytes */
};

/* Takes SUNDIALS' error messages, which would be printed otherwise. */
#if SUNDIALS_VERSION_MAJOR >= 7
static void keep_message(int line, const char *function, const char *file, const char *text, SUNErrCode code,
                         void *data, SUNContext context)
{
    (void)line, (void)file, (void)code, (void)context;
    snprintf(data, INTEGRATOR_MESSAGE_SIZE, "%s: %s", function, text ? text : "");
}
#else
#define SUN_COMM_NULL NULL
static void keep_message(int code, const char *module, const char *function, char *text, void *data)
{
    (void)code, (void)module;
    snprintf(data, INTEGRATOR_MESSAGE_SIZE, "%s: %s", function, text);
}
#endif

static bool silence(struct cvode *c)
{
#if SUNDIALS_VERSION_MAJOR >= 7
    return SUNContext_ClearErrHandlers(c->context) == 0 &&
           SUNContext_PushErrHandler(c->context, keep_message, c->message) == 0;
#else
    return CVodeSetErrHandlerFn(c->memory, keep_message, c->message) == CV_SUCCESS;
#endif
}

/* These callbacks give CVODE the scene's differential equations (scene/ode.h). */
static int rates_of(double clock, N_Vector y, N_Vector rate, void *problem)
{
    const struct cvode *c = problem;
    ode_rates(&c->ode, clock, NV_DATA_S(y), NV_DATA_S(rate));
    return 0;
}

static int events_of(double clock, N_Vector y, double *roots, void *problem)
{
    const struct cvode *c = problem;
    ode_events(&c->ode, clock, NV_DATA_S(y), roots);
    return 0;
}

/* Sets the error weights 1 / (relative * size + absolute), where `size` is the size of each state. */
static int weights_of(N_Vector y, N_Vector weights, void *problem)
{
    const struct cvode *c = problem;
    double *out = NV_DATA_S(weights);
    ode_nominal(&c->ode, NV_DATA_S(y), out);
    for (int i = 0; i < c->ode.layout.size; ++i) {
        out[i] = 1.0 / (c->relative * out[i] + c->absolute);
    }
    return 0;
}

/* Makes the Newton matrix I - gamma J in place. CVODE's own function would keep a copy of J, which it
 * allocates in the first step. */
static int newton_matrix(double clock, N_Vector y, N_Vector rate, SUNMatrix matrix, int jacobian_ok,
                         int *jacobian_now, double gamma, void *problem, N_Vector unused1, N_Vector unused2,
                         N_Vector unused3)
{
    (void)rate, (void)jacobian_ok, (void)unused1, (void)unused2, (void)unused3;
    const struct cvode *c = problem;
    *jacobian_now = 1;
    ode_jacobian(&c->ode, clock, NV_DATA_S(y), SM_DATA_D(matrix));
    return SUNMatScaleAddI(-gamma, matrix);
}

/* Gives CVODE the solver of the equations of each step: fixed-point iterations for Adams's formulas, Newton's
 * method for the others. */
static bool attach_solver(struct cvode *c)
{
    if (c->method == SOLVER_METHOD_CVODE_ADAMS) {
        c->nonlinear = SUNNonlinSol_FixedPoint(c->y, 0, c->context);
        return c->nonlinear && CVodeSetNonlinearSolver(c->memory, c->nonlinear) == CV_SUCCESS;
    }
    c->jacobian = SUNDenseMatrix(c->ode.layout.size, c->ode.layout.size, c->context);
    c->linear = c->jacobian ? SUNLinSol_Dense(c->y, c->jacobian, c->context) : NULL;
    return c->linear && CVodeSetLinearSolver(c->memory, c->linear, c->jacobian) == CV_SUCCESS &&
           CVodeSetLinSysFn(c->memory, newton_matrix) == CV_SUCCESS;
}

static bool configure(struct cvode *c)
{
    /* An event is a fall of an event function through zero, see scene/ode.h. */
    int falling[ODE_EVENTS];
    for (int i = 0; i < ODE_EVENTS; ++i) {
        falling[i] = -1;
    }
    return silence(c) && CVodeInit(c->memory, rates_of, 0.0, c->y) == CV_SUCCESS &&
           CVodeSetUserData(c->memory, c) == CV_SUCCESS &&
           CVodeWFtolerances(c->memory, weights_of) == CV_SUCCESS && attach_solver(c) &&
           CVodeRootInit(c->memory, ODE_EVENTS, events_of) == CV_SUCCESS &&
           CVodeSetRootDirection(c->memory, falling) == CV_SUCCESS &&
           CVodeSetNoInactiveRootWarn(c->memory) == CV_SUCCESS;
}

static bool create(struct cvode *c, const struct scene_values *v)
{
    c->ode.layout = ode_layout_of(v, NULL);
    c->method = (enum solver_method)solver_method(v);
    if (SUNContext_Create(SUN_COMM_NULL, &c->context) != 0) {
        return false;
    }
    c->y = N_VNew_Serial(c->ode.layout.size, c->context);
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
    if (*slot && (*slot)->method == (enum solver_method)solver_method(v) &&
        (*slot)->ode.layout.size == ode_layout_of(v, NULL).size) {
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
    /* the functions of SUNDIALS do nothing for what a failed cvode_open has not made */
    CVodeFree(&c->memory);
    SUNLinSolFree(c->linear);
    SUNNonlinSolFree(c->nonlinear);
    SUNMatDestroy(c->jacobian);
    N_VDestroy(c->y);
    SUNContext_Free(&c->context);
    c->release(c);
    *slot = NULL;
}

/* This is the largest rotation of the normal n in one internal step [rad]: a contact cannot end and begin
 * again within such a step. Near the centre, where n rotates fast, the penetration takes the place of the
 * distance d, because the gap opens only after the bodies have moved by the penetration. */
static const double LARGEST_ANGLE = 0.1;

/* Returns the bound on the internal step [s]; 0: no bound. In such a step the bodies of no contact in touch
 * move by more than LARGEST_ANGLE times the larger of distance and penetration, or times the source's radius
 * where no force is transmitted. Within the step the relative speed is below sqrt(w^2 + 4 a d), where a is
 * the acceleration by gravity and external forces. */
static double largest_step(const struct scene_instant *at)
{
    const struct scene_state *q = at->q;
    double bound = (double)INFINITY;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(q, j) || contact_is_coupled(q, j)) {
            const int source = contact_source(j);
            const double distance = fabs(at->geometry[j].distance); /* a plane's may be negative */
            const struct vec3 force_difference =
                vec3_sub(path_at(q->path[source].force, 3, q->clock),
                         path_at(q->path[contact_destination(j)].force, 3, q->clock));
            const double a =
                vec3_norm(gravity(at->v)) + vec3_norm(force_difference) / body_mass(at->v, source);
            const double speed = sqrt(vec3_dot(at->rate[j], at->rate[j]) + 4.0 * a * distance);
            const double length = contact_transmits(q, j) ? fmax(distance, -at->geometry[j].gap)
                                                          : contact_source_radius(at->v, j);
            const double step = LARGEST_ANGLE * length / speed;
            bound = step > 0.0 ? fmin(bound, step) : bound;
        }
    }
    return isfinite(bound) ? bound : 0.0;
}

/* Returns the local error allowed in one internal step, divided by the tolerance. The errors of some hundred
 * steps of a contact add up, because the damping of BDF gives all of them one sign. With these shares and a
 * tolerance of 1e-10 the energy balance after the 63 impacts of a ball in a cylinder
 * (scripts/scenarios/p3b_bouncing_in_cylinder.toml) closes to better than 1e-9 of its largest term. */
static double tolerance_share(enum solver_method method)
{
    return method == SOLVER_METHOD_CVODE_ADAMS ? 0.02 : 0.005;
}

/* Moves the scene to a clock within the last internal step; serves as `move` of a scene_output. */
static void move_to(void *memory, double clock, struct scene_state *q)
{
    struct cvode *c = memory;
    CVodeGetDky(c->memory, clock, 0, c->y);
    ode_unpack(&c->ode, q, NV_DATA_S(c->y));
}

/* Starts a phase from the motion; returns false where CVODE fails. c->ode refers to q and its values. */
static bool start_phase(struct cvode *c, struct scene_state *q)
{
    struct scene_instant at;
    ode_leave_centres(q);
    /* The start is the instant that the event functions see: at a touch the rounding of a gap decides whether
     * a slip has ended. */
    ode_pack(&c->ode, NV_DATA_S(c->y));
    ode_instant(&c->ode, q->clock, NV_DATA_S(c->y), &at);
    c->relative = tolerance_share(c->method) * solver_relative_tolerance(q->v);
    c->absolute = tolerance_share(c->method) * solver_absolute_tolerance(q->v);
    ode_begin(&c->ode, &at, c->relative, c->absolute);
    memset(c->counted, 0, sizeof c->counted);
    c->reached = q->clock;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        c->output[j] = (struct scene_output){.contact = j, .move = move_to, .mover = c};
    }
    q->integrator_fresh = 0;
    c->longest_step = largest_step(&at);
    return CVodeReInit(c->memory, q->clock, c->y) == CV_SUCCESS &&
           CVodeSetMaxStep(c->memory, c->longest_step) == CV_SUCCESS;
}

static void book_counters(struct cvode *c, struct scene_state *q, struct advance *step)
{
    long counts[4] = {0};
    int32_t *const counters[] = {&q->counters.steps, &q->counters.force_evaluations,
                                 &q->counters.rejected_steps, &q->counters.rejected_steps};
    CVodeGetNumSteps(c->memory, &counts[0]);
    CVodeGetNumRhsEvals(c->memory, &counts[1]);
    CVodeGetNumErrTestFails(c->memory, &counts[2]);
    CVodeGetNumNonlinSolvConvFails(c->memory, &counts[3]);
    advance_spend(step, counts[0] - c->counted[0], CVODE_STEP_WORK * (counts[0] - c->counted[0]));
    for (int i = 0; i < 4; ++i) {
        counter_add(counters[i], counts[i] - c->counted[i]);
        c->counted[i] = counts[i];
    }
}

/* Returns the index of the event function that has the root just found. */
static int event_found(const struct cvode *c)
{
    int found[ODE_EVENTS];
    int event = 0;
    CVodeGetRootInfo(c->memory, found);
    while (event + 1 < ODE_EVENTS && !found[event]) {
        event += 1;
    }
    return event;
}

/* Notes the peaks up to the clock `to`. A step of CVODE is short compared with the time of a contact, so that
 * no quantity has two extrema within it. */
static void note_peaks(struct cvode *c, struct scene_state *q, double to)
{
    for (int j = 0; to > q->clock && j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime != REGIME_APART) {
            c->output[j].state = q;
            scene_output_note_peaks(&c->output[j], q->clock, to, 1, &q->contact[j].peaks);
        }
    }
}

/* Makes one internal step of CVODE, which ends early at a root or at CVODE's stop time. */
static enum advance_result one_internal_step(struct cvode *c, struct scene_state *q, struct advance *step)
{
    if (advance_is_spent(step)) {
        return ADVANCE_STEP_LIMIT;
    }
    /* CVODE derives its first step from the time that it aims at, which must not be far longer than a
     * contact */
    const double longest = c->longest_step > 0.0 ? 1e4 * c->longest_step : (double)INFINITY;
    const double aim = fmin(step->clock_end, q->clock + longest);
    c->flag = CVode(c->memory, aim, c->y, &c->reached, CV_ONE_STEP);
    book_counters(c, q, step);
    if (c->flag == CV_TOO_CLOSE) { /* the time left is rounding of the clock: nothing moves */
        q->clock = step->clock_end;
        return ADVANCE_REACHED;
    }
    return c->flag < 0 ? ADVANCE_FAILED : ADVANCE_REACHED;
}

enum advance_result cvode_advance(struct cvode *c, struct scene_state *q, struct advance *step)
{
    c->ode.values = q->v;
    c->ode.state = q;
    c->ode.layout = ode_layout_of(q->v, NULL);
    if (q->integrator_fresh) {
        if (!start_phase(c, q)) {
            return ADVANCE_FAILED;
        }
        const int passed = SCENE_CONTACTS > 1 ? ode_event_passed(&c->ode, NV_DATA_S(c->y)) : -1;
        if (passed >= 0) {
            return advance_to_event(step, q, passed);
        }
    }
    CVodeSetStopTime(c->memory, step->clock_limit);
    while (q->clock < step->clock_end) {
        if (!(c->reached > q->clock)) {
            const enum advance_result result = one_internal_step(c, q, step);
            if (result != ADVANCE_REACHED || c->flag == CV_TOO_CLOSE) {
                return result;
            }
        }
        const double to = fmin(c->reached, step->clock_end);
        note_peaks(c, q, to);
        move_to(c, to, q);
        q->clock = to;
        flight_restore(q);
        if (to == c->reached && c->flag == CV_ROOT_RETURN) {
            const enum advance_result result = advance_to_event(step, q, event_found(c));
            if (step->regime == REGIME_APART) {
                projection_end_contact(q, step->contact, c->relative, c->absolute);
            }
            /* CVODE places a root to 100 roundings of its time and step. After four times this error the
             * contact is certainly in its new regime. */
            double length = 0.0;
            CVodeGetLastStep(c->memory, &length);
            q->contact[step->contact].schedule.dead_band_clock =
                q->clock + 400.0 * DBL_EPSILON * (q->clock + length);
            return result;
        }
    }
    return ADVANCE_REACHED;
}
