#include "segment/peak_error.h"

#include <float.h>

/* Roundings that the bounds in scene/rounding.h are made of. */
static const double BOUND_ROUNDINGS = 8.0;

/* Of a product n.w, besides that of n: two roundings. */
static const double RATE_ROUNDINGS = 2.0;

/* An error of a peak by less than this part of the load or peak is none: the force of all other contacts is
 * known no better (contact_pair.c). */
static const double NEGLIGIBLE = 1e-6;

/* A dashpot's force at the start is no peak if it is less than this part of what follows. */
static const double OUTWEIGHED = 0.5;

/* exp(-40) of an oscillation is less than a rounding of it. */
static const double FORGOTTEN = 40.0;

/* What the start of a segment knows [N]: its load, the oscillation about it by gap and by rate, the largest
 * of all, and the error of the largest force. */
struct start {
    double load, by_gap, by_rate, size, error;
};

/*
 * Gap and rate that are carried from the segment before have no new rounding, and what comes out as exactly
 * zero is meant so: bodies set down where they touch, or at rest. An error of the rate makes an oscillation
 * longer as a small side does a hypotenuse; one of the gap, and a dashpot's force that is itself the peak,
 * count in full.
 */
static struct start start_of(const struct segment *p)
{
    const struct contact_pair *pair = &p->pair;
    const double k = pair->coefficients.k;
    const double c = pair->coefficients.c;
    const double per_rate = sqrt(k * pair->reduced_mass);
    const double rate = fabs(pair_gap_derivative(pair));
    const double spring = fabs(k * pair->gap);
    struct start start = {.load = pair_load(pair), .by_rate = per_rate * rate};
    start.by_gap = fabs(spring - start.load);
    start.size = fmax(fmax(start.load, spring), fmax(start.by_rate, c * rate));
    start.error = p->gap_is_known ? 0.0 : k * p->gap_rounding / BOUND_ROUNDINGS;
    if (!pair->rate_is_known) {
        const double turned = contact_is_plane(&pair->shape)
                                  ? 0.0
                                  : p->gap_rounding / pair->distance * vec3_norm(pair->flight.w[0]);
        const double rounding = (RATE_ROUNDINGS * pair->rate_rounding + turned) / BOUND_ROUNDINGS;
        const double by_error = per_rate * rounding;
        const double dashpot = c * (rate + rounding);
        const double swing = fmax(start.by_gap, start.by_rate);
        const double longer = fmin(1.0, (start.by_rate + 0.5 * by_error) / fmax(swing, DBL_MIN));
        start.error += by_error * longer + (dashpot > OUTWEIGHED * start.size ? c * rounding : 0.0);
    }
    return start;
}

void peak_error_note(const struct segment *p, double time, struct contact_state *state)
{
    struct contact_record *record = &state->record;
    if (record->force_error == 0.0 && p->gap_is_known && p->pair.rate_is_known) {
        return;
    }
    const struct start start = start_of(p);
    const struct contact_coefficients *by = &p->pair.coefficients;
    const struct oscillator oscillator = {by->k / p->pair.reduced_mass, by->c / p->pair.reduced_mass};
    const double decay = fmin(oscillator_rates_of(&oscillator).slower, 0.5 * oscillator.damping_rate) * time;
    const double error = fmin(record->force_error + start.error, DBL_MAX);
    const double peak = state->peaks.force;
    record->force_error = error * exp(-decay);
    if (!(error > NEGLIGIBLE * fmax(start.size, peak))) {
        return;
    }
    /* A load, set on at once, makes 1 + 1/(1 + c/sqrt(k m)) times its force at most; it changes little while
     * the oscillation dies away. */
    const double damped = 1.0 + by->c / sqrt(by->k * p->pair.reduced_mass);
    const double first = start.load + start.by_gap / damped + start.by_rate * damped + error;
    const bool is_outweighed = decay > FORGOTTEN && first * (1.0 + FORGOTTEN / decay) < peak;
    const double bound = is_outweighed ? peak : fmax(first, peak + error);
    record->force_bound = fmin(fmax(record->force_bound, bound), DBL_MAX);
}
