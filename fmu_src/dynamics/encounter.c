#include "dynamics/encounter.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "contact/bracket.h"
#include "dynamics/centre.h"
#include "dynamics/cuts.h"
#include "dynamics/given_change.h"
#include "dynamics/head_on.h"
#include "dynamics/resolution.h"
#include "dynamics/settling.h"

static enum contact_regime regime_at(const struct approach *path, const struct contact_law *law, double s)
{
    double gap;
    double slope;
    approach_gap(path, s, &gap, &slope);
    const double distance = path->side * gap + path->reach;
    const double rate = distance > 0.0 ? path->side * polynomial_at(&path->half_rate, s) / distance : 0.0;
    return contact_regime_of(law, path->scale * gap, rate * path->scale / path->horizon,
                             approach_within(path, s));
}

static struct encounter first_change(const struct approach *path, const double *cuts, int count,
                                     const struct contact_law *law, enum contact_regime present,
                                     bool ends_only, double settle)
{
    double from = 0.0;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? cuts[i] : 1.0;
        if (to > settle && to > from) {
            from = fmax(from, settle);
            const double middle = 0.5 * (from + to);
            const enum contact_regime next = !ends_only                      ? regime_at(path, law, middle)
                                             : approach_within(path, middle) ? present
                                                                             : REGIME_APART;
            if (next != present) {
                double gap;
                double slope;
                approach_gap(path, from, &gap, &slope);
                return (struct encounter){from * path->horizon, next, path->scale * gap, false};
            }
        }
        from = to;
    }
    return (struct encounter){(double)INFINITY, present, 0.0, false};
}

/* A distance so small [scale] has lost its direction to rounding. */
static const double NO_DISTANCE = 1e-9;

static bool is_at_centre(const struct approach *path, double s)
{
    double gap;
    double slope;
    approach_gap(path, s, &gap, &slope);
    return path->side * gap + path->reach <= NO_DISTANCE;
}

/* Whether the distance vanishes before `until`, as far as rounding can tell. A source that stays where it is, on the axis say, passes
 * nothing: it keeps the direction it has. */
static bool passes_centre(const struct approach *path, const struct extremes *extremes, double until)
{
    if (path->degree == 0) {
        return false;
    }
    bool passes = is_at_centre(path, 0.0) || is_at_centre(path, fmin(until, 1.0));
    for (int i = 0; i < extremes->count && extremes->at[i] < until; ++i) {
        passes = passes || is_at_centre(path, extremes->at[i]);
    }
    return passes;
}

/* Whether the length of the path alone tells that the bodies neither touch nor meet their centres. */
static bool keeps_away(const struct approach *path)
{
    const double start = vec3_norm(path->c[0]);
    double length = 0.0;
    for (int i = 1; i <= path->degree; ++i) {
        length += vec3_norm(path->c[i]);
    }
    if (path->side > 0) {
        return start - length > path->reach + NO_DISTANCE;
    }
    return start + length < path->reach - NO_DISTANCE && start - length > NO_DISTANCE;
}

/* The first touch of bodies that are apart at `settle`, INFINITY if there is none. False where that is not all there is to
 * know, because they are not apart or do not approach when they touch: as they approach, they press. */
static bool first_touch(const struct approach *path, const struct extremes *extremes, double settle,
                        double *touch)
{
    struct bracket_end low = cuts_gap_end(path, settle);
    if (low.value == 0.0 && low.slope > 0.0) {
        low.value = DBL_MIN; /* they have just parted */
    }
    for (int i = 0; i <= extremes->count && low.value > 0.0; ++i) {
        const double s = i < extremes->count ? extremes->at[i] : 1.0;
        if (s > low.s) {
            const struct bracket_end high = cuts_gap_end(path, s);
            if (high.value < 0.0) {
                *touch = bracket_root_between(approach_gap, path, low, high);
                return path->side * polynomial_at(&path->half_rate, *touch) < 0.0;
            }
            low = high;
        }
    }
    *touch = (double)INFINITY;
    return low.value > 0.0;
}

/* Of bodies that are apart and approach when they touch, if they do. */
static struct encounter first_touch_at(double after)
{
    return (struct encounter){after, isfinite(after) ? REGIME_PRESSING : REGIME_APART, 0.0, false};
}

/* Where formulas tell; false where they do not. */
static bool head_on_change(const struct contact_shape *shape, const struct contact_law *law,
                           const struct separation *separation, const struct contact_geometry *now,
                           enum contact_regime present, double resolution, double by_positions,
                           double horizon, struct encounter *next)
{
    if (!head_on_is(shape, separation, now->normal)) {
        return false;
    }
    if (present == REGIME_APART) {
        double touch;
        if (!head_on_touch(shape, separation, now, resolution, horizon, &touch)) {
            return false;
        }
        *next = first_touch_at(touch);
        return true;
    }
    struct head_on_end end;
    const double noise = settling_margin_noise(law, now, resolution, by_positions, separation);
    if (!head_on_release(shape, law, separation, now, resolution, noise, &end)) {
        return false;
    }
    *next = end.after <= horizon ? (struct encounter){end.after, end.regime, end.gap, false}
                                 : (struct encounter){(double)INFINITY, present, 0.0, false};
    return true;
}

/* From where the centres meet the bodies go the way they move, not first through what rounding has left of c. */
static void leave_centre_flying(const struct contact_shape *shape, struct separation *separation,
                                struct contact_geometry *now)
{
    now->normal = contact_way_out(shape, separation->w[0], now->normal);
    now->gap_rate = shape->side * vec3_dot(now->normal, separation->w[0]);
    now->degenerate = true;
    if (shape->side > 0) {
        const double least = 2.0 * DBL_EPSILON * contact_reach(shape);
        const struct vec3 along_axis = vec3_sub(separation->c[0], separation->offset);
        separation->c[0] = vec3_axpy(along_axis, least, now->normal);
        separation->offset = vec3_scale(least, now->normal);
    }
}

/* |w| within the horizon, at most. */
static double speed_at_most(const struct separation *separation, double horizon)
{
    double speed = vec3_norm(separation->w[SEPARATION_DEGREE - 1]);
    for (int i = SEPARATION_DEGREE - 2; i >= 0; --i) {
        speed = speed * horizon + vec3_norm(separation->w[i]);
    }
    return speed;
}

/* Where neither body is free. */
static struct encounter given_encounter(const struct approach *path, const struct contact_shape *shape,
                                        const struct contact_law *law, const struct given_rounding *rounding,
                                        enum contact_regime present)
{
    double cuts[MAX_CUTS];
    const struct extremes extremes = extremes_of(path);
    const int count = cuts_of_all(path, &extremes, shape, law, cuts);
    const struct given_change change = given_first_change(path, law, rounding, cuts, count, present);
    const bool touches = present == REGIME_APART && fabs(change.gap) <= rounding->gap;
    return (struct encounter){change.s * path->horizon, change.regime, touches ? 0.0 : change.gap,
                              passes_centre(path, &extremes, change.s)};
}

struct encounter encounter_next(const struct scene_values *v, const struct motion *q,
                                const struct system_instant *at, double clock, int contact, double horizon)
{
    const struct contact_shape shape = system_shape(v, q, contact);
    const struct contact_law law = system_law(v, q, contact);
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    const bool has_ends = approach_has_ends(&shape);
    const bool ends_only =
        present != REGIME_APART && present != REGIME_RELEASED && !contact_is_held(v, contact);
    if ((ends_only && !has_ends) || contact_is_coupled(v, q, contact)) {
        return (struct encounter){(double)INFINITY, present, 0.0, true};
    }
    struct separation separation = separation_of(v, q, at, clock, contact);
    struct contact_geometry now = at->geometry[contact];
    if (centre_is_met(v, at, contact, &shape)) {
        leave_centre_flying(&shape, &separation, &now);
    }
    const double by_positions = resolution_of_gap(v, at, contact);
    const double resolution = system_gap_is_known(q, at, contact)
                                  ? 8.0 * DBL_EPSILON * fabs(at->geometry[contact].gap)
                                  : by_positions;
    struct encounter next;
    if (!has_ends && (present == REGIME_APART || present == REGIME_RELEASED) &&
        !(q->contact[contact].settled_clock > clock) &&
        head_on_change(&shape, &law, &separation, &now, present, resolution, by_positions, horizon, &next)) {
        return next;
    }
    const bool simple = present == REGIME_APART && !has_ends;
    const struct approach path = approach_make(&shape, &separation, at->geometry[contact].gap, horizon);
    if (simple && keeps_away(&path)) {
        return first_touch_at((double)INFINITY);
    }
    const double axially = has_ends ? resolution_of_axial(v, at, contact, &shape) : 0.0;
    if (contact_is_held(v, contact)) {
        const struct given_rounding rounding = {by_positions, axially, speed_at_most(&separation, horizon)};
        return given_encounter(&path, &shape, &law, &rounding, present);
    }
    const double found = (q->contact[contact].settled_clock - clock) / horizon;
    /* Bodies that approach touch at once, and not when rounding has been left behind: they would be pressed in by that. */
    const bool approach = present == REGIME_APART && now.gap_rate < -resolution_of_rate(at, contact);
    const double unclear = approach ? 0.0 : resolution;
    const double settle = fmax(found, settling_time(&path, &shape, &law, &now, unclear, by_positions, axially,
                                                    &separation, present, clock == 0.0));
    double cuts[MAX_CUTS];
    if (ends_only) {
        return first_change(&path, cuts, cuts_of_ends(&path, cuts, 0), &law, present, true, settle);
    }
    const struct extremes extremes = extremes_of(&path);
    double touch;
    if (simple && settle < 1.0 && first_touch(&path, &extremes, settle, &touch)) {
        next = first_touch_at(touch * horizon);
    } else {
        const int count = cuts_of_all(&path, &extremes, &shape, &law, cuts);
        next = first_change(&path, cuts, count, &law, present, false, settle);
        const double rounding = fmax(by_positions, 8.0 * DBL_EPSILON * path.scale);
        if (present == REGIME_APART && fabs(next.gap) <= rounding) {
            next.gap = 0.0; /* they touch there; otherwise one has come in by an end */
        }
    }
    next.passes_centre = passes_centre(&path, &extremes, next.after / horizon);
    return next;
}

double encounter_least_gap(const struct scene_values *v, const struct motion *q,
                           const struct system_instant *at, double clock, int contact, double until)
{
    const struct contact_shape shape = system_shape(v, q, contact);
    const struct separation separation = separation_of(v, q, at, clock, contact);
    const struct approach path = approach_make(&shape, &separation, at->geometry[contact].gap, until - clock);
    return cuts_least_gap(&path);
}

#endif
