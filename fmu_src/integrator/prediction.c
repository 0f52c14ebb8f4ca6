#include <float.h>
#include <math.h>

#include "flight/conservative_advancement.h"
#include "flight/flight.h"
#include "flight/relative_path.h"
#include "flight/zone_path.h"
#include "integrator/prediction.h"
#include "math/polynomial.h"
#include "scene/evaluate.h"

/* Returns the time [s] in which a quantity with the rate `speed` and half the second derivative `bend` leaves
 * the rounding `noise` around zero; 0 where the quantity is outside. Until then its sign means nothing. */
static double leaving_time(double value, double noise, double speed, double bend)
{
    if (fabs(value) > noise) {
        return 0.0;
    }
    const double soonest = fmin(noise / fabs(speed), sqrt(noise / fabs(bend)));
    return isfinite(soonest) ? soonest : 0.0;
}

/* Returns the time derivative of the event function of a separating contact in flight. The gap g changes by
 * c'. The gap rate g' = side n.w changes by w' and by the turning of the normal n. The rate of turning is the
 * part of c' perpendicular to n, divided by the distance d. */
static double margin_slope(const struct contact_shape *shape, const struct contact_law *law,
                           const struct contact_geometry *now, const struct separation_path *separation)
{
    const double turning =
        contact_turns(shape, now)
            ? contact_turning_rate(shape, now, separation->w[0], separation->c[1]) / now->distance
            : 0.0;
    const double bend = shape->side * (vec3_dot(now->normal, separation->w[1]) + turning);
    const double opening = shape->side * vec3_dot(now->normal, separation->c[1]);
    const struct contact_slopes slopes =
        contact_event_slopes(law, REGIME_SEPARATING, now->gap, now->gap_rate);
    return slopes.by_gap * opening + slopes.by_rate * bend;
}

/* Returns the error that rounding of the gap, of n and of n.w makes in the event function of a separating
 * contact. */
static double dead_band_rounding(const struct contact_shape *shape, const struct contact_law *law,
                                 const struct contact_geometry *now, double gap_rounding, double by_positions,
                                 const struct separation_path *separation)
{
    const double turn = 8.0 * DBL_EPSILON + (contact_turns(shape, now) ? by_positions / now->distance : 0.0);
    const struct contact_slopes slopes =
        contact_event_slopes(law, REGIME_SEPARATING, now->gap, now->gap_rate);
    return slopes.by_gap * gap_rounding + fmin(turn, 1.0) * slopes.by_rate * vec3_norm(separation->w[0]);
}

/* The ends of the dead bands as parameters s of the path. A regime whose boundary has just been crossed lasts
 * until then, whatever rounding shows: contact until `gap`, a law's regime until `law`, which is not less. */
struct dead_band {
    double gap, law;
};

/* Returns the dead bands. `gap_rounding` bounds the rounding of the gap,
 * `by_positions` that of a gap computed from positions. If `just_begun`, the integrator has left a small
 * force. */
static struct dead_band dead_band_of(const struct relative_path *path, const struct contact_shape *shape,
                                     const struct contact_law *law, const struct contact_geometry *now,
                                     double gap_rounding, double by_positions,
                                     const struct separation_path *separation, enum contact_regime present,
                                     bool just_begun)
{
    const double closing = vec3_dot(now->normal, separation->c[1]);
    const double settle = leaving_time(now->gap, gap_rounding, closing, vec3_norm(separation->c[2]));
    struct dead_band band = {settle / path->horizon, settle / path->horizon};
    if (present == REGIME_SEPARATING) {
        const double margin = contact_event(law, present, now->gap, now->gap_rate);
        const double slope = margin_slope(shape, law, now, separation);
        double noise = dead_band_rounding(shape, law, now, gap_rounding, by_positions, separation);
        if (just_begun && margin < 0.0 && slope > 0.0) {
            /* the force, now zero, that the integrator left at the event */
            noise = fmax(noise, -2.0 * margin);
        }
        band.law = fmax(band.law, leaving_time(margin, noise, slope, 0.0) / path->horizon);
    }
    return band;
}

/* While rounding may put the source on either side of a cylinder's end plane, the path has the source on the
 * side that fits the present regime. `rounding` bounds the rounding of the source's axial position [m]. */
static void dead_band_at_ends(struct relative_path *path, const struct contact_shape *shape,
                              const struct contact_geometry *now, double rounding,
                              const struct separation_path *separation, enum contact_regime present)
{
    const double beyond = fabs(now->axial) - shape->half_length;
    const double along = vec3_dot(separation->c[1], shape->axis);
    path->ends_dead_band =
        leaving_time(beyond, rounding, along, vec3_dot(separation->c[2], shape->axis)) / path->horizon;
    path->starts_within = present != REGIME_APART || (beyond <= 0.0 && !(now->gap < 0.0));
}

static enum contact_regime regime_at(const struct relative_path *path, const struct contact_law *law,
                                     double s)
{
    double gap;
    double slope;
    relative_path_gap(path, s, &gap, &slope);
    const double distance = relative_path_divisor(path, gap);
    const double rate = distance > 0.0 ? path->side * polynomial_at(&path->half_rate, s) / distance : 0.0;
    return contact_regime_of(law, path->scale * gap, rate * path->scale / path->horizon,
                             relative_path_within(path, s));
}

/* Returns the change to the regime `next` at the parameter s of the path. */
static struct regime_change change_at(const struct relative_path *path, double s, enum contact_regime next)
{
    double gap;
    double slope;
    relative_path_gap(path, s, &gap, &slope);
    return (struct regime_change){s * path->horizon, next, path->scale * gap, false};
}

/* Returns the first of `count` sorted events in [0, 1], after the dead band, after which the regime differs
 * from the present regime. If `ends_only`, only the passage of a cylinder's end changes the regime. The
 * passage of a centre is not checked. */
static struct regime_change path_first_change(const struct relative_path *path, const double *events,
                                              int count, const struct contact_law *law,
                                              enum contact_regime present, bool ends_only,
                                              struct dead_band band)
{
    double from = band.gap;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? events[i] : 1.0;
        if (to > from) {
            const double middle = 0.5 * (from + to);
            const enum contact_regime next = !ends_only ? regime_at(path, law, middle)
                                             : relative_path_within(path, middle) ? present
                                                                                  : REGIME_APART;
            const double since = next == REGIME_APART ? from : fmax(from, band.law);
            if (next != present && since < to) {
                return change_at(path, since, next);
            }
            from = to;
        }
    }
    return (struct regime_change){(double)INFINITY, present, 0.0, false};
}

/* Below this distance, in units of the path's scale, the direction of the normal is rounding. */
static const double NO_DISTANCE = 1e-9;

static bool is_at_centre(const struct relative_path *path, double s)
{
    double gap;
    double slope;
    relative_path_gap(path, s, &gap, &slope);
    return path->side * gap + path->reach <= NO_DISTANCE;
}

/* Whether the distance falls to zero, within rounding, before the parameter `until` of the path. A source
 * that does not move, for example on the axis, passes no centre; its normal keeps its direction. */
static bool path_passes_centre(const struct relative_path *path, const struct extremes *extremes,
                               double until)
{
    if (path->degree == 0 || relative_path_is_flat(path)) {
        return false;
    }
    bool passes = is_at_centre(path, 0.0) || is_at_centre(path, fmin(until, 1.0));
    for (int i = 0; i < extremes->count && extremes->at[i] < until; ++i) {
        passes = passes || is_at_centre(path, extremes->at[i]);
    }
    return passes;
}

/* Whether the path is too short for the bodies to touch or for their centres to meet. */
static bool path_keeps_away(const struct relative_path *path)
{
    const double start = relative_path_is_flat(path) ? path->c[0].x : vec3_norm(path->c[0]);
    double length = 0.0;
    for (int i = 1; i <= path->degree; ++i) {
        length += vec3_norm(path->c[i]);
    }
    if (path->side > 0) {
        return start - length > path->reach + NO_DISTANCE;
    }
    return start + length < path->reach - NO_DISTANCE && start - length > NO_DISTANCE;
}

/*
 * The functions that follow find the first change of regime of a prescribed contact. Neither body is free, so
 * the path does not depend on the regime.
 *
 * A condition that is zero at an event is computed again after the event, from a path with a new origin;
 * rounding may then give it either sign. A change counts only where its condition exceeds its rounding, and
 * it takes place where the condition is zero. So rounding at one event cannot cause another event.
 */

/* Rounding at the start of the path, and the relative speed of the bodies. */
struct prescribed_rounding {
    double gap;   /* rounding of the gap [m] */
    double axial; /* rounding of the place along a cylinder's axis [m] */
    double speed; /* bound of |w| over the whole path [m/s] */
};

/* Rounding of a sum of products of vectors, divided by the size of its terms, as in rounding_of_gap. */
static const double ROUNDINGS = 8.0 * DBL_EPSILON;

/* Gap, gap rate and axial distance at one place of the path, and bounds of their rounding. */
struct prescribed_instant {
    double gap, rate, beyond;                   /* [m], [m/s], distance beyond a cylinder's end [m] */
    double gap_noise, rate_noise, beyond_noise; /* rounding bounds [m], [m/s], [m] */
    enum contact_regime regime;
};

/* Returns the sum of the absolute terms of a polynomial at s >= 0; its rounding goes with this sum. */
static double size_of(const struct polynomial *p, double s)
{
    double size = fabs(p->a[p->degree]);
    for (int i = p->degree - 1; i >= 0; --i) {
        size = size * s + fabs(p->a[i]);
    }
    return size;
}

static double size_of_path(const struct relative_path *path, double s)
{
    double size = vec3_norm(path->c[path->degree]);
    for (int i = path->degree - 1; i >= 0; --i) {
        size = size * s + vec3_norm(path->c[i]);
    }
    return size;
}

static struct prescribed_instant prescribed_at(const struct relative_path *path,
                                               const struct contact_law *law,
                                               const struct prescribed_rounding *rounding, double s)
{
    double gap;
    double slope;
    relative_path_gap(path, s, &gap, &slope);
    const double speed_unit = path->scale / path->horizon;
    const double distance = relative_path_divisor(path, gap);
    const double along = polynomial_at(&path->half_rate, s);
    struct prescribed_instant at = {.gap = path->scale * gap, .beyond = -1.0};
    at.gap_noise = fmax(rounding->gap, ROUNDINGS * path->scale * (size_of_path(path, s) + path->reach));
    if (distance > 0.0) {
        at.rate = path->side * along / distance * speed_unit;
        /* The rounding of c.w / d comes from the sum c.w and from an error of c as large as the gap's. */
        const double sum = ROUNDINGS * size_of(&path->half_rate, s) / distance * speed_unit;
        at.rate_noise = sum + at.gap_noise * rounding->speed / (path->scale * distance);
    }
    if (SCENE_ANY_CYLINDER && path->has_ends) {
        at.beyond = path->scale * (fabs(polynomial_at(&path->axial, s)) - path->half_length);
        at.beyond_noise =
            fmax(rounding->axial, ROUNDINGS * path->scale * (size_of(&path->axial, s) + path->half_length));
    }
    at.regime = contact_regime_of(law, at.gap, at.rate, relative_path_within(path, s));
    return at;
}

/* Whether the regime has changed and its condition exceeds its rounding. */
static bool has_changed(const struct prescribed_instant *at, const struct contact_law *law,
                        enum contact_regime present)
{
    if (at->regime == present) {
        return false;
    }
    if (present == REGIME_APART) {
        return at->gap < -at->gap_noise && !(fabs(at->beyond) <= at->beyond_noise);
    }
    if (at->regime == REGIME_APART) {
        return at->gap > at->gap_noise || at->beyond > at->beyond_noise;
    }
    const struct contact_slopes slopes = contact_event_slopes(law, present, at->gap, at->rate);
    return fabs(contact_event(law, present, at->gap, at->rate)) >
           fabs(slopes.by_gap) * at->gap_noise + fabs(slopes.by_rate) * at->rate_noise;
}

/* Candidates for events of the law are roots of squared polynomials, which lose digits where the path is
 * long. So the change is located by bisection of the regime itself, between an instant before and one after
 * it. */
static double halve_to_change(const struct relative_path *path, const struct contact_law *law,
                              const struct prescribed_rounding *rounding, double before, double after,
                              enum contact_regime next)
{
    for (;;) {
        const double middle = 0.5 * (before + after);
        if (!(middle > before && middle < after)) {
            return after;
        }
        *(prescribed_at(path, law, rounding, middle).regime == next ? &after : &before) = middle;
    }
}

/* Returns the first change of regime. `events` are `count` sorted places of the path, which include every
 * place at which the regime may change. */
static struct regime_change prescribed_first_change(const struct relative_path *path,
                                                    const struct contact_law *law,
                                                    const struct prescribed_rounding *rounding,
                                                    const double *events, int count,
                                                    enum contact_regime present)
{
    double from = 0.0;
    double before = -1.0;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? events[i] : 1.0;
        if (!(to > from)) {
            continue;
        }
        const double middle = 0.5 * (from + to);
        const struct prescribed_instant at = prescribed_at(path, law, rounding, middle);
        if (has_changed(&at, law, present)) {
            const bool by_law = present != REGIME_APART && at.regime != REGIME_APART;
            if (by_law && before >= 0.0) {
                from = halve_to_change(path, law, rounding, before, middle, at.regime);
            }
            return change_at(path, from, at.regime);
        }
        before = middle;
        from = to;
    }
    return (struct regime_change){(double)INFINITY, present, 0.0, false};
}

/* Finds the first touch of bodies that are apart at `settle`; compression begins there. INFINITY: no touch.
 * Returns false where the bodies are not apart at `settle`, or do not approach at the touch. */
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

/* Returns the change of bodies that are apart: compression begins at their first touch, if they touch. */
static struct regime_change first_touch_at(double after)
{
    return (struct regime_change){after, isfinite(after) ? REGIME_COMPRESSION : REGIME_APART, 0.0, false};
}

/* Finds the change in head-on flight as the root of a quadratic equation. Returns false where that
 * fails. */
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
    const double noise = dead_band_rounding(shape, law, now, gap_rounding, by_positions, separation);
    if (!flight_head_on_regime_end(shape, law, separation, now, gap_rounding, noise, &end)) {
        return false;
    }
    *next = end.after <= horizon ? (struct regime_change){end.after, end.regime, end.gap, false}
                                 : (struct regime_change){(double)INFINITY, present, 0.0, false};
    return true;
}

/* Where the distance d is zero the separation vector is only rounding. The vector is set along the escape
 * direction, which is that of the motion. */
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

/* Returns a bound of the relative speed |w| within the horizon [m/s]. */
static double speed_at_most(const struct separation_path *separation, double horizon)
{
    double speed = vec3_norm(separation->w[SEPARATION_DEGREE - 1]);
    for (int i = SEPARATION_DEGREE - 2; i >= 0; --i) {
        speed = speed * horizon + vec3_norm(separation->w[i]);
    }
    return speed;
}

/* Returns the first change of a contact of which neither body is free. */
static struct regime_change prescribed_regime_change(const struct relative_path *path,
                                                     const struct contact_shape *shape,
                                                     const struct contact_law *law,
                                                     const struct prescribed_rounding *rounding,
                                                     enum contact_regime present)
{
    double events[MAX_CANDIDATES];
    const struct extremes extremes = extremes_of(path);
    const int count = candidates_of_all(path, &extremes, shape, law, events);
    struct regime_change next = prescribed_first_change(path, law, rounding, events, count, present);
    next.gap = present == REGIME_APART && fabs(next.gap) <= rounding->gap ? 0.0 : next.gap;
    next.passes_centre = path_passes_centre(path, &extremes, next.after / path->horizon);
    return next;
}

/* Returns the first change in flight after the dead band. The change is the first touch, or the first
 * candidate after which the regime differs from the present one. */
static struct regime_change flight_regime_change(const struct relative_path *path,
                                                 const struct contact_shape *shape,
                                                 const struct contact_law *law, enum contact_regime present,
                                                 struct dead_band band, double by_positions)
{
    const struct extremes extremes = extremes_of(path);
    struct regime_change next;
    double touch;
    if (present == REGIME_APART && !relative_path_has_ends(shape) && band.law < 1.0 &&
        first_touch(path, &extremes, band.law, &touch)) {
        next = first_touch_at(touch * path->horizon);
    } else {
        double events[MAX_CANDIDATES];
        const int count = candidates_of_all(path, &extremes, shape, law, events);
        next = path_first_change(path, events, count, law, present, false, band);
        const double rounding = fmax(by_positions, 8.0 * DBL_EPSILON * path->scale);
        if (present == REGIME_APART && fabs(next.gap) <= rounding) {
            next.gap = 0.0; /* the bodies touch; elsewhere the source enters by an end */
        }
    }
    next.passes_centre = path_passes_centre(path, &extremes, next.after / path->horizon);
    return next;
}

/* Returns the first change of a contact with a smooth shape or, within one zone, with a capped cylinder. */
static struct regime_change smooth_regime_change(const struct scene_values *v, const struct scene_state *q,
                                                 const struct scene_instant *at, double clock, int contact,
                                                 double horizon)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_law law = scene_contact_law(v, q, contact);
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    const bool has_ends = relative_path_has_ends(&shape);
    const bool ends_only =
        present != REGIME_APART && present != REGIME_SEPARATING && !contact_is_prescribed(v, contact);
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
        !(q->contact[contact].schedule.dead_band_clock > clock) &&
        head_on_change(&shape, &law, &separation, &now, present, gap_rounding, by_positions, horizon,
                       &next)) {
        return next;
    }
    struct relative_path path = relative_path_make(&shape, &separation, at->geometry[contact].gap, horizon);
    if (present == REGIME_APART && !has_ends && path_keeps_away(&path)) {
        return first_touch_at((double)INFINITY);
    }
    const double axially = has_ends ? rounding_of_axial(v, at, contact, &shape) : 0.0;
    if (contact_is_prescribed(v, contact)) {
        const struct prescribed_rounding rounding = {by_positions, axially,
                                                     speed_at_most(&separation, horizon)};
        return prescribed_regime_change(&path, &shape, &law, &rounding, present);
    }
    const double found = (q->contact[contact].schedule.dead_band_clock - clock) / horizon;
    /* Bodies that approach touch where g = 0; a wait until the gap exceeds rounding would add penetration. */
    const bool approaches = present == REGIME_APART && now.gap_rate < -rounding_of_rate(at, contact);
    const double unclear = approaches ? 0.0 : gap_rounding;
    struct dead_band band =
        dead_band_of(&path, &shape, &law, &now, unclear, by_positions, &separation, present, clock == 0.0);
    band = (struct dead_band){fmax(found, band.gap), fmax(found, band.law)};
    if (has_ends) {
        dead_band_at_ends(&path, &shape, &now, axially, &separation, present);
    }
    if (ends_only) {
        double events[MAX_CANDIDATES];
        return path_first_change(&path, events, candidates_of_ends(&path, events, 0), &law, present, true,
                                 band);
    }
    return flight_regime_change(&path, &shape, &law, present, band, by_positions);
}

void regime_change_note_depth(const struct scene_values *v, struct scene_state *q,
                              const struct scene_instant *at, int contact, double until)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct separation_path separation = separation_path_of(v, q, at, q->clock, contact);
    if (contact_advances(v, contact)) {
        return; /* the path of the gap is no polynomial */
    }
    if (SCENE_ANY_CAPS && contact_is_rim(&shape)) {
        contact_peaks_note(&q->contact[contact].peaks, 0.0,
                           -rim_least_gap(&shape, &separation, 0.0, until - q->clock));
        return;
    }
    if (contact_is_capped(&shape) && shape.solid.zone == 0) {
        return; /* such a contact is apart */
    }
    const struct relative_path path =
        relative_path_make(&shape, &separation, at->geometry[contact].gap, until - q->clock);
    contact_peaks_note(&q->contact[contact].peaks, 0.0, -candidates_least_gap(&path));
}

/* The law of a lasting contact is checked at LEAST_LAW_INSTANTS instants, and at LAW_INSTANTS_PER_RADIAN more
 * per radian that the axis turns, but at MOST_LAW_INSTANTS at most. So few instants suffice, because the
 * conditions of its changes are smooth functions of the motion. */
static const double LAW_INSTANTS_PER_RADIAN = 16.0;
static const double LEAST_LAW_INSTANTS = 64.0;
static const double MOST_LAW_INSTANTS = 1e6;

/* The last instant is right before the bodies part, where a dashpot may have been clipped shortly before. */
static const double JUST_BEFORE = 1.0 - 1e-9;

/* Whether another contact transmits a force to a body of this contact that moves freely. */
static bool is_loaded(const struct scene_values *v, const struct scene_state *q, int contact)
{
    for (int i = 0; SCENE_CONTACTS > 1 && i < 2; ++i) {
        const int body = i == 0 ? contact_source(contact) : contact_destination(contact);
        const bool moves = body_is_free(v, body) || body_turns_freely(v, body);
        if (moves && body_is_loaded(q, body, contact)) {
            return true;
        }
    }
    return false;
}

static struct advancement_path advancement_path_of(const struct scene_values *v, const struct scene_state *q,
                                                   const struct scene_instant *at, int contact)
{
    const struct separation_path separation = separation_path_of(v, q, at, q->clock, contact);
    const int destination = contact_destination(contact);
    struct advancement_path path = {.shape = scene_contact_shape_at(v, q, at, contact),
                                    .rounding = rounding_of_gap(v, at, contact)};
    for (int i = 0; i < ADVANCEMENT_TERMS; ++i) {
        path.c[i] = separation.c[i];
    }
    for (int i = 0; SCENE_ANY_PRESCRIBED && i < SEPARATION_DEGREE; ++i) {
        path.mismatch[i] = vec3_axpy(separation.w[i], -(i + 1), separation.c[i + 1]);
    }
    relative_path_put_levers(v, q, at, q->clock, contact, &path);
    path.axis = contact_tips(v, contact)
                    ? flight_axis_motion(v, q, &at->turning.body[destination], destination)
                    : axis_motion_fixed(path.shape.axis);
    return path;
}

/* Returns g' for the law [m/s]. */
static double law_rate_at(const struct advancement_path *path, const struct advancement_instant *at,
                          double time)
{
    const struct vec3 mismatch = path_at(path->mismatch, SEPARATION_DEGREE, time);
    return at->geometry.gap_rate + path->shape.side * vec3_dot(at->geometry.normal, mismatch);
}

static enum contact_regime regime_at_time(const struct advancement_path *path, const struct contact_law *law,
                                          double time)
{
    struct advancement_instant at;
    advancement_at(path, ADVANCEMENT_TOUCH, time, &at);
    return contact_regime_of(law, at.geometry.gap, law_rate_at(path, &at, time),
                             contact_within_extents(&path->shape, at.geometry.axial));
}

/* Returns the regime of bodies that touch from now on. Where the source passes an end plane, rounding decides
 * on which side of the plane it is. */
static enum contact_regime regime_of_touch(const struct advancement_path *path, const struct contact_law *law,
                                           double time)
{
    struct advancement_instant at;
    advancement_at(path, ADVANCEMENT_TOUCH, time, &at);
    return contact_regime_of(law, fmin(at.geometry.gap, -DBL_MIN), law_rate_at(path, &at, time), true);
}

static double halve_to_regime(const struct advancement_path *path, const struct contact_law *law,
                              enum contact_regime present, double before, double after)
{
    for (;;) {
        const double middle = 0.5 * (before + after);
        if (!(middle > before && middle < after)) {
            return after;
        }
        *(regime_at_time(path, law, middle) == present ? &before : &after) = middle;
    }
}

/* Looks for a change of regime by the force law before `until` [s], while the bodies go on touching. */
static void look_for_law(const struct advancement_path *from_now, const struct contact_law *law,
                         enum contact_regime present, double until, long budget, struct prediction *found)
{
    struct advancement_path path = *from_now;
    const double turning = advancement_turning(&path, 0.0, until);
    const double wanted = LEAST_LAW_INSTANTS + LAW_INSTANTS_PER_RADIAN * turning * until;
    const long count = (long)fmin(wanted, fmin(MOST_LAW_INSTANTS, fmax(LEAST_LAW_INSTANTS, (double)budget)));
    double before = 0.0;
    for (long i = 1; i <= count; ++i) {
        const double time = until * fmin((double)i / (double)count, JUST_BEFORE);
        const enum contact_regime then = regime_at_time(&path, law, time);
        found->evaluations += 1;
        if (then != present && then != REGIME_APART) {
            const double change = halve_to_regime(&path, law, present, before, time);
            struct advancement_instant at;
            advancement_at(&path, ADVANCEMENT_TOUCH, change, &at);
            found->next = (struct regime_change){change, then, at.geometry.gap, true};
            return;
        }
        before = time;
        advancement_move_on(&path, time);
    }
}

static struct prediction advancement_prediction(const struct scene_values *v, const struct scene_state *q,
                                                const struct scene_instant *at, int contact, double horizon,
                                                long budget)
{
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct advancement_path path = advancement_path_of(v, q, at, contact);
    const bool apart = present == REGIME_APART;
    const struct advancement_result change =
        advancement_first(&path, apart ? ADVANCEMENT_TOUCH : ADVANCEMENT_PARTING, horizon, budget);
    /* While the bodies are apart, n acts on nothing. */
    const struct regime_change next = {change.after, present, change.gap, .passes_centre = !apart};
    struct prediction found = {next, change.searched, change.evaluations};
    if (change.after < (double)INFINITY) {
        found.searched = horizon;
        found.next.regime = !apart              ? REGIME_APART
                            : change.gap == 0.0 ? REGIME_COMPRESSION
                                                : regime_of_touch(&path, &law, change.after);
    }
    if (!apart && contact_has_events(&law)) {
        look_for_law(&path, &law, present, fmin(change.after, change.searched), budget, &found);
    }
    return found;
}

/* So many evaluations of the gap take some milliseconds; a dozen are usual. */
enum { RIM_EVALUATIONS = 10000 };

static struct regime_change capped_regime_change(const struct scene_values *v, const struct scene_state *q,
                                                 const struct scene_instant *at, double clock, int contact,
                                                 double horizon)
{
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    const struct regime_change none = {(double)INFINITY, present, 0.0, true};
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    if (contact_is_coupled(v, q, contact) ||
        (contact_transmits(q, contact) && !contact_is_prescribed(v, contact))) {
        return none;
    }
    if (present == REGIME_APART) {
        return first_touch_at(zone_change_touch(v, q, at, clock, contact, horizon));
    }
    const struct separation_path path = separation_path_of(v, q, at, clock, contact);
    const double end = zone_path_end(&shape.solid, &path, horizon);
    const double until = fmin(end, horizon);
    struct regime_change next = none;
    if (until > 0.0 && contact_is_rim(&shape)) {
        next = advancement_prediction(v, q, at, contact, until, RIM_EVALUATIONS).next;
        /* DBL_MAX says that the gap is the one that the positions give */
        next.gap = next.regime == REGIME_APART ? 0.0 : DBL_MAX;
        next.passes_centre = false;
    } else if (until > 0.0) {
        next = smooth_regime_change(v, q, at, clock, contact, until);
    }
    if (!(next.after < end) && end < (double)INFINITY) {
        /* the gap is again the one that the positions give */
        return (struct regime_change){end, present, DBL_MAX, next.passes_centre};
    }
    return next;
}

struct regime_change next_regime_change(const struct scene_values *v, const struct scene_state *q,
                                        const struct scene_instant *at, double clock, int contact,
                                        double horizon)
{
    if (SCENE_ANY_CAPS) {
        const struct contact_shape shape = scene_contact_shape(v, q, contact);
        if (contact_is_capped(&shape)) {
            return capped_regime_change(v, q, at, clock, contact, horizon);
        }
    }
    return smooth_regime_change(v, q, at, clock, contact, horizon);
}

struct prediction prediction_of(const struct scene_values *v, const struct scene_state *q,
                                const struct scene_instant *at, int contact, double horizon, long budget)
{
    if (scene_turns(v)) {
        const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
        const struct prediction nothing = {{(double)INFINITY, present, 0.0, true}, horizon, 0};
        if (contact_transmits(q, contact) && !contact_is_prescribed(v, contact)) {
            return nothing;
        }
        if (SCENE_ANY_ADVANCEMENT && contact_advances(v, contact)) {
            return is_loaded(v, q, contact) ? nothing
                                            : advancement_prediction(v, q, at, contact, horizon, budget);
        }
    }
    const struct regime_change next = next_regime_change(v, q, at, q->clock, contact, horizon);
    return (struct prediction){next, horizon, 0};
}

/* Where the discriminant is below this part of its terms, the parabola may only touch zero. Its root then has
 * less than half of the digits. */
static const double CLEAR_OF_GRAZING = 1e-8;

/* The bound is earlier than the root by this part of the time, which is far more than rounding. */
static const double CLEARANCE = 1e-3;

/* Returns a time [s] up to which value + rate t + bend t^2 is certainly positive. `gap_rounding` and
 * `rate_rounding` bound the rounding of `value` and `rate`. The function returns 0 where rounding decides. */
static double above_plane_until(double value, double rate, double bend, double gap_rounding,
                                double rate_rounding)
{
    const double square = rate * rate;
    const double product = 4.0 * bend * value;
    const double discriminant = square - product;
    if (!(fabs(discriminant) > CLEAR_OF_GRAZING * (square + fabs(product))) || !isfinite(discriminant)) {
        return 0.0;
    }
    if (discriminant < 0.0 || (bend >= 0.0 && rate > rate_rounding)) {
        return (double)INFINITY;
    }
    const double root = sqrt(discriminant);
    const double t = rate < 0.0 ? 2.0 * value / (root - rate) : -0.5 * (root + rate) / bend;
    const double rounding = 2.0 * (gap_rounding + t * rate_rounding) / root;
    return fmax(0.0, t * (1.0 - CLEARANCE) - rounding);
}

/* Returns the acceleration of a body in flight without external force [m/s^2]. */
static struct vec3 free_fall(const struct scene_values *v, int body)
{
    return body_is_free(v, body) ? gravity(v) : vec3_make(0.0, 0.0, 0.0);
}

/* Whether apart_for applies: the source is outside its destination, and neither body is prescribed. */
static bool apart_is_known(const struct scene_values *v, const struct scene_state *q, int contact)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    if (body_is_prescribed(v, contact_source(contact)) ||
        body_is_prescribed(v, contact_destination(contact))) {
        return false;
    }
    return shape.side > 0 && !contact_is_torus(&shape) && !body_is_compound(contact_source(contact)) &&
           !body_is_compound(contact_destination(contact));
}

/* Returns the time [s] after the present instant `at` in which bodies that are apart cannot touch. A convex
 * destination lies behind the plane that touches it in the point nearest to the source. So the gap is at
 * least the source's height above that plane, which is a parabola of time. */
static double apart_for(const struct scene_values *v, const struct scene_state *q,
                        const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_geometry *now = &at->geometry[contact];
    const double rounding = rounding_of_gap(v, at, contact);
    /* Beyond a cylinder's open ends the gap may be negative without a touch. */
    const double least = relative_path_has_ends(&shape) ? 0.0 : -rounding;
    if (now->degenerate || !(now->gap > least)) {
        return 0.0;
    }
    const struct vec3 bend =
        vec3_sub(free_fall(v, contact_destination(contact)), free_fall(v, contact_source(contact)));
    return above_plane_until(fmax(now->gap, 0.0), now->gap_rate, 0.5 * vec3_dot(now->normal, bend), rounding,
                             rounding_of_rate(at, contact));
}

double flight_apart_until(const struct scene_values *v, const struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!apart_is_known(v, q, j)) {
            return 0.0;
        }
    }
    struct scene_instant at;
    scene_kinematics_now(v, q, &at);
    double least = (double)INFINITY;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        least = fmin(least, apart_for(v, q, &at, j));
    }
    return q->clock + least;
}
