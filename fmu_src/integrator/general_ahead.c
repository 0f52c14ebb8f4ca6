/* Steps of the general segment that go on beyond a communication point: the motion is read there on the
 * step's polynomial, which the state of motion keeps. */
#include <string.h>

#include "integrator/general_memory.h"

#if SCENE_ANY_TURNING

void general_keep_step(const struct general *g, struct scene_state *q)
{
    const struct radau_step *p = &g->step;
    struct unfinished_step *kept = &q->unfinished;
    const size_t bytes = (size_t)g->size * sizeof(double);
    kept->start = p->start;
    kept->length = p->length;
    kept->end = g->end.clock;
    kept->solvable = g->solvable;
    kept->simple = g->simple;
    kept->stages = p->stages->stages;
    kept->event = g->end.event.event;
    memcpy(kept->at_start, p->y, bytes);
    memcpy(kept->at_end, g->end.y, bytes);
    memcpy(kept->weight, p->weight, bytes);
    memcpy(kept->peaks, g->peaks, sizeof kept->peaks);
    for (int k = 0; k <= p->stages->stages; ++k) {
        memcpy(kept->chebyshev[k], p->chebyshev + k * p->stride, bytes);
    }
    kept->present = q->clock;
    q->integrator_fresh = 0;
}

bool general_take_up(struct general *g, const struct scene_values *v, struct scene_state *q)
{
    const struct unfinished_step *kept = &q->unfinished;
    const size_t bytes = (size_t)g->size * sizeof(double);
    if (!scene_turns(v) || q->integrator_fresh || q->clock != kept->present) {
        return false;
    }
    general_attach(g, v, q);
    g->solvable = kept->solvable;
    g->simple = kept->simple;
    g->end.clock = kept->end;
    g->end.event = (struct general_event){1.0, kept->event};
    memcpy(g->end.y, kept->at_end, bytes);
    memcpy(g->step.weight, kept->weight, bytes);
    memcpy(g->peaks, kept->peaks, sizeof g->peaks);
    radau_step_take_over(&g->step, kept->start, kept->length, kept->at_start, kept->stages,
                         kept->chebyshev[0], ODE_MOST_STATES);
    return true;
}

void general_follow(struct general *g, struct scene_state *q, double clock)
{
    radau_step_at(&g->step, (clock - g->step.start) / g->step.length, g->y);
    general_move_scene(g, q, clock, g->y);
    q->unfinished.present = clock;
    q->integrator_fresh = 0;
}

#else

bool general_take_up(struct general *g, const struct scene_values *v, struct scene_state *q)
{
    (void)g, (void)v, (void)q;
    return false;
}

void general_keep_step(const struct general *g, struct scene_state *q)
{
    (void)g, (void)q;
}

void general_follow(struct general *g, struct scene_state *q, double clock)
{
    (void)g, (void)q, (void)clock;
}

#endif
