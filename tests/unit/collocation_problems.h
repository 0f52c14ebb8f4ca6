/* Random problems for collocation, each within the range that its kind of step declares, and what may be
 * off. */
#ifndef COLLOCATION_PROBLEMS_H
#define COLLOCATION_PROBLEMS_H

#include <float.h>

#include "random.h"
#include "touch/collocation.h"

struct trial {
    struct collocation_problem problem;
    enum collocation_kind kind;
    double step;
    double turning;  /* of the motion along the contact [1/s] */
    double distance; /* d at the start [m] */
    struct oscillator_rates rates;
};

/* A polynomial of time that changes by its own size in a step. */
static inline void random_path(struct random *r, struct vec3 *a, int terms, double size, double step)
{
    for (int i = 0; i < terms; ++i) {
        a[i] = random_vector(r, size);
        size /= step * (i + 1);
    }
}

static inline struct vec3 random_across(struct random *r, struct vec3 n, double size)
{
    const struct vec3 a = random_vector(r, size);
    return vec3_axpy(a, -vec3_dot(a, n), n);
}

/* n.A + v^2/d - damping_rate n.E at the start */
static inline double load_at_start(const struct collocation_problem *p, double d)
{
    const struct vec3 along = vec3_axpy(p->rate, -vec3_dot(p->rate, p->normal), p->normal);
    return vec3_dot(along, along) / d +
           vec3_dot(p->normal, vec3_axpy(p->acceleration[0], -p->damping_rate, p->mismatch[0]));
}

static inline void set_oscillator(struct random *r, struct trial *t)
{
    struct collocation_problem *p = &t->problem;
    const double rate =
        random_power(r, log10(20.0), t->kind == COLLOCATION_RESOLVED ? 6.0 : 2.3) * t->turning;
    if (t->kind == COLLOCATION_OVERDAMPED) { /* the faster rate; a fifth of them without a spring */
        const double slower = random_index(r, 5) == 0 ? 0.0 : rate * random_power(r, -4.0, log10(0.2));
        p->damping_rate = rate + slower;
        p->omega2 = rate * slower;
    } else {
        const double ratio = t->kind == COLLOCATION_RESOLVED ? 0.95 : 1.2;
        p->omega2 = rate * rate;
        p->damping_rate = random_index(r, 3) == 0 ? 0.0 : 2.0 * random_between(r, 0.0, ratio) * rate;
    }
    t->rates = oscillator_rates_of(&(struct oscillator){p->omega2, p->damping_rate});
}

static inline double random_step(struct random *r, const struct trial *t)
{
    const double radians = random_between(r, 0.2, t->kind == COLLOCATION_AVERAGED ? 2.5 : 1.0);
    switch (t->kind) {
    case COLLOCATION_RESOLVED:
        return random_between(r, 3.0, 4.0) / t->rates.slower;
    case COLLOCATION_AVERAGED:
        return fmax(radians / t->turning, 3.0 / t->rates.slower);
    default:
        return fmin(fmax(radians / t->turning, 3.0 / t->rates.faster), 3.0 / t->rates.slower);
    }
}

/* Where x and its rate begin: `swing` [m] off what the load asks for. */
static inline void set_start(struct trial *t, double swing, double swing_rate)
{
    struct collocation_problem *p = &t->problem;
    const double load = load_at_start(p, p->reach);
    p->deviation = swing + (p->omega2 > 0.0 ? load / p->omega2 : 0.0);
    p->rate = vec3_axpy(p->rate, swing_rate, p->normal);
    p->radial = vec3_dot(p->normal, p->rate);
}

/* d to 1: the circle about the centre, a relative acceleration, a velocity mismatch; all of them such that n
 * turns by a radian in 1/turning. `swing` is the oscillation's size in parts of the largest there may be: an
 * impact's for a resolved step, of the load's depth otherwise. */
static inline struct trial random_trial(struct random *r, enum collocation_kind kind, double swing,
                                        bool has_mismatch)
{
    struct trial t = {.kind = kind, .turning = random_power(r, -1.0, 2.0)};
    struct collocation_problem *p = &t.problem;
    p->reach = random_power(r, -2.0, 1.0);
    p->normal = random_direction(r);
    set_oscillator(r, &t);
    t.step = random_step(r, &t);
    const double speed = 0.25 * p->reach * t.turning;
    const double span = fmax(t.step, 1.0 / t.turning);
    p->rate = random_across(r, p->normal, speed);
    random_path(r, p->acceleration, COLLOCATION_ACCELERATION_TERMS, 0.5 * speed * t.turning, span);
    p->has_mismatch = has_mismatch;
    if (has_mismatch) {
        const double size = kind == COLLOCATION_RESOLVED ? speed : 0.5 * speed * t.turning / t.rates.faster;
        random_path(r, p->mismatch, COLLOCATION_MISMATCH_TERMS, size, span);
    }
    const double fastest = kind == COLLOCATION_RESOLVED ? speed : speed * t.turning / t.rates.faster;
    set_start(&t, random_between(r, -swing, swing) * fastest / t.rates.faster,
              random_between(r, -swing, swing) * fastest);
    t.distance = p->reach + p->deviation;
    return t;
}

#endif
