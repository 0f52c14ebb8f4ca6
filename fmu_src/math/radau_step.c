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

/* Returns d of p' = d p, where the quaternion e p has the rate r e p, and e is the turn by the vector phi,
 * twice the integral of r. With theta = |phi| and k = sin(theta/2) / theta
 *   d = 2 k (k - cos(theta/2)) phi x r + (2 k^2 - (1 - sin(theta) / theta) / theta^2) phi x (phi x r)
 * This formula is that of e* (r - D) e, where D is the rate by the exponential function of phi. The rate d is
 * zero where r has the direction of phi. */
static struct vec3 turning_left(struct quaternion e, struct vec3 phi, struct vec3 r)
{
    const double square = vec3_dot(phi, phi);
    if (!(square > DBL_MIN)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    const struct vec3 cross = vec3_cross(phi, r);
    const double k = vec3_dot(quaternion_vector(e), phi) / square;
    const double twice = 2.0 * k * k - (1.0 - 2.0 * k * e.w) / square;
    return vec3_axpy(vec3_scale(2.0 * k * (k - e.w), cross), twice, vec3_cross(phi, cross));
}

/* The changes of a quaternion are found to this part of the error allowed, as forces are (NEWTON_SHARE of
 * integrator/general.c), or to rounding. MOST_TURNINGS is chosen: accurate steps take a few iterations, and a
 * step that takes more is much too long for its polynomial. */
static const double TURNING_SHARE = 0.05;
enum { MOST_TURNINGS = 40 };

/* Sets a quaternion p' = d p at the stages, where p starts at one and `d` holds the rates times the step's
 * length, by iterations of the integral for one stage after the other. Returns false where they do not find
 * p, which is then unfinished. */
static bool find_turning(const struct radau_stages *stages, const struct vec3 *d, double tolerance,
                         struct quaternion *p)
{
    const int s = stages->stages;
    double rates[RADAU_MOST_STAGES * 4];
    double missing = 0.0;
    double last = 1.0;
    for (int i = 0; i < s; ++i) {
        p[i] = quaternion_identity();
        quaternion_to(quaternion_make(0.0, d[i]), rates + 4 * i);
        missing = larger(vec3_max_abs(d[i]), missing);
    }
    for (int k = 0; k < MOST_TURNINGS && missing > tolerance; ++k) {
        double moved = 0.0;
        for (int i = 0; i < s; ++i) {
            double change[4];
            combine_rows(change, stages->integral + i * s, s, rates, 4, 4);
            const struct quaternion now = {1.0 + change[0], change[1], change[2], change[3]};
            const struct quaternion by = quaternion_axpy(now, -1.0, p[i]);
            moved = larger(fabs(by.w), larger(vec3_max_abs(quaternion_vector(by)), moved));
            p[i] = now;
            quaternion_to(quaternion_product(quaternion_make(0.0, d[i]), now), rates + 4 * i);
        }
        missing = moved * fmin(moved / last, 1.0);
        last = moved;
    }
    return missing <= tolerance;
}

/* Sets the changes at the stages of a quaternion q' = r q, whose rates are given for its value at the start.
 * It is e p times its start, where e turns by the integral of r, so that p = 1 where all r turn about one
 * axis. The changes are NaN where p is not found. */
CONTACT_NOT_FUSED CONTACT_FLATTEN static void turn_quaternion(struct radau_step *p, int first)
{
    const int s = p->stages->stages;
    const struct quaternion start = quaternion_from(p->y + first);
    const struct quaternion back =
        quaternion_scale(p->length / quaternion_dot(start, start), quaternion_inverse(start));
    double rates[RADAU_MOST_STAGES * 4], turned[4];
    struct quaternion e[RADAU_MOST_STAGES], left[RADAU_MOST_STAGES];
    struct vec3 d[RADAU_MOST_STAGES];
    for (int j = 0; j < s; ++j) {
        const struct quaternion rate = quaternion_from(p->rates + j * p->stride + first);
        quaternion_to(quaternion_product(rate, back), rates + 4 * j);
    }
    for (int j = 0; j < s; ++j) {
        combine_rows(turned, p->stages->integral + j * s, s, rates, 4, 4);
        const struct vec3 phi = vec3_scale(2.0, vec3_from(turned + 1));
        e[j] = quaternion_of_rotation(phi);
        d[j] = turning_left(e[j], phi, vec3_from(rates + 4 * j + 1));
    }
    const double tolerance = fmax(TURNING_SHARE / p->weight[first], DBL_EPSILON);
    const double found = find_turning(p->stages, d, tolerance, left) ? 1.0 : (double)NAN;
    for (int j = 0; j < s; ++j) {
        const struct quaternion now = quaternion_product(quaternion_product(e[j], left[j]), start);
        quaternion_to(quaternion_axpy(quaternion_scale(-1.0, start), found, now),
                      p->change + j * p->stride + first);
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
        turn_quaternion(p, j);
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
    const double length = p->length;
    radau_combine_rows(pending + from, width, p->stages->integral, s, s, rates + from, width, end - from);
    for (int i = 0; i < s; ++i) {
        for (int k = i * width + from; k < i * width + end; k += LANES) {
            double2_put(pending, k, double2_at(pending, k) * length - double2_at(p->others_change, k) * done);
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
