/* One step of the general segment: its stages, its length, its error. */
#include <float.h>
#include <stdio.h>

#include "integrator/general_memory.h"
#include "scene/rounding.h"
#include "scene/turning.h"

/* Steps in which Newton's method with the Jacobian at every stage has failed are tried again when they
 * have grown by these from what was not too long. */
static const double SOLVABLE_PART = 0.6;
static const double SOLVABLE_GROWTH = 1.1;

/* By more where so few iterations have been enough. */
enum { EASY_ITERATIONS = 3 };
static const double EASY_GROWTH = 2.0;

/* The same of simplified iterations, which cost less in vain. */
static const double SIMPLE_GROWTH = 1.3;

/* What dies away so often within a step leaves so much rounding in its force that corrections must follow
 * it. */
static const double STIFF = 200.0;

/* What is less stiff than this is followed on its way down, and simplified iterations fail for another
 * reason: a change within the step, for which it is too long. */
static const double LEAST_STIFF = 5.0;

/* Of the bound for a gap, how much its rounding commonly is. */
static const double ROUNDING_OF_GAP = 0.5;

/* At its end the error of a step is a thousandth of the tolerance (integrator/general.c), anywhere else all
 * of it. */
static const double WITHIN_SHARE = 1e-3;

/* A step of so few stages is as accurate as one of twelve that is longer by this. Of an oscillation at an
 * error of 1e-12 these are 0.18, 2 and 5 radians (scratch measurement of y'' = -y). */
static const double REACH_OF_FOUR = 0.035;
static const double REACH_OF_EIGHT = 0.4;

/* From one step to the next its length grows and shrinks by no more. */
static const double GROWTH = 4.0;
static const double SHRINKAGE = 0.15;

/* What dies away faster than the first stage sees is much faster than the step, if it is much. Where it is
 * little it is what the polynomial lacks near the start, which goes with a low power of the length. */
static const double START_SHRINKAGE = 0.05;
static const double START_POWER = 1.0 / 6.0;

/* Chebyshev coefficients that do not decrease towards the last are noise, as of the slip of friction whose
 * v_0 is hardly more than the rounding of velocities: a small error then says nothing of longer steps. */
static const double NOISE_OF_ERROR = 0.1;
static const double NOISE_OF_DECREASE = 0.1;

/* Aimed at is a little less than what the error allows. */
static const double SAFETY = 0.9;

/* The reach of a step of so many stages, as part of that of twelve. */
static double reach_of(const struct radau_stages *stages)
{
    return stages->stages == 4 ? REACH_OF_FOUR : stages->stages == 8 ? REACH_OF_EIGHT : 1.0;
}

static const struct radau_stages *stages_for(double length, double longest)
{
    return length <= REACH_OF_FOUR * longest    ? &radau_stages_4
           : length <= REACH_OF_EIGHT * longest ? &radau_stages_8
                                                : &radau_stages_12;
}

/* Of the gaps, at the start of a step [m]. */
static double rounding_of_places(struct general *g)
{
    struct scene_instant at;
    double most = 0.0;
    ode_instant(&g->ode, g->step.start, g->step.y, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        most = fmax(most, ROUNDING_OF_GAP * rounding_of_gap(g->ode.values, &at, j));
    }
    return most;
}

/* Of the rates by the states left: how fast the fastest of them dies away [1/s]. */
static double fastest_decay_of(const struct radau_step *p)
{
    double most = 0.0;
    for (int i = 0; i < p->others; ++i) {
        most = fmax(most, fabs(p->by_others[i * p->others + i]));
    }
    return most;
}

void general_begin(struct general *g, double clock, const double *y)
{
    radau_step_begin(&g->step, clock, y);
    if (SCENE_ANY_TURNING && g->step.problem.turns) {
        g->fastest_decay = fastest_decay_of(&g->step);
        g->place_rounding = rounding_of_places(g);
    }
    if (!(g->longest > 0.0)) {
        g->longest = general_length_of_springs(g);
    }
}

/* A solution by Newton's method with the Jacobian at every stage. */
static bool try_fully(struct general *g, const struct radau_stages *stages, double length, bool thoroughly)
{
    g->fully = true;
    radau_step_guess_on(&g->step, stages, length);
    general_set_weights(g);
    return general_solve_fully(g, thoroughly);
}

/* Simplified iterations first, unless the step is so stiff, or long, that they are known to fail. */
static bool try_to_solve(struct general *g, const struct radau_stages *stages, double length)
{
    struct radau_step *p = &g->step;
    const bool rubs = SCENE_ANY_FRICTION && p->problem.turns;
    const double stiffness = rubs ? length * g->fastest_decay : 0.0;
    g->fully = false;
    if (stiffness > STIFF || (stiffness > LEAST_STIFF && length > g->simple)) {
        return try_fully(g, stages, length, stiffness > STIFF);
    }
    if (radau_step_guess(p, stages, length)) {
        general_set_weights(g);
        if (radau_step_solve(p, general_newton_share(g))) {
            return true;
        }
    }
    g->simple = fmin(g->simple, SOLVABLE_PART * length);
    return stiffness > LEAST_STIFF && try_fully(g, stages, length, false);
}

/* A trial; what is left of its error by the weights, INFINITY where it is no solution. */
static double error_of_trial(struct general *g, const struct radau_stages *stages, double length)
{
    struct radau_step *p = &g->step;
    if (!try_to_solve(g, stages, length)) {
        return (double)INFINITY;
    }
    radau_step_finish(p);
    const struct radau_error error = radau_step_error(p);
    g->error_within = error.within;
    g->error_at_end = fmax(error.at_end, g->within_share * error.within);
    g->error_of_start = g->fully ? radau_step_start_error(p) : 0.0;
    return fmax(g->error_at_end, g->error_of_start);
}

/* By how much another length may be longer: the error goes with its power 2 s - 1. */
static double factor_of(const struct general *g, double error, const struct radau_stages *stages)
{
    if (!(error < (double)INFINITY)) {
        return g->fully ? SOLVABLE_PART : 0.4;
    }
    const double start = SAFETY * pow(fmax(g->error_of_start, 1e-100), -START_POWER);
    const double longest = fmin(fmax(start, START_SHRINKAGE), GROWTH);
    const double power = 1.0 / (2.0 * stages->stages - 1.0);
    const double at_end = g->error_at_end;
    if (g->step.problem.turns && !(at_end < NOISE_OF_DECREASE * g->error_within)) {
        if (at_end < NOISE_OF_ERROR || at_end > 1.0) {
            return at_end > 1.0 ? fmin(SHRINKAGE, longest) : longest;
        }
    }
    const double factor = SAFETY * pow(fmax(at_end, 1e-100), -power);
    return fmin(fmax(factor, SHRINKAGE), longest);
}

bool general_step_make(struct general *g, double limit, double left, long *budget)
{
    for (;;) {
        if (*budget <= 0) {
            return false;
        }
        const double length = fmin(limit, g->longest);
        const struct radau_stages *stages = stages_for(length, g->longest);
        g->within_share = length > left ? g->read_share : WITHIN_SHARE;
        const double error = error_of_trial(g, stages, length);
        const double reach = length / reach_of(stages);
        if (error <= 1.0) {
            const double next = reach * factor_of(g, error, stages);
            g->longest = fmin(fmax(next, length), GROWTH * fmax(g->longest, length));
            g->longest = fmin(g->longest, fmax(g->solvable, length));
            g->solvable *= g->step.iterations <= EASY_ITERATIONS ? EASY_GROWTH : SOLVABLE_GROWTH;
            g->simple *= SIMPLE_GROWTH;
            if (SCENE_ANY_FRICTION && g->step.problem.turns && g->longest * g->fastest_decay < LEAST_STIFF) {
                g->longest = fmin(g->longest, fmax(g->simple, length));
            }
            *budget -= 1;
            return true;
        }
        if (g->fully && !(error < (double)INFINITY)) {
            g->solvable = SOLVABLE_PART * length;
        }
        g->rejected += 1;
        g->longest = fmin(reach * factor_of(g, error, stages), 0.9 * g->longest);
        if (!(g->step.start + g->longest > g->step.start) || g->longest < 1e-18 * limit) {
            snprintf(g->message, INTEGRATOR_MESSAGE_SIZE,
                     "no step of the general segment is accurate enough from here on");
            return false;
        }
    }
}
