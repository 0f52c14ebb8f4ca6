/* Newton's method for a step with the Jacobian at every stage: for problems whose stiff directions turn
 * within the step, in which simplified iterations do not converge however stiff they are. */
#include <math.h>
#include <string.h>

#include "math/radau_rows.h"

/* It converges by squares; where it takes more Jacobians the start is too far off. */
static const int MOST_JACOBIANS = 14;

/* While corrections shrink by this the Jacobians are kept: an iteration with new ones costs ten of those. */
static const double KEEPING_CONTRACTION = 0.2;

/* The errors of the first iterations may grow, while a guess is brought to where the problem is nearly
 * linear. */
static const int FREE_ITERATIONS = 6;

/* Corrections that do not shrink any more are rounding where they are below this part of the error
 * allowed. */
static const double FULL_ROUNDING_SHARE = 0.25;

/* Integrals do not see what is less than this part of the error allowed. */
static const double INTEGRAL_SHARE = 0.02;

/* Of the states left, by columns: what depends on them at one stage, and on their places. */
void radau_take_stage_jacobian(struct radau_step *p, int stage)
{
    const struct radau_problem *problem = &p->problem;
    const double clock = p->start + p->length * p->stages->node[stage];
    memcpy(p->point, p->y, (size_t)problem->size * sizeof *p->point);
    radau_step_stage(p, stage, p->point);
    problem->jacobian(problem->context, clock, p->point, p->jacobian);
    p->evaluations += 1;
    radau_take_jacobian(p, p->stage_others, p->stage_places);
}

/* A^-1 - h J_stage (of those left) - h^2 A J_stage (of places), into the rows of one stage. */
static void put_stage(struct radau_step *p, int stage)
{
    const struct radau_stages *stages = p->stages;
    const int s = stages->stages;
    const int m = p->others;
    const struct dense_matrix all = p->all;
    for (int j = 0; j < s; ++j) {
        const double weight = p->length * p->length * stages->integral[stage * s + j];
        for (int column = 0; column < m; ++column) {
            double *to = all.at + (j * m + column) * all.stride + stage * m;
            memset(to, 0, (size_t)m * sizeof *to);
            to[column] = stages->inverse[stage * s + j];
            for (int i = 0; i < m && j == stage; ++i) {
                to[i] -= p->length * p->stage_others[column * m + i];
            }
        }
        for (int k = 0; k < p->problem.paired; ++k) {
            double *to = all.at + (j * m + p->speed_among[k]) * all.stride + stage * m;
            for (int i = 0; i < m; ++i) {
                to[i] -= weight * p->stage_places[k * m + i];
            }
        }
    }
}

/* Factors of the system at what is known of the stages; false where there are none. */
static bool factor_fully(struct radau_step *p)
{
    const int s = p->stages->stages;
    if (p->problem.forces > 0) {
        return radau_forces_factor(p);
    }
    p->all.rows = s * p->others;
    for (int i = 0; i < s; ++i) {
        radau_take_stage_jacobian(p, i);
        put_stage(p, i);
    }
    for (int k = 0; k < p->all.rows; ++k) { /* the zero behind each column */
        p->all.at[k * p->all.stride + p->all.rows] = 0.0;
    }
    return dense_lu_factor(p->all);
}

/* One correction from the residual, by the factors; its largest entry by the weights. */
static double correct_fully(struct radau_step *p)
{
    const int s = p->stages->stages;
    const int m = p->others;
    double *side = p->side;
    if (p->problem.forces > 0) {
        radau_forces_correct(p);
    } else {
        for (int i = 0; i < s; ++i) {
            memcpy(side + i * m, p->residual + i * p->width, (size_t)m * sizeof *side);
        }
        side[s * m] = 0.0;
        dense_lu_solve(p->all, side);
    }
    double largest = 0.0;
    for (int i = 0; i < s; ++i) {
        for (int j = 0; j < m; ++j) {
            p->others_change[i * p->width + j] += side[i * m + j];
            const double size = fabs(side[i * m + j]) * p->weight[p->other[j]];
            largest = size <= largest ? largest : size;
        }
    }
    return largest;
}

/* By how much the last corrections move a place at a stage. */
static double place_moved(const struct radau_step *p, int stage, int place)
{
    const int s = p->stages->stages;
    double sum = 0.0;
    for (int j = 0; j < s; ++j) {
        sum += p->stages->integral[stage * s + j] * p->side[j * p->others + p->speed_among[place]];
    }
    return p->length * sum;
}

/* The rates of the integrals, known before the last corrections, after them. A stiff force is all but
 * rounding where it is evaluated: its argument is a small difference of states. The corrections take that
 * away, so that integrals of it are as smooth as the states. */
static void move_integrals(struct radau_step *p)
{
    const struct radau_problem *problem = &p->problem;
    const int n = problem->size;
    for (int i = 0; i < p->stages->stages; ++i) {
        const double clock = p->start + p->length * p->stages->node[i];
        double *rates = p->rates + i * p->stride;
        memcpy(p->point, p->y, (size_t)n * sizeof *p->point);
        radau_step_stage(p, i, p->point);
        problem->whole_jacobian(problem->context, clock, p->point, p->whole);
        for (int j = 0; j < p->others + problem->paired; ++j) {
            const int k = j - p->others;
            const double moved = k < 0 ? p->side[i * p->others + j] : place_moved(p, i, k);
            const double *column = p->whole + n * (k < 0 ? p->other[j] : problem->place[k]);
            for (int row = problem->integrals; row < n; ++row) {
                rates[row] += column[row] * moved;
            }
        }
    }
    p->evaluations += p->stages->stages;
}

/* Newton's method. The Jacobians are made anew where corrections with those at hand shrink too little. A
 * `quick` one is given up where the first ones do. `*moved` is what has been corrected since. */
static bool iterate_fully(struct radau_step *p, double tolerance, bool quick, double *moved)
{
    double last = (double)INFINITY;
    bool anew = true;
    int jacobians = 0;
    for (p->iterations = 1; jacobians <= MOST_JACOBIANS; ++p->iterations) {
        radau_evaluate_residual(p);
        jacobians += anew ? 1 : 0;
        if (anew && !factor_fully(p)) {
            return false;
        }
        const double size = correct_fully(p);
        radau_move_places(p);
        if (!isfinite(size)) {
            return false;
        }
        *moved = anew ? size : *moved + size;
        p->contraction = size / last;
        if (size <= tolerance ||
            (p->iterations > 1 && p->contraction < 0.1 && size * p->contraction <= tolerance)) {
            return true;
        }
        const bool is_rounding = size <= FULL_ROUNDING_SHARE;
        if (p->contraction > 0.5 && is_rounding) {
            return true;
        }
        const bool shrinks = p->contraction < KEEPING_CONTRACTION || is_rounding;
        if ((jacobians > FREE_ITERATIONS && anew && p->contraction > 0.5) ||
            (quick && p->iterations == 2 && !shrinks)) {
            return false;
        }
        anew = p->iterations > 1 && !shrinks;
        last = size;
    }
    return false;
}

/* What the rates of the integrals miss, about: that of the states left, by the weights. */
static double missed_by_integrals(const struct radau_step *p)
{
    double largest = 0.0;
    for (int i = 0; i < p->stages->stages; ++i) {
        for (int j = 0; j < p->others; ++j) {
            largest = fmax(largest, fabs(p->residual[i * p->width + j]) * p->weight[p->other[j]]);
        }
    }
    return largest;
}

/* Goes on until the integrals miss nothing. Where rounding does not let that happen, only corrections by the
 * Jacobians as they are say what they miss: those at hand, if no more than the error allowed has been
 * corrected since. */
static bool complete_integrals(struct radau_step *p, double moved)
{
    double last = (double)INFINITY;
    for (;;) {
        radau_evaluate_residual(p);
        const double missed = missed_by_integrals(p);
        if (missed <= INTEGRAL_SHARE) {
            return true;
        }
        if (!(missed < KEEPING_CONTRACTION * last)) {
            break;
        }
        moved += correct_fully(p);
        radau_move_places(p);
        last = missed;
    }
    if (!(moved <= 1.0) && !factor_fully(p)) {
        return false;
    }
    if (!isfinite(correct_fully(p))) {
        return false;
    }
    radau_move_places(p);
    move_integrals(p);
    return true;
}

bool radau_step_approach(struct radau_step *p)
{
    double moved;
    return iterate_fully(p, 1.0, false, &moved);
}

bool radau_step_solve_fully(struct radau_step *p, double tolerance)
{
    double moved;
    return iterate_fully(p, tolerance, false, &moved) && complete_integrals(p, moved);
}

bool radau_step_solve_quickly(struct radau_step *p, double tolerance)
{
    double moved;
    return iterate_fully(p, tolerance, true, &moved) && complete_integrals(p, moved);
}
