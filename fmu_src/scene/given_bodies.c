/* In place of free_bodies.c, accumulated_gap.c and free_bodies_jet.c in scenes without a body that may be
 * free. */
#include "scene/free_bodies.h"

void free_bodies_rebase(struct scene_state *q)
{
    (void)q;
}

void free_bodies_shift_clocks(struct scene_state *q)
{
    (void)q;
}

void free_bodies_put(const struct scene_state *q, const struct body_state *bodies, int body,
                     struct body_instant *at)
{
    (void)q, (void)bodies, (void)body, (void)at;
}

const struct body_state *free_bodies_now(const struct scene_state *q)
{
    (void)q;
    return 0;
}

void free_bodies_put_gaps(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    (void)v, (void)q, (void)at;
}

bool free_bodies_put_jerk(const struct scene_values *v, const struct scene_state *q, struct scene_jet *along)
{
    (void)v, (void)q, (void)along;
    return false;
}

void free_bodies_put_work(const struct scene_values *v, const struct scene_state *q, struct scene_jet *along)
{
    (void)v, (void)q, (void)along;
}
