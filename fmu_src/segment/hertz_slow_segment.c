/* When a lasting contact under Hertz's law is slow, and how long a segment of it is. */
#include "math/radau.h"
#include "segment/hertz_recurrence.h"
#include "segment/kinds.h"
#include "segment/terminal_event.h"

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
_Static_assert(FAST_ORDER + 1 <= HERTZ_FIRST, "they are among the first");

/* By them an oscillation is known to about a quarter of it; beyond critical damping, where it is none, to
 * about this factor. */
static const double FAST_CLEARLY = 0.8;
static const double DECAY_CLEARLY = 4.0;

/* Trials, each at half the step, the third at this many of the times in which a contact beyond critical
 * damping settles: it may have to be followed. */
enum { SLOW_ATTEMPTS = 6, FOLLOWING = 2 };
static const double CREEP_STEP = 2.0;

/* Force and energy go with powers of the depth: bodies that leave go no farther than this part of it; nor, at
 * the third trial, bodies that sink. */
static const double PART_OF_DEPTH = 0.5;

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
    return (struct slow_scales){.load = hertz_pressing_load(from),
                                .along =
                                    turns ? vec3_norm(across) / d + sqrt(vec3_norm(acceleration) / d) : 0.0,
                                .fast = fmax(spring, dashpot),
                                .creep = dashpot > 2.0 * spring ? spring * spring / dashpot : 0.0};
}

/* What is fast in the penetration, as a part of it, by the coefficients of u = sqrt(delta). */
static double fast_part_of(const double *root, double unit, double fast)
{
    const double radians = fast * unit * root[0]; /* of it in a unit of s */
    double power = 1.0;
    double part = 0.0;
    for (int i = 1; i <= FAST_ORDER + 1; ++i) {
        power *= radians / i;
        part = i >= FAST_ORDER ? fmax(part, fabs(root[i]) / power) : 0.0;
    }
    return 2.0 * part / root[0];
}

bool hertz_slow_applies(const struct segment *p)
{
    const struct contact_pair *from = &p->pair;
    if (from->has_mismatch || !(from->gap < 0.0)) {
        return false;
    }
    const struct slow_scales scales = slow_scales_of(from);
    /* without a load that presses they are pushed out of a deep overlap at the speed 1/chi: where the dashpot
     * may not pull that is where the law ends, to rounding */
    const bool leaves = scales.creep > 0.0 && !terminal_event_by_law(p);
    return (scales.load > 0.0 || leaves) && scales.fast * p->longest >= SLOW_SHORTEST;
}

bool hertz_is_slow(const struct segment *p, const double *root, double unit)
{
    const struct slow_scales scales = slow_scales_of(&p->pair);
    /* beyond critical damping the force goes with the rate: a decay counts more by the ratio of the rates */
    const double clearly = scales.creep > 0.0 ? DECAY_CLEARLY * scales.creep / scales.fast : FAST_CLEARLY;
    return fast_part_of(root, unit, scales.fast) <= clearly * slow_accuracy(p);
}

bool hertz_slow_make(struct segment *p)
{
    struct hertz_slow *made = &p->as.hertz_slow;
    const struct slow_scales scales = slow_scales_of(&p->pair);
    const double accuracy = slow_accuracy(p);
    const double radians = SLOW_STEP * pow(accuracy / SLOW_FINEST, 1.0 / RADAU_POINTS);
    double step = scales.along > 0.0 ? fmin(p->longest, radians / scales.along) : p->longest;
    const double opening = pair_gap_derivative(&p->pair);
    const double part_of_depth = PART_OF_DEPTH * -p->pair.gap / fabs(opening);
    if (scales.creep > 0.0 && opening > 0.0) {
        step = fmin(step, part_of_depth);
    }
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
            step = fmin(step, fmin(CREEP_STEP / scales.creep, part_of_depth));
        }
    }
    return false;
}
