#include "math/pi.h"
#include "segment/kinds.h"
#include "segment/terminal_event.h"

/* Samples at the extrema of gap, rate and force, of which each has one at most. */
static void add_extrema_of_decay(struct segment *p)
{
    struct dense_output *w = &p->output;
    for (int order = 1; order <= OVERDAMPED_DERIVATIVES; ++order) {
        const double extremum = overdamped_zero(&p->as.oscillation.overdamped, order);
        if (extremum > 0.0 && extremum < p->end) {
            dense_output_add(w, extremum);
        }
    }
    dense_output_add(w, p->end);
}

/* Samples at the first two extrema of the gap. They are half a period apart, so no quantity has two extrema
 * between them. */
static void add_extrema_of_oscillation(struct segment *p)
{
    const struct pair_oscillation *made = &p->as.oscillation;
    struct dense_output *w = &p->output;
    bool deepest = pair_oscillation_closes(made);
    double extremum = pair_oscillation_first_extremum(made);
    for (; w->count < 3 && extremum < p->end; extremum += PI / made->omega_d) {
        pair_oscillation_sample_extremum(made, extremum, deepest, &w->at[w->count]);
        w->s[w->count++] = extremum;
        deepest = !deepest;
    }
    if (w->count < 3) {
        dense_output_add(w, p->end);
    }
}

/* Whether the bodies neither part nor change their regime any more. */
static bool is_event_free(const struct segment *p)
{
    const struct pair_oscillation *made = &p->as.oscillation;
    if (!pair_oscillation_stays_above(made, PAIR_GAP, -1.0, terminal_event_gap_tolerance(p))) {
        return false;
    }
    const struct event_function margin = terminal_event_margin(p);
    return !terminal_event_by_law(p) ||
           pair_oscillation_stays_above(made, margin.quantity, margin.factor, margin.offset);
}

bool closed_form_applies(const struct segment *p)
{
    return p->pair.is_head_on;
}

bool closed_form_make(struct segment *p)
{
    struct pair_oscillation *made = &p->as.oscillation;
    if (!pair_oscillation_make(made, &p->pair)) {
        return false;
    }
    p->clear_of_centre = true;
    p->unit = 1.0 / made->rate;
    double end = p->longest / p->unit;
    if (end * p->unit < p->longest) {
        end = nextafter(end, (double)INFINITY);
    }
    p->end = fmin(end, pair_oscillation_longest(made));
    dense_output_add(&p->output, 0.0);
    if (made->omega_d > 0.0) {
        /* the samples are extrema of the gap, where the rate is zero */
        p->largest_gap = fabs(made->equilibrium) + made->amplitude;
        p->largest_rate = made->rate * made->amplitude;
        add_extrema_of_oscillation(p);
    } else {
        add_extrema_of_decay(p);
    }
    p->event_free = is_event_free(p);
    p->end = p->event_free ? end : p->output.s[p->output.count - 1];
    return true;
}
