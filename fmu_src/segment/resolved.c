#include "segment/resolved.h"

#include "segment/terminal_event.h"

/* Places at which the first guess of a step of SEGMENT_RESOLVED is looked at: no quantity has two extrema in
 * a radian. */
enum { GUESS_PLACES = 5 };

/* A step ends beyond the contact's end by these parts of its length: the error of the first guess, with a
 * constant load; the least after one sweep; and the part of the shift that the sweep made. */
static const double BEYOND_GUESS = 1e-3;
static const double BEYOND = 1e-6;
static const double BEYOND_SHIFT = 0.02;

/* Smallest length of a step with eight nodes [radians]: oscillator_particular then loses as few digits as
 * with twelve nodes at SEGMENT_SHORTEST. */
static const double SHORTEST_OF_EIGHT = 1.0;

/* The terminal event under a constant load. */
static struct terminal_event guess_terminal_event(struct segment *p, const struct pair_timescales *scales,
                                                  double longest)
{
    struct pair_collocation *made = &p->as.collocation;
    made->from = &p->pair;
    collocation_begin(&made->step, &scales->problem, longest, COLLOCATION_RESOLVED, &lobatto[LOBATTO_EIGHT]);
    p->kind = SEGMENT_COLLOCATED;
    p->event_free = false;
    p->unit = made->step.half;
    p->end = 2.0;
    p->output.sampler = pair_collocation_sample;
    p->output.segment = made;
    p->output.latest_s = -1.0;
    p->output.count = 0;
    for (int i = 0; i < GUESS_PLACES; ++i) {
        dense_output_add(&p->output, p->end * i / (GUESS_PLACES - 1));
    }
    return terminal_event_first(p);
}

/* How far a sweep shifts the event: one Newton step. */
static double shift_of(const struct segment *p, const struct event_function *function, double s)
{
    struct pair_sample at;
    pair_collocation_sample(&p->as.collocation, s, &at);
    return -(function->factor * at.of[function->quantity][0] + function->offset) /
           (function->factor * at.of[function->quantity][1]);
}

/* Sizes a step to end with the contact, expected at `time`. Collocation is most accurate at its end, so fewer
 * nodes suffice. */
static bool until_terminal_event(struct segment *p, const struct event_function *function, double time)
{
    struct collocation *step = &p->as.collocation.step;
    collocation_size(step, time * (1.0 + BEYOND_GUESS));
    const double change = collocation_sweep(step);
    const double s = 2.0 / (1.0 + BEYOND_GUESS);
    const double shift = shift_of(p, function, s);
    if (!(fabs(shift) < BEYOND_GUESS)) {
        return false;
    }
    collocation_size(step, (s + shift) * step->half * (1.0 + fmax(BEYOND, BEYOND_SHIFT * fabs(shift))));
    if (!collocation_finish(step, change, 0.1 * p->tolerance)) {
        return false;
    }
    segment_collocated(p);
    p->terminal = terminal_event_first(p);
    return collocation_error_near_end(step, p->terminal.s) <= p->tolerance;
}

static bool to_the_regime_end(struct segment *p, const struct pair_timescales *scales, double longest)
{
    struct collocation *step = &p->as.collocation.step;
    const double rate = scales->rates.slower;
    const struct terminal_event guess = guess_terminal_event(p, scales, longest);
    const double time = guess.s * step->half;
    if (time * (1.0 + BEYOND_GUESS) > longest || !(time * rate >= SHORTEST_OF_EIGHT)) {
        return false;
    }
    if (until_terminal_event(p, &guess.function, time)) {
        return true;
    }
    if (!(time * rate >= SEGMENT_SHORTEST)) {
        return false;
    }
    collocation_begin(step, &scales->problem, time, COLLOCATION_RESOLVED, &lobatto[LOBATTO_TWELVE]);
    return until_terminal_event(p, &guess.function, time);
}

bool resolved_segment(struct segment *p, const struct pair_timescales *scales, double longest)
{
    const double rate = scales->rates.slower;
    const double step = fmin(longest, SEGMENT_RESOLVED / rate);
    if (!scales->underdamped) {
        return false;
    }
    if (to_the_regime_end(p, scales, step)) {
        return true;
    }
    p->terminal.s = (double)NAN;
    return rate * step >= SEGMENT_SHORTEST &&
           (segment_controlled(p, scales, step, COLLOCATION_RESOLVED) ||
            segment_controlled(p, scales, SEGMENT_SHORTEST / rate, COLLOCATION_RESOLVED));
}
