#include <math.h>

#include "math/compiler.h"
#include "math/lu.h"

/* Runs of rows that find_runs tells apart. In a matrix of no more than DENSE rows it does not look for them:
 * that would cost more than it saves. */
enum { MOST_RUNS = 8, DENSE = 40 };

static inline void swap_elements(double *a, int i, int k)
{
    const double kept = a[i];
    a[i] = a[k];
    a[k] = kept;
}

static inline int largest_of_column(const double *column, int first, int end)
{
    int best = first;
    double largest = -1.0;
    for (int i = first; i < end; ++i) {
        const double size = fabs(column[i]);
        best = size > largest ? i : best;
        largest = size > largest ? size : largest;
    }
    return best;
}

/* Runs of rows, [first, end) each. */
struct runs {
    int count;
    int first[MOST_RUNS], end[MOST_RUNS];
};

/* Finds the rows from `first` on, of n, where one of two columns is not zero. Bodies that do not touch
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

/* to -= by_one one + by_two two, of the elements [first, end). */
static inline void subtract_two(double *to, const double *one, double by_one, const double *two,
                                double by_two, int first, int end)
{
    for (int i = first; i < end; i += LANES) {
        double2_put(to, i, double2_at(to, i) - double2_at(one, i) * by_one - double2_at(two, i) * by_two);
    }
}

/* Finds the pivot of column k, whose elements from k on are complete, and divides by it. Swaps its row and
 * row k of this column and of the other one of a pair. */
static inline bool take_pivot(const struct lu_matrix *m, int k, int other)
{
    const int n = m->rows;
    double *column = m->re + k * m->stride;
    const int row = largest_of_column(column, k, n);
    m->pivot[k] = row;
    swap_elements(column, k, row);
    swap_elements(m->re + other * m->stride, k, row);
    const double pivot = column[k];
    const double inverse = 1.0 / pivot;
    column[k] = inverse;
    for (int i = k + 1; i < n; i += LANES) {
        double2_put(column, i, double2_at(column, i) * inverse);
    }
    return pivot != 0.0 && isfinite(pivot);
}

/* Takes two pivots at a time, which halves the loads and stores of the columns behind them. The columns
 * before them stay as they are; lu_solve swaps elements of the right side as it comes to each column. */
CONTACT_NOINLINE CONTACT_FLATTEN bool lu_factor(struct lu_matrix m)
{
    const int n = m.rows;
    for (int k = 0; k < n; k += 2) {
        if (!take_pivot(&m, k, k + 1 < n ? k + 1 : k)) {
            return false;
        }
        if (k + 1 == n) {
            break;
        }
        double *next = m.re + (k + 1) * m.stride;
        const double by = next[k];
        for (int i = by != 0.0 ? k + 1 : n; i < n; i += LANES) {
            double2_put(next, i, double2_at(next, i) - double2_at(next - m.stride, i) * by);
        }
        if (!take_pivot(&m, k + 1, k)) {
            return false;
        }
        const double *one = m.re + k * m.stride;
        const double *two = one + m.stride;
        struct runs runs; /* bodies that move along an axis leave many zeros */
        find_runs(one, two, k + 2, n, &runs);
        const bool swaps = m.pivot[k] != k || m.pivot[k + 1] != k + 1;
        for (int j = k + 2; j < n; ++j) {
            double *to = m.re + j * m.stride;
            if (swaps) {
                swap_elements(to, k, m.pivot[k]);
                swap_elements(to, k + 1, m.pivot[k + 1]);
            }
            to[k + 1] -= one[k + 1] * to[k];
            const int count = to[k] != 0.0 || to[k + 1] != 0.0 ? runs.count : 0;
            for (int i = 0; i < count; ++i) {
                subtract_two(to, one, to[k], two, to[k + 1], runs.first[i], runs.end[i]);
            }
        }
    }
    return true;
}

/* Takes two columns at a time, as lu_factor does. */
CONTACT_NOINLINE CONTACT_FLATTEN void lu_solve(struct lu_matrix m, double *side)
{
    const int n = m.rows;
    for (int k = 0; k + 1 < n; k += 2) {
        const double *one = m.re + k * m.stride;
        swap_elements(side, k, m.pivot[k]);
        swap_elements(side, k + 1, m.pivot[k + 1]);
        side[k + 1] -= one[k + 1] * side[k];
        subtract_two(side, one, side[k], one + m.stride, side[k + 1], k + 2, n);
    }
    int k = n - 1;
    for (; k > 0; k -= 2) {
        const double *one = m.re + k * m.stride;
        const double *two = one - m.stride;
        const double last = side[k] * one[k];
        const double before = (side[k - 1] - one[k - 1] * last) * two[k - 1];
        subtract_two(side, one, last, two, before, 0, k - 1);
        side[k] = last; /* the last lane of subtract_two may have changed element k - 1 */
        side[k - 1] = before;
    }
    if (k == 0) {
        side[0] *= m.re[0];
    }
}
