#include "solver/piece.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "contact/bracket.h"

/* Radians of the motion along the contact in a long step: at the nodes' full accuracy, with about 15 sweeps. */
static const double LONG_STEP = 2.5;

/* Radians of the oscillator in a resolved step. Half a turn and a little more is an impact; at the nodes the oscillation, itself
 * a correction to the load of relative size (turning / settling)^2, is then known to 3e-7. */
static const double RESOLVED_STEP = 4.0;

/* Radians of the motion along the contact in a creeping step, which must be exact in between too. */
static const double CREEPING_STEP = 1.0;

/* Below this many radians of the oscillator a series is exact in one step, and the load's response loses digits
 * (oscillator_follow). */
static const double SHORTEST_STEP = 3.0;

/* The oscillator must be faster than the motion along the contact by so much for the two to be told apart. */
static const double SEPARATION_OF_RATES = 20.0;

enum { ATTEMPTS = 12 };

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
    watch_sample(&p->watch);
}

/* Halvings of the fast decay, as long as they come before the nodes: no quantity turns twice between them. */
static void add_decay_places(struct piece *p)
{
    const double first = 0.5 / oscillator_rates_of(&p->by.collocation.step.oscillator).faster;
    double s = 0.0;
    while (s < 1.0 + lobatto_node[2] && p->watch.count < WATCH_POINTS - LOBATTO_POINTS) {
        press_collocation_sample(&p->by.collocation, s, &p->watch.at[p->watch.count]);
        p->watch.s[p->watch.count++] = s;
        s = fmax(first, 2.0 * s);
    }
}

static void collocated_piece(struct piece *p)
{
    p->collocated = true;
    p->spans = p->by.collocation.step.kind == COLLOCATION_SPANNING;
    p->unit = p->by.collocation.step.half;
    p->end = 2.0;
    p->watch.sampler = press_collocation_sample;
    p->watch.piece = &p->by.collocation;
    p->watch.count = 0;
    if (p->by.collocation.step.kind == COLLOCATION_CREEPING) {
        add_decay_places(p);
    }
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        const double s = 1.0 + lobatto_node[i];
        if (p->watch.count == 0 || s > p->watch.s[p->watch.count - 1]) {
            press_collocation_sample_node(&p->by.collocation, i, &p->watch.at[p->watch.count]);
            p->watch.s[p->watch.count++] = s;
        }
    }
}

/* Not more than the tolerance off anywhere in the step, since it may end anywhere. */
static bool watched_piece(struct piece *p, const struct press_outlook *outlook, double step,
                          enum collocation_kind kind, double tolerance)
{
    if (!press_collocation_make(&p->by.collocation, &p->press, outlook, step, kind, 0.1 * tolerance) ||
        !(p->by.collocation.step.interior_error <= tolerance)) {
        return false;
    }
    collocated_piece(p);
    return true;
}

static bool resolved_piece(struct piece *p, const struct press_outlook *outlook, double longest,
                           double tolerance)
{
    const double rate = outlook->rates.slower;
    const double step = fmin(longest, RESOLVED_STEP / rate);
    return outlook->swings && rate * step >= SHORTEST_STEP &&
           (watched_piece(p, outlook, step, COLLOCATION_RESOLVED, tolerance) ||
            watched_piece(p, outlook, SHORTEST_STEP / rate, COLLOCATION_RESOLVED, tolerance));
}

/* What a step leaves out that feels an oscillation or fast decay of amplitude `a` [m] to first order only: the next order of
 * its closed-form part, smaller by the ratio of the rates once more, and the mean of (a/d)^2 in n' for as long as it lasts, in
 * radians of the motion along the contact. */
static double left_out(double a, double ratio, double distance, double radians)
{
    return 4.0 * a * ratio * ratio + 3.0 * a * a / distance * radians;
}

static bool creeping_piece(struct piece *p, const struct press_outlook *outlook, double longest,
                           double tolerance)
{
    const double faster = outlook->rates.faster;
    const double slower = outlook->rates.slower;
    if (outlook->swings || faster < 4.0 * slower) {
        return false;
    }
    double step = fmin(longest, fmin(CREEPING_STEP / outlook->turning, SHORTEST_STEP / slower));
    for (int i = 0; i < ATTEMPTS && step * faster >= SHORTEST_STEP; ++i) {
        if (watched_piece(p, outlook, step, COLLOCATION_CREEPING, tolerance)) {
            const double decay = fabs(p->by.collocation.step.y);
            return left_out(decay, outlook->turning / faster, outlook->problem.reach,
                            outlook->turning / faster) <= tolerance;
        }
        step *= 0.5;
    }
    return false;
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

static bool long_piece(struct piece *p, const struct press_outlook *outlook, enum contact_regime regime,
                       double longest, double tolerance)
{
    const double d = outlook->problem.reach;
    double step = fmin(longest, LONG_STEP / outlook->turning);
    const double ratio = outlook->turning / outlook->rates.slower;
    if (!(outlook->oscillation < outlook->load_depth) ||
        left_out(outlook->oscillation, ratio, d, outlook->turning * step) > tolerance) {
        return false;
    }
    for (int i = 0; i < ATTEMPTS && step * outlook->rates.slower >= SHORTEST_STEP; ++i) {
        struct press_collocation *made = &p->by.collocation;
        if (!press_collocation_make(made, &p->press, outlook, step, COLLOCATION_SPANNING, 0.1 * tolerance)) {
            step *= 0.5;
            continue;
        }
        /* At its end a step of this order is off by about the square of what it leaves out in between; by measurement ten
         * times the square of the tails themselves, which are larger by the points' number, is on the safe side. */
        const double tail = LOBATTO_POINTS * made->step.interior_error;
        const double error = tail * (10.0 * tail / d);
        if (!(error <= tolerance)) {
            step *= 0.5;
            continue;
        }
        const struct press_reserve margin = reserve_of_law(p, regime);
        const double until = nothing_until(p, &margin);
        if (until >= 2.0) {
            collocated_piece(p);
            return true;
        }
        /* Stop short of it by some turns of the oscillation. */
        step = until * made->step.half - 2.0 * RESOLVED_STEP / outlook->rates.slower;
    }
    return false;
}

static bool collocate(struct piece *p, enum contact_regime regime, double longest, double tolerance)
{
    const struct press_outlook outlook = press_outlook_of(&p->press);
    if (!(outlook.rates.faster * longest >= SHORTEST_STEP) || !(outlook.problem.reach > 0.0)) {
        return false;
    }
    if (!(outlook.rates.faster >= SEPARATION_OF_RATES * outlook.turning)) {
        return false;
    }
    if (outlook.rates.slower >= SEPARATION_OF_RATES * outlook.turning &&
        long_piece(p, &outlook, regime, longest, tolerance)) {
        return true;
    }
    return resolved_piece(p, &outlook, longest, tolerance) || creeping_piece(p, &outlook, longest, tolerance);
}

bool piece_make(struct piece *p, const struct scene_values *v, const struct motion *q,
                const struct system_instant *at, int contact, double longest, double tolerance)
{
    press_make(&p->press, v, q, at, contact);
    if (!collocate(p, (enum contact_regime)q->contact[contact].regime, longest, tolerance)) {
        series_piece(p, longest);
    }
    return p->end > 0.0;
}

struct press_change piece_change(const struct piece *p, double s)
{
    return p->collocated ? press_collocation_change(&p->by.collocation, s)
                         : press_series_change(&p->by.series, s);
}

#endif
