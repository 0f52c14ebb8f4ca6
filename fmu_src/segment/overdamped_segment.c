#include "segment/kinds.h"

/* Length of an overdamped segment [radians of the tangential motion]. An event may end it anywhere, so it
 * must be accurate between its ends too. */
static const double OVERDAMPED_STEP = 1.0;

/* In an overdamped segment from near the centre d grows at most by this factor: n' is proportional to
 * 1 / d^2. */
static const double OVERDAMPED_GROWTH = 4.0;

/* Ratio of the two decay rates from which the faster decay is treated apart from the slower. */
static const double SEPARATION_OF_DECAYS = 4.0;

enum { ATTEMPTS = 12 };

bool overdamped_applies(const struct segment *p)
{
    return collocated_applies(p) && !p->scales.underdamped &&
           !(p->scales.rates.faster < SEPARATION_OF_DECAYS * p->scales.rates.slower);
}

/* Whether a step is accurate although the fast decay, of amplitude `decay` [m], enters n and H to first order
 * only. */
static bool overdamped_is_accurate(const struct segment *p, double step, double decay)
{
    const double tangential_rate = pair_tangential_rate_within(&p->scales, step);
    const double ratio = tangential_rate / p->scales.rates.faster;
    return p->scales.rates.faster >= SEPARATION_OF_RATES * tangential_rate &&
           averaged_error(decay, ratio, p->scales.problem.reach, ratio) <= p->tolerance;
}

bool overdamped_make(struct segment *p)
{
    const struct pair_timescales *scales = &p->scales;
    const double longest = fmin(p->longest, COLLOCATED_SHORTEST / scales->rates.slower);
    double step = pair_step_within(scales, longest, OVERDAMPED_STEP);
    if (pair_tangential_rate_within(scales, step) > 0.0) {
        step = fmin(step, OVERDAMPED_GROWTH * p->pair.distance / vec3_norm(scales->problem.rate));
    }
    double decay = 0.0;
    for (int i = 0; i < ATTEMPTS && step * scales->rates.faster >= COLLOCATED_SHORTEST; ++i) {
        if (overdamped_is_accurate(p, step, decay) && collocated_make(p, step, COLLOCATION_OVERDAMPED)) {
            decay = fabs(p->as.collocation.step.result.y);
            if (overdamped_is_accurate(p, step, decay)) {
                return true;
            }
        }
        step *= 0.5;
    }
    return false;
}
