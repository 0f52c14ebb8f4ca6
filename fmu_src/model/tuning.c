/*
 * Parameters that are set between steps: the factors of the law, its dashpot, gravity, the solver's
 * tolerances. They are in force from the communication point at which they are set. Those in force until then
 * are kept meanwhile, so that what is set back, or set without an effect, changes nothing.
 */
#include <string.h>

#include "model/motion.h"

static bool same_vector(struct vec3 a, struct vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static struct tunable_values tunable_values_of(const struct scene_values *v)
{
    struct tunable_values now = {.gravity = gravity(v),
                                 .relative_tolerance = solver_relative_tolerance(v),
                                 .absolute_tolerance = solver_absolute_tolerance(v)};
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        now.dashpot[j] = (int32_t)contact_dashpot(v, j);
    }
    return now;
}

/* A deferred flight is caught up with the gravity that it had. */
void model_begin_tuning(struct model *m)
{
    if (!m->state.tuned) {
        motion_catch_up(&m->state.values, &m->state.motion);
        m->state.in_force = tunable_values_of(&m->state.values);
    }
    m->state.tuned = 1;
    m->state.signals_changed = 1;
    m->state.signals_open = 1;
}

/* What differs of contact and gravity, and whether anything does. */
static bool differs(const struct scene_values *v, const struct scene_state *q,
                    const struct tunable_values *before, struct motion_tuning *tuning)
{
    bool any = !same_vector(gravity(v), before->gravity);
    tuning->more_gravity = vec3_sub(gravity(v), before->gravity);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_coefficients *now = &q->contact[j].parameters.factors;
        const struct contact_coefficients next = model_factors(v, q, j);
        tuning->factors[j] = next;
        tuning->law_changed[j] =
            next.k != now->k || next.c != now->c || contact_dashpot(v, j) != before->dashpot[j];
        any = any || tuning->law_changed[j];
    }
    return any;
}

/* CVODE takes its tolerances when it starts. */
static bool take_over(const struct scene_values *v, struct scene_state *q,
                      const struct tunable_values *before)
{
    struct motion_tuning tuning;
    if (solver_relative_tolerance(v) != before->relative_tolerance ||
        solver_absolute_tolerance(v) != before->absolute_tolerance) {
        q->integrator_fresh = 1;
    }
    return !differs(v, q, before, &tuning) || motion_tune(v, q, &tuning);
}

bool model_tune(struct model *m)
{
    if (!m->state.tuned) {
        return true;
    }
    const struct scene_state before = m->state.motion;
    const bool taken = take_over(&m->state.values, &m->state.motion, &m->state.in_force);
    if (!taken) {
        m->state.motion = before;
    }
    m->state.tuned = !taken;
    return taken;
}

bool model_can_tune(const struct model *m, const struct variable *variable, const void *value)
{
    struct scene_values v = m->state.values;
    struct scene_state q = m->state.motion;
    const struct tunable_values before = m->state.tuned ? m->state.in_force : tunable_values_of(&v);
    motion_catch_up(&m->state.values, &q);
    memcpy((char *)&v + variable->offset, value, variable_size(variable));
    return take_over(&v, &q, &before);
}
