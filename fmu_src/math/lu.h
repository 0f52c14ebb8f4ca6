/*
 * Factors of a dense matrix and the solution of its systems, by Gaussian elimination with row pivots. The
 * matrix is stored column by column. At least one zero follows each column and each right side.
 */
#ifndef CONTACT_MATH_LU_H
#define CONTACT_MATH_LU_H

#include <stdbool.h>

struct lu_matrix {
    int rows, stride; /* stride: the distance of two columns */
    double *re;
    int *pivot; /* [rows], written by lu_factor */
};

/* Returns the part of a matrix in `rows` rows and columns from `first` on. It may be used by itself where all
 * else in these rows and columns is zero. */
static inline struct lu_matrix lu_part(struct lu_matrix m, int first, int rows)
{
    const int at = first * (m.stride + 1);
    return (struct lu_matrix){rows, m.stride, m.re + at, m.pivot + first};
}

/* Factors in place. Returns false where a pivot is zero or not finite. The pivots are stored as their
 * reciprocals. */
bool lu_factor(struct lu_matrix m);

/* Solves for a right side in place. */
void lu_solve(struct lu_matrix m, double *side);

#endif
