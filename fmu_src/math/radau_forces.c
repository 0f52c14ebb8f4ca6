/* Newton's method for a step with the Jacobian at every stage (math/radau_full.c), where the states are
 * coupled by a few forces only: their changes at all stages are the unknowns of the system, of which there
 * are fewer than of the states. What a state feels of its own kind, as the direction of a force does of the
 * place where it acts, is left out: that is not stiff, and the iterations make up for it. */
#include <string.h>

#include "math/radau_rows.h"

/* Of a row of all forces, for loops that take two at a time. */
static int padded_forces(const struct radau_problem *problem)
{
    return (problem->forces + LANES - 1) / LANES * LANES;
}

/* Doubles of memory for the parts of the Jacobians and what follows from a force. */
size_t radau_forces_memory(const struct radau_problem *problem)
{
    const size_t s = RADAU_MOST_STAGES;
    const size_t f = (size_t)padded_forces(problem);
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
    const int f = padded_forces(problem);
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

static double product_of(const double *a, const double *b, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
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
    const int wide = padded_forces(problem);
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

/* A^2 of the method. */
static void put_twice(struct radau_step *p)
{
    const int s = p->stages->stages;
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
                    scale * product_of(to->own + (k * t + r) * n, to->by + (stage * f + g) * n, p->others);
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

/* 1 - of h A by, of one pair of stages, places and tipping states included. */
static void put_block(struct radau_step *p, int i, int j)
{
    const struct radau_forces *to = &p->forces;
    const int s = p->stages->stages;
    const int n = p->problem.coupled;
    const int f = p->problem.forces;
    const int t = p->problem.tipping;
    const int m = p->others;
    const double once = p->length * p->stages->integral[i * s + j];
    const double twice = p->length * p->length * to->twice[i * s + j];
    const int wide = padded_forces(&p->problem);
    const double *of = to->of + i * n * wide;
    const double *tips = to->tips + (i * s + j) * t * f;
    for (int g = 0; g < f; ++g) {
        const double *by = to->by + (j * f + g) * n;
        double *column = p->all.at + (j * f + g) * p->all.stride + i * f;
        for (int e = 0; e < f; e += LANES) {
            double2 sum = {0.0};
            for (int k = 0; k < m; ++k) {
                sum += double2_at(of + k * wide, e) * (once * by[k]);
            }
            for (int k = 0; k < p->problem.paired; ++k) {
                sum += double2_at(of + (m + k) * wide, e) * (twice * by[p->speed_among[k]]);
            }
            for (int r = 0; r < t; ++r) {
                sum += double2_at(of + (m - t + r) * wide, e) * tips[r * f + g];
            }
            double both[LANES];
            double2_put(both, 0, sum);
            for (int lane = 0; lane < LANES && e + lane < f; ++lane) {
                column[e + lane] = (i == j && e + lane == g ? 1.0 : 0.0) - both[lane];
            }
        }
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
        put_tips(p, j);
        for (int i = 0; i < s; ++i) {
            put_block(p, i, j);
        }
    }
    for (int k = 0; k < p->all.rows; ++k) { /* the zero behind each column */
        p->all.at[k * p->all.stride + p->all.rows] = 0.0;
    }
    return dense_lu_factor(p->all);
}

/* Changes of the states left, of tipping ones by the others too: A of the residual; h A of the speeds. */
static void change_without_forces(struct radau_step *p)
{
    const struct radau_forces *to = &p->forces;
    const int s = p->stages->stages;
    const int n = p->problem.coupled;
    const int m = p->others;
    const int t = p->problem.tipping;
    const int width = p->width;
    const int places = radau_padded(p->problem.paired);
    const double *once = p->stages->integral;
    for (int i = 0; i < s; ++i) {
        radau_combine(to->change + i * width, once + i * s, s, p->residual, width, width);
    }
    for (int i = 0; i < s; ++i) {
        for (int r = 0; r < t; ++r) {
            to->row[i * t + r] = p->length * product_of(to->own + (i * t + r) * n, to->change + i * width, m);
        }
        memset(to->moved + i * places, 0, (size_t)places * sizeof *to->moved);
        for (int k = 0; k < p->problem.paired; ++k) {
            to->moved[i * places + k] = p->length * to->change[i * width + p->speed_among[k]];
        }
    }
    for (int i = 0; i < s; ++i) {
        for (int r = 0; r < t; ++r) {
            for (int j = 0; j < s; ++j) {
                to->change[i * width + m - t + r] += once[i * s + j] * to->row[j * t + r];
            }
        }
        radau_combine(to->places + i * places, once + i * s, s, to->moved, places, places);
    }
}

/* By how much the forces at a stage change with those. */
static void put_changes_of_forces(struct radau_step *p, int stage, double *side)
{
    const struct radau_forces *to = &p->forces;
    const int n = p->problem.coupled;
    const int f = p->problem.forces;
    const int m = p->others;
    const int wide = padded_forces(&p->problem);
    const double *of = to->of + stage * n * wide;
    const double *change = to->change + stage * p->width;
    const double *places = to->places + stage * radau_padded(p->problem.paired);
    for (int g = 0; g < f; ++g) {
        double sum = 0.0;
        for (int k = 0; k < m; ++k) {
            sum += of[k * wide + g] * change[k];
        }
        for (int k = 0; k < p->problem.paired; ++k) {
            sum += of[(m + k) * wide + g] * places[k];
        }
        side[g] = sum;
    }
}

void radau_forces_correct(struct radau_step *p)
{
    const struct radau_forces *to = &p->forces;
    const int s = p->stages->stages;
    const int n = p->problem.coupled;
    const int f = p->problem.forces;
    const int m = p->others;
    const int t = p->problem.tipping;
    const int width = p->width;
    change_without_forces(p);
    for (int i = 0; i < s; ++i) {
        put_changes_of_forces(p, i, to->side + i * f);
    }
    to->side[s * f] = 0.0;
    dense_lu_solve(p->all, to->side);
    for (int i = 0; i < s; ++i) {
        double *moved = to->moved + i * width;
        memset(moved, 0, (size_t)width * sizeof *moved);
        for (int g = 0; g < f; ++g) {
            const double *by = to->by + (i * f + g) * n;
            const double change = p->length * to->side[i * f + g];
            for (int k = 0; k < m; ++k) {
                moved[k] += by[k] * change;
            }
        }
    }
    for (int i = 0; i < s; ++i) {
        radau_combine(p->re, p->stages->integral + i * s, s, to->moved, width, width);
        for (int k = 0; k < m; ++k) {
            p->side[i * m + k] = to->change[i * width + k] + p->re[k];
        }
        for (int j = 0; j < s && t > 0; ++j) {
            const double *tips = to->tips + (i * s + j) * t * f;
            for (int r = 0; r < t; ++r) {
                p->side[i * m + m - t + r] += product_of(tips + r * f, to->side + j * f, f);
            }
        }
    }
}
