/* 3 x 3 matrices, m[row][column]. */
#ifndef CONTACT_MATH_MATRIX3_H
#define CONTACT_MATH_MATRIX3_H

#include "math/vec3.h"

/* m += factor a b^T */
static inline void matrix3_add_outer(double m[3][3], double factor, struct vec3 a, struct vec3 b)
{
    const double left[3] = {a.x, a.y, a.z};
    const double right[3] = {b.x, b.y, b.z};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            m[i][j] += factor * left[i] * right[j];
        }
    }
}

#endif
