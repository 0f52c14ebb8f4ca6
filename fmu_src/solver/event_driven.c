#include "solver/event_driven.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "contact/bracket.h"
#include "dynamics/press.h"

/* A step is a fifth of the radius of convergence at most (SERIES_ORDER); within a quarter of it, a twentieth of the radius,
 * no quantity of the contact turns twice. */
enum { PIECES = 4 };

/* A series and what is added to it, as bracket_root wants it. */
struct watched {
    const double *series;
    double factor, offset;
};

static void watched_at(const void *data, double s, double *value, double *slope)
{
    const struct watched *f = data;
    *value = f->factor * series_at(f->series, SERIES_TERMS, s) + f->offset;
    *slope = f->factor * series_slope(f->series, SERIES_TERMS, s);
}

static double value_at(const struct watched *f, double s)
{
    return f->factor * series_at(f->series, SERIES_TERMS, s) + f->offset;
}

static double slope_at(const struct watched *f, double s)
{
    return f->factor * series_slope(f->series, SERIES_TERMS, s);
}

static void slope_watched(const void *data, double s, double *value, double *slope)
{
    const struct watched *f = data;
    double second = 0.0;
    for (int i = SERIES_TERMS - 1; i >= 2; --i) {
        second = second * s + i * (i - 1) * f->series[i];
    }
    *value = slope_at(f, s);
    *slope = f->factor * second;
}

/* The first s in (0, end] at which f falls through zero, end excluded only by not falling; INFINITY if it does not. */
static double first_fall(const struct watched *f, double end)
{
    double low = 0.0;
    double at_low = value_at(f, low);
    for (int i = 1; i <= PIECES; ++i) {
        const double high = end * i / PIECES;
        const double at_high = value_at(f, high);
        if (at_low > 0.0 && at_high <= 0.0) {
            return bracket_root(watched_at, f, low, high);
        }
        if (at_low > 0.0 && slope_at(f, low) < 0.0 && slope_at(f, high) > 0.0) {
            const double dip = bracket_root(slope_watched, f, low, high);
            if (value_at(f, dip) <= 0.0) {
                return bracket_root(watched_at, f, low, dip);
            }
        }
        low = high;
        at_low = at_high;
    }
    return (double)INFINITY;
}

/* Largest value of a series in [0, end]: at the ends of the pieces or where the slope passes zero between them. */
static double largest_of(const double *series, double factor, double end)
{
    const struct watched f = {series, factor, 0.0};
    double largest = fmax(value_at(&f, 0.0), value_at(&f, end));
    for (int i = 1; i <= PIECES; ++i) {
        const double low = end * (i - 1) / PIECES;
        const double high = end * i / PIECES;
        if (slope_at(&f, low) > 0.0 && slope_at(&f, high) < 0.0) {
            largest = fmax(largest, value_at(&f, bracket_root(slope_watched, &f, low, high)));
        }
    }
    return largest;
}

/* What ends the regime by the law: see contact_regime_margin. */
static struct watched margin_of(const struct press *p, const struct contact_law *law,
                                enum contact_regime regime)
{
    if (regime == REGIME_PRESSING && law->dashpot == DASHPOT_NON_ADHESIVE) {
        return (struct watched){p->force, 1.0, 0.0};
    }
    return (struct watched){p->rate, regime == REGIME_RECEDING ? 1.0 : -1.0, 0.0};
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

static struct ending first_ending(const struct press *p, const struct scene_values *v, const struct motion *q,
                                  const struct system_instant *at, int contact, double end)
{
    const struct contact_law law = system_law(v, q, contact);
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    const struct watched parting = {p->gap, -1.0, 2.0 * system_gap_resolution(v, at, contact)};
    struct ending first = {first_fall(&parting, end), REGIME_APART};
    if (law.damping > 0.0 && law.dashpot != DASHPOT_UNCLAMPED) {
        struct watched margin = margin_of(p, &law, regime);
        margin.offset = system_margin_armour(v, q, at, contact, 0.0);
        const double s = first_fall(&margin, end);
        if (s < first.s) {
            first.s = s;
            first.regime = contact_regime_after(&law, regime);
        }
    }
    return first;
}

static void note_peaks(const struct press *p, struct motion *q, int contact, double end)
{
    struct contact_state *state = &q->contact[contact];
    state->peak_force = fmax(state->peak_force, largest_of(p->force, 1.0, end));
    state->peak_penetration = fmax(state->peak_penetration, largest_of(p->gap, -1.0, end));
}

enum advance_result event_driven_advance(const struct scene_values *v, struct motion *q, struct advance *step)
{
    const int contact = pressing_contact(q);
    if (SCENE_CONTACTS > 1) {
        return ADVANCE_FAILED;
    }
    while (q->clock < step->clock_end) {
        struct system_instant at;
        struct press p;
        if (step->budget-- <= 0) {
            return ADVANCE_STEP_LIMIT;
        }
        system_now(v, q, &at);
        if (at.geometry[contact].degenerate) {
            return ADVANCE_FAILED;
        }
        press_make(&p, v, q, &at, contact);
        const double left = (step->clock_end - q->clock) / p.unit;
        const double end = fmin(p.step, left);
        if (!(end > 0.0)) {
            return ADVANCE_FAILED;
        }
        const struct ending ending = first_ending(&p, v, q, &at, contact, end);
        const double s = fmin(ending.s, end);
        note_peaks(&p, q, contact, s);
        press_advance(&p, v, q, contact, s);
        q->counters.steps += 1;
        q->counters.force_evaluations += 1;
        if (ending.s <= end) {
            step->contact = contact;
            step->regime = ending.regime;
            return ADVANCE_EVENT;
        }
        if (end == left) {
            q->clock = step->clock_end;
        }
    }
    return ADVANCE_REACHED;
}

#endif
