#include <math.h>
#include <stddef.h>

#include "math/compiler.h"
#include "math/lu.h"
#include "math/nodes.h"

/* Runs of rows that find_runs tells apart. In a matrix of no more than DENSE rows it does not look for them:
 * that would cost more than it saves. */
enum { MOST_RUNS = 8, DENSE = 40 };

/* A column of the matrix or a right side. In the functions below `is_complex` is a constant: the code of a
 * real matrix does not touch imaginary parts. */
struct column {
    double *re, *im;
};

static inline struct column column_of(const struct lu_matrix *m, int k, bool is_complex)
{
    return (struct column){m->re + k * m->stride, is_complex ? m->im + k * m->stride : NULL};
}

/* to -= (re + i im) from, of the elements [first, end). Bodies that move along an axis leave many zeros. */
static inline void subtract_column(struct column to, struct column from, double re, double im, int first,
                                   int end, bool is_complex)
{
    if (re == 0.0 && im == 0.0) {
        return;
    }
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

/* Runs of rows, [first, end) each. */
struct runs {
    int count;
    int first[MOST_RUNS], end[MOST_RUNS];
};

/* Finds the rows from `first` on, of n, where one of two real columns is not zero. Bodies that do not touch
 * each other leave blocks of zeros. Past the last run that has room, zeros are taken along. */
static inline void find_runs(const double *one, const double *two, int first, int n, struct runs *to)
{
    to->count = n > DENSE ? 0 : 1;
    to->first[0] = first;
    to->end[0] = n;
    for (int i = first; i < n && n > DENSE; ++i) {
        if (one[i] == 0.0 && two[i] == 0.0) {
            continue;
        }
        if (to->count > 0 && (to->end[to->count - 1] == i || to->count == MOST_RUNS)) {
            to->end[to->count - 1] = i + 1;
        } else {
            to->first[to->count] = i;
            to->end[to->count] = i + 1;
            to->count += 1;
        }
    }
}

/* to -= re_1 first - re_2 second, of the elements [first, end) of real columns. */
static inline void subtract_two(double *to, const double *one, double by_one, const double *two,
                                double by_two, int first, int end)
{
    for (int i = first; i < end; i += LANES) {
        double2_put(to, i, double2_at(to, i) - double2_at(one, i) * by_one - double2_at(two, i) * by_two);
    }
}

/* Finds the pivot of column k, whose elements from k on are complete, and divides by it. */
static inline bool take_pivot(const struct lu_matrix *m, int k, bool is_complex)
{
    const int n = m->rows;
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
    return true;
}

/* Subtracts column k from a later one. */
static inline void eliminate(const struct lu_matrix *m, int k, int j, bool is_complex)
{
    const struct column other = column_of(m, j, is_complex);
    subtract_column(other, column_of(m, k, is_complex), other.re[k], is_complex ? other.im[k] : 0.0, k + 1,
                    m->rows, is_complex);
}

static inline bool factor_complex(const struct lu_matrix *m)
{
    for (int k = 0; k < m->rows; ++k) {
        if (!take_pivot(m, k, true)) {
            return false;
        }
        for (int j = k + 1; j < m->rows; ++j) {
            eliminate(m, k, j, true);
        }
    }
    return true;
}

/* Two pivots at a time, which halves the loads and stores of the columns behind them. */
static inline bool factor_real(const struct lu_matrix *m)
{
    const int n = m->rows;
    for (int k = 0; k < n; k += 2) {
        if (!take_pivot(m, k, false)) {
            return false;
        }
        if (k + 1 == n) {
            break;
        }
        eliminate(m, k, k + 1, false);
        if (!take_pivot(m, k + 1, false)) {
            return false;
        }
        const double *one = m->re + k * m->stride;
        const double *two = one + m->stride;
        struct runs runs;
        find_runs(one, two, k + 2, n, &runs);
        for (int j = k + 2; j < n; ++j) {
            double *to = m->re + j * m->stride;
            to[k + 1] -= one[k + 1] * to[k];
            for (int i = 0; i < runs.count && (to[k] != 0.0 || to[k + 1] != 0.0); ++i) {
                subtract_two(to, one, to[k], two, to[k + 1], runs.first[i], runs.end[i]);
            }
        }
    }
    return true;
}

static inline void swap_side(const struct lu_matrix *m, struct column side, bool is_complex)
{
    for (int k = 0; k < m->rows; ++k) {
        swap_rows(side, k, m->pivot[k], is_complex);
    }
}

static inline void solve_complex(const struct lu_matrix *m, struct column side)
{
    const int n = m->rows;
    swap_side(m, side, true);
    for (int k = 0; k < n; ++k) {
        subtract_column(side, column_of(m, k, true), side.re[k], side.im[k], k + 1, n, true);
    }
    for (int k = n - 1; k >= 0; --k) {
        const struct column column = column_of(m, k, true);
        const double re = side.re[k] * column.re[k] - side.im[k] * column.im[k];
        const double im = side.re[k] * column.im[k] + side.im[k] * column.re[k];
        subtract_column(side, column, re, im, 0, k, true);
        side.re[k] = re; /* the last lane of subtract_column may have changed element k */
        side.im[k] = im;
    }
}

/* Two columns at a time, as factor_real. */
static inline void solve_real(const struct lu_matrix *m, double *side)
{
    const int n = m->rows;
    swap_side(m, (struct column){side, NULL}, false);
    for (int k = 0; k + 1 < n; k += 2) {
        const double *one = m->re + k * m->stride;
        side[k + 1] -= one[k + 1] * side[k];
        subtract_two(side, one, side[k], one + m->stride, side[k + 1], k + 2, n);
    }
    int k = n - 1;
    for (; k > 0; k -= 2) {
        const double *one = m->re + k * m->stride;
        const double *two = one - m->stride;
        const double last = side[k] * one[k];
        const double before = (side[k - 1] - one[k - 1] * last) * two[k - 1];
        subtract_two(side, one, last, two, before, 0, k - 1);
        side[k] = last; /* the last lane of subtract_two may have changed element k - 1 */
        side[k - 1] = before;
    }
    if (k == 0) {
        side[0] *= m->re[0];
    }
}

CONTACT_FLATTEN bool lu_factor(struct lu_matrix m)
{
    return m.im != NULL ? factor_complex(&m) : factor_real(&m);
}

CONTACT_FLATTEN void lu_solve(struct lu_matrix m, double *re, double *im)
{
    if (m.im != NULL) {
        solve_complex(&m, (struct column){re, im});
    } else {
        solve_real(&m, re);
    }
}
