#include <float.h>

#include "math/polynomial.h"
#include "scene/dense_output.h"
#include "scene/evaluate.h"
#include "scene/scene_jet.h"

/* An event function on a dense output, or one of its derivatives, as the argument of a root finder. */
struct probe {
    const struct dense_output *output;
    const struct event_function *what;
    int order; /* of the derivative: 0, 1 or 2 */
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

/* Returns a derivative of an event function; order 0 gives the function itself. */
static double term_of(const struct event_function *what, const struct pair_sample *at, int order)
{
    const double term = what->factor * at->of[what->quantity][order];
    return order == 0 ? term + what->offset : term;
}

/* Returns an end of a bracket: a derivative of an event function and its slope at a sample. The slope of the
 * second derivative is unknown; with zero, root_in_bracket bisects. */
static struct root_bracket_end end_of(const struct event_function *what, int order, double s,
                                      const struct pair_sample *at)
{
    return (struct root_bracket_end){s, term_of(what, at, order),
                                     order < 2 ? term_of(what, at, order + 1) : 0.0};
}

/* Returns the end of a bracket at s. */
static struct root_bracket_end end_at(const struct dense_output *w, const struct event_function *what,
                                      int order, double s)
{
    struct pair_sample at;
    w->sampler(w->segment, s, &at);
    return end_of(what, order, s, &at);
}

/* Serves as a root_function. */
static void probe_at(const void *data, double s, double *value, double *slope)
{
    const struct probe *probe = data;
    const struct root_bracket_end end = end_at(probe->output, probe->what, probe->order, s);
    *value = end.value;
    *slope = end.slope;
}

/* Returns the s of the fall through zero between the samples i and i + 1: directly, by way of a minimum, or
 * after a rise from below; else INFINITY. */
static double fall_between(const struct dense_output *w, const struct event_function *what, int i)
{
    const struct probe value = {w, what, 0};
    const struct probe slope = {w, what, 1};
    struct root_bracket_end low = end_of(what, 0, w->s[i], &w->at[i]);
    struct root_bracket_end high = end_of(what, 0, w->s[i + 1], &w->at[i + 1]);
    const bool dips = low.value > 0.0 && high.value > 0.0 && low.slope < 0.0 && high.slope > 0.0;
    const bool humps = low.value <= 0.0 && high.value <= 0.0 && low.slope > 0.0 && high.slope < 0.0;
    if (dips || humps) {
        const double s = root_between(probe_at, &slope, end_of(what, 1, low.s, &w->at[i]),
                                      end_of(what, 1, high.s, &w->at[i + 1]));
        *(dips ? &high : &low) = end_at(w, what, 0, s);
    }
    return low.value > 0.0 && high.value <= 0.0 ? root_between(probe_at, &value, low, high)
                                                : (double)INFINITY;
}

/* Whether neither of the first two samples is above zero and one is below. A function that stays zero, as the
 * gap rate at rest does, does not start below. */
static bool starts_below(const struct dense_output *w, const struct event_function *what)
{
    const double first = term_of(what, &w->at[0], 0);
    const double second = term_of(what, &w->at[1], 0);
    return fmax(first, second) <= 0.0 && fmin(first, second) < 0.0;
}

double dense_output_first_event(const struct dense_output *w, const struct event_function *what)
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

/* Whether a sample is itself the top, to rounding. */
static bool is_top(const struct event_function *what, const struct pair_sample *at)
{
    const double slope = term_of(what, at, 1);
    return slope * slope <= -DBL_EPSILON * term_of(what, at, 2) * fabs(term_of(what, at, 0));
}

/* Whether a slope with an extremum between `low` and `high` stays clear of zero. The cubic through both ends
 * is taken where its linearly interpolated derivative is zero; its value there must exceed half of the
 * smaller end value. */
static bool stays_clear(const struct root_bracket_end *low, const struct root_bracket_end *high)
{
    const double width = high->s - low->s;
    const double t = low->slope / (low->slope - high->slope);
    const double u = 1.0 - t;
    const double between = u * u * ((1.0 + 2.0 * t) * low->value + t * width * low->slope) +
                           t * t * ((1.0 + 2.0 * u) * high->value - u * width * high->slope);
    const double least = 0.5 * fmin(fabs(low->value), fabs(high->value));
    return low->value > 0.0 ? between > least : between < -least;
}

/* Whether there is a top between `low` and `high`, which hold slopes. Where the quantity rises or falls at
 * both ends, or rests at one, one end moves to the extremum of the slope. The slope then falls through zero
 * between the ends. */
static bool brackets_top(const struct dense_output *w, const struct event_function *what,
                         struct root_bracket_end *low, struct root_bracket_end *high)
{
    const struct probe bend = {w, what, 2};
    const bool falls = low->value <= 0.0 && high->value < 0.0 && low->slope > 0.0 && high->slope < 0.0;
    const bool rises = low->value > 0.0 && high->value >= 0.0 && low->slope < 0.0 && high->slope > 0.0;
    if ((falls || rises) && !stays_clear(low, high)) {
        *(falls ? low : high) = end_at(w, what, 1, root_in_bracket(probe_at, &bend, low->s, high->s));
    }
    return low->value > 0.0 && high->value < 0.0;
}

bool dense_output_is_larger(const struct dense_output *w, double value, double largest)
{
    return value > largest + w->worth_a_search * fabs(largest);
}

/* Whether a top between two samples may exceed the largest value known. Where the quantity bends down at both
 * samples, the top lies below the crossing of the two tangents. */
static bool may_be_larger(const struct dense_output *w, const struct event_function *what,
                          const struct root_bracket_end *low, const struct root_bracket_end *high,
                          const struct pair_sample *at, const struct pair_sample *next, double largest)
{
    const double width = high->s - low->s;
    const double rise = term_of(what, next, 0) - term_of(what, at, 0);
    const double meet = (rise - high->value * width) / (low->value - high->value);
    return !(low->slope < 0.0 && high->slope < 0.0) ||
           dense_output_is_larger(w, term_of(what, at, 0) + low->value * meet, largest);
}

/* A double root of a slope is found to the square root of rounding. The slope there is below the first part
 * of the slope at the start of the interval, and the bend below the second part of the mean bend. */
static const double SLOPE_AT_REST = 1e-9;
static const double BEND_AT_REST = 1e-3;

/* Whether a quantity that rises at `low` comes to rest at `high` without a bend, as the force does where a
 * prescribed body passes a rim along a tangent. Both ends hold slopes. */
static bool rests_flat(const struct root_bracket_end *low, const struct root_bracket_end *high)
{
    return low->value > 0.0 && fabs(high->value) <= SLOPE_AT_REST * low->value &&
           fabs(high->slope) * (high->s - low->s) <= BEND_AT_REST * low->value;
}

/* The search for a top before a double root halves the interval so often. It may miss a top that is nearer
 * to the root. The value at such a top exceeds the value at the root by 1e-11 of the rise at most, because
 * the excess goes with the cube of the distance. */
enum { HALVINGS_TO_REST = 12 };

/* Whether the quantity falls before it rests at `high`, where its slope then has a double root. The top lies
 * before `high`. Both ends hold slopes, and they move to both sides of the top. */
static bool fell_before(const struct dense_output *w, const struct event_function *what,
                        struct root_bracket_end *low, struct root_bracket_end *high)
{
    for (int i = 0; i < HALVINGS_TO_REST; ++i) {
        const struct root_bracket_end middle = end_at(w, what, 1, 0.5 * (low->s + high->s));
        *(middle.value < 0.0 ? high : low) = middle;
        if (middle.value < 0.0) {
            return true;
        }
    }
    return false;
}

/* Returns the larger of `largest` and of the top between the samples `at` and `next`, whose slopes are `low`
 * and `high`. */
static double larger_between(const struct dense_output *w, const struct event_function *what,
                             struct root_bracket_end low, struct root_bracket_end high,
                             const struct pair_sample *at, const struct pair_sample *next, double largest)
{
    const struct probe slope = {w, what, 1};
    const bool turns = low.value > 0.0 && high.value < 0.0;
    const bool flat = rests_flat(&low, &high);
    if (turns && !flat &&
        (is_top(what, at) || is_top(what, next) || !may_be_larger(w, what, &low, &high, at, next, largest))) {
        return largest;
    }
    bool found = flat ? fell_before(w, what, &low, &high) : brackets_top(w, what, &low, &high);
    for (int tops = 0; found && tops < 2; ++tops) { /* the second lies before a double root of the slope */
        struct pair_sample top;
        const double s = root_between(probe_at, &slope, low, high);
        w->sampler(w->segment, s, &top);
        largest = fmax(largest, term_of(what, &top, 0));
        high = end_of(what, 1, s, &top);
        found = rests_flat(&low, &high) && fell_before(w, what, &low, &high);
    }
    return largest;
}

double dense_output_largest(const struct dense_output *w, const struct event_function *what,
                            const struct dense_range *range, double known)
{
    double largest = fmax(known, fmax(term_of(what, range->first, 0), term_of(what, range->last, 0)));
    for (int i = 0; i + 1 < w->count && w->s[i] < range->to; ++i) {
        const bool begins = w->s[i] < range->from;
        const bool ends = w->s[i + 1] > range->to;
        const struct pair_sample *at = begins ? range->first : &w->at[i];
        const struct pair_sample *next = ends ? range->last : &w->at[i + 1];
        const struct root_bracket_end low = end_of(what, 1, begins ? range->from : w->s[i], at);
        const struct root_bracket_end high = end_of(what, 1, ends ? range->to : w->s[i + 1], next);
        if (low.s < high.s) {
            largest = fmax(largest, term_of(what, next, 0));
            largest = larger_between(w, what, low, high, at, next, largest);
        }
    }
    return largest;
}

const struct event_function dense_output_force = {PAIR_FORCE, 1.0, 0.0};
const struct event_function dense_output_penetration = {PAIR_GAP, -1.0, 0.0};

/* Puts the scene at a clock, or only the contacts in `met`. */
static void scene_at(const struct scene_output *o, double clock, const bool *met, struct scene_state *q,
                     struct scene_instant *at)
{
    memcpy(q, o->state,
           offsetof(struct scene_state, unfinished)); /* without the step, which is not looked at */
    q->clock = clock;
    if (o->move) {
        o->move(o->mover, clock, q);
    }
    scene_evaluate(q, clock, met, at);
}

static void put_sample(const struct contact_jet *jet, struct pair_sample *sample)
{
    for (int i = 0; i < JET_TERMS; ++i) {
        const double factor = i < 2 ? 1.0 : 2.0; /* a derivative is the coefficient times i! */
        sample->of[PAIR_GAP][i] = factor * jet->gap[i];
        sample->of[PAIR_GAP_RATE][i] = factor * jet->gap_rate[i];
        sample->of[PAIR_FORCE][i] = factor * jet->normal_force[i];
    }
}

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
    scene_at(o, clock, alone ? met : NULL, &q, &at);
    jet_of_motion(&at, met, &along);
    put_sample(&along.contact[o->contact], sample);
    if (SCENE_ANY_CURVED && singularity_rate(&at, o->contact) != at.geometry[o->contact].gap_rate) {
        sample->of[PAIR_GAP][1] = singularity_rate(&at, o->contact);
        sample->of[PAIR_FORCE][0] = scene_outward_force(&at, o->contact);
    }
}

void scene_outputs_add(struct scene_output *outputs, double clock)
{
    struct scene_state q;
    struct scene_instant at;
    struct scene_jet along;
    bool met[SCENE_CONTACTS];
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        met[j] = outputs->state->contact[j].regime != (int32_t)REGIME_APART;
    }
    scene_at(outputs, clock, NULL, &q, &at);
    jet_of_motion(&at, met, &along);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct dense_output *w = &outputs[j].output;
        if (met[j]) {
            put_sample(&along.contact[j], &w->at[w->count]);
            w->s[w->count++] = clock;
        }
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
    peaks->penetration = dense_output_largest(w, &dense_output_penetration, &whole, peaks->penetration);
    peaks->force = dense_output_largest(w, &dense_output_force, &whole, peaks->force);
    w->s[0] = w->s[last];
    w->at[0] = w->at[last];
    w->count = 1;
}
