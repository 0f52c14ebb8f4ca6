#include <float.h>

#include "segment/hertz_recurrence.h"
#include "segment/kinds.h"

/* Places at which a segment is sampled: it is a third of the radius of convergence at most, so that between
 * two of them no quantity has two extrema. */
enum { PLACES = 3 };

/* What the last terms of a series may be, as a part of the whole: the tolerance of a segment, no less than
 * some roundings, and no more than keeps energies closed to 1e-10 over thousands of segments; or a hundredth
 * of that tolerance where it is more, up to what keeps them closed to 1e-10 over an impact. */
static const double FINEST = 8.0 * DBL_EPSILON;
static const double FINE = 1e-13;
static const double PART_OF_COARSE = 0.01;
static const double COARSEST = 1e-11;

static double series_accuracy(const struct segment *p)
{
    const double asked = p->tolerance / fmax(p->pair.distance, contact_reach(&p->pair.shape));
    return fmax(fmin(fmax(asked, FINEST), FINE), fmin(PART_OF_COARSE * asked, COARSEST));
}

bool hertz_applies(const struct segment *p)
{
    return contact_is_hertz(&p->pair.law);
}

bool hertz_make(struct segment *p)
{
    struct pair_hertz *made = &p->as.hertz;
    struct hertz_recurrence z;
    const double coasting = hertz_coasting_time(p);
    if (coasting > 0.0) {
        p->longest = coasting;
        p->may_be_slow = false;
        return false;
    }
    pair_hertz_begin(made, &z, &p->pair);
    if (p->may_be_slow && hertz_is_slow(p, made->root, made->unit)) {
        return false;
    }
    p->may_be_slow = false;
    pair_hertz_complete(made, &z, series_accuracy(p));
    p->unit = made->unit;
    double parting = pair_hertz_parting(made->root, made->step);
    p->end = fmin(made->step, parting > 0.0 ? parting : made->step);
    if (parting > 0.0 && pair_hertz_time(made, p->end) > p->longest) {
        p->end = pair_hertz_place(made, p->longest, p->end);
        parting = p->end < parting ? (double)INFINITY : parting;
    }
    for (int i = 0; i < PLACES; ++i) {
        dense_output_add(&p->output, p->end * i / (PLACES - 1));
    }
    hertz_find_terminal_event(p, parting);
    return true;
}

bool hertz_elastic_applies(const struct segment *p)
{
    return contact_is_hertz(&p->pair.law) && p->pair.chi == 0.0;
}

bool hertz_elastic_segment_make(struct segment *p)
{
    struct hertz_elastic *made = &p->as.hertz_elastic;
    if (!hertz_elastic_make(made, &p->pair)) {
        return false;
    }
    const bool parts = made->end_time <= p->longest;
    p->clear_of_centre = true;
    p->end = parts ? made->end : hertz_elastic_place(made, p->longest);
    p->unit = hertz_elastic_time(made, p->end) / p->end;
    dense_output_add(&p->output, 0.0);
    if (made->start < 0.0 && -made->start < p->end) { /* the deepest place, where each has one extremum */
        dense_output_add(&p->output, -made->start);
    }
    dense_output_add(&p->output, p->end);
    hertz_find_terminal_event(p, parts ? p->end : (double)INFINITY);
    return p->end > 0.0;
}
