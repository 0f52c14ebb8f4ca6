/* Factors of a dense real matrix and the solution of its systems, by Gaussian elimination with row pivots.
 * Column by column; a column, and a right side, has a zero at least behind its last element. */
#ifndef CONTACT_MATH_LU_H
#define CONTACT_MATH_LU_H

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

/* Factors of a dense complex matrix and the solution of its systems, by Gaussian elimination with row
 * pivots. Real and imaginary parts stand in arrays of their own, column by column; a column, and a right
 * side, has a zero at least behind its last element. */

struct complex_matrix {
    int rows, stride; /* stride: the distance of two columns */
    double *re, *im;
    int *pivot; /* [rows], written by complex_lu_factor */
};

/* In place; false where a pivot is zero or no number. The pivots are stored as their reciprocals. */
bool complex_lu_factor(struct complex_matrix m);

/* Solves for the right side re + i im, in place. */
void complex_lu_solve(struct complex_matrix m, double *re, double *im);

#endif
