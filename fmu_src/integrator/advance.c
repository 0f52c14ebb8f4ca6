#include "integrator/advance.h"

const struct scene_instant *advance_now(struct advance *step, const struct scene_values *v,
                                        const struct scene_state *q)
{
    if (!step->is_now) {
        scene_kinematics_now(v, q, &step->now);
        step->is_now = true;
    }
    return &step->now;
}
