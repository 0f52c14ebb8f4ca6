#include <float.h>
#include <string.h>

#include "math/nodes.h"
#include "touch/segment.h"

/*
 * This file has the segments under Hertz's law alone, F_n = k_h delta^(3/2) (1 + chi delta'): the closed form
 * of an undamped head-on impact, lasting contact without its oscillation, and how long bodies at the touch
 * hardly feel each other.
 */

/* Returns the penetration [m] at which the normal force divided by the reduced mass is `acceleration`
 * [m/s^2]. */
static double hertz_depth_under(const struct contact_pair *from, double acceleration)
{
    const double ratio = acceleration * from->reduced_mass / from->hertz_stiffness;
    return cbrt(ratio * ratio);
}

double hertz_depth_to_come(const struct contact_pair *from, double opening)
{
    const double k = from->hertz_stiffness / from->reduced_mass;
    const double load = pair_load(from) / from->reduced_mass;
    const double speed = fabs(opening);
    const double stops = fmin(0.5 * speed, 1.0 / from->chi); /* 0.5 speed if chi = 0 */
    const double by_speed = pow(2.5 * speed * stops / k, 0.4);
    const double creeps = sqrt(sqrt(0.5 * load) / (k * from->chi)); /* INFINITY or NaN if chi = 0 */
    const double by_load = fmin(hertz_depth_under(from, load), creeps);
    return fmax(fmax(by_speed, by_load), -from->gap);
}

/*
 * These functions follow a head-on impact by Hertz's law without damping, under a constant relative
 * acceleration L that presses the bodies together (negative: pulls them apart), in closed form up to one
 * quadrature.
 *
 *   v^2 = e + 2 L delta - (4/5) k delta^(5/2),   k = k_h / m_red,   e: the square of the speed at the touch
 *
 * With delta = delta_max u^2 and u = 1 - w^2 the right side is w^2 P(u), P of degree four, and
 *
 *   delta' = -w sqrt(P),   dt = 4 delta_max u / sqrt(P) dw:
 *
 * the touch is at w = -1, the deepest place at 0, the release at 1, and nothing is singular in between.
 * Variable s = w less w at the start.
 */

/* These tables are the positive half of the Gauss-Legendre rule with 26 points on [-1, 1]. The nearest
 * singularities of dt/dw are the roots of P. For an impact without load they are at w = +-0.966 +- 0.492 i,
 * on the ellipse about -1 and 1 whose half axes add up to 2.03, and the error over a whole impact is 2.03^-52
 * = 1e-16. Under the largest load allowed the sum is 1.93 and the error 1e-15. */
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

/* This is the largest number of steps of Newton's method for delta_max. */
enum { DEEPEST_STEPS = 50 };

/* Computes P = e (1 + u + u^2 + u^3 + u^4) + 2 L delta_max u^2 (1 + u + u^2). */
static inline double elastic_polynomial(const struct hertz_elastic *p, double u)
{
    const double high = p->touch + p->pressed;
    return p->touch + u * (p->touch + u * high * (1.0 + u * (1.0 + u)));
}

/* u = 1 - w^2. */
static inline double elastic_root(double w)
{
    return (1.0 - w) * (1.0 + w);
}

/* Returns dt/dw divided by 4 delta_max [s/m]. */
static inline double elastic_pace(const struct hertz_elastic *p, double w)
{
    const double u = elastic_root(w);
    return u / sqrt(elastic_polynomial(p, u));
}

/* Returns the time from w to w + s [s]. */
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

/* Returns twice the stored elastic energy divided by m_red, (4/5) k delta^(5/2) [m^2/s^2]. */
static double elastic_stored(double k, double depth)
{
    return 0.8 * k * depth * depth * sqrt(depth);
}

/* Returns delta_max [m], the root of (4/5) k delta^(5/2) = e + 2 L delta. The function is convex, so Newton's
 * method comes down to the root from the first step on. */
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

static double elastic_time(const struct hertz_elastic *p, double s)
{
    return s == p->end ? p->end_time : s == 0.0 ? 0.0 : elastic_time_between(p, p->start, s);
}

void hertz_elastic_time(const void *hertz_elastic, double s, double time[3])
{
    const struct hertz_elastic *p = hertz_elastic;
    time[0] = elastic_time(p, s);
    time[1] = 4.0 * p->deepest * elastic_pace(p, p->start + s);
}

void hertz_elastic_sample(const void *hertz_elastic, double s, struct pair_sample *sample)
{
    const struct hertz_elastic *p = hertz_elastic;
    const double w = s == p->end ? 1.0 : p->start + s;
    const double u = elastic_root(w);
    const double high = p->touch + p->pressed;
    const double slope = p->touch + u * high * (2.0 + u * (3.0 + u * 4.0)); /* dP/du */
    const double bend = high * (2.0 + u * (6.0 + u * 12.0));                /* d2P/du2 */
    const double q = sqrt(elastic_polynomial(p, u));
    const double turn = -slope / q; /* dq/dw = w turn */
    const double q_bend = turn + w * w * (2.0 * bend - turn * turn) / q;
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

/* Returns r along side n at s, where the gap is `gap` and the time is `time`. */
static double elastic_deviation(const struct hertz_elastic *p, double gap, double time)
{
    return gap - p->from->gap - (pair_gap_derivative(p->from) - 0.5 * p->load * time) * time;
}

struct pair_change hertz_elastic_advance(const void *hertz_elastic, double s)
{
    const struct hertz_elastic *p = hertz_elastic;
    struct pair_sample at;
    hertz_elastic_sample(p, s, &at);
    const double time = elastic_time(p, s);
    const double gap = at.of[PAIR_GAP][0];
    const double r_rate = at.of[PAIR_GAP_RATE][0] - pair_gap_derivative(p->from) + p->load * time;
    return pair_change_along_normal(p->from, time, elastic_deviation(p, gap, time), r_rate, gap);
}

void hertz_elastic_moments(const void *hertz_elastic, double s, const struct pair_change *change, int count,
                           struct vec3 *moment)
{
    const struct hertz_elastic *p = hertz_elastic;
    (void)change;
    memset(moment, 0, (size_t)count * sizeof *moment);
    for (int i = 0; i < 2 * GAUSS_HALF; ++i) {
        const double node = i < GAUSS_HALF ? gauss[i].node : -gauss[i - GAUSS_HALF].node;
        const double at = 0.5 * s * (1.0 + node);
        const double u = elastic_root(p->start + at);
        const double time = elastic_time(p, at);
        const double r = p->from->shape.side * elastic_deviation(p, -p->deepest * u * u, time);
        double weight =
            0.5 * s * gauss[i % GAUSS_HALF].weight * 4.0 * p->deepest * elastic_pace(p, p->start + at);
        for (int j = 0; j < count; ++j) {
            moment[j] = vec3_axpy(moment[j], weight * r, p->from->normal);
            weight *= time;
        }
    }
}

/* How long bodies at the touch hardly feel each other, and how contact ends. */

/* A contact force is negligible if it is less than NO_FORCE times the load. */
static const double NO_FORCE = 0.5 * DBL_EPSILON;

double hertz_idle_depth(const struct contact_pair *from)
{
    return hertz_depth_under(from, NO_FORCE * pair_pressing_load(from));
}

/* A series by u = sqrt(delta) cannot begin at rest at the touch, or nearly so: the bodies then coast until
 * the force is no longer negligible. Speed, load and each power of the load's growth add one depth at most
 * whose force is negligible. */
double hertz_coasting_time(const struct segment *p)
{
    const struct contact_pair *from = &p->pair;
    const double load = pair_load(from) / from->reduced_mass;
    const double depth = hertz_idle_depth(from);
    const double speed = fabs(pair_gap_derivative(from));
    if (!(-from->gap <= depth && speed * speed <= 2.0 * load * depth)) {
        return 0.0;
    }
    double time = fmin(p->longest, depth / speed);
    for (int i = 2; i <= SEPARATION_DEGREE; ++i) { /* size t^i is the depth for size i (i - 1) t^(i-2) */
        const double size = i == 2 ? 0.5 * load : vec3_norm(from->flight.c[i]);
        const double under = hertz_depth_under(from, NO_FORCE * i * (i - 1) * size);
        time = fmin(time, pow(under / size, 3.0 / (i + 4)));
    }
    return time;
}

/* The closed form does not serve where the impact is slow, which means e < 4 L delta_max. A contact that
 * hardly parts is slow. */
bool hertz_elastic_make(struct segment *p)
{
    struct hertz_elastic *made = &p->as.hertz_elastic;
    const struct contact_pair *from = &p->pair;
    const double k = from->hertz_stiffness / from->reduced_mass;
    const double depth = fmax(-from->gap, 0.0);
    p->work += CLOSED_FORM_WORK;
    if (from->chi > 0.0 || from->has_mismatch || !from->is_head_on || contact_is_rim(&from->shape)) {
        return false;
    }
    const double rate = pair_gap_derivative(from);
    made->from = from;
    made->load =
        -2.0 * from->shape.side * vec3_dot(from->normal, contact_across(&from->shape, from->flight.c[2]));
    made->touch = rate * rate + elastic_stored(k, depth) - 2.0 * made->load * depth;
    made->deepest = elastic_deepest(k, made->load, made->touch);
    made->pressed = 2.0 * made->load * made->deepest;
    const bool free =
        !contact_may_reach_centre(&from->shape) || made->deepest < 0.5 * contact_reach(&from->shape);
    if (!(made->touch > 0.0 && made->touch >= 2.0 * made->pressed && made->deepest > DBL_MIN && free)) {
        return false;
    }
    made->start = rate / sqrt(elastic_polynomial(made, sqrt(depth / made->deepest)));
    made->start = fmin(fmax(made->start, -1.0), 1.0);
    made->end = 1.0 - made->start;
    made->end_time = elastic_time_between(made, made->start, made->end);
    if (!isfinite(made->end_time)) {
        return false;
    }
    const bool parts = made->end_time <= p->longest;
    p->clear_of_centre = true;
    p->end = parts ? made->end : pair_place_by(hertz_elastic_time, made, p->longest, made->end);
    dense_output_add(&p->output, 0.0);
    if (made->start < 0.0 &&
        -made->start < p->end) { /* every quantity has its extremum at the largest penetration */
        dense_output_add(&p->output, -made->start);
    }
    dense_output_add(&p->output, p->end);
    p->parting = parts ? p->end : (double)INFINITY;
    return p->end > 0.0;
}

/*
 * Quasi-static motion is that of a lasting contact whose oscillation has died away, in steps as long as the
 * tangential motion allows, whatever the stiffness, by touch/collocation.h. Such a step follows the load and
 * leaves out the free oscillation y from its start, so the step is only taken where y is within tolerance.
 */

/* This struct holds how fast a lasting contact oscillates, decays and creeps. */
struct slow_scales {
    double fast;  /* rate of the contact's oscillation or of its damping, the faster one [1/s] */
    double creep; /* rate at which an overdamped contact settles [1/s]; 0 if the contact oscillates */
};

static struct slow_scales slow_scales_of(const struct contact_pair *from)
{
    const double depth = -from->gap;
    const double k = from->hertz_stiffness / from->reduced_mass;
    const double spring = sqrt(1.5 * k * sqrt(depth));
    const double dashpot = k * from->chi * depth * sqrt(depth);
    return (struct slow_scales){.fast = fmax(spring, dashpot),
                                .creep = dashpot > 2.0 * spring ? spring * spring / dashpot : 0.0};
}

/* When lasting contact is quasi-static, and how long a segment is. */

/* This is the length of a segment at the finest accuracy [radians of the tangential motion]. The segment is
 * accurate between its ends too, because an event may end it. The length grows with the tolerance as
 * polynomials of the nodes' degree allow. */
static const double SLOW_STEP = 0.7;

/* This is the smallest length of a segment [radians of the contact's oscillation, or decay times of its
 * damping]. A shorter segment would reach no farther than a few power series. */
static const double SLOW_SHORTEST = 16.0;

/* Bounds of the relative accuracy of the penetration and of its remaining oscillation. Between the bounds the
 * accuracy is the solver's tolerance relative to the bodies' size, so that the force is as accurate as the
 * positions. */
static const double SLOW_FINEST = 1e-9;
static const double SLOW_COARSEST = 1e-4;

/* A segment may be wrong by PART_OF_TOLERANCE times the solver's tolerances (integrator/phases.c). */
static const double PART_OF_TOLERANCE = 1e-3;

static double slow_accuracy(const struct segment *p)
{
    const double size = fmax(p->pair.distance, contact_reach(&p->pair.shape));
    const double asked = p->tolerance / (PART_OF_TOLERANCE * size);
    return fmin(fmax(asked, SLOW_FINEST), SLOW_COARSEST);
}

/* The scaled derivatives of the slow motion fall with powers of the slow rate divided by the fast rate; the
 * scaled derivatives of the fast motion do not. At order FAST_ORDER and the next only the fast motion is
 * left. */
enum { FAST_ORDER = 6 };
/* The fast motion counts as absent if its scaled derivatives are below the accuracy times FAST_CLEARLY for an
 * oscillation, or times DECAY_CLEARLY for a decay. The derivatives show an oscillation at about a quarter of
 * its size. */
static const double FAST_CLEARLY = 0.8;
static const double DECAY_CLEARLY = 4.0;

/* These are the numbers of trials of a step; each trial is half as long as the one before. The trials after
 * FOLLOWING are for a contact beyond critical damping that is still settling. They are at most CREEP_STEP
 * settling times long. */
enum { SLOW_ATTEMPTS = 6, FOLLOWING = 2 };
static const double CREEP_STEP = 2.0;

/* Largest relative change of the depth in a segment, because force and energy are powers of the depth. The
 * limit holds for bodies that leave, and from the third trial on also for bodies that sink. */
static const double PART_OF_DEPTH = 0.5;

bool quasi_static_applies(const struct segment *p)
{
    const struct contact_pair *from = &p->pair;
    if (from->has_mismatch || !(from->gap < 0.0)) {
        return false;
    }
    const struct slow_scales scales = slow_scales_of(from);
    /* Without a load that presses, bodies leave a deep overlap at the speed 1/chi. At that speed the force is
     * zero to rounding, where a law with events ends its regime. */
    const bool leaves = scales.creep > 0.0 && !contact_has_events(&from->law);
    return scales.fast * p->longest >= SLOW_SHORTEST && (leaves || pair_pressing_load(from) > 0.0);
}

bool quasi_static_is_shown(const struct segment *p, const double *root, double unit)
{
    const struct slow_scales scales = slow_scales_of(&p->pair);
    /* the force of an overdamped contact depends on the rate, so a decay counts more by the factor fast
     * divided by creep */
    const double clearly = scales.creep > 0.0 ? DECAY_CLEARLY * scales.creep / scales.fast : FAST_CLEARLY;
    const double radians = scales.fast * unit * root[0]; /* radians of the fast motion per unit of s */
    double power = 1.0;
    double part = 0.0; /* half of the fast part of the penetration */
    for (int i = 1; i <= FAST_ORDER + 1; ++i) {
        power *= radians / i;
        part = i >= FAST_ORDER ? fmax(part, fabs(root[i]) / power) : 0.0;
    }
    return 2.0 * part / root[0] <= clearly * slow_accuracy(p);
}

/* Makes a step [s]. Returns false where the step is not accurate. delta and the free oscillation that it
 * leaves out must be within `depth_tolerance` [m], and d n within the tolerance of the segment. */
static bool quasi_static_solve(struct segment *p, const struct slow_scales *scales, double step,
                               double depth_tolerance)
{
    const enum collocation_kind kind = scales->creep > 0.0 ? COLLOCATION_OVERDAMPED : COLLOCATION_AVERAGED;
    struct collocation *made = &p->as.collocation.step;
    struct collocation_result *result = &made->result;
    if (!collocation_make(made, &p->scales.problem, step, kind, 0.1 * p->tolerance)) {
        return false;
    }
    /* the force of an overdamped contact depends on the rate at which the contact settles */
    const double by_rate =
        scales->creep > 0.0 ? scales->creep * made->half : fmax(1.0, scales->fast * made->half);
    const double left_out = fmax(fabs(result->y), fabs(result->y_rate) / by_rate);
    result->y = result->y_rate = 0.0;
    memset(result->correction, 0, sizeof result->correction);
    return fmax(left_out, result->deviation_error) <= depth_tolerance &&
           result->interior_error <= p->tolerance;
}

bool quasi_static_make(struct segment *p)
{
    const struct slow_scales scales = slow_scales_of(&p->pair);
    const double accuracy = slow_accuracy(p);
    p->work += COLLOCATED_WORK;
    const double radians = SLOW_STEP * pow(accuracy / SLOW_FINEST, 1.0 / LOBATTO_MAX);
    pair_timescales_make(&p->scales, &p->pair, &p->flight);
    double step =
        p->scales.problem.head_on ? p->longest : fmin(p->longest, radians / p->scales.tangential_rate);
    const double opening = pair_gap_derivative(&p->pair);
    const double part_of_depth = PART_OF_DEPTH * -p->pair.gap / fabs(opening);
    if (scales.creep > 0.0 && opening > 0.0) {
        step = fmin(step, part_of_depth);
    }
    const int attempts = scales.creep > 0.0 ? SLOW_ATTEMPTS : FOLLOWING;
    for (int i = 0; i < attempts && step * scales.fast >= SLOW_SHORTEST; ++i) {
        if (quasi_static_solve(p, &scales, step, -p->pair.gap * accuracy)) {
            p->parting = (double)INFINITY;
            return true;
        }
        step *= 0.5;
        if (i + 1 == FOLLOWING) {
            step = fmin(step, fmin(CREEP_STEP / scales.creep, part_of_depth));
        }
    }
    return false;
}
