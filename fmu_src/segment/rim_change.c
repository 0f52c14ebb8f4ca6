#include "segment/rim_change.h"

#include <float.h>

#include "math/root.h"

#if SCENE_ANY_CAPS

/* Length of a step, as a part of the distance from the circle: no quantity has two extrema in it. */
static const double RIM_STEP = 0.05;

/* After so many steps, some milliseconds, they are no shorter than this part of the whole: a path
 * along the circle itself takes no end of short ones. A pass of it at a distance of 1e-9 takes a thousand. */
enum { RIM_SHORT_STEPS = 20000 };
static const double RIM_LONG_STEP = 1e-4;

/* Roundings of sums of products of vectors (driven_change.c). */
static const double RIM_ROUNDINGS = 8.0 * DBL_EPSILON;

/* What the law sees at one time. */
struct rim_instant {
    double gap, rate, slope; /* [m], [m/s], and dg/dt [m/s] */
    double distance;         /* from the circle [m] */
    double event;            /* of the law in the present regime (contact_event) */
    enum contact_regime regime;
    double gap_noise, rate_noise;
};

struct rim_search {
    const struct contact_shape *shape;
    const struct contact_law *law;
    const struct separation_path *path;
    double rounding;
    enum contact_regime present;
};

static struct rim_instant rim_instant_at(const struct rim_search *search, double time)
{
    const struct separation_path *path = search->path;
    struct vec3 slope[SEPARATION_DEGREE];
    for (int i = 0; i < SEPARATION_DEGREE; ++i) {
        slope[i] = vec3_scale(i + 1, path->c[i + 1]);
    }
    const struct vec3 w = path_at(path->w, SEPARATION_DEGREE, time);
    const struct vec3 none = {0.0, 0.0, 0.0};
    const struct contact_geometry at =
        contact_geometry_at(search->shape, path_at(path->c, SEPARATION_DEGREE + 1, time), w, none);
    struct rim_instant now = {.gap = at.gap, .rate = at.gap_rate, .distance = at.distance};
    now.slope = vec3_dot(at.normal, path_at(slope, SEPARATION_DEGREE, time));
    now.gap_noise = fmax(search->rounding, RIM_ROUNDINGS * (vec3_norm(path->c[0]) + at.gap_terms));
    now.rate_noise = vec3_norm(w) * (RIM_ROUNDINGS + fmin(now.gap_noise / at.distance, 1.0));
    now.event = contact_event(search->law, search->present, now.gap, now.rate);
    now.regime = contact_regime_of(search->law, now.gap, now.rate, true);
    return now;
}

/* Whether the regime there is another one, whatever rounding does. */
static bool rim_has_changed(const struct rim_search *search, const struct rim_instant *at,
                            enum contact_regime present)
{
    if (at->regime == present) {
        return false;
    }
    if (present == REGIME_APART || at->regime == REGIME_APART) {
        return present == REGIME_APART ? at->gap < -at->gap_noise : at->gap > at->gap_noise;
    }
    const struct contact_slopes slopes = contact_event_slopes(search->law, present, at->gap, at->rate);
    return fabs(contact_event(search->law, present, at->gap, at->rate)) >
           fabs(slopes.by_gap) * at->gap_noise + fabs(slopes.by_rate) * at->rate_noise;
}

/* From a time and a distance on; `count` steps have been made. */
static double rim_step_length(const struct rim_search *search, double time, double distance, double longest,
                              int count)
{
    struct separation_path from = *search->path;
    double step = longest;
    path_shift(from.c, SEPARATION_DEGREE + 1, time);
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        step = fmin(step, pow(RIM_STEP * distance / vec3_norm(from.c[i]), 1.0 / i));
    }
    const double least = count < RIM_SHORT_STEPS ? 4.0 * DBL_EPSILON * time : RIM_LONG_STEP * longest;
    return fmax(step, fmax(least, DBL_MIN));
}

/* The time between two at which the gap is least or largest. */
static double rim_extreme_between(const struct rim_search *search, double low, double high)
{
    const bool falls = rim_instant_at(search, low).slope < 0.0;
    for (;;) {
        const double middle = 0.5 * (low + high);
        if (!(middle > low && middle < high)) {
            return middle;
        }
        *((rim_instant_at(search, middle).slope < 0.0) == falls ? &low : &high) = middle;
    }
}

/* The first change between two times, at the later of which the regime is another one. */
static struct rim_change rim_halve_to_change(const struct rim_search *search, double before, double after,
                                             enum contact_regime present, enum contact_regime next)
{
    for (;;) {
        const double middle = 0.5 * (before + after);
        if (!(middle > before && middle < after)) {
            return (struct rim_change){after, next};
        }
        const enum contact_regime then = rim_instant_at(search, middle).regime;
        if (then != present) {
            next = then;
        }
        *(then != present ? &after : &before) = middle;
    }
}

/* How far within its regime a contact is, for root_may_dip. */
static void rim_event(const void *data, double time, double *value, double *slope)
{
    const struct rim_search *search = data;
    const struct rim_instant at = rim_instant_at(search, time);
    *value = at.event;
    *slope = (double)NAN; /* not needed */
}

struct rim_change rim_first_change(const struct contact_shape *shape, const struct contact_law *law,
                                   const struct separation_path *path, double rounding,
                                   enum contact_regime present, double from, double until)
{
    const struct rim_search search = {shape, law, path, rounding, present};
    struct root_place place[3] = {{from, 1.0}, {from, 1.0}};
    struct rim_instant before = rim_instant_at(&search, from);
    place[1].value = before.event;
    double time = from;
    for (int count = 0; time < until; ++count) {
        const double to =
            fmin(until, time + rim_step_length(&search, time, before.distance, until - from, count));
        const struct rim_instant end = rim_instant_at(&search, to);
        struct rim_instant then = end;
        double at = to;
        place[2] = (struct root_place){to, end.event};
        if (before.slope * end.slope < 0.0 && !rim_has_changed(&search, &end, present)) {
            at = rim_extreme_between(&search, time, to);
            then = rim_instant_at(&search, at);
        }
        if (count > 0 && !rim_has_changed(&search, &then, present) && root_may_dip(place)) {
            at = root_lowest(rim_event, &search, place);
            then = rim_instant_at(&search, at);
            time = place[0].s;
        }
        if (rim_has_changed(&search, &then, present)) {
            return rim_halve_to_change(&search, time, at, present, then.regime);
        }
        place[0] = place[1];
        place[1] = place[2];
        time = to;
        before = end;
    }
    return (struct rim_change){(double)INFINITY, present};
}

double rim_least_gap(const struct contact_shape *shape, const struct separation_path *path, double from,
                     double until)
{
    const struct contact_law none = {.dashpot = DASHPOT_UNCLAMPED, .law = LAW_LINEAR};
    const struct rim_search search = {shape, &none, path, 0.0, REGIME_APART};
    struct rim_instant before = rim_instant_at(&search, from);
    double least = before.gap;
    double time = from;
    for (int count = 0; time < until; ++count) {
        const double to =
            fmin(until, time + rim_step_length(&search, time, before.distance, until - from, count));
        const struct rim_instant then = rim_instant_at(&search, to);
        if (before.slope < 0.0 && then.slope > 0.0) {
            least = fmin(least, rim_instant_at(&search, rim_extreme_between(&search, time, to)).gap);
        }
        least = fmin(least, then.gap);
        time = to;
        before = then;
    }
    return least;
}

#endif
