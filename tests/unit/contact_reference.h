/*
 * A contact that transmits a force in Cartesian coordinates and long double, to judge collocation by:
 *
 *   c'' = A(t) - (omega2 (d - reach) + damping_rate n.(c' + E(t))) n,   d = |c|, n = c / d
 *
 * with what the dashpot takes and a moment of the motion alongside. Extrapolation of the modified midpoint
 * rule with 2, 4 .. 16 substeps (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.9),
 * order 16.
 */
#ifndef CONTACT_REFERENCE_H
#define CONTACT_REFERENCE_H

#include <string.h>

#include "long_vec3.h"
#include "touch/collocation.h"

struct reference_state {
    struct long_vec3 c, rate;
    long double dissipated, moment;
};

enum { REFERENCE_SIZE = 8, REFERENCE_COLUMNS = 8 };

struct reference {
    const struct collocation_problem *problem;
    struct long_vec3 weight[2];
    struct reference_state start;
};

static inline struct long_vec3 long_polynomial(const struct vec3 *a, int terms, long double t)
{
    struct long_vec3 sum = {0.0L, 0.0L, 0.0L};
    for (int i = terms - 1; i >= 0; --i) {
        sum = long_axpy(long_of(a[i]), t, sum);
    }
    return sum;
}

static inline struct reference_state reference_slope(const struct reference *r, long double t,
                                                     const struct reference_state *y)
{
    const struct collocation_problem *p = r->problem;
    const long double d = long_norm(y->c);
    const struct long_vec3 zero = {0.0L, 0.0L, 0.0L};
    const struct long_vec3 n = long_axpy(zero, 1.0L / d, y->c);
    const struct long_vec3 mismatch = long_polynomial(p->mismatch, COLLOCATION_MISMATCH_TERMS, t);
    const long double closing = long_dot(n, long_axpy(y->rate, 1.0L, mismatch));
    const long double push = p->omega2 * (d - p->reach) + p->damping_rate * closing;
    const struct long_vec3 weight = long_axpy(r->weight[0], t, r->weight[1]);
    return (struct reference_state){
        .c = y->rate,
        .rate = long_axpy(long_polynomial(p->acceleration, COLLOCATION_ACCELERATION_TERMS, t), -push, n),
        .dissipated = p->damping_rate * closing * closing,
        .moment = long_dot(weight, long_axpy(y->c, -1.0L, r->start.c))};
}

static inline void reference_add(long double to[REFERENCE_SIZE], long double s,
                                 const struct reference_state *slope)
{
    const long double a[REFERENCE_SIZE] = {slope->c.x,    slope->c.y,    slope->c.z,        slope->rate.x,
                                           slope->rate.y, slope->rate.z, slope->dissipated, slope->moment};
    for (int i = 0; i < REFERENCE_SIZE; ++i) {
        to[i] += s * a[i];
    }
}

static inline struct reference_state reference_unpack(const long double a[REFERENCE_SIZE])
{
    return (struct reference_state){{a[0], a[1], a[2]}, {a[3], a[4], a[5]}, a[6], a[7]};
}

static inline void reference_midpoints(const struct reference *r, long double t, long double step, int count,
                                       const long double from[REFERENCE_SIZE], long double to[REFERENCE_SIZE])
{
    const long double h = step / count;
    long double before[REFERENCE_SIZE];
    memcpy(before, from, sizeof before);
    memcpy(to, from, sizeof before);
    for (int i = 0; i < count; ++i) {
        long double after[REFERENCE_SIZE];
        memcpy(after, i == 0 ? to : before, sizeof after);
        const struct reference_state y = reference_unpack(to);
        const struct reference_state slope = reference_slope(r, t + i * h, &y);
        reference_add(after, i == 0 ? h : 2.0L * h, &slope);
        memcpy(before, to, sizeof before);
        memcpy(to, after, sizeof before);
    }
}

static inline void reference_step(const struct reference *r, long double t, long double step,
                                  long double y[REFERENCE_SIZE])
{
    long double table[REFERENCE_COLUMNS][REFERENCE_SIZE];
    for (int k = 0; k < REFERENCE_COLUMNS; ++k) {
        reference_midpoints(r, t, step, 2 * (k + 1), y, table[k]);
        for (int j = k - 1; j >= 0; --j) { /* Aitken and Neville */
            const long double ratio = (k + 1.0L) / (j + 1.0L);
            for (int i = 0; i < REFERENCE_SIZE; ++i) {
                table[j][i] = table[j + 1][i] + (table[j + 1][i] - table[j][i]) / (ratio * ratio - 1.0L);
            }
        }
    }
    memcpy(y, table[0], sizeof table[0]);
}

static inline struct reference reference_of(const struct collocation_problem *problem,
                                            const struct vec3 weight[2])
{
    const struct long_vec3 normal = long_of(problem->normal);
    const long double d = (long double)problem->reach + problem->deviation;
    return (struct reference){
        problem,
        {long_of(weight[0]), long_of(weight[1])},
        {{d * normal.x, d * normal.y, d * normal.z}, long_of(problem->rate), 0.0L, 0.0L}};
}

/* From `from` at time t over `span`, in steps of at most `longest`. */
static inline struct reference_state reference_move(const struct reference *r, struct reference_state from,
                                                    long double t, long double span, long double longest)
{
    const int count = 1 + (int)(span / longest);
    long double y[REFERENCE_SIZE] = {from.c.x,    from.c.y,    from.c.z,        from.rate.x,
                                     from.rate.y, from.rate.z, from.dissipated, from.moment};
    for (int i = 0; i < count; ++i) {
        reference_step(r, t + span * i / count, span / count, y);
    }
    return reference_unpack(y);
}

#endif
