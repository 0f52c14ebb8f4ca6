#include "solver/spanning.h"

#if SCENE_ANY_FREE

#include "contact/bracket.h"
#include "solver/ending.h"

/* Radians of the motion along the contact in a long step: at the nodes' full accuracy, with about 15 sweeps. */
static const double LONG_STEP = 2.5;

/* Radians of the motion along the contact up to which so few nodes are likely to do. */
static const double FOUR_NODES = 0.05;
static const double EIGHT_NODES = 0.5;

enum { SPANNING_ATTEMPTS = 12 };

double spanning_left_out(double a, double ratio, double distance, double radians)
{
    return 4.0 * a * ratio * ratio + 3.0 * a * a / distance * radians;
}

static void reserve_slope(const void *data, double s, double *value, double *slope)
{
    double ignored;
    press_reserve_at(data, s, &ignored, value);
    *slope = 0.0; /* bracket_root then bisects */
}

/* Up to which s what is left of a quantity stays above zero. */
static double lasts_until(const struct watch *w, const struct press_reserve *reserve)
{
    double low_value;
    double low_slope;
    const struct oscillator_envelope envelope = press_envelope_of(reserve->of, reserve->quantity);
    press_reserve_from(reserve, &envelope, 0.0, &w->at[0], &low_value, &low_slope);
    if (!(low_value > 0.0)) {
        return 0.0;
    }
    for (int i = 1; i < w->count; ++i) {
        const double low = w->s[i - 1];
        double high = w->s[i];
        double value;
        double slope;
        press_reserve_from(reserve, &envelope, high, &w->at[i], &value, &slope);
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
static double nothing_until(const struct piece *p)
{
    const struct press_collocation *made = &p->by.collocation;
    const struct press_reserve overlap = {made, PRESS_GAP, -1.0, ending_gap_slack(p)};
    const double parts = lasts_until(&p->watch, &overlap);
    if (!ending_by_law(p)) {
        return parts;
    }
    const struct watched margin = ending_margin(p);
    const struct press_reserve reserve = {made, margin.quantity, margin.factor, margin.offset};
    return fmin(parts, lasts_until(&p->watch, &reserve));
}

static enum lobatto_size nodes_for(double radians)
{
    if (radians <= FOUR_NODES) {
        return LOBATTO_FOUR;
    }
    return radians <= EIGHT_NODES ? LOBATTO_EIGHT : LOBATTO_TWELVE;
}

/* Whether a step may leave out what it does of the oscillation. */
static bool may_span(const struct piece *p, const struct press_outlook *outlook, double step)
{
    const double turning = press_turning_within(outlook, step);
    const double slower = outlook->rates.slower;
    const double left_out =
        spanning_left_out(outlook->oscillation, turning / slower, outlook->problem.reach, turning * step);
    return slower >= SEPARATION_OF_RATES * turning && left_out <= p->tolerance;
}

/* The longest step to try; too short: none. A shorter one helps only where the pull grows. */
static double spanning_step(const struct piece *p, const struct press_outlook *outlook, double longest)
{
    double step = press_step_within(outlook, longest, LONG_STEP);
    while (step * outlook->rates.slower >= PIECE_SHORTEST && !may_span(p, outlook, step)) {
        step *= press_turning_within(outlook, step) > outlook->turning ? 0.5 : 0.0;
    }
    return step;
}

bool spanning_piece(struct piece *p, const struct press_outlook *outlook, double longest)
{
    const double d = outlook->problem.reach;
    /* What the load presses in by may have died away to less than rounding: so has the oscillation then. */
    if (!(outlook->oscillation < fmax(outlook->load_depth, ending_gap_noise(&p->press)))) {
        return false;
    }
    double step = spanning_step(p, outlook, longest);
    enum lobatto_size size = LOBATTO_FOUR;
    for (int i = 0; i < SPANNING_ATTEMPTS && step * outlook->rates.slower >= PIECE_SHORTEST; ++i) {
        struct press_collocation *made = &p->by.collocation;
        const enum lobatto_size enough = nodes_for(outlook->turning * step);
        size = enough > size ? enough : size;
        if (!press_collocation_make(made, &p->press, outlook, step, COLLOCATION_SPANNING, &lobatto[size],
                                    0.1 * p->tolerance)) {
            step *= 0.5;
            continue;
        }
        /* At its end a step of this order is off by about the square of what it leaves out in between; by measurement ten
         * times the square of the tails themselves, which are larger by the points' number, is on the safe side. */
        const double tail = made->step.nodes->points * made->step.interior_error;
        const double error = tail * (10.0 * tail / d);
        if (!(error <= p->tolerance)) {
            step *= size == LOBATTO_TWELVE ? 0.5 : 1.0;
            size += size == LOBATTO_TWELVE ? 0 : 1;
            continue;
        }
        piece_collocated(p);
        const double until = nothing_until(p);
        if (until >= 2.0) {
            return true;
        }
        /* Stop short of it by some turns of the oscillation. */
        step = until * made->step.half - 2.0 * PIECE_RESOLVED / outlook->rates.slower;
    }
    return false;
}

#endif
