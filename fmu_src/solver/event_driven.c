#include "solver/event_driven.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "solver/piece.h"

/* What ends the regime by the law: see contact_regime_margin. */
static struct watched margin_of(const struct contact_law *law, enum contact_regime regime)
{
    if (regime == REGIME_PRESSING && law->dashpot == DASHPOT_NON_ADHESIVE) {
        return (struct watched){PRESS_FORCE, 1.0, 0.0};
    }
    return (struct watched){PRESS_RATE, regime == REGIME_RECEDING ? 1.0 : -1.0, 0.0};
}

static int pressing_contact(const struct motion *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(q, j)) {
            return j;
        }
    }
    return -1;
}

struct ending {
    double s;
    enum contact_regime regime;
};

static struct ending first_ending(const struct piece *p, const struct scene_values *v, const struct motion *q,
                                  const struct system_instant *at, int contact)
{
    const struct contact_law *law = &p->press.law;
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    const struct watched parting = {PRESS_GAP, -1.0, 2.0 * system_gap_resolution(v, at, contact)};
    struct ending first = {(double)INFINITY, REGIME_APART};
    if (p->spans) {
        return first;
    }
    first.s = watch_first_fall(&p->watch, &parting);
    if (law->damping > 0.0 && law->dashpot != DASHPOT_UNCLAMPED) {
        struct watched margin = margin_of(law, regime);
        margin.offset = system_margin_armour(v, q, at, contact, 0.0);
        const double s = watch_first_fall(&p->watch, &margin);
        if (s < first.s) {
            first.s = s;
            first.regime = contact_regime_after(law, regime);
        }
    }
    return first;
}

static void note_peaks(const struct piece *p, struct motion *q, int contact, double end)
{
    const struct watched force = {PRESS_FORCE, 1.0, 0.0};
    const struct watched penetration = {PRESS_GAP, -1.0, 0.0};
    struct contact_state *state = &q->contact[contact];
    state->peak_force = fmax(state->peak_force, watch_largest(&p->watch, &force, end));
    state->peak_penetration = fmax(state->peak_penetration, watch_largest(&p->watch, &penetration, end));
}

/* The error allowed in a piece: of what the user asks for a thousandth, for impacts multiply errors, and no less than what
 * rounding leaves. */
static double tolerance_of(const struct scene_values *v, const struct system_instant *at, int contact)
{
    const double size = at->geometry[contact].distance;
    const double asked = solver_relative_tolerance(v) * size + solver_absolute_tolerance(v);
    return fmax(1e-3 * asked, 8.0 * DBL_EPSILON * size);
}

enum advance_result event_driven_advance(const struct scene_values *v, struct motion *q, struct advance *step)
{
    const int contact = pressing_contact(q);
    if (SCENE_CONTACTS > 1) {
        return ADVANCE_FAILED;
    }
    while (q->clock < step->clock_end) {
        struct system_instant at;
        struct piece p;
        if (step->budget-- <= 0) {
            return ADVANCE_STEP_LIMIT;
        }
        system_now(v, q, &at);
        const double left = step->clock_end - q->clock;
        if (at.geometry[contact].degenerate ||
            !piece_make(&p, v, q, &at, contact, left, tolerance_of(v, &at, contact))) {
            return ADVANCE_FAILED;
        }
        const struct ending ending = first_ending(&p, v, q, &at, contact);
        const double s = fmin(ending.s, p.end);
        note_peaks(&p, q, contact, s);
        const struct press_change change = piece_change(&p, s);
        press_apply(&p.press, &change, v, q, contact);
        q->counters.steps += 1;
        q->counters.force_evaluations += 1;
        if (ending.s <= p.end) {
            step->contact = contact;
            step->regime = ending.regime;
            return ADVANCE_EVENT;
        }
        if (p.end * p.unit >= left) {
            q->clock = step->clock_end;
        }
    }
    return ADVANCE_REACHED;
}

#endif
