#include "math/root.h"
#include "segment/kinds.h"
#include "segment/terminal_event.h"

/* Longest averaged step [radians of the tangential motion]: twelve nodes then have full accuracy, with about
 * 15 sweeps. */
static const double LONG_STEP = 2.5;

/* Radians of the tangential motion up to which four or eight nodes are tried first. */
static const double FOUR_NODES = 0.05;
static const double EIGHT_NODES = 0.5;

enum { AVERAGED_ATTEMPTS = 12 };

double averaged_error(double a, double ratio, double distance, double radians)
{
    return 4.0 * a * ratio * ratio + 3.0 * a * a / distance * radians;
}

static void lower_bound_slope(const void *data, double s, double *value, double *slope)
{
    double ignored;
    pair_lower_bound_at(data, s, &ignored, value);
    *slope = 0.0; /* root_in_bracket then bisects */
}

/* The s up to which a lower bound stays positive. */
static double positive_until(const struct dense_output *w, const struct pair_lower_bound *bound)
{
    double low_value;
    double low_slope;
    const struct oscillator_envelope envelope = pair_envelope_of(bound->of, bound->quantity);
    pair_lower_bound_from(bound, &envelope, 0.0, &w->at[0], &low_value, &low_slope);
    if (!(low_value > 0.0)) {
        return 0.0;
    }
    for (int i = 1; i < w->count; ++i) {
        const double low = w->s[i - 1];
        double high = w->s[i];
        double value;
        double slope;
        pair_lower_bound_from(bound, &envelope, high, &w->at[i], &value, &slope);
        if (value > 0.0 && low_slope < 0.0 && slope > 0.0) {
            double ignored;
            double at_dip;
            const double dip = root_in_bracket(lower_bound_slope, bound, low, high);
            pair_lower_bound_at(bound, dip, &at_dip, &ignored);
            if (!(at_dip > 0.0)) {
                high = dip;
                value = at_dip;
            }
        }
        if (!(value > 0.0)) {
            return root_in_bracket(pair_lower_bound_at, bound, low, high);
        }
        low_slope = slope;
    }
    return 2.0;
}

/* The s up to which neither the bodies part nor the law ends the regime. */
static double event_free_until(const struct segment *p)
{
    const struct pair_collocation *made = &p->as.collocation;
    const struct pair_lower_bound overlap = {made, PAIR_GAP, -1.0, terminal_event_gap_tolerance(p)};
    const double parts = positive_until(&p->output, &overlap);
    if (!terminal_event_by_law(p)) {
        return parts;
    }
    const struct event_function margin = terminal_event_margin(p);
    const struct pair_lower_bound bound = {made, margin.quantity, margin.factor, margin.offset};
    return fmin(parts, positive_until(&p->output, &bound));
}

static enum lobatto_size nodes_for(double radians)
{
    if (radians <= FOUR_NODES) {
        return LOBATTO_FOUR;
    }
    return radians <= EIGHT_NODES ? LOBATTO_EIGHT : LOBATTO_TWELVE;
}

/* Whether a step is accurate although the oscillation enters n and H to first order only. */
static bool averaged_is_accurate(const struct segment *p, double step)
{
    const struct pair_timescales *scales = &p->scales;
    const double tangential_rate = pair_tangential_rate_within(scales, step);
    const double slower = scales->rates.slower;
    const double left_out = averaged_error(scales->oscillation, tangential_rate / slower,
                                           scales->problem.reach, tangential_rate * step);
    return slower >= SEPARATION_OF_RATES * tangential_rate && left_out <= p->tolerance;
}

/* The longest step to try [s]; 0: none. A shorter one helps only where the relative acceleration grows. */
static double longest_step(const struct segment *p)
{
    const struct pair_timescales *scales = &p->scales;
    double step = pair_step_within(scales, p->longest, LONG_STEP);
    while (step * scales->rates.slower >= COLLOCATED_SHORTEST && !averaged_is_accurate(p, step)) {
        step *= pair_tangential_rate_within(scales, step) > scales->tangential_rate ? 0.5 : 0.0;
    }
    return step;
}

bool averaged_applies(const struct segment *p)
{
    const struct pair_timescales *scales = &p->scales;
    /* Where the load has faded, so may have the oscillation, to less than rounding. */
    return collocated_applies(p) && scales->rates.slower >= SEPARATION_OF_RATES * scales->tangential_rate &&
           scales->oscillation < fmax(scales->equilibrium_depth, terminal_event_gap_noise(&p->pair));
}

bool averaged_make(struct segment *p)
{
    const struct pair_timescales *scales = &p->scales;
    const double d = scales->problem.reach;
    double step = longest_step(p);
    enum lobatto_size size = LOBATTO_FOUR;
    for (int i = 0; i < AVERAGED_ATTEMPTS && step * scales->rates.slower >= COLLOCATED_SHORTEST; ++i) {
        struct pair_collocation *made = &p->as.collocation;
        const enum lobatto_size enough = nodes_for(scales->tangential_rate * step);
        size = enough > size ? enough : size;
        if (!collocation_make(&made->step, &scales->problem, step, COLLOCATION_AVERAGED, &lobatto[size],
                              0.1 * p->tolerance)) {
            step *= 0.5;
            continue;
        }
        /* The error at the end of a step is about the square of that in between. Ten times the square of the
         * tails and of the number of points is above all measured errors (tests/unit/collocation.c). */
        const double tail = made->step.nodes->points * made->step.result.interior_error;
        const double error = tail * (10.0 * tail / d);
        if (!(error <= p->tolerance)) {
            step *= size == LOBATTO_TWELVE ? 0.5 : 1.0;
            size += size == LOBATTO_TWELVE ? 0 : 1;
            continue;
        }
        collocated_sample(p);
        const double until = event_free_until(p);
        p->event_free = until >= 2.0;
        if (p->event_free) {
            return true;
        }
        /* End two resolved segments before the event: those locate it. */
        step = until * made->step.half - 2.0 * RESOLVED_LENGTH / scales->rates.slower;
    }
    return false;
}
