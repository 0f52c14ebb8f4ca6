#include "solver/peaks.h"

#if SCENE_ANY_FREE

#include <float.h>

/* Places in one turn of the oscillation: no quantity turns twice in a quarter of it. */
enum { TURN_PLACES = 5 };

/* An oscillation of less than this part of what it is added to adds nothing that is worth the search. */
static const double NEGLIGIBLE = 1e-12;

/* Summits that are so many turns apart are looked at together. */
static const double NEAR = 0.125;

/* A turn of fewer representable places than this is not searched: its largest value could no longer be told to rounding, for it
 * is missed by (2 pi / places)^2 / 8 of the oscillation at most. */
static const double PLACES_OF_TURN = 4096.0;

/* The envelope of an oscillation is a bound that nothing reaches where its square of turn is less than this part of that of its
 * decay (oscillator_envelope_of): it dies away within a turn. */
static const double HARDLY_TURNS = 1.0 / 16.0;

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

/* Up to half a turn, for within a turn about it is searched, or to the last digit. The reserve falls towards it and rises beyond. */
static double summit_between(const struct press_reserve *reserve, double low, double high, double turn)
{
    double middle = 0.5 * (low + high);
    while (high - low > 0.5 * turn && middle > low && middle < high) {
        double left;
        double slope;
        press_reserve_at(reserve, middle, &left, &slope);
        low = slope < 0.0 ? middle : low;
        high = slope < 0.0 ? high : middle;
        middle = 0.5 * (low + high);
    }
    return middle;
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

/* Load and envelope together. */
static double height_at(const struct piece *p, const struct watched *what, double place)
{
    const struct press_reserve reserve = {&p->by.collocation, what->quantity, -what->factor, 0.0};
    double left;
    double slope;
    press_reserve_at(&reserve, place, &left, &slope);
    return -left;
}

/* About a place: within a turn, or, where a turn has no places to speak of, at the top of one. */
static void peaks_about(struct peaks *peaks, const struct piece *p, double place, double turn)
{
    if (turn > PLACES_OF_TURN * DBL_EPSILON * place) {
        peaks_in_turn(peaks, p, place, turn);
        return;
    }
    const double deepest = height_at(p, &peak_penetration, place);
    const double strongest = p->press.by.c > 0.0 ? height_at(p, &peak_force, place) : p->press.by.k * deepest;
    peaks->deepest = fmax(peaks->deepest, deepest);
    peaks->strongest = fmax(peaks->strongest, strongest);
}

/* Further nodes at which a quantity might be larger than the largest so far: one whose oscillation decays may not reach its envelope
 * where that is highest. */
static void peaks_elsewhere(struct peaks *peaks, const struct piece *p, const struct watched *what,
                            const double *largest, double turn)
{
    const struct press_reserve reserve = {&p->by.collocation, what->quantity, -what->factor, 0.0};
    const struct oscillator_envelope envelope = press_envelope_of(&p->by.collocation, what->quantity);
    for (int i = 0; i < p->watch.count; ++i) {
        double left;
        double slope;
        press_reserve_from(&reserve, &envelope, p->watch.s[i], &p->watch.at[i], &left, &slope);
        if (-left > *largest + NEGLIGIBLE * fabs(*largest)) {
            peaks_about(peaks, p, p->watch.s[i], turn);
        }
    }
}

static void peaks_of_swinging(struct peaks *peaks, const struct piece *p, double turn)
{
    const struct summit deepest = summit_of(p, &peak_penetration, turn);
    const struct summit strongest = summit_of(p, &peak_force, turn);
    if (!deepest.swings && !strongest.swings) {
        peaks_add(peaks, p, &p->watch, p->end, &p->watch.at[p->watch.count - 1]);
        return;
    }
    peaks_about(peaks, p, deepest.place, turn);
    if (fabs(strongest.place - deepest.place) > NEAR * turn) {
        peaks_about(peaks, p, strongest.place, turn);
    }
    if (deepest.first || strongest.first) {
        peaks_about(peaks, p, 0.0, turn);
    }
    peaks_elsewhere(peaks, p, &peak_penetration, &peaks->deepest, turn);
    peaks_elsewhere(peaks, p, &peak_force, &peaks->strongest, turn);
}

/* Between places that double, from half the fast decay's time on, and the nodes: what decays turns as the exponentials do, what
 * follows the load as the nodes show. In portions of the places that there is room for. */
static void peaks_of_decaying(struct peaks *peaks, const struct piece *p, double faster)
{
    struct watch w = {.sampler = p->watch.sampler, .piece = p->watch.piece, .count = 0};
    double place = 0.0;
    int next = 0;
    for (;;) {
        watch_place(&w, place);
        if (w.count == WATCH_POINTS || !(place < p->end)) {
            peaks_add(peaks, p, &w, place, &w.at[w.count - 1]);
            w.s[0] = w.s[w.count - 1];
            w.at[0] = w.at[w.count - 1];
            w.count = 1;
        }
        if (!(place < p->end)) {
            return;
        }
        while (next < p->watch.count && !(p->watch.s[next] > place)) {
            next += 1;
        }
        place = fmin(fmax(0.5 / faster, 2.0 * place), next < p->watch.count ? p->watch.s[next] : p->end);
    }
}

/* The nodes of a spanning step do not see the oscillation. */
static void peaks_of_spanning(struct peaks *peaks, const struct piece *p)
{
    const struct oscillator *o = &p->by.collocation.step.oscillator;
    const double decay_square = 0.25 * o->damping * o->damping;
    const double turn_square = o->square - decay_square;
    if (turn_square > HARDLY_TURNS * decay_square) {
        peaks_of_swinging(peaks, p, 6.283185307179586 / sqrt(turn_square));
    } else {
        peaks_of_decaying(peaks, p, oscillator_rates_of(o).faster);
    }
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
