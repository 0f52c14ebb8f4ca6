#include "solver/straight_piece.h"

#if SCENE_ANY_FREE

#include "solver/ending.h"

static const double PI = 3.141592653589793;

/* From turn to turn of the gap, two of them at most. No two places are further apart than half a turn of the oscillation: no quantity
 * turns twice between them. */
static void watch_straight(struct piece *p)
{
    const struct press_straight *made = &p->by.straight;
    struct watch *w = &p->watch;
    w->sampler = press_straight_sample;
    w->piece = &p->by.straight;
    w->count = 0;
    watch_place(w, 0.0);
    bool deepest = press_straight_closes(made);
    double turn = press_straight_first_turn(made);
    for (; w->count < 3 && turn < p->end; turn += PI / made->turn) {
        press_straight_sample_turn(made, turn, deepest, &w->at[w->count]);
        w->s[w->count++] = turn;
        deepest = !deepest;
    }
    if (w->count < 3) {
        watch_place(w, p->end);
    }
}

/* Whether the bodies neither part nor change their regime any more. */
static bool straight_spans(const struct piece *p)
{
    const struct press_straight *made = &p->by.straight;
    if (!press_straight_keeps(made, PRESS_GAP, -1.0, ending_gap_slack(p))) {
        return false;
    }
    const struct watched margin = ending_margin(p);
    return !ending_by_law(p) || press_straight_keeps(made, margin.quantity, margin.factor, margin.offset);
}

bool straight_piece_make(struct piece *p, double longest)
{
    struct press_straight *made = &p->by.straight;
    if (!press_straight_make(made, &p->press)) {
        return false;
    }
    p->kind = PIECE_STRAIGHT;
    p->unit = 1.0 / made->rate;
    p->end = longest / p->unit;
    if (p->end * p->unit < longest) {
        p->end = nextafter(p->end, (double)INFINITY);
    }
    watch_straight(p);
    p->spans = straight_spans(p);
    if (!p->spans) {
        p->end = p->watch.s[p->watch.count - 1];
    }
    return true;
}

#endif
