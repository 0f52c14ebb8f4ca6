#include <float.h>

#include "math/compiler.h"
#include "math/polynomial.h"
#include "scene/dense_output.h"
#include "scene/evaluate.h"
#include "scene/scene_jet.h"

/* This struct holds an event function on a dense output, or its slope, as the argument of a root finder. */
struct probe {
    struct dense_output *output;
    const struct event_function *what;
    int order; /* of the derivative: 0 or 1 */
};

double dense_output_worth_a_search(const struct scene_values *v)
{
    return fmin(solver_relative_tolerance(v), 1e-9); /* a looser bound would spare no search */
}

void dense_output_add(struct dense_output *w, double s)
{
    w->sampler(w->segment, s, &w->at[w->count]);
    w->s[w->count++] = s;
}

const struct pair_sample *dense_output_at(struct dense_output *w, double s)
{
    if (w->latest_s != s) {
        w->sampler(w->segment, s, &w->latest);
        w->latest_s = s;
    }
    return &w->latest;
}

static struct event_place event_place_of(const struct event_function *what, double s,
                                         const struct pair_sample *at)
{
    const double *terms = at->of[what->quantity];
    return (struct event_place){
        s, {what->factor * terms[0] + what->offset, what->factor * terms[1], what->factor * terms[2]}};
}

static struct event_place event_place_at(struct dense_output *w, const struct event_function *what, double s)
{
    return event_place_of(what, s, dense_output_at(w, s));
}

/* Returns an end of a bracket for a root of the event function (order 0) or of its slope (order 1). */
static struct root_bracket_end end_of(const struct event_place *place, int order)
{
    return (struct root_bracket_end){place->s, place->of[order], place->of[order + 1]};
}

/* Serves as a root_function. */
static void probe_at(const void *data, double s, double *value, double *slope)
{
    const struct probe *probe = data;
    const struct event_place place = event_place_at(probe->output, probe->what, s);
    *value = place.of[probe->order];
    *slope = place.of[probe->order + 1];
}

/* Returns the s of the fall through zero between the samples i and i + 1: directly, by way of a minimum, or
 * after a rise from below; else INFINITY. */
static double fall_between(struct dense_output *w, const struct event_function *what, int i)
{
    const struct probe value = {w, what, 0};
    const struct probe slope = {w, what, 1};
    const struct event_place at = event_place_of(what, w->s[i], &w->at[i]);
    const struct event_place next = event_place_of(what, w->s[i + 1], &w->at[i + 1]);
    struct root_bracket_end low = end_of(&at, 0);
    struct root_bracket_end high = end_of(&next, 0);
    const bool dips = low.value > 0.0 && high.value > 0.0 && low.slope < 0.0 && high.slope > 0.0;
    const bool humps = low.value <= 0.0 && high.value <= 0.0 && low.slope > 0.0 && high.slope < 0.0;
    if (dips || humps) {
        const double s = root_between(probe_at, &slope, end_of(&at, 1), end_of(&next, 1));
        const struct event_place extremum = event_place_at(w, what, s);
        *(dips ? &high : &low) = end_of(&extremum, 0);
    }
    return low.value > 0.0 && high.value <= 0.0 ? root_between(probe_at, &value, low, high)
                                                : (double)INFINITY;
}

/* Whether neither of the first two samples is above zero and one is below. A function that stays zero, as the
 * gap rate at rest does, does not start below. */
static bool starts_below(const struct dense_output *w, const struct event_function *what)
{
    const double first = event_place_of(what, w->s[0], &w->at[0]).of[0];
    const double second = event_place_of(what, w->s[1], &w->at[1]).of[0];
    return first <= 0.0 && second <= 0.0 && (first < 0.0 || second < 0.0);
}

double dense_output_first_event(struct dense_output *w, const struct event_function *what)
{
    double fall = (double)INFINITY;
    for (int i = 0; i + 1 < w->count && !(fall < (double)INFINITY); ++i) {
        fall = fall_between(w, what, i);
        if (i == 0 && !(fall < (double)INFINITY) && starts_below(w, what)) {
            return w->s[0];
        }
    }
    return fall;
}

/* Whether a place is itself the top, to rounding. */
static bool is_top(const struct event_place *place)
{
    return place->of[1] * place->of[1] <= -DBL_EPSILON * place->of[2] * fabs(place->of[0]);
}

/* Whether a slope with an extremum between `low` and `high` stays clear of zero. The cubic through both ends
 * is taken where its linearly interpolated derivative is zero; its value there must exceed half of the
 * smaller end value. */
static bool stays_clear(const struct event_place *low, const struct event_place *high)
{
    const double width = high->s - low->s;
    const double t = low->of[2] / (low->of[2] - high->of[2]);
    const double u = 1.0 - t;
    const double between = u * u * ((1.0 + 2.0 * t) * low->of[1] + t * width * low->of[2]) +
                           t * t * ((1.0 + 2.0 * u) * high->of[1] - u * width * high->of[2]);
    const double least = 0.5 * fmin(fabs(low->of[1]), fabs(high->of[1]));
    return low->of[1] > 0.0 ? between > least : between < -least;
}

bool dense_output_is_larger(const struct dense_output *w, double value, double largest)
{
    return value > largest + w->worth_a_search * fabs(largest);
}

/* Whether a top between two samples may exceed the largest value known. Where the quantity bends down at both
 * samples, the top lies below the crossing of the two tangents. */
static bool may_be_larger(const struct dense_output *w, const struct event_place *low,
                          const struct event_place *high, double largest)
{
    const double width = high->s - low->s;
    const double meet = (high->of[0] - low->of[0] - high->of[1] * width) / (low->of[1] - high->of[1]);
    return !(low->of[2] < 0.0 && high->of[2] < 0.0) ||
           dense_output_is_larger(w, low->of[0] + low->of[1] * meet, largest);
}

/* A double root of a slope is found to the square root of rounding. The slope there is below the first part
 * of the slope at the start of the interval, and the bend below the second part of the mean bend. */
static const double SLOPE_AT_REST = 1e-9;
static const double BEND_AT_REST = 1e-3;

/* Whether a quantity that rises at `low` comes to rest at `high` without a bend, as the force does where a
 * prescribed body passes a rim along a tangent. */
static bool rests_flat(const struct event_place *low, const struct event_place *high)
{
    return low->of[1] > 0.0 && fabs(high->of[1]) <= SLOPE_AT_REST * low->of[1] &&
           fabs(high->of[2]) * (high->s - low->s) <= BEND_AT_REST * low->of[1];
}

/* The search for a slope of the other sign halves the interval so often. It may miss a top whose slope has
 * the other sign on a shorter part of the interval. The value at such a top exceeds the values beside it by
 * 1e-11 of the rise at most, because the excess goes with the cube of that part. */
enum { HALVINGS_TO_TOP = 12 };

/* Whether there is a top between `low` and `high`. Where the quantity rises or falls at both ends, or comes
 * to rest at `high`, the slope may have the other sign about its extremum between them. Then one end moves to
 * a place where the slope has that sign, and the slope falls through zero between the ends. */
static bool brackets_top(struct dense_output *w, const struct event_function *what, bool rests,
                         struct event_place *low, struct event_place *high)
{
    const bool falls = low->of[1] <= 0.0 && high->of[1] < 0.0 && low->of[2] > 0.0 && high->of[2] < 0.0;
    const bool rises = low->of[1] > 0.0 && high->of[1] >= 0.0 && low->of[2] < 0.0 && high->of[2] > 0.0;
    struct event_place from = *low;
    struct event_place to = *high;
    if (!falls && !rises && !rests) {
        return low->of[1] > 0.0 && high->of[1] < 0.0;
    }
    for (int i = 0; i < HALVINGS_TO_TOP && (rests || !stays_clear(&from, &to)); ++i) {
        const struct event_place middle = event_place_at(w, what, 0.5 * (from.s + to.s));
        if (falls ? middle.of[1] > 0.0 : middle.of[1] < 0.0) {
            *(falls ? low : high) = middle;
            return true;
        }
        *((middle.of[2] > 0.0) == falls ? &from : &to) = middle;
    }
    return false;
}

static struct event_place larger_of(struct event_place a, struct event_place b)
{
    return b.of[0] > a.of[0] ? b : a;
}

/* Returns the larger of `largest` and of the tops between two samples. */
static struct event_place larger_between(struct dense_output *w, const struct event_function *what,
                                         struct event_place low, struct event_place high,
                                         struct event_place largest)
{
    const struct probe slope = {w, what, 1};
    bool rests = rests_flat(&low, &high);
    if (!rests && low.of[1] > 0.0 && high.of[1] < 0.0 &&
        (is_top(&low) || is_top(&high) || !may_be_larger(w, &low, &high, largest.of[0]))) {
        return largest;
    }
    bool found = brackets_top(w, what, rests, &low, &high);
    for (int tops = 0; found && tops < 2; ++tops) { /* the second lies before a double root of the slope */
        high = event_place_at(w, what, root_between(probe_at, &slope, end_of(&low, 1), end_of(&high, 1)));
        largest = larger_of(largest, high);
        rests = rests_flat(&low, &high);
        found = rests && brackets_top(w, what, rests, &low, &high);
    }
    return largest;
}

struct event_place dense_output_largest(struct dense_output *w, const struct event_function *what,
                                        const struct dense_range *range, double known)
{
    struct event_place largest = {range->from, {known, 0.0, 0.0}};
    largest = larger_of(largest, event_place_of(what, range->from, range->first));
    largest = larger_of(largest, event_place_of(what, range->to, range->last));
    for (int i = 0; i + 1 < w->count && w->s[i] < range->to; ++i) {
        if (w->s[i + 1] <= range->from) {
            continue;
        }
        const bool begins = w->s[i] < range->from;
        const bool ends = w->s[i + 1] > range->to;
        const struct event_place low =
            event_place_of(what, begins ? range->from : w->s[i], begins ? range->first : &w->at[i]);
        const struct event_place high =
            event_place_of(what, ends ? range->to : w->s[i + 1], ends ? range->last : &w->at[i + 1]);
        largest = larger_between(w, what, low, high, larger_of(largest, high));
    }
    return largest;
}

const struct event_function dense_output_force = {PAIR_FORCE, 1.0, 0.0};
const struct event_function dense_output_penetration = {PAIR_GAP, -1.0, 0.0};

/* Samples the scene; serves as a dense_output_sampler, whose variable is the clock [s]. */
static void sample_scene(const void *output, double clock, struct pair_sample *sample)
{
    const struct scene_output *o = output;
    struct scene_state q;
    struct scene_instant at;
    struct scene_jet along;
    bool met[SCENE_CONTACTS] = {false};
    met[o->contact] = true;
    /* a contact of bodies whose motion is given depends on no other */
    const bool alone = SCENE_CONTACTS > 1 && contact_is_prescribed(o->state->v, o->contact);
    memcpy(&q, o->state, offsetof(struct scene_state, unfinished)); /* a sample does not read that step */
    q.clock = clock;
    if (o->move) {
        o->move(o->mover, clock, &q);
    }
    scene_place_bodies(&q, clock, &at);
    scene_meet(alone ? met : NULL, &at);
    scene_forces(alone ? met : NULL, &at);
    jet_of_motion(&at, met, &along);
    for (int i = 0; i < JET_TERMS; ++i) {
        const struct contact_jet *jet = &along.contact[o->contact];
        const double factor = i < 2 ? 1.0 : 2.0; /* a derivative is the coefficient times i! */
        sample->of[PAIR_GAP][i] = factor * jet->gap[i];
        sample->of[PAIR_GAP_RATE][i] = factor * jet->gap_rate[i];
        sample->of[PAIR_FORCE][i] = factor * jet->normal_force[i];
    }
    if (SCENE_ANY_CURVED && singularity_rate(&at, o->contact) != at.geometry[o->contact].gap_rate) {
        sample->of[PAIR_GAP][1] = singularity_rate(&at, o->contact);
        sample->of[PAIR_FORCE][0] = scene_outward_force(&at, o->contact);
    }
}

/* Notes the peaks on both sides of the centre of solid bodies. There n and the force of a dashpot reverse, so
 * that the force is largest right before or right after. The gap falls at `low`, rises at `high`, and is
 * least in the centre. */
static void note_at_centre(const struct scene_output *o, double low, double high, struct contact_peaks *peaks)
{
    struct pair_sample at;
    for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high)) {
        sample_scene(o, middle, &at);
        contact_peaks_note(peaks, at.of[PAIR_FORCE][0], -at.of[PAIR_GAP][0]);
        *(at.of[PAIR_GAP][1] < 0.0 ? &low : &high) = middle;
    }
}

/* Whether the motion between two samples may have passed the centre: the bodies have stopped approaching, and
 * overlap by more than half of the distance d at which they touch. */
static bool may_pass_centre(const struct scene_output *o, const struct pair_sample *before,
                            const struct pair_sample *after)
{
    const struct contact_shape shape = scene_contact_shape(o->state, o->contact);
    return shape.side > 0 && -2.0 * after->of[PAIR_GAP][0] > contact_reach(&shape) &&
           before->of[PAIR_GAP][1] < 0.0 && after->of[PAIR_GAP][1] > 0.0;
}

void scene_output_note_peaks(struct scene_output *o, double from, double to, int parts,
                             struct contact_peaks *peaks)
{
    struct dense_output *w = &o->output;
    w->sampler = sample_scene;
    w->segment = o;
    w->latest_s = -1.0; /* the motion may have changed since the last call */
    if (w->count == 0) {
        dense_output_add(w, from);
    }
    for (int i = 1; i <= parts; ++i) {
        const double place = i < parts ? from + (to - from) * i / parts : to;
        if (place > w->s[w->count - 1]) {
            dense_output_add(w, place);
        }
    }
    const int last = w->count - 1;
    for (int i = 0; i < last; ++i) {
        if (may_pass_centre(o, &w->at[i], &w->at[i + 1])) {
            note_at_centre(o, w->s[i], w->s[i + 1], peaks);
        }
    }
    const struct dense_range whole = {w->s[0], w->s[last], &w->at[0], &w->at[last]};
    peaks->penetration = dense_output_largest(w, &dense_output_penetration, &whole, peaks->penetration).of[0];
    peaks->force = dense_output_largest(w, &dense_output_force, &whole, peaks->force).of[0];
    w->s[0] = w->s[last];
    w->at[0] = w->at[last];
    w->count = 1;
}
