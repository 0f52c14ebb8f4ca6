#include "segment/hertz_elastic.h"

#include <float.h>

#include "math/root.h"
#include "segment/pair_hertz.h"
#include "segment/pair_oscillation.h"

/* Gauss-Legendre rule on [-1, 1], 26 points, the positive half. The nearest singularities of dt/dw are the
 * roots of P: of an impact without load at w = +-0.966 +- 0.492 i, on the ellipse about -1 and 1 whose half
 * axes add up to 2.03. Over a whole impact the rule is off by 2.03^-52 = 1e-16; with the largest load allowed
 * the ellipse is of 1.93, and that is 1e-15. */
static const struct {
    double node, weight;
} gauss[] = {
    {0.05923009342931321, 0.11832141527926228}, {0.17685882035689018, 0.11666044348529658},
    {0.2920048394859569, 0.11336181654631966},  {0.4030517551234863, 0.10847184052857659},
    {0.5084407148245057, 0.10205916109442542},  {0.6066922930176181, 0.09421380035591415},
    {0.6964272604199573, 0.08504589431348523},  {0.7763859488206789, 0.07468414976565975},
    {0.845445942788498, 0.06327404632957484},   {0.9026378619843071, 0.05097582529714781},
    {0.9471590666617142, 0.037962383294362766}, {0.978385445956471, 0.02441785109263191},
    {0.9958857011456169, 0.010551372617343006},
};

enum { GAUSS_HALF = sizeof gauss / sizeof gauss[0] };

/* Newton's method for delta_max from a place near it. */
enum { DEEPEST_STEPS = 50 };

/* P and its first two derivatives: e (1 + u + u^2 + u^3 + u^4) + 2 L delta_max u^2 (1 + u + u^2). */
static inline double elastic_polynomial(const struct hertz_elastic *p, double u)
{
    const double high = p->touch + p->pressed;
    return p->touch + u * (p->touch + u * high * (1.0 + u * (1.0 + u)));
}

static void elastic_polynomial_slopes(const struct hertz_elastic *p, double u, double out[2])
{
    const double high = p->touch + p->pressed;
    out[0] = p->touch + u * high * (2.0 + u * (3.0 + u * 4.0));
    out[1] = high * (2.0 + u * (6.0 + u * 12.0));
}

static inline double elastic_root(double w)
{
    return (1.0 - w) * (1.0 + w);
}

/* dt/dw over 4 delta_max [s/m] */
static inline double elastic_pace(const struct hertz_elastic *p, double w)
{
    const double u = elastic_root(w);
    return u / sqrt(elastic_polynomial(p, u));
}

/* The time from w to w + s [s]. */
static double elastic_time_between(const struct hertz_elastic *p, double w, double s)
{
    const double half = 0.5 * s;
    const double middle = w + half;
    double sum = 0.0;
    for (int i = 0; i < GAUSS_HALF; ++i) {
        const double off = half * gauss[i].node;
        sum += gauss[i].weight * (elastic_pace(p, middle - off) + elastic_pace(p, middle + off));
    }
    return 4.0 * p->deepest * half * sum;
}

/* (4/5) k delta^(5/2) */
static double elastic_stored(double k, double depth)
{
    return 0.8 * k * depth * depth * sqrt(depth);
}

/* The root of (4/5) k delta^(5/2) = e + 2 L delta, convex: from the first step on Newton's method comes down
 * to it. */
static double elastic_deepest(double k, double load, double touch)
{
    double depth = pow(1.25 * touch / k, 0.4);
    for (int i = 0; i < DEEPEST_STEPS; ++i) {
        const double stored = elastic_stored(k, depth);
        const double missing = touch + 2.0 * load * depth - stored;
        const double step = missing / (2.5 * stored / depth - 2.0 * load);
        depth += step;
        if (!(fabs(step) > 2.0 * DBL_EPSILON * depth)) {
            break;
        }
    }
    return depth;
}

bool hertz_elastic_make(struct hertz_elastic *p, const struct contact_pair *from)
{
    const double k = from->hertz_stiffness / from->reduced_mass;
    const double depth = fmax(-from->gap, 0.0);
    if (from->chi > 0.0 || from->has_mismatch || !from->is_head_on) {
        return false;
    }
    const double rate = pair_gap_derivative(from);
    p->from = from;
    p->load = -2.0 * from->shape.side * vec3_dot(from->normal, pair_across(from, from->flight.c[2]));
    p->touch = rate * rate + elastic_stored(k, depth) - 2.0 * p->load * depth;
    p->deepest = elastic_deepest(k, p->load, p->touch);
    p->pressed = 2.0 * p->load * p->deepest;
    const bool free =
        !contact_may_reach_centre(&from->shape) || p->deepest < 0.5 * contact_reach(&from->shape);
    if (!(p->touch > 0.0 && p->touch >= 2.0 * p->pressed && p->deepest > DBL_MIN && free)) {
        return false;
    }
    p->start = rate / sqrt(elastic_polynomial(p, sqrt(depth / p->deepest)));
    p->start = fmin(fmax(p->start, -1.0), 1.0);
    p->end = 1.0 - p->start;
    p->end_time = elastic_time_between(p, p->start, p->end);
    return p->end > 0.0 && isfinite(p->end_time);
}

double hertz_elastic_time(const struct hertz_elastic *p, double s)
{
    return s == p->end ? p->end_time : s == 0.0 ? 0.0 : elastic_time_between(p, p->start, s);
}

struct elastic_time_left {
    const struct hertz_elastic *of;
    double time;
};

static void elastic_time_left_at(const void *elastic_time_left, double s, double *value, double *slope)
{
    const struct elastic_time_left *left = elastic_time_left;
    *value = hertz_elastic_time(left->of, s) - left->time;
    *slope = 4.0 * left->of->deepest * elastic_pace(left->of, left->of->start + s);
}

double hertz_elastic_place(const struct hertz_elastic *p, double time)
{
    const struct elastic_time_left left = {p, time};
    return time < p->end_time ? root_in_bracket(elastic_time_left_at, &left, 0.0, p->end) : p->end;
}

void hertz_elastic_sample(const void *hertz_elastic, double s, struct pair_sample *sample)
{
    const struct hertz_elastic *p = hertz_elastic;
    const double w = s == p->end ? 1.0 : p->start + s;
    const double u = elastic_root(w);
    double slopes[2];
    elastic_polynomial_slopes(p, u, slopes);
    const double q = sqrt(elastic_polynomial(p, u));
    const double turn = -slopes[0] / q; /* dq/dw = w turn */
    const double q_bend = turn + w * w * (2.0 * slopes[1] - turn * turn) / q;
    const double by_root = p->from->hertz_stiffness * p->deepest * sqrt(p->deepest);
    sample->of[PAIR_GAP][0] = -p->deepest * u * u;
    sample->of[PAIR_GAP][1] = 4.0 * p->deepest * u * w;
    sample->of[PAIR_GAP][2] = 4.0 * p->deepest * (u - 2.0 * w * w);
    sample->of[PAIR_GAP_RATE][0] = w * q;
    sample->of[PAIR_GAP_RATE][1] = q + w * w * turn;
    sample->of[PAIR_GAP_RATE][2] = w * (2.0 * turn + q_bend);
    sample->of[PAIR_FORCE][0] = by_root * u * u * u;
    sample->of[PAIR_FORCE][1] = -6.0 * by_root * u * u * w;
    sample->of[PAIR_FORCE][2] = by_root * u * (24.0 * w * w - 6.0 * u);
}

/* The work of paths that are constant, as in pair_oscillation.c. */
struct pair_change hertz_elastic_change(const void *hertz_elastic, double s)
{
    const struct hertz_elastic *p = hertz_elastic;
    const struct contact_pair *from = p->from;
    struct pair_sample at;
    hertz_elastic_sample(p, s, &at);
    const double time = hertz_elastic_time(p, s);
    const double rate = pair_gap_derivative(from);
    const double r = at.of[PAIR_GAP][0] - from->gap - (rate - 0.5 * p->load * time) * time;
    const double r_rate = at.of[PAIR_GAP_RATE][0] - rate + p->load * time;
    struct pair_change change = {.time = time,
                                 .r = vec3_scale(from->shape.side * r, from->normal),
                                 .r_rate = vec3_scale(from->shape.side * r_rate, from->normal),
                                 .gap = at.of[PAIR_GAP][0],
                                 .dissipated = 0.0};
    for (int end = 0; end < PAIR_BODIES; ++end) {
        const struct pair_work *work = &from->work[end];
        const struct vec3 by = work->order == 1 ? change.r : change.r_rate;
        change.work[end] = work->order == 0 ? 0.0 : vec3_dot(work->path[0], by);
    }
    return change;
}
