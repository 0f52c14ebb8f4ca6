/* Moving the origin of the clock to the present. */
#include "scene/free_bodies.h"
#include "scene/scene_state.h"
#include "scene/topology.h"
#include "scene/turning.h"

/* base + base_tail += clock, by Knuth's two-sum, so that base_tail holds the rounding error exactly. */
static void advance_base(struct scene_state *q)
{
    const double add = q->base_tail + q->clock;
    const double sum = q->base + add;
    const double shadow = sum - q->base;
    q->base_tail = (q->base - (sum - shadow)) + (add - shadow);
    q->base = sum;
    q->clock = 0.0;
}

/* The input paths of a body: those its motion follows. */
static void shift_paths(const struct scene_values *v, struct scene_state *q, int body)
{
    struct body_path *path = &q->path[body];
    if (body_is_prescribed(v, body)) {
        path_shift(path->displacement, 4, q->clock);
        path_shift(path->velocity, 3, q->clock);
    } else if (body_is_free(v, body)) {
        path_shift(path->force, 3, q->clock);
    }
}

#if SCENE_ANY_ROTATION
/* And those that it turns by. */
static void shift_turning_paths(const struct scene_values *v, struct scene_state *q, int body)
{
    struct body_path *path = &q->path[body];
    if (body_turn_is_prescribed(v, body)) {
        path_shift(path->angular_velocity, 3, q->clock);
        path_shift(path->axis, 3, q->clock);
    } else if (body_turns_freely(v, body)) {
        path_shift(path->torque, 3, q->clock);
    }
}
#endif

void scene_rebase(const struct scene_values *v, struct scene_state *q)
{
    q->integrator_fresh = 1;
    free_bodies_rebase(q);
#if SCENE_ANY_TURNING
    const bool turns = scene_turns(v);
    if (turns) {
        turning_rebase(v, q);
    }
#endif
    if (q->clock == 0.0) {
        return;
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        shift_paths(v, q, i);
    }
#if SCENE_ANY_ROTATION
    for (int i = 0; turns && i < SCENE_BODIES; ++i) {
        shift_turning_paths(v, q, i);
    }
#endif
    free_bodies_shift_clocks(q);
    advance_base(q);
}
