#include <math.h>

#include "math/lu.h"
#include "math/nodes.h"

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

/* to -= (re + i im) from, of the elements [first, end). */
static void subtract_column(double *to_re, double *to_im, const double *from_re, const double *from_im,
                            double re, double im, int first, int end)
{
    for (int i = first; i < end; i += LANES) {
        const double2 a = double2_at(from_re, i);
        const double2 b = double2_at(from_im, i);
        double2_put(to_re, i, double2_at(to_re, i) - (a * re - b * im));
        double2_put(to_im, i, double2_at(to_im, i) - (a * im + b * re));
    }
}

static void swap_elements(double *a, int i, int k)
{
    const double kept = a[i];
    a[i] = a[k];
    a[k] = kept;
}

static int largest_of_column(const double *re, const double *im, int first, int end)
{
    int best = first;
    double largest = -1.0;
    for (int i = first; i < end; ++i) {
        const double size = fabs(re[i]) + fabs(im[i]);
        best = size > largest ? i : best;
        largest = size > largest ? size : largest;
    }
    return best;
}

bool complex_lu_factor(struct complex_matrix m)
{
    const int n = m.rows;
    for (int k = 0; k < n; ++k) {
        double *re = m.re + k * m.stride;
        double *im = m.im + k * m.stride;
        const int pivot = largest_of_column(re, im, k, n);
        m.pivot[k] = pivot;
        for (int j = 0; j < n && pivot != k; ++j) {
            swap_elements(m.re + j * m.stride, k, pivot);
            swap_elements(m.im + j * m.stride, k, pivot);
        }
        const double square = re[k] * re[k] + im[k] * im[k];
        if (!(square > 0.0) || !isfinite(square)) {
            return false;
        }
        const double inverse_re = re[k] / square;
        const double inverse_im = -im[k] / square;
        re[k] = inverse_re;
        im[k] = inverse_im;
        for (int i = k + 1; i < n; ++i) {
            const double a = re[i];
            re[i] = a * inverse_re - im[i] * inverse_im;
            im[i] = a * inverse_im + im[i] * inverse_re;
        }
        for (int j = k + 1; j < n; ++j) {
            double *to_re = m.re + j * m.stride;
            double *to_im = m.im + j * m.stride;
            if (to_re[k] != 0.0 || to_im[k] != 0.0) {
                subtract_column(to_re, to_im, re, im, to_re[k], to_im[k], k + 1, n);
            }
        }
    }
    return true;
}

void complex_lu_solve(struct complex_matrix m, double *re, double *im)
{
    const int n = m.rows;
    for (int k = 0; k < n; ++k) {
        if (m.pivot[k] != k) {
            swap_elements(re, k, m.pivot[k]);
            swap_elements(im, k, m.pivot[k]);
        }
    }
    for (int k = 0; k < n; ++k) {
        subtract_column(re, im, m.re + k * m.stride, m.im + k * m.stride, re[k], im[k], k + 1, n);
    }
    for (int k = n - 1; k >= 0; --k) {
        const double *column_re = m.re + k * m.stride;
        const double *column_im = m.im + k * m.stride;
        const double a = re[k];
        re[k] = a * column_re[k] - im[k] * column_im[k];
        im[k] = a * column_im[k] + im[k] * column_re[k];
        const double b = re[k];
        const double c = im[k];
        subtract_column(re, im, column_re, column_im, b, c, 0, k);
        if (k % LANES != 0) { /* the last of them was not meant */
            re[k] = b;
            im[k] = c;
        }
    }
}
