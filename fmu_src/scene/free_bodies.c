#include "scene/free_bodies.h"

#include <float.h>

void free_bodies_rebase(struct scene_state *q)
{
    q->deferrable_clock = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        q->origin[i].displacement = vec3_add(q->origin[i].displacement, q->body[i].moved);
        q->origin[i].velocity = q->body[i].velocity;
        q->body[i].moved = vec3_make(0.0, 0.0, 0.0);
    }
}

void free_bodies_shift_clocks(struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].record.touch_clock -= q->clock;
        q->contact[j].schedule.change_clock -= q->clock;
        q->contact[j].schedule.settled_clock -= q->clock;
        if (q->contact[j].regime == REGIME_APART || q->contact[j].regime == REGIME_SEPARATING) {
            /* Not known where it has flown on to, unless that was foreseen. */
            q->contact[j].physics.accumulated_gap =
                q->contact[j].schedule.change_clock == 0.0 ? q->contact[j].schedule.change_gap : DBL_MAX;
        }
    }
    q->horizon_clock -= q->clock;
}

void free_bodies_put(const struct scene_state *q, const struct body_state *bodies, int body,
                     struct body_instant *at)
{
    at->origin = q->origin[body].displacement;
    at->moved = bodies[body].moved;
    at->velocity = bodies[body].velocity;
}

const struct body_state *free_bodies_now(const struct scene_state *q)
{
    return q->body;
}
