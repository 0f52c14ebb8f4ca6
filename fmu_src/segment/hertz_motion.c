#include <float.h>

#include "math/radau.h"
#include "segment/kinds.h"
#include "segment/terminal_event.h"

/* A contact force of this part of the load is none. */
static const double NO_FORCE = 0.5 * DBL_EPSILON;

/* Places at which a segment is sampled: it is a third of the radius of convergence at most, so that between
 * two of them no quantity has two extrema. */
enum { PLACES = 3 };

/* What the last terms of a series may be, as a part of the whole: the tolerance of a segment, but no less
 * than some roundings, and no more than keeps energies closed to 1e-10 over thousands of steps. */
static const double FINEST = 8.0 * DBL_EPSILON;
static const double COARSEST = 1e-13;

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

/* L: the acceleration that presses the bodies together [m/s^2]. */
static double pressing_load(const struct contact_pair *from)
{
    return -from->shape.side *
           (pair_turning(from, from->distance) + 2.0 * vec3_dot(from->normal, from->flight.c[2]));
}

/* Whether bodies that part at this speed come back before it has brought them apart by the depth at which the
 * force is nothing beside the load. An oscillation that touches zero is to have no events on rounding. */
static bool hardly_parts(const struct contact_pair *from, double speed)
{
    const double load = pressing_load(from);
    return load > 0.0 && speed * speed <= 2.0 * load * pair_hertz_depth_under(from, NO_FORCE * load);
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
    const double depth = pair_hertz_depth_under(from, NO_FORCE * load);
    const double speed = pair_gap_derivative(from);
    if (!(-from->gap <= depth && speed * speed <= 2.0 * load * depth)) {
        return 0.0;
    }
    double time = p->longest;
    for (int i = 0; i < HALVINGS && time > 0.0; ++i) {
        const struct coasting then = coasting_to(from, time);
        /* four: penetration, speed and load bring one depth each, and the force is a little more than
         * proportional */
        if (then.depth <= 4.0 * pair_hertz_depth_under(from, NO_FORCE * then.acceleration)) {
            return time;
        }
        time *= 0.5;
    }
    return time;
}

bool hertz_applies(const struct segment *p)
{
    return contact_is_hertz(&p->pair.law);
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

bool hertz_make(struct segment *p)
{
    struct pair_hertz *made = &p->as.hertz;
    const double coasting = hertz_coasting_time(p);
    if (coasting > 0.0) {
        p->longest = coasting;
        return false;
    }
    const double asked = p->tolerance / fmax(p->pair.distance, contact_reach(&p->pair.shape));
    pair_hertz_make(made, &p->pair, fmin(fmax(asked, FINEST), COARSEST));
    p->unit = made->unit;
    double parting = pair_hertz_parting(made->root, made->step);
    p->end = fmin(made->step, parting > 0.0 ? parting : made->step);
    if (parting > 0.0 && pair_hertz_time(made, p->end) > p->longest) {
        p->end = pair_hertz_place(made, p->longest, p->end);
        parting = p->end < parting ? (double)INFINITY : parting;
    }
    for (int i = 0; i < PLACES; ++i) {
        dense_output_add(&p->output, p->end * i / (PLACES - 1));
    }
    hertz_find_terminal_event(p, parting);
    return true;
}

bool hertz_elastic_applies(const struct segment *p)
{
    return contact_is_hertz(&p->pair.law) && p->pair.chi == 0.0;
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

/* Length of a slow segment at the finest accuracy [radians of the tangential motion]; an event may end it, so
 * that it is accurate in between too. It grows as polynomials of the stages' degree allow. */
static const double SLOW_STEP = 0.7;

/* Smallest length of it [radians of the contact's oscillation, or decay times of its damping]. A shorter one
 * is no longer than a few of the other kind. */
static const double SLOW_SHORTEST = 16.0;

/* The accuracy of the penetration, and what is left of its oscillation, relative to it: the tolerance of the
 * solver, relative to the bodies' size, so that outputs of the force are as good as those of positions; but
 * no less than this, and no more. */
static const double SLOW_FINEST = 1e-9;
static const double SLOW_COARSEST = 1e-4;

/* A segment may be wrong by this part of the solver's tolerances (event_driven.c). */
static const double PART_OF_TOLERANCE = 1e-3;

static double slow_accuracy(const struct segment *p)
{
    const double size = fmax(p->pair.distance, contact_reach(&p->pair.shape));
    const double asked = p->tolerance / (PART_OF_TOLERANCE * size);
    return fmin(fmax(asked, SLOW_FINEST), SLOW_COARSEST);
}

/* The derivatives of the slow motion fall with powers of the ratio of the rates, those of what is fast do
 * not: by this order and the next only that is left. */
enum { FAST_ORDER = 6 };

/* By them an oscillation is known to about a quarter of it; beyond critical damping, where it is none, to
 * about this factor. */
static const double FAST_CLEARLY = 0.8;
static const double DECAY_CLEARLY = 4.0;

/* Trials, each at half the step, the third at this many of the times in which a contact beyond critical
 * damping settles: it may have to be followed. */
enum { SLOW_ATTEMPTS = 4, FOLLOWING = 2 };
static const double CREEP_STEP = 2.0;

/* The pair as the slow motion sees it. */
struct slow_scales {
    double load;  /* L: the acceleration that presses [m/s^2] */
    double along; /* the tangential rate [1/s] */
    double fast;  /* of the contact's oscillation or of its damping, whichever is faster [1/s] */
    double creep; /* beyond critical damping the rate at which it settles; 0: it oscillates [1/s] */
};

static struct slow_scales slow_scales_of(const struct contact_pair *from)
{
    const struct vec3 across = pair_tangential(from, pair_across(from, from->flight.c[1]));
    const struct vec3 acceleration = pair_across(from, vec3_scale(2.0, from->flight.c[2]));
    const double d = from->distance;
    const double depth = -from->gap;
    const double k = from->hertz_stiffness / from->reduced_mass;
    const bool turns = !vec3_is_zero(across) || !vec3_is_zero(pair_tangential(from, acceleration));
    const double spring = sqrt(1.5 * k * sqrt(depth));
    const double dashpot = k * from->chi * depth * sqrt(depth);
    return (struct slow_scales){.load = pressing_load(from),
                                .along =
                                    turns ? vec3_norm(across) / d + sqrt(vec3_norm(acceleration) / d) : 0.0,
                                .fast = fmax(spring, dashpot),
                                .creep = dashpot > 2.0 * spring ? spring * spring / dashpot : 0.0};
}

/* What is fast in the penetration, as a part of it, by the coefficients of u = sqrt(delta). */
static double fast_part_of(const struct pair_hertz *series, double fast)
{
    const double root = series->root[0];
    const double radians = fast * series->unit * root; /* of it in a unit of s */
    double power = 1.0;
    double part = 0.0;
    for (int i = 1; i <= FAST_ORDER + 1; ++i) {
        power *= radians / i;
        part = i >= FAST_ORDER ? fmax(part, fabs(series->root[i]) / power) : 0.0;
    }
    return 2.0 * part / root;
}

bool hertz_slow_applies(const struct segment *p)
{
    const struct contact_pair *from = &p->pair;
    if (from->has_mismatch || !(from->gap < 0.0)) {
        return false;
    }
    const struct slow_scales scales = slow_scales_of(from);
    const double clearly = scales.creep > 0.0 ? DECAY_CLEARLY : FAST_CLEARLY;
    return scales.load > 0.0 && scales.fast * p->longest >= SLOW_SHORTEST &&
           fast_part_of(&p->as.hertz, scales.fast) <= clearly * slow_accuracy(p);
}

bool hertz_slow_make(struct segment *p)
{
    struct hertz_slow *made = &p->as.hertz_slow;
    const struct slow_scales scales = slow_scales_of(&p->pair);
    const double accuracy = slow_accuracy(p);
    const double radians = SLOW_STEP * pow(accuracy / SLOW_FINEST, 1.0 / RADAU_POINTS);
    double step = scales.along > 0.0 ? fmin(p->longest, radians / scales.along) : p->longest;
    const int attempts = scales.creep > 0.0 ? SLOW_ATTEMPTS : FOLLOWING;
    for (int i = 0; i < attempts && step * scales.fast >= SLOW_SHORTEST; ++i) {
        if (slow_hertz_make(made, &p->pair, step, p->tolerance, -p->pair.gap * accuracy)) {
            p->unit = made->half;
            p->end = 2.0;
            dense_output_add(&p->output, 0.0);
            for (int k = 0; k < RADAU_POINTS; ++k) {
                dense_output_add(&p->output, 1.0 + radau.node[k]);
            }
            hertz_find_terminal_event(p, (double)INFINITY);
            return true;
        }
        step *= 0.5;
        if (i + 1 == FOLLOWING) {
            step = fmin(step, CREEP_STEP / scales.creep);
        }
    }
    return false;
}
