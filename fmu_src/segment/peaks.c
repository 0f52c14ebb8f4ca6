#include "segment/peaks.h"

#include <float.h>

#include "math/pi.h"

/* Places in one period of the oscillation: no quantity has two extrema in a quarter of it. */
enum { PERIOD_PLACES = 5 };

/* An oscillation of less than this part of what it is added to adds nothing that is worth the search. */
static const double NEGLIGIBLE = 1e-12;

/* A node whose bound is above the largest value found by less than this part is not searched: what it could
 * add is less than the tolerance that anybody asks for (1e-8 is the start value). */
static const double WORTH_A_SEARCH = 1e-9;

/* Maxima that are less than this many periods apart are searched together. */
static const double NEAR = 0.125;

/* A turn of fewer representable places than this is not searched: its largest value could no longer be told
 * to rounding, for it is missed by (2 pi / places)^2 / 8 of the oscillation at most. */
static const double PLACES_OF_TURN = 4096.0;

/* The envelope of an oscillation is a bound that nothing reaches where its square of turn is less than this
 * part of that of its decay (oscillator_envelope_of): it dies away within a period. */
static const double HARDLY_TURNS = 1.0 / 16.0;

static const struct event_function peak_force = {PAIR_FORCE, 1.0, 0.0};
static const struct event_function peak_penetration = {PAIR_GAP, -1.0, 0.0};

struct peaks {
    double deepest, strongest;
};

/* Without a dashpot the largest force is that of the largest penetration. */
static void peaks_add(struct peaks *peaks, const struct segment *p, const struct dense_output *w, double end,
                      const struct pair_sample *then)
{
    const double deepest = dense_output_largest(w, &peak_penetration, end, then);
    const double strongest = p->pair.coefficients.c > 0.0 ? dense_output_largest(w, &peak_force, end, then)
                                                          : p->pair.coefficients.k * deepest;
    peaks->deepest = fmax(peaks->deepest, deepest);
    peaks->strongest = fmax(peaks->strongest, strongest);
}

/* Within one period about a place, inside the step. */
static void peaks_in_period(struct peaks *peaks, const struct segment *p, double place, double period)
{
    struct dense_output w = {
        .sampler = p->output.sampler, .segment = p->output.segment, .count = PERIOD_PLACES};
    const double low = fmax(0.0, fmin(place - 0.5 * period, p->end - period));
    const double high = fmin(p->end, low + period);
    for (int i = 0; i < PERIOD_PLACES; ++i) {
        w.s[i] = low + (high - low) * i / (PERIOD_PLACES - 1);
    }
    dense_output_sample(&w);
    peaks_add(peaks, p, &w, high, &w.at[PERIOD_PLACES - 1]);
}

/* Where load and envelope together are largest. */
struct summit {
    double place;
    bool oscillates; /* the oscillation matters */
    bool first;      /* it may be larger in the first period, if it decays */
};

/* Up to half a period, for within a period about it is searched, or to the last digit. The reserve falls
 * towards it and rises beyond. */
static double summit_between(const struct pair_lower_bound *bound, double low, double high, double period)
{
    double middle = 0.5 * (low + high);
    while (high - low > 0.5 * period && middle > low && middle < high) {
        double left;
        double slope;
        pair_lower_bound_at(bound, middle, &left, &slope);
        low = slope < 0.0 ? middle : low;
        high = slope < 0.0 ? high : middle;
        middle = 0.5 * (low + high);
    }
    return middle;
}

static struct summit summit_of(const struct segment *p, const struct event_function *what, double period)
{
    const struct dense_output *w = &p->output;
    const struct pair_lower_bound bound = {&p->as.collocation, what->quantity, -what->factor, 0.0};
    const struct oscillator_envelope envelope = pair_envelope_of(&p->as.collocation, what->quantity);
    struct summit summit = {.place = 0.0};
    double left[DENSE_OUTPUT_POINTS] = {0.0};
    double slope[DENSE_OUTPUT_POINTS] = {0.0};
    double oscillation = 0.0;
    int best = 0;
    for (int i = 0; i < w->count; ++i) {
        pair_lower_bound_from(&bound, &envelope, w->s[i], &w->at[i], &left[i], &slope[i]);
        oscillation = fmax(oscillation, -left[i] - what->factor * w->at[i].of[what->quantity][0]);
        best = left[i] < left[best] ? i : best;
    }
    summit.oscillates = oscillation > -NEGLIGIBLE * left[best];
    summit.place = w->s[best];
    if (summit.oscillates && slope[best] < 0.0 && best + 1 < w->count) {
        summit.place = summit_between(&bound, w->s[best], w->s[best + 1], period);
    } else if (summit.oscillates && slope[best] > 0.0 && best > 0) {
        summit.place = summit_between(&bound, w->s[best - 1], w->s[best], period);
    }
    /* An upper bound of the first period's largest value, compared with the largest without the
     * oscillation. */
    const double early = -left[0] + period * fabs(what->factor * w->at[0].of[what->quantity][1]);
    summit.first = summit.place > period && early > what->factor * w->at[best].of[what->quantity][0];
    return summit;
}

/* Load and envelope together. */
static double height_at(const struct segment *p, const struct event_function *what, double place)
{
    const struct pair_lower_bound bound = {&p->as.collocation, what->quantity, -what->factor, 0.0};
    double left;
    double slope;
    pair_lower_bound_at(&bound, place, &left, &slope);
    return -left;
}

/* About a place: within a period, or, where a turn has no places to speak of, at the top of one. */
static void peaks_about(struct peaks *peaks, const struct segment *p, double place, double period)
{
    if (period > PLACES_OF_TURN * DBL_EPSILON * place) {
        peaks_in_period(peaks, p, place, period);
        return;
    }
    const double deepest = height_at(p, &peak_penetration, place);
    const double strongest =
        p->pair.coefficients.c > 0.0 ? height_at(p, &peak_force, place) : p->pair.coefficients.k * deepest;
    peaks->deepest = fmax(peaks->deepest, deepest);
    peaks->strongest = fmax(peaks->strongest, strongest);
}

/* Further nodes at which a quantity might be larger than the largest so far: one whose oscillation decays may
 * not reach its envelope where that is highest. */
static void peaks_elsewhere(struct peaks *peaks, const struct segment *p, const struct event_function *what,
                            const double *largest, double period)
{
    const struct pair_lower_bound bound = {&p->as.collocation, what->quantity, -what->factor, 0.0};
    const struct oscillator_envelope envelope = pair_envelope_of(&p->as.collocation, what->quantity);
    for (int i = 0; i < p->output.count; ++i) {
        double left;
        double slope;
        pair_lower_bound_from(&bound, &envelope, p->output.s[i], &p->output.at[i], &left, &slope);
        if (-left > *largest + WORTH_A_SEARCH * fabs(*largest)) {
            peaks_about(peaks, p, p->output.s[i], period);
        }
    }
}

static void peaks_of_swinging(struct peaks *peaks, const struct segment *p, double period)
{
    const struct summit deepest = summit_of(p, &peak_penetration, period);
    const struct summit strongest = summit_of(p, &peak_force, period);
    if (!deepest.oscillates && !strongest.oscillates) {
        peaks_add(peaks, p, &p->output, p->end, &p->output.at[p->output.count - 1]);
        return;
    }
    peaks_about(peaks, p, deepest.place, period);
    if (fabs(strongest.place - deepest.place) > NEAR * period) {
        peaks_about(peaks, p, strongest.place, period);
    }
    if (deepest.first || strongest.first) {
        peaks_about(peaks, p, 0.0, period);
    }
    peaks_elsewhere(peaks, p, &peak_penetration, &peaks->deepest, period);
    peaks_elsewhere(peaks, p, &peak_force, &peaks->strongest, period);
}

/* Between places that double, from half the fast decay's time on, and the nodes: what decays turns as the
 * exponentials do, what follows the load as the nodes show. In portions of the places that there is room
 * for. */
static void peaks_of_decaying(struct peaks *peaks, const struct segment *p, double faster)
{
    struct dense_output w = {.sampler = p->output.sampler, .segment = p->output.segment, .count = 0};
    double place = 0.0;
    int next = 0;
    for (;;) {
        dense_output_add(&w, place);
        if (w.count == DENSE_OUTPUT_POINTS || !(place < p->end)) {
            peaks_add(peaks, p, &w, place, &w.at[w.count - 1]);
            w.s[0] = w.s[w.count - 1];
            w.at[0] = w.at[w.count - 1];
            w.count = 1;
        }
        if (!(place < p->end)) {
            return;
        }
        while (next < p->output.count && !(p->output.s[next] > place)) {
            next += 1;
        }
        place = fmin(fmax(0.5 / faster, 2.0 * place), next < p->output.count ? p->output.s[next] : p->end);
    }
}

/* The nodes of an averaged step do not see the oscillation. */
static void peaks_of_averaged(struct peaks *peaks, const struct segment *p)
{
    const struct oscillator *o = &p->as.collocation.step.result.oscillator;
    const double decay_square = 0.25 * o->damping_rate * o->damping_rate;
    const double omega_d2 = o->omega2 - decay_square;
    if (omega_d2 > HARDLY_TURNS * decay_square) {
        peaks_of_swinging(peaks, p, 2.0 * PI / sqrt(omega_d2));
    } else {
        peaks_of_decaying(peaks, p, oscillator_rates_of(o).faster);
    }
}

void peaks_note(struct segment *p, struct contact_state *state, double end)
{
    struct peaks peaks = {-(double)INFINITY, -(double)INFINITY};
    if (p->kind == SEGMENT_AVERAGED) {
        peaks_of_averaged(&peaks, p);
    } else {
        peaks_add(&peaks, p, &p->output, end, dense_output_at(&p->output, end));
    }
    state->record.peak_force = fmax(state->record.peak_force, peaks.strongest);
    state->record.peak_penetration = fmax(state->record.peak_penetration, peaks.deepest);
}
