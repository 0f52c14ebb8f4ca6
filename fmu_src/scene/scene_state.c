#include "scene/scene_state.h"

void counter_add(int32_t *counter, long more)
{
    const long room = (long)INT32_MAX - *counter;
    *counter += (int32_t)(more < room ? more : room);
}

double scene_time(const struct scene_state *q)
{
    return q->base + (q->base_tail + q->clock);
}

double scene_remaining(const struct scene_state *q, double end_time)
{
    return (end_time - q->base) - q->base_tail - q->clock;
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
    if (path_is_steady(coefficients, count)) {
        return;
    }
    for (int done = 0; done < count - 1; ++done) {
        for (int i = count - 2; i >= done; --i) {
            coefficients[i] = vec3_axpy(coefficients[i], clock, coefficients[i + 1]);
        }
    }
}
