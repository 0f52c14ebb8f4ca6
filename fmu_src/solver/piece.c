#include "solver/piece.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "contact/bracket.h"

/* Radians of the motion along the contact in a long step: at the nodes' full accuracy, with about 15 sweeps. */
static const double LONG_STEP = 2.5;

/* Radians of the oscillator in a resolved step. Half a turn and a little more is an impact; at the nodes the oscillation, itself
 * a correction to the load of relative size (turning / settling)^2, is then known to 3e-7. */
static const double RESOLVED_STEP = 4.0;

/* Below this many radians of the oscillator a series is exact in one step, and the load's response loses digits
 * (oscillator_follow). */
static const double SHORTEST_STEP = 3.0;

/* The oscillator must be faster than the motion along the contact by so much for the two to be told apart. */
static const double SEPARATION_OF_RATES = 20.0;

enum { ATTEMPTS = 12, LONG_PEAKS = 9 };

static void series_piece(struct piece *p, double longest)
{
    press_series_make(&p->by.series, &p->press);
    p->collocated = false;
    p->spans = false;
    p->unit = p->by.series.unit;
    p->end = fmin(p->by.series.step, longest / p->unit);
    p->watch.sampler = press_series_sample;
    p->watch.piece = &p->by.series;
    /* A step is a fifth of the radius of convergence at most (SERIES_ORDER); within a quarter of it, a twentieth of the
     * radius, no quantity of the contact turns twice. */
    p->watch.count = 5;
    for (int i = 0; i < p->watch.count; ++i) {
        p->watch.s[i] = p->end * i / (p->watch.count - 1);
    }
}

static void collocated_piece(struct piece *p, bool spans)
{
    p->collocated = true;
    p->spans = spans;
    p->unit = p->by.collocation.step.half;
    p->end = 2.0;
    p->watch.sampler = press_collocation_sample;
    p->watch.piece = &p->by.collocation;
    p->watch.count = LOBATTO_POINTS;
    for (int i = 0; i < p->watch.count; ++i) {
        p->watch.s[i] = 1.0 + lobatto_node[i];
    }
}

static bool resolved_piece(struct piece *p, const struct press_outlook *outlook, double longest,
                           double tolerance)
{
    const double step = fmin(longest, RESOLVED_STEP / outlook->settling);
    if (!press_collocation_make(&p->by.collocation, &p->press, outlook, step, true, 0.1 * tolerance) ||
        p->by.collocation.step.interior_error > tolerance) {
        return false;
    }
    collocated_piece(p, false);
    return true;
}

static void reserve_slope(const void *data, double s, double *value, double *slope)
{
    double ignored;
    press_reserve_at(data, s, &ignored, value);
    *slope = 0.0; /* bracket_root then bisects */
}

/* Up to which s what is left of a quantity stays above zero. */
static double lasts_until(const struct press_reserve *reserve)
{
    double low_value;
    double low_slope;
    press_reserve_at(reserve, 0.0, &low_value, &low_slope);
    if (!(low_value > 0.0)) {
        return 0.0;
    }
    for (int i = 1; i < LOBATTO_POINTS; ++i) {
        const double low = 1.0 + lobatto_node[i - 1];
        double high = 1.0 + lobatto_node[i];
        double value;
        double slope;
        press_reserve_at(reserve, high, &value, &slope);
        if (value > 0.0 && low_slope < 0.0 && slope > 0.0) {
            double ignored;
            double at_dip;
            const double dip = bracket_root(reserve_slope, reserve, low, high);
            press_reserve_at(reserve, dip, &at_dip, &ignored);
            if (!(at_dip > 0.0)) {
                high = dip;
                value = at_dip;
            }
        }
        if (!(value > 0.0)) {
            return bracket_root(press_reserve_at, reserve, low, high);
        }
        low_slope = slope;
    }
    return 2.0;
}

/* Up to which s neither the bodies part nor the law changes its regime. */
static double nothing_until(const struct piece *p, const struct press_reserve *margin)
{
    const struct press_reserve overlap = {&p->by.collocation, PRESS_GAP, -1.0};
    const double parts = lasts_until(&overlap);
    return margin->of ? fmin(parts, lasts_until(margin)) : parts;
}

static struct press_reserve reserve_of_law(const struct piece *p, enum contact_regime regime)
{
    const struct contact_law *law = &p->press.law;
    if (!(law->damping > 0.0) || law->dashpot == DASHPOT_UNCLAMPED) {
        return (struct press_reserve){.of = 0};
    }
    if (law->dashpot == DASHPOT_NON_ADHESIVE) {
        return (struct press_reserve){&p->by.collocation, PRESS_FORCE, 1.0};
    }
    return (struct press_reserve){&p->by.collocation, PRESS_RATE, regime == REGIME_RECEDING ? 1.0 : -1.0};
}

/* What second-order effects of the oscillation a long step leaves out: the mean of (y/d)^2 in n', and the oscillation's own
 * answer to what it does to n and H. */
static double left_out(const struct press_outlook *outlook, double distance, double step)
{
    const double a = outlook->oscillation;
    const double ratio = outlook->turning / outlook->settling;
    return 3.0 * a * a / distance * outlook->turning * step + a * ratio * ratio;
}

static bool long_piece(struct piece *p, const struct press_outlook *outlook, enum contact_regime regime,
                       double longest, double tolerance)
{
    const double d = outlook->problem.reach;
    double step = fmin(longest, LONG_STEP / outlook->turning);
    if (!(outlook->oscillation < outlook->load_depth) || left_out(outlook, d, step) > tolerance) {
        return false;
    }
    for (int i = 0; i < ATTEMPTS && step * outlook->settling >= SHORTEST_STEP; ++i) {
        struct press_collocation *made = &p->by.collocation;
        if (!press_collocation_make(made, &p->press, outlook, step, false, 0.1 * tolerance)) {
            step *= 0.5;
            continue;
        }
        /* At its end a step of this order is off by about the square of what it leaves out in between. */
        const double error = made->step.interior_error * (10.0 * made->step.interior_error / d);
        if (error > tolerance) {
            step *= 0.5;
            continue;
        }
        const struct press_reserve margin = reserve_of_law(p, regime);
        const double until = nothing_until(p, &margin);
        if (until >= 2.0) {
            collocated_piece(p, true);
            return true;
        }
        /* Stop short of it by some turns of the oscillation. */
        step = until * made->step.half - 2.0 * RESOLVED_STEP / outlook->settling;
    }
    return false;
}

static bool collocate(struct piece *p, enum contact_regime regime, double longest, double tolerance)
{
    if (!(p->press.by.k > 0.0)) {
        return false;
    }
    const struct press_outlook outlook = press_outlook_of(&p->press);
    if (!(outlook.settling * longest >= SHORTEST_STEP) ||
        !(outlook.settling >= SEPARATION_OF_RATES * outlook.turning) || !(outlook.problem.reach > 0.0)) {
        return false;
    }
    return long_piece(p, &outlook, regime, longest, tolerance) ||
           (outlook.swings && resolved_piece(p, &outlook, longest, tolerance));
}

bool piece_make(struct piece *p, const struct scene_values *v, const struct motion *q,
                const struct system_instant *at, int contact, double longest, double tolerance)
{
    press_make(&p->press, v, q, at, contact);
    if (!collocate(p, (enum contact_regime)q->contact[contact].regime, longest, tolerance)) {
        series_piece(p, longest);
    }
    if (!(p->end > 0.0)) {
        return false;
    }
    watch_sample(&p->watch);
    return true;
}

struct press_change piece_change(const struct piece *p, double s)
{
    return p->collocated ? press_collocation_change(&p->by.collocation, s)
                         : press_series_change(&p->by.series, s);
}

#endif
