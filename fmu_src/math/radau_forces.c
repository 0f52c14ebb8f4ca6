/* Newton's method for a step with the Jacobian at every stage (math/radau_full.c), where the states are
 * coupled by a few forces only: their changes at all stages are the unknowns of the system, of which there
 * are fewer than of the states. What a state feels of its own kind, as the direction of a force does of the
 * place where it acts, is left out: that is not stiff, and the iterations make up for it. */
#include <string.h>

#include "math/radau_rows.h"

/* Doubles of memory for the parts of the Jacobians and what follows from a force. */
size_t radau_forces_memory(const struct radau_problem *problem)
{
    const size_t s = RADAU_MOST_STAGES;
    const size_t f = (size_t)radau_padded_forces(problem);
    const size_t n = (size_t)radau_padded(problem->coupled);
    const size_t t = (size_t)problem->tipping;
    return f > 0 ? 2 * n * f + s * (2 * n * f + t * n + t * f + 3 * n + f + 1) + s * s * (t * f + 1) : 0;
}

static double *take_some(double **from, int count)
{
    double *taken = *from;
    *from += count;
    return taken;
}

void radau_forces_place(struct radau_step *p, double *memory)
{
    const struct radau_problem *problem = &p->problem;
    struct radau_forces *to = &p->forces;
    const int s = RADAU_MOST_STAGES;
    const int f = radau_padded_forces(problem);
    const int n = radau_padded(problem->coupled);
    const int t = problem->tipping;
    if (f == 0) {
        return;
    }
    to->by_forces = take_some(&memory, n * f);
    to->of_forces = take_some(&memory, n * f);
    to->by = take_some(&memory, s * n * f);
    to->of = take_some(&memory, s * n * f);
    to->own = take_some(&memory, s * t * n);
    to->row = take_some(&memory, s * t * f);
    to->change = take_some(&memory, s * n);
    to->places = take_some(&memory, s * n);
    to->moved = take_some(&memory, s * n);
    to->side = take_some(&memory, s * f + s);
    to->tips = take_some(&memory, s * s * t * f);
    to->twice = take_some(&memory, s * s);
}

/* The parts of the Jacobian at a stage: what a force does to the states left, a row a force; how forces
 * depend on them and on the places, a row a state; how tipping states depend on those left, a row a
 * state. */
static void take_split_stage(struct radau_step *p, int stage)
{
    const struct radau_problem *problem = &p->problem;
    const struct radau_forces *to = &p->forces;
    const int n = problem->coupled;
    const int m = p->others;
    const int f = problem->forces;
    const int wide = radau_padded_forces(problem);
    memcpy(p->point, p->y, (size_t)problem->size * sizeof *p->point);
    radau_step_stage(p, stage, p->point);
    problem->split_jacobian(problem->context, p->start + p->length * p->stages->node[stage], p->point,
                            p->jacobian, to->by_forces, to->of_forces);
    p->evaluations += 1;
    double *of = to->of + stage * n * wide;
    memset(of, 0, (size_t)(n * wide) * sizeof *of);
    for (int g = 0; g < f; ++g) {
        double *by = to->by + (stage * f + g) * n;
        for (int i = 0; i < m; ++i) {
            by[i] = to->by_forces[g * n + p->other[i]];
            of[i * wide + g] = to->of_forces[p->other[i] * f + g];
        }
        for (int k = 0; k < problem->paired; ++k) {
            of[(m + k) * wide + g] = to->of_forces[problem->place[k] * f + g];
        }
    }
    for (int r = 0; r < problem->tipping; ++r) {
        double *own = to->own + (stage * problem->tipping + r) * n;
        const int row = p->other[m - problem->tipping + r];
        for (int i = 0; i < m; ++i) {
            own[i] = p->jacobian[p->other[i] * n + row];
        }
    }
}

/* A^2 of the method, unless it is there. */
static void put_twice(struct radau_step *p)
{
    const int s = p->stages->stages;
    if (p->forces.twice_of == p->stages) {
        return;
    }
    p->forces.twice_of = p->stages;
    const double *once = p->stages->integral;
    for (int i = 0; i < s; ++i) {
        for (int j = 0; j < s; ++j) {
            double sum = 0.0;
            for (int k = 0; k < s; ++k) {
                sum += once[i * s + k] * once[k * s + j];
            }
            p->forces.twice[i * s + j] = sum;
        }
    }
}

/* What tipping states at all stages follow of the forces at one: h^2 sum A_ik A_kj own_k by_j. */
static void put_tips(struct radau_step *p, int stage)
{
    const struct radau_forces *to = &p->forces;
    const int s = p->stages->stages;
    const int n = p->problem.coupled;
    const int f = p->problem.forces;
    const int t = p->problem.tipping;
    const double *once = p->stages->integral;
    for (int k = 0; k < s; ++k) {
        const double scale = p->length * p->length * once[k * s + stage];
        for (int r = 0; r < t; ++r) {
            for (int g = 0; g < f; ++g) {
                to->row[(k * t + r) * f + g] =
                    scale * radau_product(to->own + (k * t + r) * n, to->by + (stage * f + g) * n, p->others);
            }
        }
    }
    for (int i = 0; i < s; ++i) {
        double *restrict tips = to->tips + (i * s + stage) * t * f;
        memset(tips, 0, (size_t)(t * f) * sizeof *tips);
        for (int k = 0; k < s; ++k) {
            const double weight = once[i * s + k];
            for (int e = 0; e < t * f; ++e) {
                tips[e] += weight * to->row[k * t * f + e];
            }
        }
    }
}

/* Four numbers from `e` on of the sum of rows `of` [count][wide], each times its own of `by`: each `apart`-th
 * of them, or those that `among` says. */
struct four_sums {
    double2 low, high;
};

static inline struct four_sums sum_rows(const double *of, int wide, int e, int count, const double *by,
                                        int apart, const int *among)
{
    const double2 none = {0.0};
    struct four_sums sum = {none, none};
    for (int k = 0; k < count; ++k) {
        const double factor = by[among ? among[k] : k * apart];
        sum.low += double2_at(of + k * wide, e) * factor;
        sum.high += double2_at(of + k * wide, e + LANES) * factor;
    }
    return sum;
}

/* 1 - of h A by, of one pair of stages, places and tipping states included. Rows beyond the forces of a stage
 * are those of the next one, which comes later, or behind the matrix. */
static void put_block(struct radau_step *p, int i, int j)
{
    const struct radau_forces *to = &p->forces;
    const int s = p->stages->stages;
    const int n = p->problem.coupled;
    const int f = p->problem.forces;
    const int t = p->problem.tipping;
    const int m = p->others;
    const double once = -p->length * p->stages->integral[i * s + j];
    const double twice = -p->length * p->length * to->twice[i * s + j];
    const int wide = radau_padded_forces(&p->problem);
    const double *of = to->of + i * n * wide;
    const double *places = of + m * wide;
    const double *tips = to->tips + (i * s + j) * t * f;
    for (int g = 0; g < f; ++g) {
        const double *by = to->by + (j * f + g) * n;
        double *column = p->all.at + (j * f + g) * p->all.stride + i * f;
        for (int e = 0; e < wide; e += 2 * LANES) {
            const struct four_sums a = sum_rows(of, wide, e, m, by, 1, NULL);
            const struct four_sums b = sum_rows(places, wide, e, p->problem.paired, by, 0, p->speed_among);
            const struct four_sums c = sum_rows(places - t * wide, wide, e, t, tips + g, f, NULL);
            double2_put(column, e, once * a.low + twice * b.low - c.low);
            double2_put(column, e + LANES, once * a.high + twice * b.high - c.high);
        }
        column[g] += i == j ? 1.0 : 0.0;
    }
}

bool radau_forces_factor(struct radau_step *p)
{
    const int s = p->stages->stages;
    p->all.rows = s * p->problem.forces;
    for (int i = 0; i < s; ++i) {
        take_split_stage(p, i);
    }
    put_twice(p);
    for (int j = 0; j < s; ++j) {
        if (p->problem.tipping > 0) {
            put_tips(p, j);
        }
        for (int i = 0; i < s; ++i) {
            put_block(p, i, j);
        }
    }
    for (int k = 0; k < p->all.rows; ++k) { /* the zero behind each column */
        p->all.at[k * p->all.stride + p->all.rows] = 0.0;
    }
    return dense_lu_factor(p->all);
}
