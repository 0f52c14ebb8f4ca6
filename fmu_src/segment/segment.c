#include "segment/segment.h"

#include <float.h>

#include "scene/present.h"
#include "scene/rounding.h"
#include "segment/kinds.h"
#include "segment/peaks.h"
#include "segment/terminal_event.h"
#include "segment/torque_impulse.h"
#include "segment/zone_end.h"

static bool taylor_applies(const struct segment *p)
{
    (void)p;
    return true;
}

static bool taylor_make(struct segment *p)
{
    pair_taylor_make(&p->as.taylor, &p->pair);
    p->unit = p->as.taylor.unit;
    p->end = fmin(p->as.taylor.step, p->longest / p->unit);
    /* A step is a fifth of the radius of convergence at most (TAYLOR_ORDER); within a quarter of it, a
     * twentieth of the radius, no quantity of the contact has two extrema. */
    for (int i = 0; i < 5; ++i) {
        dense_output_add(&p->output, p->end * i / 4);
    }
    return true;
}

/* The first kind that applies and can be made is taken. */
static const struct {
    bool (*applies)(const struct segment *p);
    bool (*make)(struct segment *p);
    dense_output_sampler *sample;
    struct pair_change (*change)(const void *motion, double s);
} kinds[] = {
    /* Head-on under constant acceleration: exact for any time, so it comes first. */
    [SEGMENT_CLOSED_FORM] = {closed_form_applies, closed_form_make, pair_oscillation_sample,
                             pair_oscillation_change},
    /* Fast oscillations that are small and clear of g = 0: many in one step, as far as the tangential motion
     * allows. */
    [SEGMENT_AVERAGED] = {averaged_applies, averaged_make, pair_collocation_sample, pair_collocation_change},
    /* Other oscillations, below critical damping: half a period and more, most of an impact. */
    [SEGMENT_RESOLVED] = {resolved_applies, resolved_make, pair_collocation_sample, pair_collocation_change},
    /* Far beyond critical damping, or without a spring: a radian of the tangential motion. */
    [SEGMENT_OVERDAMPED] = {overdamped_applies, overdamped_make, pair_collocation_sample,
                            pair_collocation_change},
    /* Everything else, soft contacts and short remainders: two radians of the contact or of its passage. */
    [SEGMENT_TAYLOR] = {taylor_applies, taylor_make, pair_taylor_sample, pair_taylor_change},
#if SCENE_ANY_HERTZ
    /* Hertz's law, the oscillation died away: a radian of the tangential motion. */
    [SEGMENT_HERTZ_SLOW] = {hertz_slow_applies, hertz_slow_make, slow_hertz_sample, slow_hertz_change},
    /* Hertz's law without damping, head-on under constant acceleration: all the rest of an impact. */
    [SEGMENT_HERTZ_ELASTIC] = {hertz_elastic_applies, hertz_elastic_segment_make, hertz_elastic_sample,
                               hertz_elastic_change},
    /* Hertz's law: a third of the radius of convergence in a variable of its own. */
    [SEGMENT_HERTZ] = {hertz_applies, hertz_make, pair_hertz_sample, pair_hertz_change},
#endif
#if SCENE_ANY_CAPS
    /* At a rim, whatever the law, what no collocated or slow segment takes: two radians of the contact, or a
     * fifth of the rim. */
    [SEGMENT_RIM] = {rim_applies, rim_make, rim_series_sample, rim_series_change},
#endif
};

static bool make_kind(struct segment *p, enum segment_kind kind)
{
    p->kind = kind;
    p->event_free = false;
    /* in a hollow body contact ends before */
    p->clear_of_centre = !contact_may_reach_centre(&p->pair.shape);
    p->largest_gap = p->largest_rate = 0.0;
    p->terminal.s = (double)NAN;
    p->output.sampler = kinds[kind].sample;
    p->output.segment = &p->as;
    p->output.worth_a_search = DENSE_OUTPUT_WORTH_A_SEARCH;
    p->output.count = 0;
    p->output.latest_s = -1.0;
    return kinds[kind].applies(p) && kinds[kind].make(p);
}

static bool is_collocated(const struct segment *p)
{
    return p->kind != SEGMENT_CLOSED_FORM && p->kind < SEGMENT_TAYLOR;
}

#if SCENE_ANY_HERTZ
/* What is in closed form first; then the series, whose first coefficients tell if anything is fast; where
 * they were wrong it is made in spite of them. */
static void make_hertz(struct segment *p)
{
    if (make_kind(p, SEGMENT_HERTZ_ELASTIC)) {
        return;
    }
    p->may_be_slow = hertz_slow_applies(p);
    if (make_kind(p, SEGMENT_HERTZ)) {
        return;
    }
    if (!p->may_be_slow) {
        (void)make_kind(p, SEGMENT_TAYLOR);
    } else if (!make_kind(p, SEGMENT_HERTZ_SLOW)) {
        p->may_be_slow = false;
        (void)make_kind(p, SEGMENT_HERTZ);
    }
}
#else /* then it is not called */
static void make_hertz(struct segment *p)
{
    (void)p;
}
#endif

/* Where nothing turns, nothing would end a segment. But unless the bodies are head-on their motion is that of
 * the flight without contact and a deviation that nearly cancels it: the flight may be as long as the gap's
 * own rounding bound allows [s]. */
static double longest_by_flight(const struct segment *p)
{
    const double flight = p->gap_rounding / DBL_EPSILON;
    double longest = (double)INFINITY;
    for (int i = 2; i <= SEPARATION_DEGREE; ++i) {
        const double along = fabs(vec3_dot(p->pair.normal, p->pair.flight.c[i]));
        longest = fmin(longest, pow(flight / (SEPARATION_DEGREE * along), 1.0 / i));
    }
    return longest;
}

/* By collocation, where that applies and stays clear of the centre. */
static bool make_collocated(struct segment *p)
{
    enum segment_kind kind = SEGMENT_AVERAGED;
    pair_timescales_make(&p->scales, &p->pair);
    p->as.collocation.from = &p->pair;
    p->as.collocation.felt = p->scales.felt;
    while (kind < SEGMENT_TAYLOR && !make_kind(p, kind)) {
        kind += 1;
    }
    return kind < SEGMENT_TAYLOR && collocated_stays_off_centre(p);
}

#if SCENE_ANY_CAPS
#if SCENE_ANY_HERTZ
/* As make_hertz. */
static bool make_hertz_at_rim(struct segment *p)
{
    p->may_be_slow = hertz_slow_applies(p);
    if (make_kind(p, SEGMENT_RIM) || make_kind(p, SEGMENT_HERTZ_SLOW)) {
        return true;
    }
    p->may_be_slow = false;
    return make_kind(p, SEGMENT_RIM);
}
#else /* then it is not called */
static bool make_hertz_at_rim(struct segment *p)
{
    (void)p;
    return false;
}
#endif

static bool make_at_rim(struct segment *p)
{
    if (!contact_is_rim(&p->pair.shape)) {
        return false;
    }
    return contact_is_hertz(&p->pair.law) ? make_hertz_at_rim(p)
                                          : make_collocated(p) || make_kind(p, SEGMENT_RIM);
}
#else
static bool make_at_rim(struct segment *p)
{
    (void)p;
    return false;
}
#endif

static void make_up_to(struct segment *p, double longest)
{
    p->longest = p->pair.is_head_on ? longest : fmin(longest, longest_by_flight(p));
    if (make_at_rim(p)) {
        /* it has kinds of its own */
    } else if (contact_is_hertz(&p->pair.law)) {
        make_hertz(p);
    } else if (!make_kind(p, SEGMENT_CLOSED_FORM) && !make_collocated(p)) {
        (void)make_kind(p, SEGMENT_TAYLOR);
    }
    if (isnan(p->terminal.s)) {
        p->terminal = terminal_event_first(p);
    }
}

/* `tolerance` bounds the error of the whole segment. If contact ends within its first 0.1 %, that is no
 * longer small: rebuild with twice the contact's length. */
static const double EARLY_EVENT = 1e-3;

#if SCENE_ANY_CAPS
/* A collocated step is most accurate at its end: where a zone ends within, it is made to end there, or a
 * little beyond by this part, so that the edge is found again. */
static const double BEYOND_EDGE = 1e-6;

static void note_zone_end(struct segment *p)
{
    zone_end_note(p);
    if (p->leaves_zone && p->terminal.s > 0.0 && is_collocated(p) && contact_is_rim(&p->pair.shape)) {
        make_up_to(p, p->terminal.s * p->unit * (1.0 + BEYOND_EDGE));
        zone_end_note(p);
    }
}
#else
static void note_zone_end(struct segment *p)
{
    (void)p;
}
#endif

bool segment_make(struct segment *p, const struct scene_values *v, const struct scene_state *q,
                  const struct scene_instant *at, int contact, double longest, double tolerance)
{
    pair_make(&p->pair, v, q, at, contact);
    p->regime = (enum contact_regime)q->contact[contact].regime;
    p->gap_rounding = rounding_of_gap(v, at, contact);
    p->gap_is_known = p->pair.gap == 0.0 || scene_gap_is_accumulated(q, at, contact);
    p->tolerance = tolerance;
    make_up_to(p, longest);
    if (is_collocated(p) && p->terminal.s > 0.0 && p->terminal.s < EARLY_EVENT * p->end) {
        make_up_to(p, 2.0 * p->terminal.s * p->unit);
    }
    terminal_event_at_centre(p);
    note_zone_end(p);
    return p->end > 0.0;
}

const struct pair_sample *segment_sample(struct segment *p, double s)
{
    return dense_output_at(&p->output, s);
}

/* Corrects r along n so that the bodies are as far apart as the gap says. Gap and r are truncated apart, and
 * bodies that part at a gap of zero must not overlap by that. */
static void agree_with_gap(const struct segment *p, struct pair_change *change)
{
    const struct contact_pair *from = &p->pair;
    const struct vec3 none = {0.0, 0.0, 0.0};
    struct vec3 c = vec3_add(path_at(from->flight.c, SEPARATION_DEGREE + 1, change->time), change->r);
    if (change->head_on) {
        return;
    }
    if (!from->starts_rounded) {
        c = vec3_add(c, from->rounded);
    }
    const struct contact_geometry then = contact_geometry_at(&from->shape, c, none, from->normal);
    const double missing = change->gap - then.gap;
    if (fabs(missing) <= p->tolerance) { /* else the gap has its sign beyond a centre */
        change->r = vec3_axpy(change->r, from->shape.side * missing, then.normal);
    }
}

void segment_advance(struct segment *p, double s, const struct scene_values *v, struct scene_state *q,
                     int contact)
{
    struct contact_state *state = &q->contact[contact];
    struct pair_change change = kinds[p->kind].change(&p->as, s);
    agree_with_gap(p, &change);
    peaks_note(p, state, s);
    pair_apply(&p->pair, &change, v, q, contact);
    state->physics.rate_rounding = pair_rate_rounding_after(&p->pair, &change, v, q, contact);
    if (state->physics.rate_rounding > 0.0) {
        state->physics.carried_rate = segment_sample(p, s)->of[PAIR_GAP_RATE][0];
    }
#if SCENE_HAS_TORQUES
    state->torques.destination_impulse =
        vec3_add(state->torques.destination_impulse, torque_impulse(p, kinds[p->kind].change, &change, s));
#endif
}
