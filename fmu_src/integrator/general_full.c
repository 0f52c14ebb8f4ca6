/* Steps of the general segment in which friction is so stiff that Newton's method takes the Jacobian at every
 * stage. */
#include "integrator/general_memory.h"
#include "scene/turning.h"

#if SCENE_ANY_FRICTION
/* What is put back after a first guess. */
struct kept_friction {
    int32_t regime[SCENE_CONTACTS];
    double slip_velocity[SCENE_CONTACTS];
};

/* Regularized friction as its tangent at no slip, under the normal force at the start of the step, and
 * back: it does not saturate, so that Newton's method finds where the slip is as small as it is in
 * rolling, from any guess. */
static void straighten_friction(struct general *g, struct kept_friction *kept)
{
    struct scene_instant at;
    ode_instant(&g->ode, g->step.start, g->step.y, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct contact_state *contact = &g->state->contact[j];
        const struct friction_law law = scene_friction_law(g->ode.values, g->state, j);
        const double limit =
            friction_limit(&law, (enum friction_regime)contact->friction_regime, at.normal_force[j]);
        kept->regime[j] = contact->friction_regime;
        kept->slip_velocity[j] = contact->parameters.slip_velocity;
        if (law.kind == FRICTION_REGULARIZED && limit > 0.0) {
            contact->friction_regime = (int32_t)FRICTION_STICKING;
            contact->parameters.slip_velocity *= law.largest / limit;
        }
    }
}

static void restore_friction(struct general *g, const struct kept_friction *kept)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        g->state->contact[j].friction_regime = kept->regime[j];
        g->state->contact[j].parameters.slip_velocity = kept->slip_velocity[j];
    }
}
#endif

bool general_solve_fully(struct general *g, bool thoroughly)
{
#if SCENE_ANY_FRICTION
    struct radau_step *p = &g->step;
    const bool goes_on = radau_step_goes_on(p);
    if (goes_on && radau_step_solve_quickly(p, general_newton_share(g))) {
        return true;
    }
    if (!thoroughly) {
        return false;
    }
    if (goes_on) {
        radau_step_guess_on(p, p->stages, p->length);
    }
    struct kept_friction kept;
    straighten_friction(g, &kept);
    const bool rolls = radau_step_approach(p); /* the slip is found afterwards */
    restore_friction(g, &kept);
    general_set_weights(g); /* the first guess may have been far off */
    return rolls && radau_step_solve_fully(p, general_newton_share(g));
#else
    (void)g, (void)thoroughly;
    return false;
#endif
}
