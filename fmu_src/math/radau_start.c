/* What a step does not see before its first stage. */
#include <math.h>
#include <string.h>

#include "math/radau_rows.h"

/* h (rates at the start less those of the polynomial there), of those left. */
static void put_start_defect(struct radau_step *p)
{
    const int s = p->stages->stages;
    for (int i = 0; i < p->others; ++i) {
        const int j = p->other[i];
        double slope = 0.0; /* T_k' = -(-1)^k k^2 there, and the step is two long */
        for (int k = 1; k <= s; ++k) {
            slope += (k % 2 == 0 ? -2.0 : 2.0) * k * k * p->chebyshev[k * p->stride + j];
        }
        p->side[i] = p->length * p->start_rates[j] - slope;
    }
    p->side[p->others] = 0.0;
}

/* I - h J, of those left, factored; where `by_places` is not NULL with what they feel through the places. */
static bool factor_dying(struct radau_step *p, struct dense_matrix system, const double *by_others,
                         const double *by_places)
{
    const int m = system.rows;
    for (int column = 0; column < m; ++column) {
        double *to = system.at + column * system.stride;
        for (int i = 0; i < m; ++i) {
            to[i] = (i == column ? 1.0 : 0.0) - p->length * by_others[column * m + i];
        }
        to[m] = 0.0;
    }
    for (int k = 0; k < p->problem.paired && by_places; ++k) {
        double *to = system.at + p->speed_among[k] * system.stride;
        for (int i = 0; i < m; ++i) {
            to[i] -= p->length * p->length * by_places[k * m + i];
        }
    }
    return dense_lu_factor(system);
}

/* What dies away is the defect less what is left of it, (1 - 1/(1 + h lambda)) of it, and leaves behind
 * as much as it acts for, 1/(1 + h lambda) of that. */
double radau_step_start_error(struct radau_step *p)
{
    const int m = p->others;
    struct dense_matrix system = p->all;
    system.rows = m;
    put_start_defect(p);
    if (!factor_dying(p, system, p->by_others, NULL)) {
        return (double)INFINITY;
    }
    memcpy(p->point, p->side, (size_t)m * sizeof *p->side);
    dense_lu_solve(system, p->side);
    for (int i = 0; i < m; ++i) {
        p->side[i] = p->point[i] - p->side[i];
    }
    dense_lu_solve(system, p->side);
    radau_take_stage_jacobian(p, p->stages->stages - 1);
    if (!factor_dying(p, system, p->stage_others, p->stage_places)) {
        return (double)INFINITY;
    }
    dense_lu_solve(system, p->side);
    double largest = 0.0;
    for (int i = 0; i < m; ++i) {
        const double size = fabs(p->side[i]) * p->weight[p->other[i]];
        largest = size <= largest ? largest : size;
    }
    return largest;
}
