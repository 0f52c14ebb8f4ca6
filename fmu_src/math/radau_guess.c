/* First guesses of a step that is solved with the Jacobian at every stage (math/radau_full.c). */
#include <math.h>
#include <string.h>

#include "math/radau_rows.h"

static void guess_steady(struct radau_step *p)
{
    memset(p->others_change, 0, (size_t)(p->stages->stages * p->width) * sizeof(double));
    for (int i = 0; i < p->stages->stages; ++i) {
        for (int j = 0; j < p->others; ++j) {
            p->others_change[i * p->width + j] = p->length * p->stages->node[i] * p->start_rates[p->other[j]];
        }
    }
}

/* Up to which coefficient the last polynomial is worth its while at a part of its step: the contributions
 * of later ones grow. */
static int coefficients_worth(const struct radau_step *p, const double *of)
{
    int best = 1;
    double least = (double)INFINITY;
    for (int k = 1; k <= p->known_stages; ++k) {
        double largest = 0.0;
        for (int j = 0; j < p->others; ++j) {
            const int i = p->other[j];
            largest = fmax(largest, fabs(p->chebyshev[k * p->stride + i] * of[k]) * p->weight[i]);
        }
        best = largest < least ? k : best;
        least = fmin(least, largest);
    }
    return best + 1;
}

bool radau_step_goes_on(const struct radau_step *p)
{
    const double end = p->known_start + p->known_length;
    return p->known_length > 0.0 &&
           (p->known_start == p->start || fabs(end - p->start) <= 1e-6 * p->known_length);
}

static void guess_on(struct radau_step *p)
{
    double of[RADAU_MOST_STAGES + 1] = {0.0};
    double here[RADAU_MOST_STAGES + 1] = {0.0};
    const double begins = p->known_start == p->start ? 0.0 : 1.0;
    const double part = p->length / p->known_length;
    radau_polynomials_at(p->known_stages + 1, begins + part, of);
    const int count = begins + part > 1.0 ? coefficients_worth(p, of) : p->known_stages + 1;
    radau_polynomials_at(count, begins, here);
    for (int i = 0; i < p->stages->stages; ++i) {
        radau_polynomials_at(count, begins + part * p->stages->node[i], of);
        for (int k = 0; k < count; ++k) {
            of[k] -= here[k];
        }
        radau_combine(p->point, of, count, p->chebyshev, p->stride, p->stride);
        for (int j = 0; j < p->width; ++j) {
            p->others_change[i * p->width + j] = j < p->others ? p->point[p->other[j]] : 0.0;
        }
    }
}

void radau_step_guess_on(struct radau_step *p, const struct radau_stages *stages, double length)
{
    p->stages = stages;
    p->length = length;
    if (radau_step_goes_on(p)) {
        guess_on(p);
    } else {
        guess_steady(p);
    }
    radau_move_places(p);
}
