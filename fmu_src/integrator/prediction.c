#include <float.h>
#include <math.h>

#include "flight/conservative_advancement.h"
#include "flight/flight.h"
#include "flight/relative_path.h"
#include "flight/zone_path.h"
#include "integrator/prediction.h"
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

/* Returns the change of a contact whose regime does not change within the horizon. */
static struct regime_change no_change(enum contact_regime present, bool passes_centre)
{
    return (struct regime_change){(double)INFINITY, present, 0.0, passes_centre};
}

/* Returns the change of bodies that are apart: compression begins at their first touch, if they touch. */
static struct regime_change touch_at(double after)
{
    return (struct regime_change){after, isfinite(after) ? REGIME_COMPRESSION : REGIME_APART, 0.0, false};
}

/* Returns the passage of a cylinder's end by a source on which the cylinder's force acts: this force is
 * perpendicular to the axis. While rounding may put the source on either side of an end plane, the source
 * counts as between them. It also does during the first `settle` seconds. */
static struct regime_change passage_of_end(const struct contact_shape *shape,
                                           const struct separation_path *separation, double axial_rounding,
                                           double settle, double horizon, enum contact_regime present)
{
    double ends[2 * POLYNOMIAL_MAX_DEGREE];
    const int count = separation_path_planes(separation, horizon, shape->axis, shape->half_length, ends, 0);
    const double beyond = fabs(vec3_dot(separation->c[0], shape->axis)) - shape->half_length;
    double leaves = fabs(beyond) > axial_rounding ? 0.0 : (double)INFINITY;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) { /* a source that never moves along the axis stays */
        leaves = fmin(leaves, pow(axial_rounding / fabs(vec3_dot(separation->c[i], shape->axis)), 1.0 / i));
    }
    double from = fmax(leaves, settle) / horizon;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? ends[i] : 1.0;
        const struct vec3 c = path_at(separation->c, SEPARATION_DEGREE + 1, 0.5 * (from + to) * horizon);
        if (to > from && fabs(vec3_dot(c, shape->axis)) > shape->half_length) {
            return (struct regime_change){from * horizon, REGIME_APART, DBL_MAX, false};
        }
        from = fmax(from, to);
    }
    return no_change(present, false);
}

/* Below this distance, in units of the path's scale, the direction of the normal is rounding. */
static const double NO_DISTANCE = 1e-9;

static struct root_bracket_end gap_along(const struct relative_path *path, double s)
{
    struct root_bracket_end end = {.s = s};
    relative_path_gap(path, s, &end.value, &end.slope);
    return end;
}

/* Whether the path is too short for the bodies to touch or for their centres to meet. */
static bool path_keeps_away(const struct relative_path *path)
{
    const double start = contact_is_plane(path->shape) ? path->c[0].x : path->start;
    const double length = path_size(path->c + 1, path->degree, 1.0);
    if (path->shape->side > 0) {
        return start - length > path->reach + NO_DISTANCE;
    }
    return start + length < path->reach - NO_DISTANCE && start - length > NO_DISTANCE;
}

/* Returns the place s on the path at which the bodies first touch from the place `settle` on, or INFINITY.
 * Bodies whose gap is not above zero at `settle` touch there, unless the gap rises above zero first. Sets the
 * least distance d before the touch [scale]. */
static double first_touch(const struct relative_path *path, double settle, double *nearest)
{
    double extremes[POLYNOMIAL_MAX_DEGREE];
    const int count = polynomial_add_sign_changes(&path->closing, extremes, 0);
    struct root_bracket_end low = gap_along(path, settle);
    double earliest = settle;
    *nearest = path->start;
    for (int i = 0; i <= count; ++i) {
        const double s = i < count ? extremes[i] : 1.0;
        if (!(s > low.s)) {
            continue;
        }
        const struct root_bracket_end high = gap_along(path, s);
        const double middle = low.value > 0.0 ? 1.0 : gap_along(path, 0.5 * (low.s + s)).value;
        if (middle > 0.0) {
            low.value = fmax(low.value, DBL_MIN);
            if (high.value < 0.0) {
                return root_between(relative_path_gap, path, low, high);
            }
            earliest = s;
        } else if (middle < 0.0 || high.value < 0.0) {
            return earliest;
        }
        low = high;
        *nearest = fmin(*nearest, path->shape->side * high.value + path->reach);
    }
    return (double)INFINITY;
}

/* Rounding of a sum of products of vectors, divided by the size of its terms, as in rounding_of_gap. */
static const double ROUNDINGS = 8.0 * DBL_EPSILON;

/* Returns the rounding of the present gap [m]. It is that of the positions unless the gap is accumulated. */
static double rounding_now(const struct scene_instant *at, int contact)
{
    return scene_gap_is_accumulated(at, contact) ? ROUNDINGS * fabs(at->geometry[contact].gap)
                                                 : rounding_of_gap(at, contact);
}

/* Returns g'' in flight [m/s^2]: n turns with the motion across n. */
static double gap_bend(const struct contact_shape *shape, const struct contact_geometry *now,
                       const struct separation_path *path)
{
    const double turning =
        contact_turns(shape, now) ? contact_turning_rate(shape, now, path->c[1]) / now->distance : 0.0;
    return shape->side * (2.0 * vec3_dot(now->normal, path->c[2]) + turning);
}

/* Returns the change of bodies that are apart, with a destination without ends: compression begins at their
 * first touch. A contact whose gap has just passed zero is within a dead band until the gap exceeds its
 * rounding. */
static struct regime_change touch_in_flight(const struct scene_instant *at, const struct contact_shape *shape,
                                            const struct separation_path *separation, int contact,
                                            double horizon)
{
    const struct contact_geometry *now = &at->geometry[contact];
    const double rounding = rounding_now(at, contact);
    const double dead_band = at->q->contact[contact].schedule.dead_band_clock - at->q->clock;
    const bool has_normal = !singularity_is_reached(at, contact, shape);
    const bool head_on = has_normal && !(dead_band > 0.0);
    double touch;
    if (head_on && flight_is_head_on(shape, separation, now->normal) &&
        flight_head_on_touch(shape, separation, now, rounding, horizon, &touch)) {
        return touch_at(touch);
    }
    /* bodies touch at once if their relative speed is rounding and a load presses them together */
    if (now->gap == 0.0 && gap_bend(shape, now, separation) < 0.0 && !(dead_band > 0.0) &&
        fabs(now->gap_rate) <= rounding_of_rate(at, contact)) {
        return touch_at(0.0);
    }
    const struct relative_path path = relative_path_make(shape, separation, now->gap, horizon);
    if (path_keeps_away(&path)) {
        return touch_at((double)INFINITY);
    }
    /* Bodies that approach touch where g = 0; a wait until the gap exceeds rounding would add penetration. */
    const bool approaches = now->gap_rate < -rounding_of_rate(at, contact);
    const double settle = leaving_time(now->gap, approaches ? 0.0 : rounding,
                                       vec3_dot(now->normal, separation->c[1]), vec3_norm(separation->c[2]));
    double nearest;
    const double s = first_touch(&path, fmin(fmax(dead_band, settle) / horizon, 1.0), &nearest);
    struct regime_change next = touch_at(s * horizon);
    /* a source that does not move, for example on the axis, passes no centre; its normal stays */
    next.passes_centre = path.degree > 0 && !contact_is_plane(shape) && nearest <= NO_DISTANCE;
    return next;
}

/* The law of a lasting contact is checked at LEAST_LAW_INSTANTS instants, and at LAW_INSTANTS_PER_RADIAN more
 * per radian that the axis turns, but at MOST_LAW_INSTANTS at most. So few instants suffice, because the
 * conditions of its changes are smooth functions of the motion. Bodies that separate in flight under constant
 * forces move along parabolas. They need LAW_INSTANTS_PER_RADIAN instants less for each radian by which n
 * turns less than RADIANS_OF_FLIGHT. */
static const double LAW_INSTANTS_PER_RADIAN = 16.0;
static const double LEAST_LAW_INSTANTS = 64.0;
static const double RADIANS_OF_FLIGHT = 3.0;
static const double MOST_LAW_INSTANTS = 1e6;

/* The last instant is right before the bodies part, where a dashpot may have been clipped shortly before. */
static const double JUST_BEFORE = 1.0 - 1e-9;

/* Returns the regime that follows by the law. It is another one than `present` only where the law's event
 * function is below zero by more than its rounding and by more than `left`, so that rounding at one event
 * cannot cause another event. */
static enum contact_regime regime_by_law(const struct contact_law *law, enum contact_regime present,
                                         double gap, double rate, double gap_noise, double rate_noise,
                                         double left)
{
    const double event = contact_event(law, present, gap, rate);
    if (event >= -left) {
        return present;
    }
    const struct contact_slopes slopes = contact_event_slopes(law, present);
    const double noise = fabs(slopes.by_gap) * gap_noise + fabs(slopes.by_rate) * rate_noise;
    return event < -noise ? contact_regime_after(law, present) : present;
}

/* Returns the regime of bodies that touch at a time. Of bodies that have been apart the law alone gives it:
 * where the source passes an end plane, rounding decides on which side of the plane it is. */
static enum contact_regime regime_at_time(const struct advancement_path *path, const struct contact_law *law,
                                          enum contact_regime present, double time)
{
    struct advancement_instant at;
    advancement_at(path, time, &at);
    const double gap = fmin(at.geometry.gap, -DBL_MIN);
    const struct vec3 mismatch = path_at(path->mismatch, SEPARATION_DEGREE, time);
    const double rate = at.geometry.gap_rate + path->shape.side * vec3_dot(at.geometry.normal, mismatch);
    if (present == REGIME_APART) {
        return contact_regime_of(law, gap, rate, true);
    }
    const double gap_noise = at.noise[ADVANCEMENT_GAP];
    const double tilt = contact_turns(&path->shape, &at.geometry) ? gap_noise / at.geometry.distance : 0.0;
    return regime_by_law(law, present, gap, rate, gap_noise, vec3_norm(at.c[1]) * (ROUNDINGS + tilt), 0.0);
}

/* Looks for a change of regime by the force law before `until` [s], while the bodies go on touching, by
 * `least` instants at least. */
static void look_for_law(struct advancement_path *path, const struct contact_law *law,
                         enum contact_regime present, double until, double least, long budget,
                         struct prediction *found)
{
    const double turning = advancement_turning(path, 0.0, until);
    const double wanted = least + LAW_INSTANTS_PER_RADIAN * turning * until;
    const long count = (long)fmin(wanted, fmin(MOST_LAW_INSTANTS, fmax(LEAST_LAW_INSTANTS, (double)budget)));
    double before = 0.0;
    for (long i = 1; i <= count; ++i) {
        double time = until * fmin((double)i / (double)count, JUST_BEFORE);
        const enum contact_regime then = regime_at_time(path, law, present, time);
        found->evaluations += 1;
        if (then != present) {
            struct advancement_instant at;
            for (double middle = 0.5 * (before + time); middle > before && middle < time;
                 middle = 0.5 * (before + time)) {
                *(regime_at_time(path, law, present, middle) == present ? &before : &time) = middle;
            }
            advancement_at(path, time, &at);
            found->next = (struct regime_change){time, then, at.geometry.gap, true};
            return;
        }
        before = time;
        advancement_move_on(path, time);
    }
}

static struct prediction advancement_prediction(const struct scene_instant *at, int contact, double horizon,
                                                long budget)
{
    const enum contact_regime present = (enum contact_regime)at->q->contact[contact].regime;
    const struct contact_law law = scene_contact_law(at->q, contact);
    struct advancement_path path = advancement_path_of(at, at->q->clock, contact);
    const bool apart = present == REGIME_APART;
    const struct advancement_result change = advancement_first(&path, horizon, budget);
    /* While the bodies are apart, n acts on nothing: no passage of the centre counts. */
    struct prediction found = {
        {change.after, present, change.gap, !apart}, change.searched, change.evaluations};
    if (change.after < (double)INFINITY) {
        found.searched = horizon;
        found.next.regime = !apart              ? REGIME_APART
                            : change.gap == 0.0 ? REGIME_COMPRESSION
                                                : regime_at_time(&path, &law, present, change.after);
    }
    if (!apart && contact_has_events(&law)) {
        const double until = fmin(change.after, change.searched);
        const double moved = until * path_size(path.c + 1, SEPARATION_DEGREE, until);
        const bool flies = flight_is_steady(at->q, contact_source(contact)) &&
                           flight_is_steady(at->q, contact_destination(contact));
        const double spared =
            flies ? fmax(RADIANS_OF_FLIGHT - moved / at->geometry[contact].distance, 0.0) : 0.0;
        look_for_law(&path, &law, present, until, LEAST_LAW_INSTANTS - LAW_INSTANTS_PER_RADIAN * spared,
                     budget, &found);
    }
    return found;
}

/* This struct describes a separating contact in flight: its path, and bounds of rounding. */
struct separating {
    struct contact_shape shape;
    struct contact_law law;
    struct separation_path separation;
    struct relative_path path; /* over the horizon [s] */
    struct vec3 normal;
    double settle;                /* the gap counts as below zero up to this s */
    double gap_noise, rate_noise; /* rounding of gap and gap rate at the start [m], [m/s] */
    double left;                  /* an integrator may leave the event function below zero by this much */
};

/* Returns the regime at the place s of the path, by a gap that has the digits of the gap at the start. */
static enum contact_regime separating_at(const struct separating *f, double s, double *gap)
{
    const double time = s * f->path.horizon;
    *gap = f->path.scale * gap_along(&f->path, s).value;
    const double rate = contact_geometry_at(&f->shape, path_at(f->separation.c, SEPARATION_DEGREE + 1, time),
                                            path_at(f->separation.w, SEPARATION_DEGREE, time), f->normal)
                            .gap_rate;
    if (!(*gap < 0.0)) {
        return s > f->settle ? REGIME_APART : REGIME_SEPARATING;
    }
    return regime_by_law(&f->law, REGIME_SEPARATING, *gap, rate, f->gap_noise, f->rate_noise, f->left);
}

/* A separating contact is evaluated at so many places between two extremes of its gap. Between two of these
 * places neither the gap nor the event function changes its sign twice by an amount that matters. */
enum { SEPARATING_PLACES = 16 };

/* Returns the first change of a separating contact, whose bodies fly: they part, or the force returns. */
static struct regime_change separating_change(const struct scene_instant *at,
                                              const struct contact_shape *shape,
                                              const struct separation_path *separation, int contact,
                                              double horizon)
{
    const struct contact_geometry *now = &at->geometry[contact];
    const double by_positions = rounding_of_gap(at, contact);
    struct separating f = {.shape = *shape,
                           .law = scene_contact_law(at->q, contact),
                           .separation = *separation,
                           .normal = now->normal};
    f.path = relative_path_make(&f.shape, &f.separation, now->gap, horizon);
    f.gap_noise = rounding_now(at, contact);
    const double tilt = contact_turns(&f.shape, now) ? fmin(by_positions / now->distance, 1.0) : 0.0;
    f.rate_noise = (ROUNDINGS + tilt) * vec3_norm(f.separation.w[0]);
    f.settle = leaving_time(now->gap, f.gap_noise, vec3_dot(now->normal, f.separation.c[1]),
                            vec3_norm(f.separation.c[2])) /
               horizon;
    f.left = at->q->clock == 0.0
                 ? fmax(-2.0 * contact_event(&f.law, REGIME_SEPARATING, now->gap, now->gap_rate), 0.0)
                 : 0.0;
    double extremes[POLYNOMIAL_MAX_DEGREE];
    const int count = polynomial_add_sign_changes(&f.path.closing, extremes, 0);
    double from = 0.0;
    double before = 0.0;
    double gap;
    for (int i = 0; i < (count + 1) * SEPARATING_PLACES; ++i) {
        const int interval = i / SEPARATING_PLACES;
        const double to = interval < count ? extremes[interval] : 1.0;
        double s = from + (to - from) * (1 + i % SEPARATING_PLACES) / SEPARATING_PLACES;
        if (separating_at(&f, s, &gap) != REGIME_SEPARATING) {
            const struct root_bracket_end low = gap_along(&f.path, before);
            if (!(gap < 0.0) && low.value < 0.0) { /* the bodies part */
                s = root_between(relative_path_gap, &f.path, low, gap_along(&f.path, s));
                return (struct regime_change){fmax(s, f.settle) * horizon, REGIME_APART, 0.0, true};
            }
            for (double middle = 0.5 * (before + s); middle > before && middle < s;
                 middle = 0.5 * (before + s)) {
                *(separating_at(&f, middle, &gap) == REGIME_SEPARATING ? &before : &s) = middle;
            }
            const enum contact_regime next = separating_at(&f, s, &gap);
            return (struct regime_change){s * horizon, next, gap, true};
        }
        before = s;
        from = (i + 1) % SEPARATING_PLACES == 0 ? to : from;
    }
    return no_change(REGIME_SEPARATING, true);
}

/* Returns the first change of a contact with a capped cylinder that transmits no force to a free body.
 * Conservative advancement finds it, except while the contact separates within its zone on a side or a cap,
 * where the gap may be smaller than the rounding of positions. A prescribed contact that goes into another
 * zone keeps its regime there; positions then give the gap (DBL_MAX). */
static struct prediction change_at_capped(const struct scene_instant *at, int contact, double horizon,
                                          long budget)
{
    const enum contact_regime present = (enum contact_regime)at->q->contact[contact].regime;
    const struct contact_shape in = scene_shape_met(at, contact);
    const struct separation_path path = separation_path_of(at, at->q->clock, contact);
    const double noise = rounding_of_gap(at, contact);
    const double bend = gap_bend(&in, &at->geometry[contact], &path);
    const double rate = at->geometry[contact].gap_rate;
    if (present == REGIME_APART && !contact_is_prescribed(at->v, contact) &&
        fabs(at->geometry[contact].gap) <= noise && bend < 0.0 && rate * rate < -2.0 * bend * noise) {
        /* the hop of bodies that touch within rounding is a parabola, and bodies that approach touch now */
        const double dead_band = at->q->contact[contact].schedule.dead_band_clock - at->q->clock;
        return (struct prediction){touch_at(fmax(fmax(-2.0 * rate / bend, 0.0), dead_band)), horizon, 0};
    }
    const double end = present == REGIME_APART ? (double)INFINITY : zone_path_end(&in.solid, &path, horizon);
    if (present == REGIME_SEPARATING && !contact_is_prescribed(at->v, contact) && !contact_is_rim(&in)) {
        const struct regime_change next = separating_change(at, &in, &path, contact, horizon);
        if (fmin(next.after, horizon) < end) {
            return (struct prediction){next, horizon, 0};
        }
    }
    const double until = at->q->contact[contact].zone != 0 ? end : (double)INFINITY;
    struct prediction found = {no_change(present, true), horizon, 0};
    if (until > 0.0) {
        found = advancement_prediction(at, contact, fmin(until, horizon), budget);
    }
    if (until <= found.searched && !(found.next.after < until)) {
        found.next = (struct regime_change){until, present, DBL_MAX, true};
    }
    return found;
}

struct prediction prediction_of(const struct scene_instant *at, int contact, double horizon, long budget)
{
    const struct scene_state *q = at->q;
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    const struct contact_shape shape = scene_contact_shape(q, contact);
    const bool has_ends = scene_ends_suddenly(at->v, contact);
    const bool pushes = contact_pushes(q, contact);
    const bool advances = SCENE_ANY_ADVANCEMENT && contact_advances(at->v, contact);
    struct prediction found = {no_change(present, true), horizon, 0};
    if (contact_is_coupled(q, contact) || (pushes && (scene_turns(at->v) || !has_ends))) {
        return found;
    }
    if (SCENE_ANY_CAPS && contact_is_capped(&shape) && !advances) {
        return change_at_capped(at, contact, horizon, budget);
    }
    const double rounding = has_ends ? rounding_of_axial(at, contact, &shape) : 0.0;
    const bool within = !has_ends || scene_beyond_ends(&shape, &at->geometry[contact]) < -rounding;
    if (advances || contact_is_prescribed(at->v, contact) || (present == REGIME_APART && !within)) {
        return advancement_prediction(at, contact, horizon, budget);
    }
    const struct separation_path path = separation_path_of(at, q->clock, contact);
    double until = horizon;
    double settle = 0.0;
    if (present == REGIME_APART) {
        found.next = touch_in_flight(at, &shape, &path, contact, horizon);
        until = found.next.after;
    } else if (pushes) {
        settle = q->contact[contact].schedule.dead_band_clock - q->clock;
    } else {
        found.next = separating_change(at, &shape, &path, contact, horizon);
    }
    if (!has_ends || !isfinite(until)) {
        return found;
    }
    const struct regime_change end = passage_of_end(&shape, &path, rounding, settle, until, present);
    if (present == REGIME_APART) { /* the touch is on the side if no end is passed before */
        return isfinite(end.after) ? advancement_prediction(at, contact, horizon, budget) : found;
    }
    found.next = end.after < found.next.after ? end : found.next;
    return found;
}
