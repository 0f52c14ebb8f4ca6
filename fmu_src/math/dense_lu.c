#include "math/dense_lu.h"

#include <math.h>

#include "math/nodal_values.h"

/* to -= factor from, of the elements [first, end). */
static void subtract_scaled(double *to, const double *from, double factor, int first, int end)
{
    for (int i = first; i < end; i += LANES) {
        double2_put(to, i, double2_at(to, i) - double2_at(from, i) * factor);
    }
}

static int largest_below(const double *column, int first, int end)
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

bool dense_lu_factor(struct dense_matrix m)
{
    const int n = m.rows;
    for (int k = 0; k < n; ++k) {
        double *column = m.at + k * m.stride;
        const int pivot = largest_below(column, k, n);
        m.pivot[k] = pivot;
        for (int j = 0; j < n && pivot != k; ++j) {
            double *other = m.at + j * m.stride;
            const double kept = other[k];
            other[k] = other[pivot];
            other[pivot] = kept;
        }
        if (column[k] == 0.0 || !isfinite(column[k])) {
            return false;
        }
        column[k] = 1.0 / column[k];
        for (int i = k + 1; i < n; ++i) {
            column[i] *= column[k];
        }
        for (int j = k + 1; j < n; ++j) {
            double *other = m.at + j * m.stride;
            if (other[k] != 0.0) {
                subtract_scaled(other, column, other[k], k + 1, n);
            }
        }
    }
    return true;
}

void dense_lu_solve(struct dense_matrix m, double *side)
{
    const int n = m.rows;
    for (int k = 0; k < n; ++k) {
        const double kept = side[k];
        side[k] = side[m.pivot[k]];
        side[m.pivot[k]] = kept;
    }
    for (int k = 0; k < n; ++k) {
        subtract_scaled(side, m.at + k * m.stride, side[k], k + 1, n);
    }
    for (int k = n - 1; k >= 0; --k) {
        const double solved = side[k] * m.at[k * m.stride + k];
        side[k] = solved;
        subtract_scaled(side, m.at + k * m.stride, solved, 0, k);
        side[k] = solved; /* the last pair may have changed it */
    }
}
