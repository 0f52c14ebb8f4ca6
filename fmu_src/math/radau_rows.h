/* Rows of numbers as radau_step.c and radau_solve.c keep them. */
#ifndef CONTACT_MATH_RADAU_ROWS_H
#define CONTACT_MATH_RADAU_ROWS_H

#include "math/nodal_values.h"
#include "math/radau_step.h"

/* Rows end with at least one zero and are so many numbers long, for loops that take some at a time. */
enum { RADAU_ROW_BLOCK = 4 };

static inline int radau_padded(int count)
{
    return (count / RADAU_ROW_BLOCK + 1) * RADAU_ROW_BLOCK;
}

/* A row of a table times the rows of `from`. */
static inline void radau_combine(double *restrict to, const double *row, int count, const double *from,
                                 int stride, int width)
{
    for (int i = 0; i < width; i += 2 * LANES) {
        double2 low = {0.0};
        double2 high = {0.0};
        for (int j = 0; j < count; ++j) {
            low += double2_at(from + j * stride, i) * row[j];
            high += double2_at(from + j * stride, i + LANES) * row[j];
        }
        double2_put(to, i, low);
        double2_put(to, i + LANES, high);
    }
}

/* Chebyshev polynomials at a part of the step, by their recurrence. */
static inline void radau_polynomials_at(int count, double part, double *of)
{
    const double x = 2.0 * part - 1.0;
    of[0] = 1.0;
    of[1] = x;
    for (int k = 2; k < count; ++k) {
        of[k] = 2.0 * x * of[k - 1] - of[k - 2];
    }
}

/* Of a row of all forces, for loops that take four at a time: columns of the matrix are as much longer than
 * its rows, which are a multiple of the stages. */
static inline int radau_padded_forces(const struct radau_problem *problem)
{
    return (problem->forces + 2 * LANES - 1) / (2 * LANES) * (2 * LANES);
}

/* The product of two rows. */
static inline double radau_product(const double *a, const double *b, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* radau_step.c: the parts of p->jacobian that are kept as by_others and by_places. */
void radau_take_jacobian(const struct radau_step *p, double *by_others, double *by_places);

/* radau_solve.c: what follows for the places, h A times their speeds; the residual h f - A^-1 change. */
void radau_move_places(struct radau_step *p);
void radau_evaluate_residual(struct radau_step *p);

/* radau_full.c: p->stage_others and p->stage_places at what is known of a stage. */
void radau_take_stage_jacobian(struct radau_step *p, int stage);

/* radau_forces.c: factors of the system of the forces at what is known of the stages, false where there are
 * none. radau_forces_correct.c: changes of the states left by the residual, into p->side. */
size_t radau_forces_memory(const struct radau_problem *problem);
void radau_forces_place(struct radau_step *p, double *memory);
bool radau_forces_factor(struct radau_step *p);
void radau_forces_correct(struct radau_step *p);

#endif
