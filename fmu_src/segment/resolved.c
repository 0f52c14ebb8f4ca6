#include "segment/kinds.h"
#include "segment/terminal_event.h"

/* Places at which the first guess of a step of RESOLVED_LENGTH is looked at: no quantity has two extrema in
 * a radian. */
enum { GUESS_PLACES = 5 };

/* A step ends beyond the contact's end by these parts of its length: the error of the first guess, with a
 * constant load; the least after one sweep; and the part of the shift that the sweep made. */
static const double BEYOND_GUESS = 1e-3;
static const double BEYOND = 1e-6;
static const double BEYOND_SHIFT = 0.02;

/* Smallest length of a step with eight nodes [radians]: oscillator_particular then loses as few digits as
 * with twelve nodes at COLLOCATED_SHORTEST. */
static const double SHORTEST_OF_EIGHT = 1.0;

/* The terminal event under a constant load. */
static struct terminal_event guess_terminal_event(struct segment *p, double longest)
{
    struct pair_collocation *made = &p->as.collocation;
    collocation_begin(&made->step, &p->scales.problem, longest, COLLOCATION_RESOLVED,
                      &lobatto[LOBATTO_EIGHT]);
    collocated_begin(p);
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
static bool fit_to_terminal_event(struct segment *p, const struct event_function *function, double time)
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
    collocated_sample(p);
    p->terminal = terminal_event_first(p);
    return collocation_error_near_end(step, p->terminal.s) <= p->tolerance;
}

static bool make_to_terminal_event(struct segment *p, double longest)
{
    struct collocation *step = &p->as.collocation.step;
    const double rate = p->scales.rates.slower;
    const struct terminal_event guess = guess_terminal_event(p, longest);
    const double time = guess.s * step->half;
    if (time * (1.0 + BEYOND_GUESS) > longest || !(time * rate >= SHORTEST_OF_EIGHT)) {
        return false;
    }
    if (fit_to_terminal_event(p, &guess.function, time)) {
        return true;
    }
    if (!(time * rate >= COLLOCATED_SHORTEST)) {
        return false;
    }
    collocation_begin(step, &p->scales.problem, time, COLLOCATION_RESOLVED, &lobatto[LOBATTO_TWELVE]);
    return fit_to_terminal_event(p, &guess.function, time);
}

bool resolved_applies(const struct segment *p)
{
    return collocated_applies(p) && p->scales.underdamped;
}

bool resolved_make(struct segment *p)
{
    const double rate = p->scales.rates.slower;
    const double step = fmin(p->longest, RESOLVED_LENGTH / rate);
    if (make_to_terminal_event(p, step)) {
        return true;
    }
    p->terminal.s = (double)NAN;
    return rate * step >= COLLOCATED_SHORTEST &&
           (collocated_make(p, step, COLLOCATION_RESOLVED) ||
            collocated_make(p, COLLOCATED_SHORTEST / rate, COLLOCATION_RESOLVED));
}
