/* Factors of a dense real matrix and the solution of its systems, by Gaussian elimination with row pivots.
 * Column by column; a column, and a right side, has a zero at least behind its last element. */
#ifndef CONTACT_MATH_DENSE_LU_H
#define CONTACT_MATH_DENSE_LU_H

#include <stdbool.h>

struct dense_matrix {
    int rows, stride; /* stride: the distance of two columns */
    double *at;
    int *pivot; /* [rows], written by dense_lu_factor */
};

/* In place; false where a pivot is zero or no number. The pivots are stored as their reciprocals. */
bool dense_lu_factor(struct dense_matrix m);

/* Solves for the right side, in place. */
void dense_lu_solve(struct dense_matrix m, double *side);

#endif
