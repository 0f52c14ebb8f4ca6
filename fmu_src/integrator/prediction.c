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

/* A contact whose next change is foreseen in closed form: its geometry `now`, and its relative motion from
 * now on. */
struct foresight {
    struct contact_shape shape;
    struct contact_law law;
    enum contact_regime present;
    struct contact_geometry now;
    struct separation_path separation;
    struct relative_path path; /* over the horizon [s] */
    double horizon;
    /* bounds of rounding: of the gap, of a gap computed from positions, and of the place along a cylinder's
     * axis [m] */
    double gap_rounding, by_positions, axial_rounding;
};

/* Returns the time derivative of the event function of a separating contact in flight. The gap g changes by
 * c'. The gap rate g' = side n.w changes by w' and by the turning of the normal n. The rate of turning is the
 * part of c' perpendicular to n, divided by the distance d. */
static double margin_slope(const struct foresight *f)
{
    const struct contact_geometry *now = &f->now;
    const double turning =
        contact_turns(&f->shape, now)
            ? contact_turning_rate(&f->shape, now, f->separation.w[0], f->separation.c[1]) / now->distance
            : 0.0;
    const double bend = f->shape.side * (vec3_dot(now->normal, f->separation.w[1]) + turning);
    const double opening = f->shape.side * vec3_dot(now->normal, f->separation.c[1]);
    const struct contact_slopes slopes =
        contact_event_slopes(&f->law, REGIME_SEPARATING, now->gap, now->gap_rate);
    return slopes.by_gap * opening + slopes.by_rate * bend;
}

/* Returns the error that rounding of the gap, of n and of n.w makes in the event function of a separating
 * contact. */
static double dead_band_rounding(const struct foresight *f, double gap_rounding)
{
    const double turn =
        8.0 * DBL_EPSILON + (contact_turns(&f->shape, &f->now) ? f->by_positions / f->now.distance : 0.0);
    const struct contact_slopes slopes =
        contact_event_slopes(&f->law, REGIME_SEPARATING, f->now.gap, f->now.gap_rate);
    return slopes.by_gap * gap_rounding + fmin(turn, 1.0) * slopes.by_rate * vec3_norm(f->separation.w[0]);
}

/* The ends of the dead bands as parameters s of the path. A regime whose boundary has just been crossed lasts
 * until then, whatever rounding shows: contact until `gap`, a law's regime until `law`, which is not less. */
struct dead_band {
    double gap, law;
};

/* Returns the dead bands. `gap_rounding` bounds the rounding of the gap. If `just_begun`, the integrator has
 * left a small force. */
static struct dead_band dead_band_of(const struct foresight *f, double gap_rounding, bool just_begun)
{
    const double closing = vec3_dot(f->now.normal, f->separation.c[1]);
    const double settle = leaving_time(f->now.gap, gap_rounding, closing, vec3_norm(f->separation.c[2]));
    struct dead_band band = {settle / f->horizon, settle / f->horizon};
    if (f->present == REGIME_SEPARATING) {
        const double margin = contact_event(&f->law, f->present, f->now.gap, f->now.gap_rate);
        const double slope = margin_slope(f);
        double noise = dead_band_rounding(f, gap_rounding);
        if (just_begun && margin < 0.0 && slope > 0.0) {
            /* the force, now zero, that the integrator left at the event */
            noise = fmax(noise, -2.0 * margin);
        }
        band.law = fmax(band.law, leaving_time(margin, noise, slope, 0.0) / f->horizon);
    }
    return band;
}

/* While rounding may put the source on either side of a cylinder's end plane, the path has the source on the
 * side that fits the present regime. */
static void dead_band_at_ends(struct foresight *f)
{
    const double beyond = fabs(f->now.axial) - f->shape.half_length;
    const double along = vec3_dot(f->separation.c[1], f->shape.axis);
    const double bend = vec3_dot(f->separation.c[2], f->shape.axis);
    f->path.ends_dead_band = leaving_time(beyond, f->axial_rounding, along, bend) / f->horizon;
    f->path.starts_within = f->present != REGIME_APART || (beyond <= 0.0 && !(f->now.gap < 0.0));
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

/* Returns the change of a contact whose regime does not change within the horizon. */
static struct regime_change no_change(enum contact_regime present, bool passes_centre)
{
    return (struct regime_change){(double)INFINITY, present, 0.0, passes_centre};
}

/* Returns the first of `count` sorted events in [0, 1], after the dead band, after which the regime differs
 * from the present regime. If `ends_only`, only the passage of a cylinder's end changes the regime. The
 * passage of a centre is not checked. */
static struct regime_change path_first_change(const struct foresight *f, const double *events, int count,
                                              bool ends_only, struct dead_band band)
{
    double from = band.gap;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? events[i] : 1.0;
        if (to > from) {
            const double middle = 0.5 * (from + to);
            const enum contact_regime next = !ends_only ? regime_at(&f->path, &f->law, middle)
                                             : relative_path_within(&f->path, middle) ? f->present
                                                                                      : REGIME_APART;
            const double since = next == REGIME_APART ? from : fmax(from, band.law);
            if (next != f->present && since < to) {
                return change_at(&f->path, since, next);
            }
            from = to;
        }
    }
    return no_change(f->present, false);
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
    const double length = path_size(path->c + 1, path->degree, 1.0);
    if (path->side > 0) {
        return start - length > path->reach + NO_DISTANCE;
    }
    return start + length < path->reach - NO_DISTANCE && start - length > NO_DISTANCE;
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

/* Where the distance d is zero the separation vector is only rounding. The vector is set along the escape
 * direction, which is that of the motion. */
static void leave_centre_in_flight(struct foresight *f)
{
    struct contact_geometry *now = &f->now;
    now->normal = singularity_escape(&f->shape, f->separation.w[0], vec3_make(0.0, 0.0, 0.0), now->normal);
    now->gap_rate = f->shape.side * vec3_dot(now->normal, f->separation.w[0]);
    now->degenerate = true;
    if (f->shape.side > 0) {
        const double least = 2.0 * DBL_EPSILON * contact_reach(&f->shape);
        const struct vec3 along_axis = vec3_sub(f->separation.c[0], f->separation.offset);
        f->separation.c[0] = vec3_axpy(along_axis, least, now->normal);
        f->separation.offset = vec3_scale(least, now->normal);
    }
}

/* Returns the first change in flight after the dead band. The change is the first touch, or the first
 * candidate after which the regime differs from the present one. */
static struct regime_change flight_regime_change(const struct foresight *f, struct dead_band band)
{
    const struct extremes extremes = extremes_of(&f->path);
    struct regime_change next;
    double touch;
    if (f->present == REGIME_APART && !relative_path_has_ends(&f->shape) && band.law < 1.0 &&
        first_touch(&f->path, &extremes, band.law, &touch)) {
        next = first_touch_at(touch * f->horizon);
    } else {
        double events[MAX_CANDIDATES];
        const int count = candidates_of_all(&f->path, &extremes, &f->shape, &f->law, events);
        next = path_first_change(f, events, count, false, band);
        const double rounding = fmax(f->by_positions, 8.0 * DBL_EPSILON * f->path.scale);
        if (f->present == REGIME_APART && fabs(next.gap) <= rounding) {
            next.gap = 0.0; /* the bodies touch; elsewhere the source enters by an end */
        }
    }
    next.passes_centre = path_passes_centre(&f->path, &extremes, next.after / f->horizon);
    return next;
}

/* Returns the first change of a contact with a smooth shape or, within one zone, with a capped cylinder. */
static struct regime_change smooth_regime_change(const struct scene_values *v, const struct scene_state *q,
                                                 const struct scene_instant *at, int contact, double horizon)
{
    struct foresight f; /* whose other members are set where they are needed: to clear them all takes time */
    f.shape = scene_contact_shape(v, q, contact);
    f.law = scene_contact_law(v, q, contact);
    f.present = (enum contact_regime)q->contact[contact].regime;
    f.now = at->geometry[contact];
    f.horizon = horizon;
    const bool has_ends = relative_path_has_ends(&f.shape);
    const bool in_flight = f.present == REGIME_APART || f.present == REGIME_SEPARATING;
    if ((!in_flight && !has_ends) || contact_is_coupled(v, q, contact)) {
        return no_change(f.present, true);
    }
    f.separation = separation_path_of(v, q, at, q->clock, contact);
    if (singularity_is_reached(v, at, contact, &f.shape)) {
        leave_centre_in_flight(&f);
    }
    const double gap = at->geometry[contact].gap;
    f.by_positions = rounding_of_gap(v, at, contact);
    f.gap_rounding =
        scene_gap_is_accumulated(q, at, contact) ? 8.0 * DBL_EPSILON * fabs(gap) : f.by_positions;
    double touch;
    const double dead_band_rest = q->contact[contact].schedule.dead_band_clock - q->clock;
    if (!has_ends && f.present == REGIME_APART && !(dead_band_rest > 0.0) &&
        flight_is_head_on(&f.shape, &f.separation, f.now.normal) &&
        flight_head_on_touch(&f.shape, &f.separation, &f.now, f.gap_rounding, horizon, &touch)) {
        return first_touch_at(touch);
    }
    f.path = relative_path_make(&f.shape, &f.separation, gap, horizon);
    if (f.present == REGIME_APART && !has_ends && path_keeps_away(&f.path)) {
        return first_touch_at((double)INFINITY);
    }
    f.axial_rounding = has_ends ? rounding_of_axial(v, at, contact, &f.shape) : 0.0;
    /* Bodies that approach touch where g = 0; a wait until the gap exceeds rounding would add penetration. */
    const bool approaches = f.present == REGIME_APART && f.now.gap_rate < -rounding_of_rate(at, contact);
    struct dead_band band = dead_band_of(&f, approaches ? 0.0 : f.gap_rounding, q->clock == 0.0);
    const double found = dead_band_rest / horizon;
    band = (struct dead_band){fmax(found, band.gap), fmax(found, band.law)};
    if (has_ends) {
        dead_band_at_ends(&f);
    }
    if (!in_flight) {
        double events[MAX_CANDIDATES];
        return path_first_change(&f, events, candidates_of_ends(&f.path, events, 0), true, band);
    }
    return flight_regime_change(&f, band);
}

/* The law of a lasting contact is checked at LEAST_LAW_INSTANTS instants, and at LAW_INSTANTS_PER_RADIAN more
 * per radian that the axis turns, but at MOST_LAW_INSTANTS at most. So few instants suffice, because the
 * conditions of its changes are smooth functions of the motion. */
static const double LAW_INSTANTS_PER_RADIAN = 16.0;
static const double LEAST_LAW_INSTANTS = 64.0;
static const double MOST_LAW_INSTANTS = 1e6;

/* The last instant is right before the bodies part, where a dashpot may have been clipped shortly before. */
static const double JUST_BEFORE = 1.0 - 1e-9;

/* Returns g' for the law [m/s]. */
static double law_rate_at(const struct advancement_path *path, const struct advancement_instant *at,
                          double time)
{
    const struct vec3 mismatch = path_at(path->mismatch, SEPARATION_DEGREE, time);
    return at->geometry.gap_rate + path->shape.side * vec3_dot(at->geometry.normal, mismatch);
}

/* Rounding of a sum of products of vectors, divided by the size of its terms, as in rounding_of_gap. */
static const double ROUNDINGS = 8.0 * DBL_EPSILON;

/* Returns the regime at a time: it is another one than `present` only where the law's event function exceeds its
 * rounding, so that rounding at one event cannot cause another event. */
static enum contact_regime regime_at_time(const struct advancement_path *path, const struct contact_law *law,
                                          enum contact_regime present, double time)
{
    struct advancement_instant at;
    advancement_at(path, ADVANCEMENT_TOUCH, time, &at);
    const double gap = at.geometry.gap;
    const double rate = law_rate_at(path, &at, time);
    const struct contact_slopes slopes = contact_event_slopes(law, present, gap, rate);
    const double gap_noise = at.noise[ADVANCEMENT_GAP];
    const double tilt = contact_turns(&path->shape, &at.geometry) ? gap_noise / at.geometry.distance : 0.0;
    const double rate_noise = vec3_norm(at.c[1]) * (ROUNDINGS + tilt);
    const bool is_clear = fabs(contact_event(law, present, gap, rate)) >
                          fabs(slopes.by_gap) * gap_noise + fabs(slopes.by_rate) * rate_noise;
    return is_clear
               ? contact_regime_of(law, gap, rate, contact_within_extents(&path->shape, at.geometry.axial))
               : present;
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
        *(regime_at_time(path, law, present, middle) == present ? &before : &after) = middle;
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
        const enum contact_regime then = regime_at_time(&path, law, present, time);
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
    const struct advancement_path path = advancement_path_of(v, q, at, q->clock, contact);
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
                                                 const struct scene_instant *at,
                                                 const struct contact_shape *shape, int contact,
                                                 double horizon)
{
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    struct regime_change next = no_change(present, true);
    if (contact_is_coupled(v, q, contact) || contact_pushes(v, q, contact)) {
        return next;
    }
    if (present == REGIME_APART) {
        return first_touch_at(zone_change_touch(v, q, at, q->clock, contact, horizon));
    }
    const struct separation_path path = separation_path_of(v, q, at, q->clock, contact);
    const double end = zone_path_end(&shape->solid, &path, horizon);
    const double until = fmin(end, horizon);
    if (until > 0.0 && (contact_is_rim(shape) || contact_is_prescribed(v, contact))) {
        next = advancement_prediction(v, q, at, contact, until, RIM_EVALUATIONS).next;
        /* DBL_MAX says that the gap is the one that the positions give */
        next.gap = next.regime == REGIME_APART ? 0.0 : DBL_MAX;
        next.passes_centre = false;
    } else if (until > 0.0) {
        next = smooth_regime_change(v, q, at, contact, until);
    }
    if (!(next.after < end) && end < (double)INFINITY) {
        /* the gap is again the one that the positions give */
        return (struct regime_change){end, present, DBL_MAX, next.passes_centre};
    }
    return next;
}

struct prediction prediction_of(const struct scene_values *v, const struct scene_state *q,
                                const struct scene_instant *at, int contact, double horizon, long budget)
{
    if (scene_turns(v)) {
        const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
        const struct prediction nothing = {no_change(present, true), horizon, 0};
        if (contact_pushes(v, q, contact)) {
            return nothing;
        }
        if (SCENE_ANY_ADVANCEMENT && contact_advances(v, contact)) {
            return contact_is_coupled(v, q, contact)
                       ? nothing
                       : advancement_prediction(v, q, at, contact, horizon, budget);
        }
    }
    if (SCENE_ANY_CAPS) {
        const struct contact_shape shape = scene_contact_shape(v, q, contact);
        if (contact_is_capped(&shape)) {
            return (struct prediction){capped_regime_change(v, q, at, &shape, contact, horizon), horizon, 0};
        }
    }
    return contact_is_prescribed(v, contact)
               ? advancement_prediction(v, q, at, contact, horizon, budget)
               : (struct prediction){smooth_regime_change(v, q, at, contact, horizon), horizon, 0};
}
