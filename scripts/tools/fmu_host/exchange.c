#include "exchange.h"

#include <dlfcn.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

#ifdef FMU_HOST_ARKODE
#include <arkode/arkode_arkstep.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#endif

enum { MOST_STATES = 64, MOST_INDICATORS = 32 };

/* What an integrator works on: some of the FMU's states. The others do not change or do not act on these. */
struct exchange {
    const struct experiment *one;
    const fmi2ValueReference *moved; /* their places among the FMU's states */
    fmi2Component instance;
    fmi2SetTimeTYPE *set_time;
    fmi2SetContinuousStatesTYPE *set_states;
    fmi2GetContinuousStatesTYPE *get_states;
    fmi2GetDerivativesTYPE *get_rates;
    fmi2GetEventIndicatorsTYPE *get_indicators;
    fmi2EnterEventModeTYPE *enter_events;
    fmi2NewDiscreteStatesTYPE *new_discrete_states;
    fmi2EnterContinuousTimeModeTYPE *enter_continuous;
    size_t all; /* number of the FMU's states */
    int count;  /* of those integrated */
    int places; /* the first of them, whose rates are as many states further on */
    size_t indicators;
    bool refused;                     /* the FMU has refused a state */
    double states[MOST_STATES];       /* of the FMU */
    double y[MOST_STATES];            /* those integrated */
    double before[MOST_STATES], time; /* y at the begin of a step, and its time [s] */
    double margin[MOST_INDICATORS];   /* the indicators there */
    double event;                     /* when an indicator changes its sign, by the dense output [s] */
};

static bool put(struct exchange *x, double time, const double *y)
{
    for (int i = 0; i < x->count; i++) {
        x->states[x->moved[i]] = y[i];
    }
    x->refused = x->set_time(x->instance, time) > fmi2Warning ||
                 x->set_states(x->instance, x->states, x->all) > fmi2Warning;
    return !x->refused;
}

static bool rates_at(struct exchange *x, double time, const double *y, double *rates)
{
    double all[MOST_STATES];
    if (!put(x, time, y) || x->get_rates(x->instance, all, x->all) > fmi2Warning) {
        x->refused = true;
        return false;
    }
    for (int i = 0; i < x->count; i++) {
        rates[i] = all[x->moved[i]];
    }
    return true;
}

static bool indicators_at(struct exchange *x, double time, const double *y, double *indicators)
{
    if (!put(x, time, y) || x->get_indicators(x->instance, indicators, x->indicators) > fmi2Warning) {
        x->refused = true;
    }
    return !x->refused;
}

/* ---- the event in a step, the same for each code */

/* Returns the least of the indicators' sizes, with a minus where a sign is not that at the step's begin. */
static double least_margin(struct exchange *x, double time, const double *y)
{
    double indicators[MOST_INDICATORS], least = HUGE_VAL;
    if (indicators_at(x, time, y, indicators)) {
        for (size_t i = 0; i < x->indicators; i++) {
            const double sign = x->margin[i] > 0.0 ? 1.0 : x->margin[i] < 0.0 ? -1.0 : 0.0;
            least = sign != 0.0 ? fmin(least, sign * indicators[i]) : least;
        }
    }
    return least;
}

static void begin_step(struct exchange *x, double time, const double *y)
{
    memcpy(x->before, y, (size_t)x->count * sizeof *y);
    x->time = time;
    indicators_at(x, time, y, x->margin);
}

/* The code's dense output: the state at a time within the last step */
typedef void dense_function(void *code, double time, double *y);

/* Returns whether an indicator has changed its sign in the step that ends now. It finds the time by the dense
 * output, with the Illinois variant of regula falsi. */
static bool event_within(struct exchange *x, double time, const double *y, dense_function *dense, void *code)
{
    double low = x->time, high = time, at_high = least_margin(x, time, y);
    if (!(at_high <= 0.0)) {
        begin_step(x, time, y);
        return false;
    }
    double at_low = least_margin(x, low, x->before), last = at_high, middle[MOST_STATES];
    for (int i = 0; i < 60 && high - low > 4.0 * DBL_EPSILON * high; i++) {
        const double to = (low * at_high - high * at_low) / (at_high - at_low);
        dense(code, to, middle);
        const double now = least_margin(x, to, middle);
        if (now <= 0.0) {
            at_low *= last <= 0.0 ? 0.5 : 1.0;
            high = to, at_high = now;
        } else {
            at_high *= last > 0.0 ? 0.5 : 1.0;
            low = to, at_low = now;
        }
        last = now;
    }
    x->event = high;
    return true;
}

/* Integrates from the begin of the step to a time within it; returns whether it could. */
typedef bool again_function(struct exchange *x, void *code, double end, double *y);

/* Steps that are shorter than this part of the time go straight along the rates: no code takes them. */
static const double LEAST_STEP = 1e-13;

static bool go_straight(struct exchange *x, double time, double to, double *y)
{
    double rates[MOST_STATES];
    const bool done = rates_at(x, time, y, rates);
    for (int i = 0; i < x->count && done; i++) {
        y[i] += (to - time) * rates[i];
    }
    return done;
}

/* Moves time and state to the event. The dense output is less exact than the step, so that the step is made
 * anew up to the event, whose time Newton's method mends, until the sign is the new one. */
static bool go_to_event(struct exchange *x, double *time, double *y, again_function *again, void *code)
{
    double ahead[MOST_STATES], to = x->event;
    const double end = *time, short_time = 1e-6 * (end - x->time);
    for (int i = 0; i < 50; i++) {
        memcpy(y, x->before, (size_t)x->count * sizeof *y);
        if (to - x->time > LEAST_STEP * to ? !again(x, code, to, y) : !go_straight(x, x->time, to, y)) {
            return false;
        }
        *time = to;
        const double least = least_margin(x, to, y);
        memcpy(ahead, y, sizeof ahead);
        if (!go_straight(x, to, to + short_time, ahead)) {
            return false;
        }
        const double slope = (least_margin(x, to + short_time, ahead) - least) / short_time;
        const double by = slope < 0.0 ? -least / slope : 0.0;
        if (least <= 0.0 && (i > 1 || fabs(by) <= 64.0 * DBL_EPSILON * to)) {
            break;
        }
        /* Rather behind the event than before it, and ever further where the bodies hardly move */
        const double rounding = 4.0 * DBL_EPSILON * to;
        to += least > 0.0 ? fmax(by, ldexp(rounding, i)) : by + rounding;
        to = fmin(fmax(to, x->time), end);
    }
    return true;
}

/* ---- RADAU5, a Fortran subroutine in the library of R's package deSolve, which needs R's own library */

static const char *const R_LIBRARY = "/usr/lib/R/lib/libR.so";
static const char *const DESOLVE = "/usr/lib/R/site-library/deSolve/libs/deSolve.so";

typedef void solout_function(const int *, const double *, const double *, const double *, double *, int *,
                             const int *, double *, int *, int *);
typedef void radau5_function(int *,
                             void (*)(const int *, const double *, const double *, double *, double *, int *),
                             double *, double *, const double *, double *, const double *, const double *,
                             const int *, void *, const int *, int *, int *, void *, const int *, int *,
                             int *, solout_function *, const int *, double *, int *, int *, int *, void *,
                             int *, int *);
typedef void contr5_function(const int *, const double *, double *, int *, double *);

/* RADAU5 tells by this why it fails. R's own function needs an R that runs; the program's comes first. */
void Rprintf(const char *format, ...);
void Rprintf(const char *format, ...)
{
    (void)format;
}

static radau5_function *radau5;
static contr5_function *contr5;

static bool radau5_found(void)
{
    if (!radau5 && dlopen(R_LIBRARY, RTLD_LAZY | RTLD_GLOBAL)) {
        void *const library = dlopen(DESOLVE, RTLD_LAZY | RTLD_LOCAL);
        void *const found[2] = {library ? dlsym(library, "radau5_") : NULL,
                                library ? dlsym(library, "contr5_") : NULL};
        if (found[0] && found[1]) { /* ISO C knows no cast from void * to a function */
            memcpy(&radau5, &found[0], sizeof radau5);
            memcpy(&contr5, &found[1], sizeof contr5);
        }
    }
    return radau5;
}

/* The subroutine hands `user`, its RPAR, through. */
static void radau5_rates(const int *count, const double *time, const double *y, double *rates, double *user,
                         int *unused)
{
    (void)unused;
    if (!rates_at((struct exchange *)(void *)user, *time, y, rates)) {
        for (int i = 0; i < *count; i++) { /* a step with such rates is rejected */
            rates[i] = (double)NAN;
        }
    }
}

struct radau5_output {
    double *values;
    int *size;
    const int *count;
};

static void radau5_dense(void *code, double time, double *y)
{
    const struct radau5_output *output = code;
    contr5(output->count, &time, output->values, output->size, y);
}

/* RADAU5 calls this function at the start and after each of its steps. A negative `stop` ends the
 * integration. */
static void radau5_step(const int *number, const double *old, const double *time, const double *y,
                        double *output, int *output_size, const int *count, double *user, int *unused,
                        int *stop)
{
    struct radau5_output dense = {output, output_size, count};
    (void)old, (void)unused;
    if (*number > 1 && event_within((struct exchange *)(void *)user, *time, y, radau5_dense, &dense)) {
        *stop = -1;
    }
}

/* Returns the code's own IDID: 1 at the end, 2 where radau5_step has ended it, negative on failure. */
static int radau5_to(struct exchange *x, double *time, double end, double *y, bool events)
{
    static double work[20 + MOST_STATES * (4 * MOST_STATES + 12)]; /* zeros in front: the code's parameters */
    int whole[20 + 3 * MOST_STATES] = {0}, none = 0, all = x->count, result = 0;
    double first = 0.0; /* the code's own first step */
    int work_size = (int)(sizeof work / sizeof *work), whole_size = (int)(sizeof whole / sizeof *whole);
    memset(work, 0, 20 * sizeof *work);
    whole[1] = 1000000000;                 /* steps */
    whole[8] = whole[9] = x->places;       /* the first states have the rates that follow them */
    int nontrivial = x->count - x->places; /* the Jacobian is full */
    const int output = events;
    const double relative = x->one->tolerance, absolute = x->one->absolute_tolerance;
    radau5(&all, radau5_rates, time, y, &end, &first, &relative, &absolute, &none, NULL, &none, &nontrivial,
           &nontrivial, NULL, &none, &nontrivial, &nontrivial, radau5_step, &output, work, &work_size, whole,
           &whole_size, x, &none, &result);
    return x->refused ? -9 : result;
}

static bool radau5_again(struct exchange *x, void *unused, double end, double *y)
{
    double time = x->time;
    (void)unused;
    return radau5_to(x, &time, end, y, false) > 0;
}

static bool radau5_phase(struct exchange *x, double *time, double end)
{
    const int result = radau5_to(x, time, end, x->y, true);
    return result == 2 ? go_to_event(x, time, x->y, radau5_again, NULL) : result > 0;
}

/* ---- KenCarp4 of ARKODE: diagonally implicit, of order four; Newton with a dense matrix of differences */

#ifdef FMU_HOST_ARKODE
struct arkode {
    void *memory;
    N_Vector y;
};

static int arkode_rates(double time, N_Vector y, N_Vector rates, void *x)
{
    return rates_at(x, time, NV_DATA_S(y), NV_DATA_S(rates)) ? 0 : 1;
}

static void arkode_dense(void *code, double time, double *y)
{
    const struct arkode *a = code;
    N_Vector at = N_VClone(a->y);
    ARKStepGetDky(a->memory, time, 0, at);
    memcpy(y, NV_DATA_S(at), (size_t)N_VGetLength(at) * sizeof *y);
    N_VDestroy(at);
}

static bool arkode_again(struct exchange *x, void *code, double end, double *y)
{
    const struct arkode *a = code;
    double time = x->time;
    memcpy(NV_DATA_S(a->y), y, (size_t)x->count * sizeof *y);
    const bool done = ARKStepReset(a->memory, time, a->y) == 0 && ARKStepSetStopTime(a->memory, end) == 0 &&
                      ARKStepEvolve(a->memory, end, a->y, &time, ARK_NORMAL) >= 0;
    memcpy(y, NV_DATA_S(a->y), (size_t)x->count * sizeof *y);
    return done;
}

static bool arkode_steps(struct exchange *x, struct arkode *a, double *time, double end)
{
    while (*time < end) {
        if (ARKStepEvolve(a->memory, end, a->y, time, ARK_ONE_STEP) < 0 || x->refused) {
            return false;
        }
        if (event_within(x, *time, NV_DATA_S(a->y), arkode_dense, a)) {
            return go_to_event(x, time, x->y, arkode_again, a);
        }
    }
    memcpy(x->y, NV_DATA_S(a->y), (size_t)x->count * sizeof *x->y);
    return true;
}

static bool kencarp4_phase(struct exchange *x, double *time, double end)
{
    SUNContext context = NULL;
    if (SUNContext_Create(0, &context) != 0) {
        return false;
    }
    struct arkode a = {.y = N_VNew_Serial(x->count, context)};
    SUNMatrix matrix = SUNDenseMatrix(x->count, x->count, context);
    SUNLinearSolver linear = SUNLinSol_Dense(a.y, matrix, context);
    memcpy(NV_DATA_S(a.y), x->y, (size_t)x->count * sizeof *x->y);
    a.memory = ARKStepCreate(NULL, arkode_rates, *time, a.y, context);
    /* Each step makes its Newton matrix. With the matrix of a step of another size, stages have passed that
     * were wrong by 1e-4 of the energy, and the error test did not see it. */
    const bool done = ARKStepSetUserData(a.memory, x) == 0 &&
                      ARKStepSetTableNum(a.memory, ARKODE_ARK436L2SA_DIRK_6_3_4, ARKODE_ERK_NONE) == 0 &&
                      ARKStepSStolerances(a.memory, x->one->tolerance, x->one->absolute_tolerance) == 0 &&
                      ARKStepSetLinearSolver(a.memory, linear, matrix) == 0 &&
                      ARKStepSetLSetupFrequency(a.memory, 1) == 0 &&
                      ARKStepSetMaxNumSteps(a.memory, 1000000000) == 0 &&
                      ARKStepSetStopTime(a.memory, end) == 0 && arkode_steps(x, &a, time, end);
    ARKStepFree(&a.memory);
    SUNLinSolFree(linear);
    SUNMatDestroy(matrix);
    N_VDestroy(a.y);
    SUNContext_Free(&context);
    return done;
}
#endif

/* ---- the FMU's events between the phases */

/* Integrates to the end or to the first event before it. It returns false where it fails. */
typedef bool phase_function(struct exchange *x, double *time, double end);

static phase_function *phase_of(const char *integrator)
{
    static const struct {
        const char *name;
        phase_function *phase;
    } known[] = {
        {"radau5", radau5_phase},
#ifdef FMU_HOST_ARKODE
        {"kencarp4", kencarp4_phase},
#endif
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (strcmp(known[i].name, integrator) == 0) {
            return known[i].phase != radau5_phase || radau5_found() ? known[i].phase : NULL;
        }
    }
    return NULL;
}

const char *exchange_lacks(const char *integrator)
{
    return phase_of(integrator)                ? NULL
           : strcmp(integrator, "radau5") == 0 ? "Debian's package r-cran-desolve"
                                               : "SUNDIALS 6 with ARKODE, when fmu_host was built";
}

static bool find(struct slave *slave, void *function, const char *name)
{
    void *found = dlsym(slave->library, name);
    memcpy(function, &found, sizeof found);
    return found;
}

static bool find_all(struct slave *slave, struct exchange *x)
{
    return find(slave, &x->set_time, "fmi2SetTime") &&
           find(slave, &x->set_states, "fmi2SetContinuousStates") &&
           find(slave, &x->get_states, "fmi2GetContinuousStates") &&
           find(slave, &x->get_rates, "fmi2GetDerivatives") &&
           find(slave, &x->get_indicators, "fmi2GetEventIndicators") &&
           find(slave, &x->enter_events, "fmi2EnterEventMode") &&
           find(slave, &x->new_discrete_states, "fmi2NewDiscreteStates") &&
           find(slave, &x->enter_continuous, "fmi2EnterContinuousTimeMode");
}

/* Lets the FMU deal with an event; `next` becomes the time of its next one [s]. */
static fmi2Status event(struct exchange *x, double *next)
{
    fmi2EventInfo info = {.newDiscreteStatesNeeded = fmi2True};
    fmi2Status status = fmi2OK;
    while (info.newDiscreteStatesNeeded && status <= fmi2Warning) {
        status = x->new_discrete_states(x->instance, &info);
    }
    *next = info.nextEventTimeDefined ? fmin(info.nextEventTime, x->one->stop_time) : x->one->stop_time;
    if (status <= fmi2Warning) {
        status = x->enter_continuous(x->instance);
    }
    if (status <= fmi2Warning) {
        status = x->get_states(x->instance, x->states, x->all);
    }
    for (int i = 0; i < x->count; i++) {
        x->y[i] = x->states[x->moved[i]];
    }
    return status;
}

bool exchange_run(struct slave *slave, const struct experiment *one)
{
    struct exchange x = {.one = one,
                         .instance = slave->instance,
                         .all = one->states.items[STATES_ALL],
                         .indicators = one->states.items[STATES_INDICATORS],
                         .places = (int)one->states.items[STATES_PLACES],
                         .moved = one->states.items + STATES_FIRST,
                         .count = (int)(one->states.count - STATES_FIRST)};
    phase_function *const phase = phase_of(one->integrator);
    double time = one->start_time, next = time;
    bool known = phase && find_all(slave, &x) && x.all <= MOST_STATES && x.indicators <= MOST_INDICATORS;
    for (int i = 0; i < x.count; i++) {
        known = known && x.moved[i] < x.all;
    }
    if (!known) {
        return slave_check(slave, fmi2Error, one->integrator);
    }
    fmi2Status status = event(&x, &next);
    while (time < one->stop_time && status <= fmi2Warning) {
        begin_step(&x, time, x.y);
        const bool near = next - time <= LEAST_STEP * next;
        if (!(near ? go_straight(&x, time, next, x.y) : phase(&x, &time, next)) ||
            !put(&x, near ? next : time, x.y)) {
            return slave_check(slave, fmi2Error, one->integrator);
        }
        time = near ? next : time;
        status = time < one->stop_time ? x.enter_events(x.instance) : fmi2OK;
        if (time < one->stop_time && status <= fmi2Warning) {
            status = event(&x, &next);
        }
    }
    return slave_check(slave, status, "fmi2NewDiscreteStates");
}
