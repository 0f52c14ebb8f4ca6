#include "math/radau_step.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "math/nodal_values.h"

/* More are dearer than two steps of half the length. */
static const int MOST_ITERATIONS = 12;

/* Corrections that shrink no faster do not get there within those. */
static const double SLOWEST_CONTRACTION = 0.5;

/* Of a quaternion: as many turn it by ten radians. */
enum { MOST_SWEEPS = 60 };

/* Unless they are rounding, by which they are below this part of the error allowed. */
static const double ROUNDING_SHARE = 0.25;

/* Rows end with at least one zero and are so many numbers long, for loops that take some at a time. */
enum { ROW_BLOCK = 4 };

static int padded(int count)
{
    return (count / ROW_BLOCK + 1) * ROW_BLOCK;
}

size_t radau_step_memory(int size)
{
    const size_t n = (size_t)padded(size);
    const size_t s = RADAU_MOST_STAGES;
    const size_t doubles = 6 * s * n + (s + 1) * n + 3 * n * n + s * n * n + 5 * n;
    const size_t ints = 2 * n + s / 2 * n;
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
    p->width = padded(p->others);
}

void radau_step_place(struct radau_step *p, const struct radau_problem *problem, void *memory)
{
    const int n = padded(problem->size);
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
    int *whole = (int *)(void *)next;
    p->other = whole;
    p->speed_among = whole + n;
    list_others(p);
    for (int k = 0; k < s / 2; ++k) {
        p->system[k].rows = p->others;
        p->system[k].stride = p->width;
        p->system[k].pivot = whole + (2 + k) * n;
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
    const int m = p->others;
    for (int i = 0; i < m; ++i) {
        const double *row = p->jacobian + p->other[i];
        for (int j = 0; j < m; ++j) {
            p->by_others[j * m + i] = row[p->other[j] * problem->coupled];
        }
        for (int j = 0; j < problem->paired; ++j) {
            p->by_places[j * m + i] = row[problem->place[j] * problem->coupled];
        }
    }
    p->factored_length = 0.0;
}

/* lambda - h J of those left, with what they feel through the places: those change by h/lambda of their speeds. */
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

/* A row of a table times the rows of `from`. */
static void combine(double *restrict to, const double *row, int count, const double *from, int stride,
                    int width)
{
    for (int i = 0; i < width; i += 2 * LANES) {
        double2 low = {0.0};
        double2 high = {0.0};
        for (int j = 0; j < count; ++j) {
            low += double2_at(from + j * stride, i) * row[j];
            high += double2_at(from + j * stride, i + LANES) * row[j];
        }
        double2_put(to, i, low);
        double2_put(to, i + LANES, high);
    }
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
        combine(re, stages->into + 2 * k * s, s, p->residual, width, width);
        combine(re + width, stages->into + (2 * k + 1) * s, s, p->residual, width, width);
        complex_lu_solve(p->system[k], re, re + width);
    }
    double largest = 0.0;
    for (int i = 0; i < s; ++i) {
        combine(p->re, stages->back + i * s, s, parts, width, width);
        for (int j = 0; j < p->others; ++j) {
            p->others_change[i * width + j] += p->re[j];
            const double size = fabs(p->re[j]) * p->weight[p->other[j]];
            largest = size <= largest ? largest : size; /* no number is larger than any */
        }
    }
    return largest;
}

/* What follows for the places: h A times their speeds. */
static void move_places(struct radau_step *p)
{
    const struct radau_problem *problem = &p->problem;
    const struct radau_stages *stages = p->stages;
    const int s = stages->stages;
    double *speeds = p->scratch;
    const int width = padded(problem->paired);
    memset(speeds, 0, (size_t)(s * width) * sizeof(double));
    for (int i = 0; i < s; ++i) {
        for (int j = 0; j < problem->paired; ++j) {
            speeds[i * width + j] =
                p->length * (p->y[problem->speed[j]] + p->others_change[i * p->width + p->speed_among[j]]);
        }
    }
    for (int i = 0; i < s; ++i) {
        combine(p->places_change + i * width, stages->integral + i * s, s, speeds, width, width);
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
    move_places(p);
    return solved;
}

/* Chebyshev polynomials at a part of the step, by their recurrence. */
static void polynomials_at(int count, double part, double *of)
{
    const double x = 2.0 * part - 1.0;
    of[0] = 1.0;
    of[1] = x;
    for (int k = 2; k < count; ++k) {
        of[k] = 2.0 * x * of[k - 1] - of[k - 2];
    }
}

bool radau_step_guess_again(struct radau_step *p, const struct radau_stages *stages, double length)
{
    const int s = p->known_stages;
    for (int i = 0; i < stages->stages; ++i) {
        double of[RADAU_MOST_STAGES + 1];
        polynomials_at(s + 1, stages->node[i] * length / p->known_length, of);
        combine(p->point, of, s + 1, p->chebyshev, p->stride, p->stride);
        for (int j = 0; j < p->width; ++j) {
            p->others_change[i * p->width + j] = j < p->others ? p->point[p->other[j]] : 0.0;
        }
    }
    p->stages = stages;
    p->length = length;
    move_places(p);
    return factor(p, stages, length);
}

void radau_step_stage(const struct radau_step *p, int stage, double *y)
{
    const struct radau_problem *problem = &p->problem;
    const double *others = p->others_change + stage * p->width;
    const double *places = p->places_change + stage * padded(problem->paired);
    for (int j = 0; j < p->others; ++j) {
        y[p->other[j]] = p->y[p->other[j]] + others[j];
    }
    for (int j = 0; j < problem->paired; ++j) {
        y[problem->place[j]] = p->y[problem->place[j]] + places[j];
    }
}

/* h f - A^-1 change */
static void evaluate_residual(struct radau_step *p)
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
        combine(to, p->stages->inverse + i * s, s, p->others_change, p->width, p->width);
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
        evaluate_residual(p);
        const double size = correct(p);
        move_places(p);
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
        last = size;
    }
    return false;
}

/* a b, and a b^-1 of quaternions (real part first). */
static void multiply_quaternions(const double *a, const double *b, double *product)
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

/* Change of a quaternion whose rates are known as if it stayed as it was at the start: by sweeps, which converge as the
 * series of the exponential function does. */
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
            combine(change, p->stages->integral + i * s, s, rates, 4, 4);
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
        combine(to, stages->integral + i * s, s, p->rates, p->stride, p->stride);
        for (int j = problem->integrals; j < problem->size; ++j) {
            to[j] *= p->length;
        }
        for (int j = 0; j < p->others; ++j) {
            to[p->other[j]] = p->others_change[i * p->width + j];
        }
        for (int j = 0; j < problem->paired; ++j) {
            to[problem->place[j]] = p->places_change[i * padded(problem->paired) + j];
        }
    }
    for (int j = problem->coupled; j < problem->integrals; j += 4) {
        turn_quaternion(p, j);
    }
    p->known_length = p->length;
    p->known_stages = s;
    for (int k = 0; k <= s; ++k) {
        combine(p->chebyshev + k * p->stride, stages->chebyshev + k * s, s, p->change, p->stride, p->stride);
    }
}

void radau_step_at(const struct radau_step *p, double part, double *y)
{
    double of[RADAU_MOST_STAGES + 1];
    const int s = p->stages->stages;
    polynomials_at(s + 1, part, of);
    for (int j = 0; j < p->problem.size; ++j) {
        double sum = of[0] * p->chebyshev[j];
        for (int k = 1; k <= s; ++k) {
            sum += of[k] * p->chebyshev[k * p->stride + j];
        }
        y[j] = p->y[j] + sum;
    }
}

/* Of an oscillation, by as much as its last Chebyshev coefficients have decreased within four (of four stages, two),
 * to the power 0.45 to 0.6 anywhere, 1.5 to 2 at the end (measured for 0.5 to 8 radians). */
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
        last = fmax(last, fmax(fabs(of[s * n]), fabs(of[(s - 1) * n])) * p->weight[j]);
        before = fmax(before, fmax(fabs(of[(s - apart) * n]), fabs(of[(s - apart - 1) * n])) * p->weight[j]);
    }
    const double ratio = before > 0.0 ? fmin(last / before, 1.0) : 0.0;
    return (struct radau_error){last * pow(ratio, DECREASE_WITHIN), last * pow(ratio, DECREASE_AT_END)};
}
