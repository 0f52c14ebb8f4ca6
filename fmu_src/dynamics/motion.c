#include "dynamics/motion.h"

#include <float.h>

void counter_add(int32_t *counter, long more)
{
    const long room = (long)INT32_MAX - *counter;
    *counter += (int32_t)(more < room ? more : room);
}

double motion_time(const struct motion *q)
{
    return q->base + (q->base_tail + q->clock);
}

double motion_remaining(const struct motion *q, double end_time)
{
    return (end_time - q->base) - q->base_tail - q->clock;
}

/* base + base_tail += clock, by Knuth's two-sum, so that base_tail holds the rounding error exactly. */
static void advance_base(struct motion *q)
{
    const double add = q->base_tail + q->clock;
    const double sum = q->base + add;
    const double shadow = sum - q->base;
    q->base_tail = (q->base - (sum - shadow)) + (add - shadow);
    q->base = sum;
    q->clock = 0.0;
}

struct vec3 path_at(const struct vec3 *coefficients, int count, double clock)
{
    struct vec3 value = coefficients[count - 1];
    for (int i = count - 2; i >= 0; --i) {
        value = vec3_axpy(coefficients[i], clock, value);
    }
    return value;
}

void path_shift(struct vec3 *coefficients, int count, double clock)
{
    while (count > 1 && vec3_is_zero(coefficients[count - 1])) {
        --count; /* most paths are constant or zero */
    }
    for (int done = 0; done < count - 1; ++done) {
        for (int i = count - 2; i >= done; --i) {
            coefficients[i] = vec3_axpy(coefficients[i], clock, coefficients[i + 1]);
        }
    }
}

void motion_rebase(struct motion *q)
{
    q->integrator_fresh = 1;
#if SCENE_ANY_FREE
    q->quiet_clock = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        q->origin[i].displacement = vec3_add(q->origin[i].displacement, q->body[i].moved);
        q->origin[i].velocity = q->body[i].velocity;
        q->body[i].moved = vec3_make(0.0, 0.0, 0.0);
    }
#endif
    if (q->clock == 0.0) {
        return;
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        path_shift(q->path[i].displacement, 4, q->clock);
        path_shift(q->path[i].velocity, 3, q->clock);
        path_shift(q->path[i].force, 3, q->clock);
    }
#if SCENE_ANY_FREE
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].touch_clock -= q->clock;
        q->contact[j].change_clock -= q->clock;
        q->contact[j].settled_clock -= q->clock;
        if (q->contact[j].regime == REGIME_APART || q->contact[j].regime == REGIME_RELEASED) {
            q->contact[j].carried_gap = DBL_MAX; /* not known: it has flown on */
        }
    }
    q->horizon_clock -= q->clock;
#endif
    advance_base(q);
}
