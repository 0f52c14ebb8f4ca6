#include "solver/resolved.h"

#if SCENE_ANY_FREE

#include "solver/ending.h"

/* Places at which the first guess of a step of PIECE_RESOLVED is looked at: no quantity turns twice in a radian. */
enum { GUESS_PLACES = 5 };

/* A step goes on beyond the place where the contact ends by so much of itself: what the guess may be off, first with the load as it
 * begins, then after a sweep, which may be off by a part of what it has moved that place. */
static const double BEYOND_GUESS = 1e-3;
static const double BEYOND = 1e-6;
static const double BEYOND_SHIFT = 0.02;

/* The load in a step of half the radians and eight nodes is answered with as few digits lost as in one of PIECE_SHORTEST by twelve
 * (oscillator_follow). */
static const double SHORTEST_OF_EIGHT = 1.0;

/* Where the contact ends if its load stays as it begins. */
static struct ending guess_ending(struct piece *p, const struct press_outlook *outlook, double longest)
{
    struct press_collocation *made = &p->by.collocation;
    made->from = &p->press;
    collocation_begin(&made->step, &outlook->problem, longest, COLLOCATION_RESOLVED, &lobatto[LOBATTO_EIGHT]);
    p->kind = PIECE_COLLOCATED;
    p->spans = false;
    p->unit = made->step.half;
    p->end = 2.0;
    p->watch.sampler = press_collocation_sample;
    p->watch.piece = made;
    p->watch.seen_s = -1.0;
    p->watch.count = 0;
    for (int i = 0; i < GUESS_PLACES; ++i) {
        watch_place(&p->watch, p->end * i / (GUESS_PLACES - 1));
    }
    return ending_first(p);
}

/* The place again after a sweep, which moves it by little: one step of Newton's method. */
static double shift_of(const struct piece *p, const struct watched *by, double s)
{
    struct press_sample at;
    press_collocation_sample(&p->by.collocation, s, &at);
    return -(by->factor * at.of[by->quantity][0] + by->offset) / (by->factor * at.of[by->quantity][1]);
}

/* A step begun that is to end with the contact, guessed to be at `time`. There collocation is at its best: fewer nodes do. */
static bool until_ending(struct piece *p, const struct watched *by, double time)
{
    struct collocation *step = &p->by.collocation.step;
    collocation_size(step, time * (1.0 + BEYOND_GUESS));
    const double change = collocation_sweep(step);
    const double s = 2.0 / (1.0 + BEYOND_GUESS);
    const double shift = shift_of(p, by, s);
    if (!(fabs(shift) < BEYOND_GUESS)) {
        return false;
    }
    collocation_size(step, (s + shift) * step->half * (1.0 + fmax(BEYOND, BEYOND_SHIFT * fabs(shift))));
    if (!collocation_finish(step, change, 0.1 * p->tolerance)) {
        return false;
    }
    piece_collocated(p);
    p->ending = ending_first(p);
    return collocation_error_near_end(step, p->ending.s) <= p->tolerance;
}

static bool to_the_end(struct piece *p, const struct press_outlook *outlook, double longest)
{
    struct collocation *step = &p->by.collocation.step;
    const double rate = outlook->rates.slower;
    const struct ending guess = guess_ending(p, outlook, longest);
    const double time = guess.s * step->half;
    if (time * (1.0 + BEYOND_GUESS) > longest || !(time * rate >= SHORTEST_OF_EIGHT)) {
        return false;
    }
    if (until_ending(p, &guess.by, time)) {
        return true;
    }
    if (!(time * rate >= PIECE_SHORTEST)) {
        return false;
    }
    collocation_begin(step, &outlook->problem, time, COLLOCATION_RESOLVED, &lobatto[LOBATTO_TWELVE]);
    return until_ending(p, &guess.by, time);
}

bool resolved_piece(struct piece *p, const struct press_outlook *outlook, double longest)
{
    const double rate = outlook->rates.slower;
    const double step = fmin(longest, PIECE_RESOLVED / rate);
    if (!outlook->swings) {
        return false;
    }
    if (to_the_end(p, outlook, step)) {
        return true;
    }
    p->ending.s = (double)NAN;
    return rate * step >= PIECE_SHORTEST &&
           (piece_watched(p, outlook, step, COLLOCATION_RESOLVED) ||
            piece_watched(p, outlook, PIECE_SHORTEST / rate, COLLOCATION_RESOLVED));
}

#endif
