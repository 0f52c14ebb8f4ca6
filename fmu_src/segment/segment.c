#include "segment/segment.h"

#include "scene/rounding.h"
#include "segment/averaged.h"
#include "segment/closed_form.h"
#include "segment/resolved.h"
#include "segment/terminal_event.h"

/* Radians of the tangential motion in an overdamped step. An event may end it anywhere, so it must be
 * accurate between its ends too. */
static const double OVERDAMPED_STEP = 1.0;

/* In an overdamped step from near the centre d grows at most by this factor: n' is proportional to 1 /
 * d^2. */
static const double OVERDAMPED_GROWTH = 4.0;

enum { ATTEMPTS = 12 };

static void taylor_segment(struct segment *p, double longest)
{
    pair_taylor_make(&p->as.taylor, &p->pair);
    p->kind = SEGMENT_TAYLOR;
    p->event_free = false;
    p->unit = p->as.taylor.unit;
    p->end = fmin(p->as.taylor.step, longest / p->unit);
    p->output.sampler = pair_taylor_sample;
    p->output.segment = &p->as.taylor;
    p->output.latest_s = -1.0;
    /* A step is a fifth of the radius of convergence at most (TAYLOR_ORDER); within a quarter of it, a
     * twentieth of the radius, no quantity of the contact has two extrema. */
    p->output.count = 5;
    for (int i = 0; i < p->output.count; ++i) {
        p->output.s[i] = p->end * i / (p->output.count - 1);
    }
    dense_output_sample(&p->output);
}

/* Samples at 0.5, 1, 2, 4, ... fast decay times, before the nodes: between two samples no quantity has two
 * extrema. */
static void add_decay_samples(struct segment *p)
{
    const struct lobatto *nodes = p->as.collocation.step.nodes;
    const double first = 0.5 / oscillator_rates_of(&p->as.collocation.step.oscillator).faster;
    double s = 0.0;
    while (s < 1.0 + nodes->node[2] && p->output.count < DENSE_OUTPUT_POINTS - LOBATTO_MAX) {
        pair_collocation_sample(&p->as.collocation, s, &p->output.at[p->output.count]);
        p->output.s[p->output.count++] = s;
        s = fmax(first, 2.0 * s);
    }
}

void segment_collocated(struct segment *p)
{
    p->kind = SEGMENT_COLLOCATED;
    p->event_free = p->as.collocation.step.kind == COLLOCATION_AVERAGED;
    p->unit = p->as.collocation.step.half;
    p->end = 2.0;
    p->output.sampler = pair_collocation_sample;
    p->output.segment = &p->as.collocation;
    p->output.latest_s = -1.0;
    p->output.count = 0;
    if (p->as.collocation.step.kind == COLLOCATION_OVERDAMPED) {
        add_decay_samples(p);
    }
    const struct lobatto *nodes = p->as.collocation.step.nodes;
    for (int i = 0; i < nodes->points; ++i) {
        const double s = 1.0 + nodes->node[i];
        if (p->output.count == 0 || s > p->output.s[p->output.count - 1]) {
            struct pair_sample *at = &p->output.at[p->output.count];
            if (p->event_free) {
                pair_collocation_sample_averaged(&p->as.collocation, s, at);
            } else {
                pair_collocation_sample_node(&p->as.collocation, i, at);
            }
            p->output.s[p->output.count++] = s;
        }
    }
}

bool segment_controlled(struct segment *p, const struct pair_timescales *scales, double step,
                        enum collocation_kind kind)
{
    if (!pair_collocation_make(&p->as.collocation, &p->pair, scales, step, kind, &lobatto[LOBATTO_TWELVE],
                               0.1 * p->tolerance) ||
        !(p->as.collocation.step.interior_error <= p->tolerance)) {
        return false;
    }
    segment_collocated(p);
    return true;
}

/* Whether an overdamped step may leave out what it does of a fast decay of such an amplitude [m]. */
static bool may_creep(const struct segment *p, const struct pair_timescales *scales, double step,
                      double decay)
{
    const double tangential_rate = press_turning_within(scales, step);
    const double ratio = tangential_rate / scales->rates.faster;
    return scales->rates.faster >= SEPARATION_OF_RATES * tangential_rate &&
           averaged_error(decay, ratio, scales->problem.reach, ratio) <= p->tolerance;
}

static bool overdamped_segment(struct segment *p, const struct pair_timescales *scales, double longest)
{
    const double faster = scales->rates.faster;
    const double slower = scales->rates.slower;
    if (scales->underdamped || faster < 4.0 * slower) {
        return false;
    }
    double step = press_step_within(scales, fmin(longest, SEGMENT_SHORTEST / slower), OVERDAMPED_STEP);
    if (press_turning_within(scales, step) > 0.0) {
        step = fmin(step, OVERDAMPED_GROWTH * p->pair.distance / vec3_norm(scales->problem.rate));
    }
    double decay = 0.0;
    for (int i = 0; i < ATTEMPTS && step * faster >= SEGMENT_SHORTEST; ++i) {
        if (may_creep(p, scales, step, decay) &&
            segment_controlled(p, scales, step, COLLOCATION_OVERDAMPED)) {
            decay = fabs(p->as.collocation.step.y);
            if (may_creep(p, scales, step, decay)) {
                return true;
            }
        }
        step *= 0.5;
    }
    return false;
}

/* Part of the reach. Where a node is nearer to the centre than this, the motion between the nodes may be
 * nearer still, and d = reach + x loses digits. */
static const double NEAR_CENTRE = 0.1;

/* Whether local coordinates are accurate throughout a collocated segment. */
static bool stays_off_centre(const struct segment *p)
{
    const struct collocation *step = &p->as.collocation.step;
    double nearest = step->from.reach;
    for (int i = 0; i < step->nodes->points; ++i) {
        nearest = fmin(nearest, step->from.reach + step->x[i]);
    }
    if (step->head_on || nearest > NEAR_CENTRE * step->from.reach) {
        return true;
    }
    return step->kind == COLLOCATION_OVERDAMPED && !(segment_meets_centre(p) < (double)INFINITY);
}

static bool collocate(struct segment *p, double longest)
{
    const struct pair_timescales scales = pair_timescales_of(&p->pair);
    if (!(scales.rates.faster * longest >= SEGMENT_SHORTEST) || !(scales.problem.reach > 0.0)) {
        return false;
    }
    if (!(scales.rates.faster >= SEPARATION_OF_RATES * scales.tangential_rate)) {
        return false;
    }
    if (scales.rates.slower >= SEPARATION_OF_RATES * scales.tangential_rate &&
        averaged_segment(p, &scales, longest)) {
        return true;
    }
    return resolved_segment(p, &scales, longest) || overdamped_segment(p, &scales, longest);
}

static void segment_over(struct segment *p, double longest)
{
    p->output.latest_s = -1.0;
    p->terminal.s = (double)NAN;
    if (!closed_form_make(p, longest) && !(collocate(p, longest) && stays_off_centre(p))) {
        p->terminal.s = (double)NAN;
        taylor_segment(p, longest);
    }
    if (isnan(p->terminal.s)) {
        p->terminal = terminal_event_first(p);
    }
}

/* `tolerance` bounds the error of the whole segment. If contact ends within its first 0.1 %, that is no
 * longer small: rebuild with twice the contact's length. */
static const double EARLY_EVENT = 1e-3;

bool segment_make(struct segment *p, const struct scene_values *v, const struct scene_state *q,
                  const struct scene_instant *at, int contact, double longest, double tolerance)
{
    pair_make(&p->pair, v, q, at, contact);
    p->regime = (enum contact_regime)q->contact[contact].regime;
    p->gap_rounding = rounding_of_gap(v, at, contact);
    p->tolerance = tolerance;
    segment_over(p, longest);
    if (p->kind == SEGMENT_COLLOCATED && p->terminal.s > 0.0 && p->terminal.s < EARLY_EVENT * p->end) {
        segment_over(p, 2.0 * p->terminal.s * p->unit);
    }
    terminal_event_at_centre(p);
    return p->end > 0.0;
}

/* Between two samples a quantity may have one extremum larger than both, but less than four times as
 * large. */
static bool stays_clear_of_centre(const struct segment *p)
{
    double deepest = 0.0;
    for (int i = 0; i < p->output.count; ++i) {
        deepest = fmax(deepest, fabs(p->output.at[i].of[PAIR_GAP][0]));
    }
    return 4.0 * deepest < contact_reach(&p->pair.shape);
}

double segment_meets_centre(const struct segment *p)
{
    if (p->kind == SEGMENT_CLOSED_FORM || p->pair.shape.side < 0 || stays_clear_of_centre(p)) {
        return (double)INFINITY; /* made where it cannot; in a hollow body it parts before */
    }
    const struct event_function distance = {PAIR_GAP, p->pair.shape.side, contact_reach(&p->pair.shape)};
    return dense_output_first_event(&p->output, &distance);
}

struct pair_change segment_change(const struct segment *p, double s)
{
    switch (p->kind) {
    case SEGMENT_CLOSED_FORM:
        return pair_oscillation_change(&p->as.oscillation, s);
    case SEGMENT_COLLOCATED:
        return pair_collocation_change(&p->as.collocation, s);
    default:
        return pair_taylor_change(&p->as.taylor, s);
    }
}
