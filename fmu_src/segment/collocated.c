#include "segment/kinds.h"
#include "segment/terminal_event.h"

bool collocated_applies(const struct segment *p)
{
    const struct pair_timescales *scales = &p->scales;
    return scales->rates.faster * p->longest >= COLLOCATED_SHORTEST && scales->problem.reach > 0.0 &&
           scales->rates.faster >= SEPARATION_OF_RATES * scales->tangential_rate;
}

void collocated_begin(struct segment *p)
{
    p->unit = p->as.collocation.step.half;
    p->end = 2.0;
    p->output.latest_s = -1.0;
    p->output.count = 0;
}

/* Samples at 0.5, 1, 2, 4, ... fast decay times, before the nodes: between two samples no quantity has two
 * extrema. */
static void add_decay_samples(struct segment *p)
{
    const struct lobatto *nodes = p->as.collocation.step.nodes;
    const double first = 0.5 / oscillator_rates_of(&p->as.collocation.step.result.oscillator).faster;
    double s = 0.0;
    while (s < 1.0 + nodes->node[2] && p->output.count < DENSE_OUTPUT_POINTS - LOBATTO_MAX) {
        dense_output_add(&p->output, s);
        s = fmax(first, 2.0 * s);
    }
}

void collocated_sample(struct segment *p)
{
    const enum collocation_kind kind = p->as.collocation.step.kind;
    const struct lobatto *nodes = p->as.collocation.step.nodes;
    collocated_begin(p);
    if (kind == COLLOCATION_OVERDAMPED) {
        add_decay_samples(p);
    }
    for (int i = 0; i < nodes->points; ++i) {
        const double s = 1.0 + nodes->node[i];
        if (p->output.count == 0 || s > p->output.s[p->output.count - 1]) {
            struct pair_sample *at = &p->output.at[p->output.count];
            if (kind == COLLOCATION_AVERAGED) {
                pair_collocation_sample_averaged(&p->as.collocation, s, at);
            } else {
                pair_collocation_sample_node(&p->as.collocation, i, at);
            }
            p->output.s[p->output.count++] = s;
        }
    }
}

bool collocated_make(struct segment *p, double step, enum collocation_kind kind)
{
    if (!collocation_make(&p->as.collocation.step, &p->scales.problem, step, kind, &lobatto[LOBATTO_TWELVE],
                          0.1 * p->tolerance) ||
        !(p->as.collocation.step.result.interior_error <= p->tolerance)) {
        return false;
    }
    collocated_sample(p);
    return true;
}

/* Part of the reach. Where a node is nearer to the centre than this, the motion between the nodes may be
 * nearer still, and d = reach + x loses digits. */
static const double NEAR_CENTRE = 0.1;

bool collocated_stays_off_centre(const struct segment *p)
{
    const struct collocation *step = &p->as.collocation.step;
    double nearest = step->from.reach;
    for (int i = 0; i < step->nodes->points; ++i) {
        nearest = fmin(nearest, step->from.reach + step->result.x[i]);
    }
    if (step->local.head_on || nearest > NEAR_CENTRE * step->from.reach) {
        return true;
    }
    return step->kind == COLLOCATION_OVERDAMPED && !(terminal_event_centre(p) < (double)INFINITY);
}
