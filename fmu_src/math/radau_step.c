#include "math/radau_step.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "math/compiler.h"
#include "math/radau_rows.h"

/* Of a quaternion: as many turn it by ten radians. */
enum { MOST_SWEEPS = 60 };

/* Rows of the system of all stages. */
static int rows_of_all(const struct radau_problem *problem)
{
    return problem->turns ? RADAU_MOST_STAGES * (problem->coupled - problem->paired) : 0;
}

size_t radau_step_memory(const struct radau_problem *problem)
{
    const size_t n = (size_t)radau_padded(problem->size);
    const size_t s = RADAU_MOST_STAGES;
    const size_t all = (size_t)radau_padded(rows_of_all(problem));
    const size_t doubles = 6 * s * n + (s + 1) * n + 6 * n * n + s * n * n + 5 * n + (all + 1) * all +
                           radau_forces_memory(problem);
    const size_t ints = 2 * n + s / 2 * n + all;
    return doubles * sizeof(double) + ints * sizeof(int);
}

static double *take(double **from, int count)
{
    double *taken = *from;
    *from += count;
    return taken;
}

/* Which of the coupled states remain once places are eliminated. */
static void list_others(struct radau_step *p)
{
    const struct radau_problem *problem = &p->problem;
    p->others = 0;
    for (int i = 0; i < problem->coupled; ++i) {
        bool is_place = false;
        for (int k = 0; k < problem->paired; ++k) {
            is_place = is_place || problem->place[k] == i;
            if (problem->speed[k] == i) {
                p->speed_among[k] = p->others;
            }
        }
        if (!is_place) {
            p->other[p->others++] = i;
        }
    }
    p->width = radau_padded(p->others);
}

void radau_step_place(struct radau_step *p, const struct radau_problem *problem, void *memory)
{
    const int n = radau_padded(problem->size);
    const int s = RADAU_MOST_STAGES;
    double *next = memory;
    *p = (struct radau_step){.problem = *problem, .stride = n};
    p->change = take(&next, s * n);
    p->rates = take(&next, s * n);
    p->others_change = take(&next, s * n);
    p->places_change = take(&next, s * n);
    p->residual = take(&next, s * n);
    p->scratch = take(&next, s * n);
    p->chebyshev = take(&next, (s + 1) * n);
    p->jacobian = take(&next, n * n);
    p->by_others = take(&next, n * n);
    p->by_places = take(&next, n * n);
    p->y = take(&next, n);
    p->start_rates = take(&next, n);
    p->weight = take(&next, n);
    p->point = take(&next, n);
    p->re = take(&next, n);
    for (int k = 0; k < s / 2; ++k) {
        p->system[k].re = take(&next, n * n);
        p->system[k].im = take(&next, n * n);
    }
    const int all = radau_padded(rows_of_all(problem));
    p->stage_others = take(&next, n * n);
    p->stage_places = take(&next, n * n);
    p->side = take(&next, all);
    p->whole = take(&next, n * n);
    p->all = (struct dense_matrix){.stride = all, .at = take(&next, all * all)};
    radau_forces_place(p, take(&next, (int)radau_forces_memory(problem)));
    int *whole = (int *)(void *)next;
    p->other = whole;
    p->speed_among = whole + n;
    p->all.pivot = whole + (2 + s / 2) * n;
    list_others(p);
    for (int k = 0; k < s / 2; ++k) {
        p->system[k].rows = p->others;
        p->system[k].stride = p->width;
        p->system[k].pivot = whole + (2 + k) * n;
    }
}

void radau_take_jacobian(const struct radau_step *p, double *by_others, double *by_places)
{
    const struct radau_problem *problem = &p->problem;
    const int m = p->others;
    for (int i = 0; i < m; ++i) {
        const double *row = p->jacobian + p->other[i];
        for (int j = 0; j < m; ++j) {
            by_others[j * m + i] = row[p->other[j] * problem->coupled];
        }
        for (int j = 0; j < problem->paired; ++j) {
            by_places[j * m + i] = row[problem->place[j] * problem->coupled];
        }
    }
}

void radau_step_begin(struct radau_step *p, double clock, const double *y)
{
    const struct radau_problem *problem = &p->problem;
    const int n = problem->size;
    p->start = clock;
    memcpy(p->y, y, (size_t)n * sizeof *y);
    problem->rates(problem->context, clock, y, p->start_rates);
    problem->jacobian(problem->context, clock, y, p->jacobian);
    p->evaluations += 2;
    radau_take_jacobian(p, p->by_others, p->by_places);
    p->factored_length = 0.0;
}

/* a b, and a b^-1 of quaternions (real part first). */
CONTACT_NOT_FUSED static void multiply_quaternions(const double *a, const double *b, double *product)
{
    product[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    product[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    product[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    product[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

static void divide_quaternions(const double *a, const double *b, double *quotient)
{
    const double square = b[0] * b[0] + b[1] * b[1] + b[2] * b[2] + b[3] * b[3];
    const double inverse[4] = {b[0] / square, -b[1] / square, -b[2] / square, -b[3] / square};
    multiply_quaternions(a, inverse, quotient);
}

/* Change of a quaternion whose rates are known as if it stayed as it was at the start: by sweeps, which
 * converge as the series of the exponential function does. */
static void turn_quaternion(struct radau_step *p, int first)
{
    const int s = p->stages->stages;
    double turning[RADAU_MOST_STAGES][4];
    double rates[RADAU_MOST_STAGES * 4];
    double change[4];
    const double *start = p->y + first;
    for (int i = 0; i < s; ++i) {
        divide_quaternions(p->rates + i * p->stride + first, start, turning[i]);
        memcpy(rates + 4 * i, p->rates + i * p->stride + first, sizeof change);
        memset(p->change + i * p->stride + first, 0, sizeof change);
    }
    double largest = 1.0;
    for (int sweep = 0; sweep < MOST_SWEEPS && largest > DBL_EPSILON; ++sweep) {
        largest = 0.0;
        for (int i = 0; i < s; ++i) {
            double *known = p->change + i * p->stride + first;
            radau_combine(change, p->stages->integral + i * s, s, rates, 4, 4);
            for (int k = 0; k < 4; ++k) {
                largest = fmax(largest, fabs(p->length * change[k] - known[k]));
                known[k] = p->length * change[k];
            }
        }
        for (int i = 0; i < s; ++i) {
            double now[4];
            for (int k = 0; k < 4; ++k) {
                now[k] = start[k] + p->change[i * p->stride + first + k];
            }
            multiply_quaternions(turning[i], now, rates + 4 * i);
        }
    }
}

void radau_step_finish(struct radau_step *p)
{
    const struct radau_problem *problem = &p->problem;
    const struct radau_stages *stages = p->stages;
    const int s = stages->stages;
    for (int i = 0; i < s; ++i) {
        double *to = p->change + i * p->stride;
        radau_combine(to, stages->integral + i * s, s, p->rates, p->stride, p->stride);
        for (int j = problem->integrals; j < problem->size; ++j) {
            to[j] *= p->length;
        }
        for (int j = 0; j < p->others; ++j) {
            to[p->other[j]] = p->others_change[i * p->width + j];
        }
        for (int j = 0; j < problem->paired; ++j) {
            to[problem->place[j]] = p->places_change[i * radau_padded(problem->paired) + j];
        }
    }
    for (int j = problem->coupled; j < problem->integrals; j += 4) {
        turn_quaternion(p, j);
    }
    p->known_start = p->start;
    p->known_length = p->length;
    p->known_stages = s;
    for (int k = 0; k <= s; ++k) {
        radau_combine(p->chebyshev + k * p->stride, stages->chebyshev + k * s, s, p->change, p->stride,
                      p->stride);
    }
}

void radau_step_take_over(struct radau_step *p, double start, double length, const double *y, int count,
                          const double *chebyshev, int stride)
{
    const size_t bytes = (size_t)p->problem.size * sizeof *y;
    p->stages = count == 4 ? &radau_stages_4 : count == 8 ? &radau_stages_8 : &radau_stages_12;
    p->start = p->known_start = start;
    p->length = p->known_length = length;
    p->known_stages = count;
    memcpy(p->y, y, bytes);
    for (int k = 0; k <= count; ++k) {
        memcpy(p->chebyshev + k * p->stride, chebyshev + k * stride, bytes);
    }
}

void radau_step_at(const struct radau_step *p, double part, double *y)
{
    double of[RADAU_MOST_STAGES + 1] = {1.0};
    const int s = p->stages->stages;
    radau_polynomials_at(s + 1, part, of);
    for (int j = 0; j < p->problem.size; ++j) {
        double sum = of[0] * p->chebyshev[j];
        for (int k = 1; k <= s; ++k) {
            sum += of[k] * p->chebyshev[k * p->stride + j];
        }
        y[j] = p->y[j] + sum;
    }
}

/* Of an oscillation, by as much as its last Chebyshev coefficients have decreased within four (of four
 * stages, two), to the power 0.45 to 0.6 anywhere, 1.5 to 2 at the end (measured for 0.5 to 8 radians). */
static const double DECREASE_WITHIN = 0.45;
static const double DECREASE_AT_END = 1.5;

struct radau_error radau_step_error(const struct radau_step *p)
{
    const int s = p->stages->stages;
    const int apart = s > 4 ? 4 : 2;
    const int n = p->stride;
    double last = 0.0;
    double before = 0.0;
    for (int j = 0; j < p->problem.size; ++j) {
        const double *of = p->chebyshev + j;
        if (!isfinite(of[s * n])) { /* a quaternion's sweeps diverge where it turns much too far */
            return (struct radau_error){(double)INFINITY, (double)INFINITY};
        }
        last = fmax(last, fmax(fabs(of[s * n]), fabs(of[(s - 1) * n])) * p->weight[j]);
        before = fmax(before, fmax(fabs(of[(s - apart) * n]), fabs(of[(s - apart - 1) * n])) * p->weight[j]);
    }
    const double ratio = before > 0.0 ? fmin(last / before, 1.0) : 0.0;
    return (struct radau_error){last * pow(ratio, DECREASE_WITHIN), last * pow(ratio, DECREASE_AT_END)};
}
