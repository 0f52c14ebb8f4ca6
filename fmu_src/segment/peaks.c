#include "segment/peaks.h"

#include <float.h>

#include "math/pi.h"
#include "segment/peak_error.h"

/* A turn of fewer representable places than this is not searched: its largest value could no longer be told
 * to rounding, for it is missed by (2 pi / places)^2 / 8 of the oscillation at most. */
static const double PLACES_OF_TURN = 4096.0;

/* The envelope of an oscillation is a bound that nothing reaches where its square of turn is less than this
 * part of that of its decay (oscillator_envelope_of): it dies away within a period. */
static const double HARDLY_TURNS = 1.0 / 16.0;

/* A top foreseen outside the segment by less than this part of a turn may be inside: the slope of the slow
 * part changes. */
static const double JUST_OUTSIDE = 0.25;

static const struct event_function peak_force = {PAIR_FORCE, 1.0, 0.0};
static const struct event_function peak_penetration = {PAIR_GAP, -1.0, 0.0};

/*
 * A quantity of an averaged segment and its largest value so far: slow(s) + u(s), of which u oscillates,
 * |u| <= amplitude exp(-decay_rate s). u alone has its tops at omega s = phase + 2 pi n, and is steepest by
 * `steepness` times its bound.
 */
struct search {
    const struct segment *p;
    const struct event_function *what;
    struct pair_lower_bound bound; /* of minus the quantity */
    struct oscillator_envelope envelope;
    double omega, phase, steepness;
    double end, largest;
};

/* A positive deviation outside is a positive gap; penetration and force are minus that. */
static double sign_of_oscillation(const struct segment *p)
{
    return -p->pair.shape.side;
}

static double slow_of(const struct search *f, const struct pair_sample *slow, int derivative)
{
    return f->what->factor * slow->of[f->what->quantity][derivative];
}

static struct search search_of(struct segment *p, const struct event_function *what, double omega, double end,
                               double known)
{
    const struct pair_collocation *made = &p->as.collocation;
    struct search f = {.p = p, .what = what, .omega = omega, .end = end};
    double u;
    double rate;
    pair_free_oscillation(made, what->quantity, &u, &rate);
    u *= sign_of_oscillation(p);
    rate *= sign_of_oscillation(p);
    f.bound = (struct pair_lower_bound){made, what->quantity, -what->factor, 0.0};
    f.envelope = pair_envelope_of(made, what->quantity);
    f.phase = atan2((rate + f.envelope.decay_rate * u) / omega, u) - atan2(f.envelope.decay_rate, omega);
    f.steepness = sqrt(omega * omega + f.envelope.decay_rate * f.envelope.decay_rate);
    const double last = slow_of(&f, dense_output_at(&p->output, end), 0);
    f.largest = fmax(known, fmax(slow_of(&f, &p->output.at[0], 0) + u, last));
    return f;
}

static void climb(struct search *f, double top, double turn)
{
    if (top > -JUST_OUTSIDE * turn && top < f->end + JUST_OUTSIDE * turn) {
        (void)dense_output_climb(&f->p->output, f->what, fmin(fmax(top, 0.0), f->end), 0.0, f->end,
                                 &f->largest);
    }
}

/* The two tops next to a place. Where the slow part is steeper than the oscillation, its top; where a turn
 * has no places to speak of, the top of one. */
static void climb_about(struct search *f, double place, const struct pair_sample *slow)
{
    const double turn = 2.0 * PI / f->omega;
    const double still = f->envelope.amplitude * exp(-f->envelope.decay_rate * place);
    const double slope =
        slow_of(f, slow, 1) / (f->steepness * still); /* against the oscillation's steepest */
    if (turn <= PLACES_OF_TURN * DBL_EPSILON * place) {
        f->largest = fmax(f->largest, slow_of(f, slow, 0) + still);
    } else if (fabs(slope) < 1.0) {
        const double beyond = remainder(f->omega * place - f->phase - asin(slope), 2.0 * PI) / f->omega;
        climb(f, place - beyond, turn);
        climb(f, place - beyond + (beyond > 0.0 ? turn : -turn), turn);
    } else if (place > 0.0 && place < f->end) { /* the slow part's own top, or none */
        climb(f, place, turn);
    }
}

/* Where slow part and envelope together are highest between two places: up to half a turn, for the tops next
 * to it are searched, or to the last digit. The lower bound falls towards it and rises beyond. */
static double summit_between(const struct search *f, double low, double high)
{
    double middle = 0.5 * (low + high);
    while (high - low > PI / f->omega && middle > low && middle < high) {
        double left;
        double slope;
        pair_lower_bound_at(&f->bound, middle, &left, &slope);
        low = slope < 0.0 ? middle : low;
        high = slope < 0.0 ? high : middle;
        middle = 0.5 * (low + high);
    }
    return middle;
}

/* About the summit; then about every other node where the bound is above the largest found: an oscillation
 * that decays may not reach its envelope where that is highest. */
static void search_swinging(struct search *f)
{
    const struct dense_output *w = &f->p->output;
    double left[DENSE_OUTPUT_POINTS] = {0.0};
    double slope[DENSE_OUTPUT_POINTS] = {0.0};
    int best = 0;
    for (int i = 0; i < w->count; ++i) {
        pair_lower_bound_from(&f->bound, &f->envelope, w->s[i], &w->at[i], &left[i], &slope[i]);
        best = left[i] < left[best] ? i : best;
    }
    const int next = slope[best] < 0.0 ? best + 1 : best - 1;
    if (slope[best] != 0.0 && next >= 0 && next < w->count) {
        const double place = summit_between(f, fmin(w->s[best], w->s[next]), fmax(w->s[best], w->s[next]));
        struct pair_sample slow;
        pair_collocation_sample_averaged(&f->p->as.collocation, place, &slow);
        climb_about(f, place, &slow);
    }
    for (int i = 0; i < w->count; ++i) {
        const int node = i == 0 ? best : i <= best ? i - 1 : i;
        if (dense_output_is_larger(w, -left[node], f->largest) && !(w->s[node] > f->end)) {
            climb_about(f, w->s[node], &w->at[node]);
        }
    }
    if (f->end < f->p->end) { /* and about the end, which is no node then */
        struct pair_sample slow;
        pair_collocation_sample_averaged(&f->p->as.collocation, f->end, &slow);
        climb_about(f, f->end, &slow);
    }
}

/* Of the slow part alone. */
static double largest_of_slow(struct segment *p, const struct event_function *what, double end)
{
    struct dense_output *w = &p->output;
    dense_output_sampler *whole = w->sampler;
    struct pair_sample then = w->at[w->count - 1];
    w->sampler = pair_collocation_sample_averaged;
    if (end < p->end) {
        w->sampler(w->segment, end, &then);
    }
    const double largest = dense_output_largest(w, what, end, &then, -(double)INFINITY);
    w->sampler = whole;
    return largest;
}

static double largest_of_swinging(struct segment *p, const struct event_function *what, double omega,
                                  double end, double known)
{
    struct search f = search_of(p, what, omega, end, known);
    const double slow = largest_of_slow(p, what, end);
    if (!dense_output_is_larger(&p->output, fabs(slow) + f.envelope.amplitude, fabs(slow))) {
        return fmax(f.largest, slow);
    }
    if (dense_output_is_larger(&p->output, slow + f.envelope.amplitude, f.largest)) {
        search_swinging(&f);
    }
    return f.largest;
}

/* Between places that double, from half the fast decay's time on, and the nodes: what decays turns as the
 * exponentials do, what follows the load as the nodes show. In portions of the places that there is room
 * for. */
static double largest_of_decaying(const struct segment *p, const struct event_function *what, double faster,
                                  double end, double largest)
{
    struct dense_output w = {p->output.sampler, p->output.segment, p->output.worth_a_search, .count = 0};
    double place = 0.0;
    int next = 0;
    for (;;) {
        dense_output_add(&w, place);
        if (w.count == DENSE_OUTPUT_POINTS || !(place < end)) {
            largest = dense_output_largest(&w, what, place, &w.at[w.count - 1], largest);
            w.s[0] = w.s[w.count - 1];
            w.at[0] = w.at[w.count - 1];
            w.count = 1;
        }
        if (!(place < end)) {
            return largest;
        }
        while (next < p->output.count && !(p->output.s[next] > place)) {
            next += 1;
        }
        place = fmin(fmin(fmax(0.5 / faster, 2.0 * place), end),
                     next < p->output.count ? p->output.s[next] : end);
    }
}

/* The nodes of an averaged step do not see the oscillation. */
static double largest_of(struct segment *p, const struct event_function *what, double end, double known)
{
    const struct oscillator *o = &p->as.collocation.step.result.oscillator;
    if (p->kind != SEGMENT_AVERAGED) {
        return dense_output_largest(&p->output, what, end, dense_output_at(&p->output, end), known);
    }
    const double decay_square = 0.25 * o->damping_rate * o->damping_rate;
    const double omega_d2 = o->omega2 - decay_square;
    return omega_d2 > HARDLY_TURNS * decay_square
               ? largest_of_swinging(p, what, sqrt(omega_d2), end, known)
               : largest_of_decaying(p, what, oscillator_rates_of(o).faster, end, known);
}

void peaks_note(struct segment *p, struct contact_state *state, double end)
{
    struct contact_peaks *peaks = &state->peaks;
    if (p->pair.coefficients.c > 0.0 || p->pair.chi > 0.0) {
        peaks->penetration = largest_of(p, &peak_penetration, end, peaks->penetration);
        peaks->force = largest_of(p, &peak_force, end, peaks->force);
    } else { /* the largest force of a spring is that of its largest penetration */
        const double deepest = largest_of(p, &peak_penetration, end, -(double)INFINITY);
        const double force = contact_is_hertz(&p->pair.law)
                                 ? contact_normal_force_of(&p->pair.law, p->regime, -deepest, 0.0)
                                 : p->pair.coefficients.k * deepest;
        contact_peaks_note(peaks, force, deepest);
    }
    if (p->pair.coefficients.k >= PAIR_STIFF) {
        peak_error_note(p, segment_time(p, end), state);
    }
}
