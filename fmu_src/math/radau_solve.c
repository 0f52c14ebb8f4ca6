/* Simplified Newton iterations of a step: its systems, a first guess, corrections. */
#include <math.h>
#include <string.h>

#include "math/radau_rows.h"

/* More are dearer than two steps of half the length. */
static const int MOST_ITERATIONS = 12;

/* Corrections that shrink no faster do not get there within those. */
static const double SLOWEST_CONTRACTION = 0.5;

/* Unless they are rounding, by which they are below this part of the error allowed. */
static const double ROUNDING_SHARE = 0.25;

/* lambda - h J of those left, with what they feel through the places: those change by h/lambda of their
 * speeds. */
static bool factor(struct radau_step *p, const struct radau_stages *stages, double length)
{
    if (p->factored_length == length && p->factored_stages == stages) {
        return true;
    }
    const int m = p->others;
    const int paired = p->problem.paired;
    p->factored_length = 0.0;
    for (int k = 0; k < stages->stages / 2; ++k) {
        const double re = stages->eigenvalue[2 * k];
        const double im = stages->eigenvalue[2 * k + 1];
        const double scale = length * length / (re * re + im * im);
        const struct complex_matrix system = p->system[k];
        memset(system.im, 0, (size_t)(m * system.stride) * sizeof(double));
        memset(system.re, 0, (size_t)(m * system.stride) * sizeof(double));
        for (int j = 0; j < m; ++j) {
            double *column = system.re + j * system.stride;
            for (int i = 0; i < m; ++i) {
                column[i] = -length * p->by_others[j * m + i];
            }
        }
        for (int j = 0; j < paired; ++j) {
            double *column_re = system.re + p->speed_among[j] * system.stride;
            double *column_im = system.im + p->speed_among[j] * system.stride;
            for (int i = 0; i < m; ++i) {
                column_re[i] -= scale * re * p->by_places[j * m + i];
                column_im[i] += scale * im * p->by_places[j * m + i];
            }
        }
        for (int i = 0; i < m; ++i) {
            system.re[i * system.stride + i] += re;
            system.im[i * system.stride + i] += im;
        }
        if (!complex_lu_factor(system)) {
            return false;
        }
    }
    p->factored_length = length;
    p->factored_stages = stages;
    return true;
}

/* One correction from p->residual; its largest entry by the weights. */
static double correct(struct radau_step *p)
{
    const struct radau_stages *stages = p->stages;
    const int s = stages->stages;
    const int width = p->width;
    double *parts = p->scratch; /* of the solutions: all real parts, all imaginary ones */
    for (int k = 0; k < s / 2; ++k) {
        double *re = parts + 2 * k * width;
        radau_combine(re, stages->into + 2 * k * s, s, p->residual, width, width);
        radau_combine(re + width, stages->into + (2 * k + 1) * s, s, p->residual, width, width);
        complex_lu_solve(p->system[k], re, re + width);
    }
    double largest = 0.0;
    for (int i = 0; i < s; ++i) {
        radau_combine(p->re, stages->back + i * s, s, parts, width, width);
        for (int j = 0; j < p->others; ++j) {
            p->others_change[i * width + j] += p->re[j];
            const double size = fabs(p->re[j]) * p->weight[p->other[j]];
            largest = size <= largest ? largest : size; /* no number is larger than any */
        }
    }
    return largest;
}

/* What follows for the places: h A times their speeds. */
void radau_move_places(struct radau_step *p)
{
    const struct radau_problem *problem = &p->problem;
    const struct radau_stages *stages = p->stages;
    const int s = stages->stages;
    double *speeds = p->scratch;
    const int width = radau_padded(problem->paired);
    memset(speeds, 0, (size_t)(s * width) * sizeof(double));
    for (int i = 0; i < s; ++i) {
        for (int j = 0; j < problem->paired; ++j) {
            speeds[i * width + j] =
                p->length * (p->y[problem->speed[j]] + p->others_change[i * p->width + p->speed_among[j]]);
        }
    }
    for (int i = 0; i < s; ++i) {
        radau_combine(p->places_change + i * width, stages->integral + i * s, s, speeds, width, width);
    }
}

bool radau_step_guess(struct radau_step *p, const struct radau_stages *stages, double length)
{
    p->stages = stages;
    p->length = length;
    if (!factor(p, stages, length)) {
        return false;
    }
    memset(p->others_change, 0, (size_t)(stages->stages * p->width) * sizeof(double));
    memset(p->residual, 0, (size_t)(stages->stages * p->width) * sizeof(double));
    for (int i = 0; i < p->others; ++i) { /* places move on at first */
        double moved = 0.0;
        for (int j = 0; j < p->problem.paired; ++j) {
            moved += p->by_places[j * p->others + i] * p->y[p->problem.speed[j]];
        }
        for (int k = 0; k < stages->stages; ++k) {
            p->residual[k * p->width + i] =
                length * (p->start_rates[p->other[i]] + stages->node[k] * length * moved);
        }
    }
    const bool solved = isfinite(correct(p));
    radau_move_places(p);
    return solved;
}

bool radau_step_guess_again(struct radau_step *p, const struct radau_stages *stages, double length)
{
    const int s = p->known_stages;
    for (int i = 0; i < stages->stages; ++i) {
        double of[RADAU_MOST_STAGES + 1];
        radau_polynomials_at(s + 1, stages->node[i] * length / p->known_length, of);
        radau_combine(p->point, of, s + 1, p->chebyshev, p->stride, p->stride);
        for (int j = 0; j < p->width; ++j) {
            p->others_change[i * p->width + j] = j < p->others ? p->point[p->other[j]] : 0.0;
        }
    }
    p->stages = stages;
    p->length = length;
    radau_move_places(p);
    return factor(p, stages, length);
}

void radau_step_stage(const struct radau_step *p, int stage, double *y)
{
    const struct radau_problem *problem = &p->problem;
    const double *others = p->others_change + stage * p->width;
    const double *places = p->places_change + stage * radau_padded(problem->paired);
    for (int j = 0; j < p->others; ++j) {
        y[p->other[j]] = p->y[p->other[j]] + others[j];
    }
    for (int j = 0; j < problem->paired; ++j) {
        y[problem->place[j]] = p->y[problem->place[j]] + places[j];
    }
}

/* h f - A^-1 change */
void radau_evaluate_residual(struct radau_step *p)
{
    const struct radau_problem *problem = &p->problem;
    const int s = p->stages->stages;
    memcpy(p->point, p->y, (size_t)problem->size * sizeof *p->point);
    for (int i = 0; i < s; ++i) {
        radau_step_stage(p, i, p->point);
        problem->rates(problem->context, p->start + p->length * p->stages->node[i], p->point,
                       p->rates + i * p->stride);
    }
    p->evaluations += s;
    for (int i = 0; i < s; ++i) {
        double *restrict to = p->residual + i * p->width;
        const double *rates = p->rates + i * p->stride;
        radau_combine(to, p->stages->inverse + i * s, s, p->others_change, p->width, p->width);
        for (int j = 0; j < p->others; ++j) {
            to[j] = p->length * rates[p->other[j]] - to[j];
        }
    }
}

bool radau_step_solve(struct radau_step *p, double tolerance)
{
    double last = 0.0;
    p->contraction = 0.0;
    for (p->iterations = 1; p->iterations <= MOST_ITERATIONS; ++p->iterations) {
        radau_evaluate_residual(p);
        const double size = correct(p);
        radau_move_places(p);
        if (!isfinite(size)) {
            return false;
        }
        if (p->iterations > 1) {
            p->contraction = size / last;
        }
        const double factor = p->iterations > 1 ? p->contraction : SLOWEST_CONTRACTION;
        if (factor < 1.0 && factor / (1.0 - factor) * size <= tolerance) {
            return true;
        }
        if (p->iterations > 2 && p->contraction > SLOWEST_CONTRACTION) {
            return size <= ROUNDING_SHARE;
        }
        if (p->problem.forces > 0 && p->iterations > 2 && size > ROUNDING_SHARE &&
            pow(factor, MOST_ITERATIONS - p->iterations) * size > tolerance) {
            return false; /* not within as many iterations as there may be */
        }
        last = size;
    }
    return false;
}
