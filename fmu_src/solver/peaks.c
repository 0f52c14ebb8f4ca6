#include "solver/peaks.h"

#if SCENE_ANY_FREE

/* Places in one turn of the oscillation. */
enum { TURN_PLACES = 9 };

/* An oscillation of less than this part of what it is added to adds nothing that is worth the search. */
static const double NEGLIGIBLE = 1e-12;

/* Within one turn that begins at `from`, inside the step. */
static double largest_in_turn(const struct piece *p, const struct watched *what, double from, double turn)
{
    struct watch w = {.sampler = p->watch.sampler, .piece = p->watch.piece, .count = TURN_PLACES};
    const double low = fmax(0.0, fmin(from, p->end - turn));
    const double high = fmin(p->end, low + turn);
    for (int i = 0; i < TURN_PLACES; ++i) {
        w.s[i] = low + (high - low) * i / (TURN_PLACES - 1);
    }
    watch_sample(&w);
    return watch_largest(&w, what, high, &w.at[TURN_PLACES - 1]);
}

/* The nodes of a spanning step do not see the oscillation. Its largest value is within a turn of the place where load and
 * envelope together are largest, or in the first one, if the oscillation decays. */
static double largest_spanning(const struct piece *p, const struct watched *what)
{
    const struct press_collocation *made = &p->by.collocation;
    const struct press_reserve reserve = {made, what->quantity, -what->factor, 0.0};
    const struct oscillator *o = &made->step.oscillator;
    const double turn_square = o->square - 0.25 * o->damping * o->damping;
    double best = 0.0;
    double height = -(double)INFINITY;
    double oscillation = 0.0;
    const struct oscillator_envelope envelope = press_envelope_of(made, what->quantity);
    for (int i = 0; i < p->watch.count; ++i) {
        double reached;
        double slope;
        press_reserve_from(&reserve, &envelope, p->watch.s[i], &p->watch.at[i], &reached, &slope);
        const double slow = what->factor * p->watch.at[i].of[what->quantity][0];
        oscillation = fmax(oscillation, -reached - slow);
        if (-reached > height) {
            height = -reached;
            best = p->watch.s[i];
        }
    }
    if (!(turn_square > 0.0) || oscillation <= NEGLIGIBLE * height) {
        return watch_largest(&p->watch, what, p->end, &p->watch.at[p->watch.count - 1]);
    }
    const double turn = 6.283185307179586 / sqrt(turn_square);
    return fmax(largest_in_turn(p, what, 0.0, turn), largest_in_turn(p, what, best - 0.5 * turn, turn));
}

void peaks_note(struct piece *p, struct contact_state *state, double end)
{
    const struct watched force = {PRESS_FORCE, 1.0, 0.0};
    const struct watched penetration = {PRESS_GAP, -1.0, 0.0};
    double deepest;
    double strongest;
    if (p->spans && p->kind == PIECE_COLLOCATED) {
        deepest = largest_spanning(p, &penetration);
        strongest = largest_spanning(p, &force);
    } else {
        const struct press_sample *then = watch_see(&p->watch, end);
        deepest = watch_largest(&p->watch, &penetration, end, then);
        /* A spring alone pushes hardest where it is pressed in deepest. */
        strongest =
            p->press.by.c > 0.0 ? watch_largest(&p->watch, &force, end, then) : p->press.by.k * deepest;
    }
    state->peak_force = fmax(state->peak_force, strongest);
    state->peak_penetration = fmax(state->peak_penetration, deepest);
}

#endif
