#include "solver/straight_piece.h"

#if SCENE_ANY_FREE

#include "solver/ending.h"

static const double FULL_TURN = 6.283185307179586;
enum { QUARTERS = 4 };

/* A turn of the oscillation. No two places are further apart than a quarter of it: no quantity turns twice between them. */
static void watch_straight(struct piece *p)
{
    const double until = fmin(p->end, FULL_TURN / p->by.straight.turn);
    const int parts = (int)fmin(QUARTERS, 1.0 + QUARTERS * until * p->by.straight.turn / FULL_TURN);
    p->watch.sampler = press_straight_sample;
    p->watch.piece = &p->by.straight;
    p->watch.count = parts + 1;
    for (int i = 0; i <= parts; ++i) {
        p->watch.s[i] = until * i / parts;
    }
    watch_sample(&p->watch);
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
