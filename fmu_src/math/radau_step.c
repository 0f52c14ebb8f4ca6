#include <float.h>
#include <math.h>
#include <string.h>

#include "math/compiler.h"
#include "math/nodes.h"
#include "math/quaternion.h"
#include "math/radau_step.h"

/* Rows end with at least one zero, and their length is a multiple of this, for loops that take several
 * numbers at a time. */
enum { RADAU_ROW_BLOCK = 4 };

static inline int radau_padded(int count)
{
    return (count / RADAU_ROW_BLOCK + 1) * RADAU_ROW_BLOCK;
}

/* Sets row i of `to` to what combine_rows makes of row i of the table. */
static inline void radau_combine_rows(double *restrict to, int to_stride, const double *table, int rows,
                                      int count, const double *from, int stride, int width)
{
    for (int i = 0; i < rows; ++i) {
        combine_rows(to + i * to_stride, table + i * count, count, from, stride, width);
    }
}

const struct radau_stages *radau_stages_of(int stages, enum radau_pace pace)
{
    return pace == RADAU_FROM_TOUCH   ? &radau_stages_touch
           : pace == RADAU_TO_RELEASE ? &radau_stages_release
           : stages == 4              ? &radau_stages_4
           : stages == 8              ? &radau_stages_8
                                      : &radau_stages_12;
}

/* sqrt(e) and sqrt(1 + e) - sqrt(e) of node_tables.h */
static const double ROOT_OF_REST = 0.03125;
static const double ROOTS_APART = 0.9692381620988826;

double radau_place(const struct radau_stages *stages, double part)
{
    const double left = sqrt(fmax(1.0 + RADAU_REST - part, 0.0));
    return stages->pace == RADAU_FROM_TOUCH   ? sqrt(part)
           : stages->pace == RADAU_TO_RELEASE ? 1.0 - (left - ROOT_OF_REST) / ROOTS_APART
                                              : part;
}

double radau_part(const struct radau_stages *stages, double place)
{
    const double left = ROOT_OF_REST + (1.0 - place) * ROOTS_APART;
    return stages->pace == RADAU_FROM_TOUCH   ? place * place
           : stages->pace == RADAU_TO_RELEASE ? 1.0 + RADAU_REST - left * left
                                              : place;
}

/* Sets of[k] to the Chebyshev polynomial T_k at a place of the step, by the recurrence. */
static inline void radau_polynomials_at(int count, double place, double *of)
{
    const double x = 2.0 * place - 1.0;
    of[0] = 1.0;
    of[1] = x;
    for (int k = 2; k < count; ++k) {
        of[k] = 2.0 * x * of[k - 1] - of[k - 2];
    }
}

int radau_room(const struct radau_problem *problem)
{
    const int unknowns = problem->unknowns;
    const int most = RADAU_MOST_STAGES * unknowns;
    const int least = RADAU_LEAST_STAGES * unknowns > RADAU_ROOM ? RADAU_LEAST_STAGES * unknowns : RADAU_ROOM;
    const int rows = most < least ? most : least;
    return rows > problem->coupled ? rows : problem->coupled;
}

size_t radau_step_memory(const struct radau_problem *problem)
{
    const size_t n = (size_t)radau_padded(problem->size);
    const size_t s = RADAU_MOST_STAGES;
    const size_t all = (size_t)radau_padded(radau_room(problem));
    const size_t doubles = (8 * s + 1) * n + 5 * n + (all + 1) * all;
    const size_t ints = 2 * n + all;
    return doubles * sizeof(double) + ints * sizeof(int);
}

static double *take(double **from, int count)
{
    double *taken = *from;
    *from += count;
    return taken;
}

/* Lists the coupled states that remain once places are eliminated. */
static void list_others(struct radau_step *p)
{
    const struct radau_problem *problem = &p->problem;
    memset(p->among, 0, (size_t)problem->coupled * sizeof *p->among);
    for (int k = 0; k < problem->paired; ++k) {
        p->among[problem->place[k]] = -1;
    }
    p->others = 0;
    for (int i = 0; i < problem->coupled; ++i) {
        if (p->among[i] == 0) {
            p->among[i] = p->others;
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
    double **const of_stages[] = {&p->change, &p->rates,   &p->others_change, &p->places_change,
                                  &p->bare,   &p->scratch, &p->more};
    double **const of_states[] = {&p->y, &p->start_rates, &p->weight, &p->point, &p->re};
    for (size_t i = 0; i < sizeof of_stages / sizeof *of_stages; ++i) {
        *of_stages[i] = take(&next, s * n);
    }
    for (size_t i = 0; i < sizeof of_states / sizeof *of_states; ++i) {
        *of_states[i] = take(&next, n);
    }
    p->chebyshev = take(&next, (s + 1) * n);
    const int all = radau_padded(radau_room(problem));
    p->side = take(&next, all);
    p->all = (struct lu_matrix){.stride = all, .re = take(&next, all * all)};
    int *whole = (int *)(void *)next;
    p->other = whole;
    p->among = whole + n;
    p->all.pivot = whole + 2 * n;
    list_others(p);
}

void radau_step_begin(struct radau_step *p, double clock, const double *y)
{
    p->start = clock;
    memcpy(p->y, y, (size_t)p->problem.size * sizeof *y);
}

static struct quaternion reciprocal_of(struct quaternion q)
{
    return quaternion_scale(1.0 / quaternion_dot(q, q), quaternion_inverse(q));
}

/* Writes the matrix I - h A_ij r_j, and its right side h sum A_ij r_j q behind each row, where r_j q are the
 * rates of the quaternion q at the start. */
CONTACT_NOT_FUSED static void put_turning_matrix(const struct radau_step *p, int first,
                                                 struct quaternion matrix[][RADAU_MOST_STAGES + 1])
{
    const int s = p->stages->stages;
    const struct quaternion inverse = reciprocal_of(quaternion_from(p->y + first));
    for (int i = 0; i < s; ++i) {
        matrix[i][s] = (struct quaternion){0.0, 0.0, 0.0, 0.0};
    }
    for (int j = 0; j < s; ++j) {
        const struct quaternion rate = quaternion_from(p->rates + j * p->stride + first);
        const struct quaternion turning = quaternion_product(rate, inverse);
        for (int i = 0; i < s; ++i) {
            const double weight = p->length * p->stages->integral[i * s + j];
            matrix[i][j] = quaternion_axpy((struct quaternion){i == j, 0.0, 0.0, 0.0}, -weight, turning);
            matrix[i][s] = quaternion_axpy(matrix[i][s], weight, rate);
        }
    }
}

/* The part of a rate across the fastest rate, divided by the fastest rate, is rounding below this number. */
static const double ONE_AXIS = 4.0 * DBL_EPSILON;

/* Sets the changes at the stages of a quaternion q' = r q if all r turn it about one axis: the angles of the
 * turns then sum up. Returns false if they do not. */
static bool turn_about_one_axis(struct radau_step *p, int first)
{
    const int s = p->stages->stages;
    const struct quaternion start = quaternion_from(p->y + first);
    const struct quaternion inverse = reciprocal_of(start);
    struct vec3 turning[RADAU_MOST_STAGES];
    struct vec3 fastest = {0.0, 0.0, 0.0};
    for (int j = 0; j < s; ++j) {
        const struct quaternion rate = quaternion_from(p->rates + j * p->stride + first);
        turning[j] = quaternion_vector(quaternion_product(rate, inverse));
        fastest = vec3_max_abs(turning[j]) > vec3_max_abs(fastest) ? turning[j] : fastest;
    }
    for (int j = 0; j < s; ++j) {
        const struct vec3 across = vec3_cross(turning[j], fastest);
        if (!(vec3_norm(across) <= ONE_AXIS * vec3_dot(fastest, fastest))) {
            return false;
        }
    }
    for (int i = 0; i < s; ++i) {
        struct vec3 turned = {0.0, 0.0, 0.0};
        for (int j = 0; j < s; ++j) {
            turned = vec3_axpy(turned, 2.0 * p->length * p->stages->integral[i * s + j], turning[j]);
        }
        const struct quaternion now = quaternion_product(quaternion_of_rotation(turned), start);
        quaternion_to(quaternion_axpy(now, -1.0, start), p->change + i * p->stride + first);
    }
    return true;
}

/* Sets the changes at the stages of a quaternion q' = r q, whose rates are given for its value at the start.
 * They solve a linear system whose entries are quaternions, eliminated like numbers in the order of their
 * products. Without pivots the entries do not grow, for turns of up to fifty radians (measured). */
CONTACT_NOT_FUSED CONTACT_FLATTEN static void turn_quaternion(struct radau_step *p, int first)
{
    const int s = p->stages->stages;
    struct quaternion matrix[RADAU_MOST_STAGES][RADAU_MOST_STAGES + 1];
    put_turning_matrix(p, first, matrix);
    for (int k = 0; k < s; ++k) {
        const struct quaternion inverse = reciprocal_of(matrix[k][k]);
        for (int i = k + 1; i < s; ++i) {
            const struct quaternion factor = quaternion_product(matrix[i][k], inverse);
            for (int j = k + 1; j <= s; ++j) {
                matrix[i][j] = quaternion_axpy(matrix[i][j], -1.0, quaternion_product(factor, matrix[k][j]));
            }
        }
    }
    for (int i = s - 1; i >= 0; --i) {
        struct quaternion *side = &matrix[i][s];
        for (int j = i + 1; j < s; ++j) {
            *side = quaternion_axpy(*side, -1.0, quaternion_product(matrix[i][j], matrix[j][s]));
        }
        *side = quaternion_product(reciprocal_of(matrix[i][i]), *side);
        quaternion_to(*side, p->change + i * p->stride + first);
    }
}

void radau_step_finish(struct radau_step *p)
{
    const struct radau_problem *problem = &p->problem;
    const struct radau_stages *stages = p->stages;
    const int s = stages->stages;
    const int first = problem->integrals / RADAU_ROW_BLOCK * RADAU_ROW_BLOCK;
    radau_combine_rows(p->change + first, p->stride, stages->integral, s, s, p->rates + first, p->stride,
                       p->stride - first);
    for (int i = 0; i < s; ++i) {
        double *to = p->change + i * p->stride;
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
        if (!turn_about_one_axis(p, j)) {
            turn_quaternion(p, j);
        }
    }
    p->known_start = p->start;
    p->known_length = p->length;
    p->known = stages;
    radau_combine_rows(p->chebyshev, p->stride, stages->chebyshev, s + 1, s, p->change, p->stride, p->stride);
}

void radau_step_take_over(struct radau_step *p, double start, double length, const double *y,
                          const struct radau_stages *stages, const double *chebyshev, int stride)
{
    const size_t bytes = (size_t)p->problem.size * sizeof *y;
    p->stages = p->known = stages;
    p->start = p->known_start = start;
    p->length = p->known_length = length;
    memcpy(p->y, y, bytes);
    for (int k = 0; k <= stages->stages; ++k) {
        memcpy(p->chebyshev + k * p->stride, chebyshev + k * stride, bytes);
    }
}

void radau_step_at(const struct radau_step *p, double part, double *y)
{
    double of[RADAU_MOST_STAGES + 1] = {1.0};
    const int count = p->stages->stages + 1;
    radau_polynomials_at(count, radau_place(p->stages, part), of);
    combine_rows(p->re, of, count, p->chebyshev, p->stride, p->stride);
    for (int j = 0; j < p->problem.size; ++j) {
        y[j] = p->y[j] + p->re[j];
    }
}

/* The error of an oscillation is its last Chebyshev coefficients times the ratio by which they have decreased
 * within four (with four stages two), to the power 0.45 to 0.6 within the step and 1.5 to 2 at its end,
 * measured for 0.5 to 8 radians. */
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
        if (!isfinite(of[s * n])) {
            return (struct radau_error){(double)INFINITY, (double)INFINITY};
        }
        last = larger(larger(fabs(of[s * n]), fabs(of[(s - 1) * n])) * p->weight[j], last);
        before =
            larger(larger(fabs(of[(s - apart) * n]), fabs(of[(s - apart - 1) * n])) * p->weight[j], before);
    }
    const double ratio = before > 0.0 ? fmin(last / before, 1.0) : 0.0;
    return (struct radau_error){last * pow(ratio, DECREASE_WITHIN), last * pow(ratio, DECREASE_AT_END)};
}

static void guess_steady(struct radau_step *p)
{
    p->problem.rates(p->problem.context, p->start, p->y, p->start_rates);
    p->evaluations += 1;
    for (int i = 0; i < p->stages->stages; ++i) {
        const double passed = p->length * p->stages->node[i];
        for (int j = 0; j < p->width; ++j) {
            p->others_change[i * p->width + j] = j < p->others ? passed * p->start_rates[p->other[j]] : 0.0;
        }
    }
}

/* Number of coefficients of the last polynomial that are of use at a part of its step; the contributions of
 * later ones grow. */
static int coefficients_worth(const struct radau_step *p, const double *of)
{
    int best = 1;
    double least = (double)INFINITY;
    for (int k = 1; k <= p->known->stages; ++k) {
        double largest = 0.0;
        for (int j = 0; j < p->others; ++j) {
            const int i = p->other[j];
            largest = larger(fabs(p->chebyshev[k * p->stride + i] * of[k]) * p->weight[i], largest);
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
           (p->known_start == p->start ||
            (p->known->pace != RADAU_TO_RELEASE && fabs(end - p->start) <= 1e-6 * p->known_length));
}

static void guess_on(struct radau_step *p)
{
    double of[RADAU_MOST_STAGES + 1] = {0.0};
    double here[RADAU_MOST_STAGES + 1] = {0.0};
    const double begins = p->known_start == p->start ? 0.0 : 1.0;
    const double part = p->length / p->known_length;
    radau_polynomials_at(p->known->stages + 1, radau_place(p->known, begins + part), of);
    const int count = begins + part > 1.0 ? coefficients_worth(p, of) : p->known->stages + 1;
    radau_polynomials_at(count, begins, here);
    for (int i = 0; i < p->stages->stages; ++i) {
        radau_polynomials_at(count, radau_place(p->known, begins + part * p->stages->node[i]), of);
        for (int k = 0; k < count; ++k) {
            of[k] -= here[k];
        }
        double *change = p->change + i * p->stride;
        combine_rows(change, of, count, p->chebyshev, p->stride, p->stride);
        for (int j = 0; j < p->width; ++j) {
            p->others_change[i * p->width + j] = j < p->others ? change[p->other[j]] : 0.0;
        }
    }
}

/* Sets the changes of the places at all stages to h A times the speeds. */
static void radau_move_places(struct radau_step *p)
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
                p->length *
                (p->y[problem->speed[j]] + p->others_change[i * p->width + p->among[problem->speed[j]]]);
        }
    }
    radau_combine_rows(p->places_change, width, stages->integral, s, s, speeds, width, width);
}

void radau_step_pending(const struct radau_step *p, int first, int count, const double *rates, double done,
                        double *pending)
{
    const int s = p->stages->stages;
    const int width = p->width;
    const int from = first / RADAU_ROW_BLOCK * RADAU_ROW_BLOCK;
    const int end = radau_padded(first + count - 1);
    radau_combine_rows(pending + from, width, p->stages->integral, s, s, rates + from, width, end - from);
    for (int i = 0; i < s; ++i) {
        for (int k = i * width + from; k < i * width + end; k += LANES) {
            double2_put(pending, k,
                        double2_at(pending, k) * p->length - double2_at(p->others_change, k) * done);
        }
    }
}

double radau_step_integrate(struct radau_step *p, const double *rates)
{
    const int width = p->width;
    double largest = 0.0;
    radau_step_pending(p, 0, p->others, rates, 1.0, p->scratch);
    for (int i = 0; i < p->stages->stages; ++i) {
        const double *pending = p->scratch + i * width;
        double *change = p->others_change + i * width;
        for (int j = 0; j < p->others; ++j) {
            const double size = fabs(pending[j]) * p->weight[p->other[j]];
            largest = size <= largest ? largest : size; /* NaN counts as the largest */
            change[j] += pending[j];
        }
    }
    radau_move_places(p);
    return largest;
}

void radau_step_guess_rates(const struct radau_step *p, int first, int count, double *rates)
{
    const int s = p->stages->stages;
    for (int i = 0; i < s; ++i) {
        for (int k = 0; k < count; ++k) {
            double sum = 0.0;
            for (int j = 0; j < s; ++j) {
                sum += p->stages->inverse[i * s + j] * p->change[j * p->stride + first + k];
            }
            rates[i * count + k] = sum / p->length;
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
