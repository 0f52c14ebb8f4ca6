#include "solver/straight_piece.h"

#if SCENE_ANY_FREE

#include "solver/ending.h"

static const double PI = 3.141592653589793;

/* Where the gap, its rate and the force turn, each at most once: beyond, where nothing may be left of them, they only fade. */
static void watch_decay(struct piece *p)
{
    struct watch *w = &p->watch;
    for (int order = 1; order <= DECAY_DERIVATIVES; ++order) {
        const double turn = decay_zero(&p->by.straight.decay, order);
        if (turn > 0.0 && turn < p->end) {
            watch_place(w, turn);
        }
    }
    watch_place(w, p->end);
}

/* From turn to turn of the gap, two of them at most. No two places are further apart than half a turn of the oscillation: no quantity
 * turns twice between them. */
static void watch_turns(struct piece *p)
{
    const struct press_straight *made = &p->by.straight;
    struct watch *w = &p->watch;
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
    double end = longest / p->unit;
    if (end * p->unit < longest) {
        end = nextafter(end, (double)INFINITY);
    }
    p->end = fmin(end, press_straight_longest(made, p->resolution));
    p->watch.sampler = press_straight_sample;
    p->watch.piece = made;
    p->watch.count = 0;
    watch_place(&p->watch, 0.0);
    if (made->turn > 0.0) {
        watch_turns(p);
    } else {
        watch_decay(p);
    }
    p->spans = straight_spans(p);
    p->end = p->spans ? end : p->watch.s[p->watch.count - 1];
    return true;
}

#endif
