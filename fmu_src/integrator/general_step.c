/* One step of the general segment: its stages, its length, its error. */
#include <float.h>
#include <stdio.h>
#include <string.h>

#include "integrator/general_memory.h"

/* At its end the error of a step is a thousandth of the tolerance (integrator/general.c), anywhere else all
 * of it. */
static const double WITHIN_SHARE = 1e-3;

/* A step of so few stages is as accurate as one of twelve that is longer by this. Of an oscillation at an
 * error of 1e-12 these are 0.18, 2 and 5 radians (scratch measurement of y'' = -y). */
static const double REACH_OF_FOUR = 0.035;
static const double REACH_OF_EIGHT = 0.4;

/* First guess: radians of the fastest oscillation between places and speeds. An impact takes pi. */
static const double FIRST_STEP = 4.0;

/* From one step to the next its length grows and shrinks by no more. */
static const double GROWTH = 4.0;
static const double SHRINKAGE = 0.15;

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

/* [s]; INFINITY where no place acts on a speed. */
static double first_length(const struct radau_step *p)
{
    double square = 0.0;
    for (int i = 0; i < p->problem.paired; ++i) {
        const double *row = p->by_places + p->speed_among[i] * p->problem.paired;
        double sum = 0.0;
        for (int j = 0; j < p->problem.paired; ++j) {
            sum += fabs(row[j]);
        }
        square = fmax(square, sum);
    }
    return square > 0.0 ? FIRST_STEP / sqrt(square) : (double)INFINITY;
}

void general_begin(struct general *g, double clock, const double *y)
{
    radau_step_begin(&g->step, clock, y);
    if (!(g->longest > 0.0)) {
        g->longest = first_length(&g->step);
    }
}

/* Weights of errors: by the sizes of the states at the start, or at the end of the guess if those are
 * larger. */
static void set_weights(struct general *g)
{
    struct radau_step *p = &g->step;
    memcpy(g->y, p->y, (size_t)g->size * sizeof *g->y);
    radau_step_stage(p, p->stages->stages - 1, g->y);
    ode_nominal(&g->ode, p->y, g->size_of);
    ode_nominal(&g->ode, g->y, g->end_size);
    for (int i = 0; i < g->size; ++i) {
        p->weight[i] = 1.0 / (g->relative * fmax(g->size_of[i], g->end_size[i]) + g->absolute);
    }
}

/* A trial; what is left of its error by the weights, INFINITY where it is no solution. */
static double error_of_trial(struct general *g, const struct radau_stages *stages, double length)
{
    struct radau_step *p = &g->step;
    if (!radau_step_guess(p, stages, length)) {
        return (double)INFINITY;
    }
    set_weights(g);
    if (!radau_step_solve(p, GENERAL_NEWTON_SHARE)) {
        return (double)INFINITY;
    }
    radau_step_finish(p);
    const struct radau_error error = radau_step_error(p);
    g->error_within = error.within;
    return fmax(error.at_end, WITHIN_SHARE * error.within);
}

/* By how much another length may be longer: the error goes with its power 2 s - 1. */
static double factor_of(double error, const struct radau_stages *stages)
{
    if (!(error < (double)INFINITY)) {
        return 0.4;
    }
    const double power = 1.0 / (2.0 * stages->stages - 1.0);
    const double factor = SAFETY * pow(fmax(error, 1e-100), -power);
    return fmin(fmax(factor, SHRINKAGE), GROWTH);
}

bool general_step_make(struct general *g, double limit, long *budget)
{
    for (;;) {
        if (*budget <= 0) {
            return false;
        }
        const double length = fmin(limit, g->longest);
        const struct radau_stages *stages = stages_for(length, g->longest);
        const double error = error_of_trial(g, stages, length);
        const double reach = length / reach_of(stages);
        if (error <= 1.0) {
            const double next = reach * factor_of(error, stages);
            g->longest = fmin(fmax(next, length), GROWTH * fmax(g->longest, length));
            *budget -= 1;
            return true;
        }
        g->rejected += 1;
        g->longest = fmin(reach * factor_of(error, stages), 0.9 * g->longest);
        if (!(g->step.start + g->longest > g->step.start) || g->longest < 1e-18 * limit) {
            snprintf(g->message, INTEGRATOR_MESSAGE_SIZE,
                     "no step of the general segment is accurate enough from here on");
            return false;
        }
    }
}
