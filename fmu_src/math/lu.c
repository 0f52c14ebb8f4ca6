#include <math.h>
#include <stddef.h>

#include "math/compiler.h"
#include "math/lu.h"
#include "math/nodes.h"

/* A column of the matrix or a right side. In the functions below `is_complex` is a constant: the code of a
 * real matrix does not touch imaginary parts. */
struct column {
    double *re, *im;
};

static inline struct column column_of(const struct lu_matrix *m, int k, bool is_complex)
{
    return (struct column){m->re + k * m->stride, is_complex ? m->im + k * m->stride : NULL};
}

/* to -= (re + i im) from, of the elements [first, end). */
static inline void subtract_column(struct column to, struct column from, double re, double im, int first,
                                   int end, bool is_complex)
{
    for (int i = first; i < end; i += LANES) {
        const double2 a = double2_at(from.re, i);
        if (is_complex) {
            const double2 b = double2_at(from.im, i);
            double2_put(to.re, i, double2_at(to.re, i) - (a * re - b * im));
            double2_put(to.im, i, double2_at(to.im, i) - (a * im + b * re));
        } else {
            double2_put(to.re, i, double2_at(to.re, i) - a * re);
        }
    }
}

static inline void swap_elements(double *a, int i, int k)
{
    const double kept = a[i];
    a[i] = a[k];
    a[k] = kept;
}

static inline void swap_rows(struct column column, int i, int k, bool is_complex)
{
    swap_elements(column.re, i, k);
    if (is_complex) {
        swap_elements(column.im, i, k);
    }
}

static inline int largest_of_column(struct column column, int first, int end, bool is_complex)
{
    int best = first;
    double largest = -1.0;
    for (int i = first; i < end; ++i) {
        const double size = is_complex ? fabs(column.re[i]) + fabs(column.im[i]) : fabs(column.re[i]);
        best = size > largest ? i : best;
        largest = size > largest ? size : largest;
    }
    return best;
}

/* column[i] *= column[k] */
static inline void scale_element(struct column column, int i, int k, bool is_complex)
{
    const double re = column.re[k];
    if (is_complex) {
        const double a = column.re[i];
        column.re[i] = a * re - column.im[i] * column.im[k];
        column.im[i] = a * column.im[k] + column.im[i] * re;
    } else {
        column.re[i] *= re;
    }
}

/* Replaces a pivot by its reciprocal. */
static inline bool invert_pivot(struct column column, int k, bool is_complex)
{
    if (!is_complex) {
        const double pivot = column.re[k];
        column.re[k] = 1.0 / pivot;
        return pivot != 0.0 && isfinite(pivot);
    }
    const double square = column.re[k] * column.re[k] + column.im[k] * column.im[k];
    column.re[k] = column.re[k] / square;
    column.im[k] = -column.im[k] / square;
    return square > 0.0 && isfinite(square);
}

static inline bool factor_matrix(const struct lu_matrix *m, bool is_complex)
{
    const int n = m->rows;
    for (int k = 0; k < n; ++k) {
        const struct column column = column_of(m, k, is_complex);
        const int pivot = largest_of_column(column, k, n, is_complex);
        m->pivot[k] = pivot;
        for (int j = 0; j < n && pivot != k; ++j) {
            swap_rows(column_of(m, j, is_complex), k, pivot, is_complex);
        }
        if (!invert_pivot(column, k, is_complex)) {
            return false;
        }
        for (int i = k + 1; i < n; ++i) {
            scale_element(column, i, k, is_complex);
        }
        for (int j = k + 1; j < n; ++j) {
            const struct column other = column_of(m, j, is_complex);
            if (other.re[k] != 0.0 || (is_complex && other.im[k] != 0.0)) {
                subtract_column(other, column, other.re[k], is_complex ? other.im[k] : 0.0, k + 1, n,
                                is_complex);
            }
        }
    }
    return true;
}

static inline void solve_matrix(const struct lu_matrix *m, struct column side, bool is_complex)
{
    const int n = m->rows;
    for (int k = 0; k < n; ++k) {
        swap_rows(side, k, m->pivot[k], is_complex);
    }
    for (int k = 0; k < n; ++k) {
        subtract_column(side, column_of(m, k, is_complex), side.re[k], is_complex ? side.im[k] : 0.0, k + 1,
                        n, is_complex);
    }
    for (int k = n - 1; k >= 0; --k) {
        const struct column column = column_of(m, k, is_complex);
        double re = side.re[k] * column.re[k];
        double im = 0.0;
        if (is_complex) {
            re -= side.im[k] * column.im[k];
            im = side.re[k] * column.im[k] + side.im[k] * column.re[k];
        }
        subtract_column(side, column, re, im, 0, k, is_complex);
        side.re[k] = re; /* the last lane of subtract_column may have changed element k */
        if (is_complex) {
            side.im[k] = im;
        }
    }
}

CONTACT_FLATTEN bool lu_factor(struct lu_matrix m)
{
    return m.im != NULL ? factor_matrix(&m, true) : factor_matrix(&m, false);
}

CONTACT_FLATTEN void lu_solve(struct lu_matrix m, double *re, double *im)
{
    if (m.im != NULL) {
        solve_matrix(&m, (struct column){re, im}, true);
    } else {
        solve_matrix(&m, (struct column){re, NULL}, false);
    }
}
