#include "solver/peaks.h"

#if SCENE_ANY_FREE

/* Places in one turn of the oscillation: no quantity turns twice in a quarter of it. */
enum { TURN_PLACES = 5 };

/* An oscillation of less than this part of what it is added to adds nothing that is worth the search. */
static const double NEGLIGIBLE = 1e-12;

/* Summits that are so many turns apart are looked at together. */
static const double NEAR = 0.125;

static const struct watched peak_force = {PRESS_FORCE, 1.0, 0.0};
static const struct watched peak_penetration = {PRESS_GAP, -1.0, 0.0};

struct peaks {
    double deepest, strongest;
};

/* A spring alone pushes hardest where it is pressed in deepest. */
static void peaks_add(struct peaks *peaks, const struct piece *p, const struct watch *w, double end,
                      const struct press_sample *then)
{
    const double deepest = watch_largest(w, &peak_penetration, end, then);
    const double strongest =
        p->press.by.c > 0.0 ? watch_largest(w, &peak_force, end, then) : p->press.by.k * deepest;
    peaks->deepest = fmax(peaks->deepest, deepest);
    peaks->strongest = fmax(peaks->strongest, strongest);
}

/* Within one turn about a place, inside the step. */
static void peaks_in_turn(struct peaks *peaks, const struct piece *p, double place, double turn)
{
    struct watch w = {.sampler = p->watch.sampler, .piece = p->watch.piece, .count = TURN_PLACES};
    const double low = fmax(0.0, fmin(place - 0.5 * turn, p->end - turn));
    const double high = fmin(p->end, low + turn);
    for (int i = 0; i < TURN_PLACES; ++i) {
        w.s[i] = low + (high - low) * i / (TURN_PLACES - 1);
    }
    watch_sample(&w);
    peaks_add(peaks, p, &w, high, &w.at[TURN_PLACES - 1]);
}

/* Where load and envelope together are largest. */
struct summit {
    double place;
    bool swings; /* the oscillation matters */
    bool first;  /* it may be larger in the first turn, if it decays */
};

/* Up to half a turn, for within a turn about it is searched. The reserve falls towards it and rises beyond. */
static double summit_between(const struct press_reserve *reserve, double low, double high, double turn)
{
    while (high - low > 0.5 * turn) {
        const double middle = 0.5 * (low + high);
        double left;
        double slope;
        press_reserve_at(reserve, middle, &left, &slope);
        low = slope < 0.0 ? middle : low;
        high = slope < 0.0 ? high : middle;
    }
    return 0.5 * (low + high);
}

static struct summit summit_of(const struct piece *p, const struct watched *what, double turn)
{
    const struct watch *w = &p->watch;
    const struct press_reserve reserve = {&p->by.collocation, what->quantity, -what->factor, 0.0};
    const struct oscillator_envelope envelope = press_envelope_of(&p->by.collocation, what->quantity);
    struct summit summit = {.place = 0.0};
    double left[WATCH_POINTS] = {0.0};
    double slope[WATCH_POINTS] = {0.0};
    double oscillation = 0.0;
    int best = 0;
    for (int i = 0; i < w->count; ++i) {
        press_reserve_from(&reserve, &envelope, w->s[i], &w->at[i], &left[i], &slope[i]);
        oscillation = fmax(oscillation, -left[i] - what->factor * w->at[i].of[what->quantity][0]);
        best = left[i] < left[best] ? i : best;
    }
    summit.swings = oscillation > -NEGLIGIBLE * left[best];
    summit.place = w->s[best];
    if (summit.swings && slope[best] < 0.0 && best + 1 < w->count) {
        summit.place = summit_between(&reserve, w->s[best], w->s[best + 1], turn);
    } else if (summit.swings && slope[best] > 0.0 && best > 0) {
        summit.place = summit_between(&reserve, w->s[best - 1], w->s[best], turn);
    }
    /* What the first turn comes to at most, against what there is without the oscillation. */
    const double early = -left[0] + turn * fabs(what->factor * w->at[0].of[what->quantity][1]);
    summit.first = summit.place > turn && early > what->factor * w->at[best].of[what->quantity][0];
    return summit;
}

/* The nodes of a spanning step do not see the oscillation. */
static void peaks_of_spanning(struct peaks *peaks, const struct piece *p)
{
    const struct oscillator *o = &p->by.collocation.step.oscillator;
    const double turn_square = o->square - 0.25 * o->damping * o->damping;
    if (turn_square > 0.0) {
        const double turn = 6.283185307179586 / sqrt(turn_square);
        const struct summit deepest = summit_of(p, &peak_penetration, turn);
        const struct summit strongest = summit_of(p, &peak_force, turn);
        if (deepest.swings || strongest.swings) {
            peaks_in_turn(peaks, p, deepest.place, turn);
            if (fabs(strongest.place - deepest.place) > NEAR * turn) {
                peaks_in_turn(peaks, p, strongest.place, turn);
            }
            if (deepest.first || strongest.first) {
                peaks_in_turn(peaks, p, 0.0, turn);
            }
            return;
        }
    }
    peaks_add(peaks, p, &p->watch, p->end, &p->watch.at[p->watch.count - 1]);
}

void peaks_note(struct piece *p, struct contact_state *state, double end)
{
    struct peaks peaks = {-(double)INFINITY, -(double)INFINITY};
    if (p->spans && p->kind == PIECE_COLLOCATED) {
        peaks_of_spanning(&peaks, p);
    } else {
        peaks_add(&peaks, p, &p->watch, end, watch_see(&p->watch, end));
    }
    state->peak_force = fmax(state->peak_force, peaks.strongest);
    state->peak_penetration = fmax(state->peak_penetration, peaks.deepest);
}

#endif
