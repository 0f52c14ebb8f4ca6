#include "segment/regime_change.h"

#include <float.h>

#include "math/root.h"
#include "scene/present.h"
#include "scene/rounding.h"
#include "scene/singularity.h"
#include "segment/driven_change.h"
#include "segment/flight_candidates.h"
#include "segment/flight_head_on.h"
#include "segment/path_change.h"
#include "segment/rim_change.h"
#include "segment/settling.h"
#include "segment/zone_change.h"

/* The first touch of bodies that are apart at `settle`, INFINITY if there is none; compression follows. False
 * where more is to be found out: the bodies are not apart, or do not approach when they touch. */
static bool first_touch(const struct relative_path *path, const struct extremes *extremes, double settle,
                        double *touch)
{
    struct root_bracket_end low = flight_gap_bracket_end(path, settle);
    if (low.value == 0.0 && low.slope > 0.0) {
        low.value = DBL_MIN; /* they have just parted */
    }
    for (int i = 0; i <= extremes->count && low.value > 0.0; ++i) {
        const double s = i < extremes->count ? extremes->at[i] : 1.0;
        if (s > low.s) {
            const struct root_bracket_end high = flight_gap_bracket_end(path, s);
            if (high.value < 0.0) {
                *touch = root_between(relative_path_gap, path, low, high);
                return path->side * polynomial_at(&path->half_rate, *touch) < 0.0;
            }
            low = high;
        }
    }
    *touch = (double)INFINITY;
    return low.value > 0.0;
}

/* The change of bodies that are apart: compression from their first touch on, if there is one. */
static struct regime_change first_touch_at(double after)
{
    return (struct regime_change){after, isfinite(after) ? REGIME_COMPRESSION : REGIME_APART, 0.0, false};
}

/* Head-on flight: the change as the root of a quadratic equation; false where that does not apply. */
static bool head_on_change(const struct contact_shape *shape, const struct contact_law *law,
                           const struct separation_path *separation, const struct contact_geometry *now,
                           enum contact_regime present, double gap_rounding, double by_positions,
                           double horizon, struct regime_change *next)
{
    if (!flight_is_head_on(shape, separation, now->normal)) {
        return false;
    }
    if (present == REGIME_APART) {
        double touch;
        if (!flight_head_on_touch(shape, separation, now, gap_rounding, horizon, &touch)) {
            return false;
        }
        *next = first_touch_at(touch);
        return true;
    }
    struct flight_regime_end end;
    const double noise = settling_margin_rounding(shape, law, now, gap_rounding, by_positions, separation);
    if (!flight_head_on_regime_end(shape, law, separation, now, gap_rounding, noise, &end)) {
        return false;
    }
    *next = end.after <= horizon ? (struct regime_change){end.after, end.regime, end.gap, false}
                                 : (struct regime_change){(double)INFINITY, present, 0.0, false};
    return true;
}

/* At d = 0 the separation is only rounding: it is set along the escape direction, that of the motion. */
static void leave_centre_in_flight(const struct contact_shape *shape, struct separation_path *separation,
                                   struct contact_geometry *now)
{
    now->normal = singularity_escape(shape, separation->w[0], vec3_make(0.0, 0.0, 0.0), now->normal);
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
static double speed_at_most(const struct separation_path *separation, double horizon)
{
    double speed = vec3_norm(separation->w[SEPARATION_DEGREE - 1]);
    for (int i = SEPARATION_DEGREE - 2; i >= 0; --i) {
        speed = speed * horizon + vec3_norm(separation->w[i]);
    }
    return speed;
}

/* Where neither body is free. */
static struct regime_change driven_regime_change(const struct relative_path *path,
                                                 const struct contact_shape *shape,
                                                 const struct contact_law *law,
                                                 const struct driven_rounding *rounding,
                                                 enum contact_regime present)
{
    double events[MAX_CANDIDATES];
    const struct extremes extremes = extremes_of(path);
    const int count = candidates_of_all(path, &extremes, shape, law, events);
    const struct driven_change change = driven_first_change(path, law, rounding, events, count, present);
    const bool touches = present == REGIME_APART && fabs(change.gap) <= rounding->gap;
    return (struct regime_change){change.s * path->horizon, change.regime, touches ? 0.0 : change.gap,
                                  path_passes_centre(path, &extremes, change.s)};
}

/* Of a flight after `settle`: the first touch, or the first candidate after which the regime differs. */
static struct regime_change flight_regime_change(const struct relative_path *path,
                                                 const struct contact_shape *shape,
                                                 const struct contact_law *law, enum contact_regime present,
                                                 double settle, double by_positions)
{
    const struct extremes extremes = extremes_of(path);
    struct regime_change next;
    double touch;
    if (present == REGIME_APART && !path->has_ends && settle < 1.0 &&
        first_touch(path, &extremes, settle, &touch)) {
        next = first_touch_at(touch * path->horizon);
    } else {
        double events[MAX_CANDIDATES];
        const int count = candidates_of_all(path, &extremes, shape, law, events);
        next = path_first_change(path, events, count, law, present, false, settle);
        const double rounding = fmax(by_positions, 8.0 * DBL_EPSILON * path->scale);
        if (present == REGIME_APART && fabs(next.gap) <= rounding) {
            next.gap = 0.0; /* they touch there; otherwise one has come in by an end */
        }
    }
    next.passes_centre = path_passes_centre(path, &extremes, next.after / path->horizon);
    return next;
}

/* With a shape that is smooth, as all are but a capped cylinder. */
static struct regime_change smooth_regime_change(const struct scene_values *v, const struct scene_state *q,
                                                 const struct scene_instant *at, double clock, int contact,
                                                 double horizon)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_law law = scene_contact_law(v, q, contact);
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    const bool has_ends = relative_path_has_ends(&shape);
    const bool ends_only =
        present != REGIME_APART && present != REGIME_SEPARATING && !contact_is_driven(v, contact);
    if ((ends_only && !has_ends) || contact_is_coupled(v, q, contact)) {
        return (struct regime_change){(double)INFINITY, present, 0.0, true};
    }
    struct separation_path separation = separation_path_of(v, q, at, clock, contact);
    struct contact_geometry now = at->geometry[contact];
    if (singularity_is_reached(v, at, contact, &shape)) {
        leave_centre_in_flight(&shape, &separation, &now);
    }
    const double by_positions = rounding_of_gap(v, at, contact);
    const double gap_rounding = scene_gap_is_accumulated(q, at, contact)
                                    ? 8.0 * DBL_EPSILON * fabs(at->geometry[contact].gap)
                                    : by_positions;
    struct regime_change next;
    if (!has_ends && (present == REGIME_APART || present == REGIME_SEPARATING) &&
        !(q->contact[contact].schedule.settled_clock > clock) &&
        head_on_change(&shape, &law, &separation, &now, present, gap_rounding, by_positions, horizon,
                       &next)) {
        return next;
    }
    struct relative_path path = relative_path_make(&shape, &separation, at->geometry[contact].gap, horizon);
    if (present == REGIME_APART && !has_ends && path_keeps_away(&path)) {
        return first_touch_at((double)INFINITY);
    }
    const double axially = has_ends ? rounding_of_axial(v, at, contact, &shape) : 0.0;
    if (contact_is_driven(v, contact)) {
        const struct driven_rounding rounding = {by_positions, axially, speed_at_most(&separation, horizon)};
        return driven_regime_change(&path, &shape, &law, &rounding, present);
    }
    const double found = (q->contact[contact].schedule.settled_clock - clock) / horizon;
    /* Bodies that approach touch where g = 0; waiting for more than rounding would add penetration. */
    const bool approaches = present == REGIME_APART && now.gap_rate < -rounding_of_rate(at, contact);
    const double unclear = approaches ? 0.0 : gap_rounding;
    const double settle = fmax(found, settling_time(&path, &shape, &law, &now, unclear, by_positions,
                                                    &separation, present, clock == 0.0));
    if (has_ends) {
        settling_at_ends(&path, &shape, &now, axially, &separation, present);
    }
    if (ends_only) {
        double events[MAX_CANDIDATES];
        return path_first_change(&path, events, candidates_of_ends(&path, events, 0), &law, present, true,
                                 settle);
    }
    return flight_regime_change(&path, &shape, &law, present, settle, by_positions);
}

#if SCENE_ANY_CAPS
static struct regime_change change_at_rim(const struct scene_values *v, const struct scene_state *q,
                                          const struct scene_instant *at, double clock, int contact,
                                          double horizon)
{
    const struct rim_change change = zone_change_at_rim(v, q, at, clock, contact, horizon);
    const double gap = change.regime == REGIME_APART ? 0.0 : DBL_MAX; /* as positions give it */
    return (struct regime_change){change.time, change.regime, gap, false};
}

static struct regime_change capped_regime_change(const struct scene_values *v, const struct scene_state *q,
                                                 const struct scene_instant *at, double clock, int contact,
                                                 double horizon)
{
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    const struct regime_change none = {(double)INFINITY, present, 0.0, true};
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    if (contact_is_coupled(v, q, contact) ||
        (contact_transmits(q, contact) && !contact_is_driven(v, contact))) {
        return none;
    }
    if (present == REGIME_APART) {
        return first_touch_at(zone_change_touch(v, q, at, clock, contact, horizon));
    }
    const double end = zone_change_after(v, q, at, clock, contact, horizon);
    const double until = fmin(end, horizon);
    struct regime_change next = none;
    if (until > 0.0) {
        next = contact_is_rim(&shape) ? change_at_rim(v, q, at, clock, contact, until)
                                      : smooth_regime_change(v, q, at, clock, contact, until);
    }
    if (!(next.after < end) && end < (double)INFINITY) {
        /* the gap goes on as positions give it */
        return (struct regime_change){end, present, DBL_MAX, next.passes_centre};
    }
    return next;
}
#endif

struct regime_change next_regime_change(const struct scene_values *v, const struct scene_state *q,
                                        const struct scene_instant *at, double clock, int contact,
                                        double horizon)
{
#if SCENE_ANY_CAPS
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    if (contact_is_capped(&shape)) {
        return capped_regime_change(v, q, at, clock, contact, horizon);
    }
#endif
    return smooth_regime_change(v, q, at, clock, contact, horizon);
}

void regime_change_note_depth(const struct scene_values *v, struct scene_state *q,
                              const struct scene_instant *at, int contact, double until)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct separation_path separation = separation_path_of(v, q, at, q->clock, contact);
#if SCENE_ANY_CAPS
    if (contact_is_rim(&shape)) {
        contact_peaks_note(&q->contact[contact].peaks, 0.0,
                           -rim_least_gap(&shape, &separation, 0.0, until - q->clock));
        return;
    }
    if (contact_is_capped(&shape) && shape.solid.zone == 0) {
        return; /* it is apart */
    }
#endif
    const struct relative_path path =
        relative_path_make(&shape, &separation, at->geometry[contact].gap, until - q->clock);
    contact_peaks_note(&q->contact[contact].peaks, 0.0, -candidates_least_gap(&path));
}
