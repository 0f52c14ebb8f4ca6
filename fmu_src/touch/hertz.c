#include <float.h>

#include "math/polynomial.h"
#include "touch/hertz.h"
#include "touch/segment.h"
#include "touch/terminal_event.h"

double hertz_depth_under(const struct contact_pair *from, double acceleration)
{
    const double ratio = acceleration * from->reduced_mass / from->hertz_stiffness;
    return cbrt(ratio * ratio);
}

double hertz_depth_to_come(const struct contact_pair *from, double opening)
{
    const double k = from->hertz_stiffness / from->reduced_mass;
    const double load = pair_load(from) / from->reduced_mass;
    const double speed = fabs(opening);
    const double stops = fmin(0.5 * speed, 1.0 / from->chi); /* chi = 0: the former */
    const double by_speed = pow(2.5 * speed * stops / k, 0.4);
    const double creeps = sqrt(sqrt(0.5 * load) / (k * from->chi)); /* chi = 0: INFINITY, or NaN */
    const double by_load = fmin(hertz_depth_under(from, load), creeps);
    return fmax(fmax(by_speed, by_load), -from->gap);
}

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

/* The work of paths that are constant, as in pair.c. */
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

/* Under Hertz's law: how long bodies at the touch hardly feel each other, and how contact ends. */

/* A contact force of this part of the load is none. */
static const double NO_FORCE = 0.5 * DBL_EPSILON;

/* Halvings of a step at most: from the longest to the shortest that double precision tells apart. */
enum { HALVINGS = 1100 };

/* Bounds of penetration [m] and relative acceleration [m/s^2] after a time without contact force. */
struct coasting {
    double depth, acceleration;
};

static struct coasting coasting_to(const struct contact_pair *from, double time)
{
    const struct vec3 *c = from->flight.c;
    const double load = pair_load(from) / from->reduced_mass;
    const double cubic = vec3_norm(c[3]) * time;
    const double quartic = vec3_norm(c[4]) * time * time;
    const double speed = fabs(pair_gap_derivative(from));
    return (struct coasting){fmax(-from->gap, 0.0) + time * (speed + time * (0.5 * load + cubic + quartic)),
                             load + 6.0 * cubic + 12.0 * quartic};
}

double hertz_pressing_load(const struct contact_pair *from)
{
    return -from->shape.side *
           (pair_turning(from, from->distance) + 2.0 * vec3_dot(from->normal, from->flight.c[2]));
}

/* Whether bodies that part at this speed come back before it has brought them apart by the depth at which the
 * force is nothing beside the load. An oscillation that touches zero is to have no events on rounding. */
static bool hardly_parts(const struct contact_pair *from, double speed)
{
    const double load = hertz_pressing_load(from);
    return load > 0.0 && speed * speed <= 2.0 * load * hertz_depth_under(from, NO_FORCE * load);
}

/*
 * At rest at the touch, or nearly so, u = sqrt(delta) is no variable to begin with. For how long the
 * contact's force stays nothing beside the load [s]; 0 where it is not, or where the bodies move on their
 * own.
 */
double hertz_coasting_time(const struct segment *p)
{
    const struct contact_pair *from = &p->pair;
    const double load = pair_load(from) / from->reduced_mass;
    const double depth = hertz_depth_under(from, NO_FORCE * load);
    const double speed = pair_gap_derivative(from);
    if (!(-from->gap <= depth && speed * speed <= 2.0 * load * depth)) {
        return 0.0;
    }
    double time = p->longest;
    for (int i = 0; i < HALVINGS && time > 0.0; ++i) {
        const struct coasting then = coasting_to(from, time);
        /* four: penetration, speed and load bring one depth each, and the force is a little more than
         * proportional */
        if (then.depth <= 4.0 * hertz_depth_under(from, NO_FORCE * then.acceleration)) {
            return time;
        }
        time *= 0.5;
    }
    return time;
}

void hertz_find_terminal_event(struct segment *p, double parting)
{
    const int last = p->output.count - 1;
    if (parting > 0.0 && parting <= p->end &&
        hardly_parts(&p->pair, p->output.at[last].of[PAIR_GAP_RATE][0])) {
        parting = (double)INFINITY;
    }
    const struct terminal_event parts = {parting, {PAIR_GAP, -1.0, 0.0}, REGIME_APART};
    p->terminal = parts;
    if (terminal_event_by_law(p)) {
        const struct event_function margin = terminal_event_margin(p);
        const double s = dense_output_first_event(&p->output, &margin);
        if (s < parting) {
            p->terminal = (struct terminal_event){s, margin, contact_regime_after(&p->pair.law, p->regime)};
        }
    }
}

bool hertz_elastic_applies(const struct segment *p)
{
    return contact_is_hertz(&p->pair.law) && p->pair.chi == 0.0 && !contact_is_rim(&p->pair.shape);
}

bool hertz_elastic_segment_make(struct segment *p)
{
    struct hertz_elastic *made = &p->as.hertz_elastic;
    if (!hertz_elastic_make(made, &p->pair)) {
        return false;
    }
    const bool parts = made->end_time <= p->longest;
    p->clear_of_centre = true;
    p->end = parts ? made->end : hertz_elastic_place(made, p->longest);
    p->unit = hertz_elastic_time(made, p->end) / p->end;
    dense_output_add(&p->output, 0.0);
    if (made->start < 0.0 && -made->start < p->end) { /* the deepest place, where each has one extremum */
        dense_output_add(&p->output, -made->start);
    }
    dense_output_add(&p->output, p->end);
    hertz_find_terminal_event(p, parts ? p->end : (double)INFINITY);
    return p->end > 0.0;
}
