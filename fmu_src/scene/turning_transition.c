#include "scene/turning_transition.h"

#include "scene/present.h"

#if SCENE_ANY_FRICTION

static void set_friction_regime(struct scene_state *q, int contact, enum friction_regime regime)
{
    q->contact[contact].friction_regime = (int32_t)regime;
}

/* The spring is at rest; what it stored counts as dissipated from now on (energy.friction). */
static void end_friction(struct scene_state *q, int contact)
{
    set_friction_regime(q, contact, FRICTION_LIFTED);
    q->turning.spring[contact] = vec3_make(0.0, 0.0, 0.0);
}

/* Of sliding without a dashpot the state is the spring's direction, of any length: against the slip that
 * begins, 1 m. */
static struct vec3 first_direction(const struct friction_law *law, struct vec3 slip)
{
    const double speed = vec3_norm(slip);
    return law->damping > 0.0 || !(speed > 0.0) ? vec3_make(0.0, 0.0, 0.0) : vec3_scale(1.0 / speed, slip);
}

static void begin_friction(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    end_friction(q, contact);
    scene_now(v, q, &at);
    const double force = at.normal_force[contact];
    if (force < 0.0) {
        return; /* a dashpot that pulls */
    }
    const struct friction_law law = scene_friction_law(v, q, contact);
    const double force_rate = turning_normal_force_rate(v, q, q->clock, &at, contact);
    const struct vec3 slip = at.turning.slip[contact];
    const enum friction_regime next = friction_onset_regime(&law, force, force_rate, slip);
    set_friction_regime(q, contact, next);
    if (law.kind == FRICTION_ELASTIC && next != FRICTION_STICKING) {
        q->turning.spring[contact] = first_direction(&law, slip);
    }
}

static void stick(const struct friction_law *law, enum friction_regime regime, struct friction_state rubbing,
                  struct scene_state *q, int contact)
{
    q->turning.spring[contact] = friction_spring(law, regime, rubbing);
    set_friction_regime(q, contact, FRICTION_STICKING);
}

/* Under mu_s > mu the spring jumps back as it breaks away; where the slip does not stretch it on from there,
 * the contact sticks again at once. */
static void break_away(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    const struct friction_law law = scene_friction_law(v, q, contact);
    scene_now(v, q, &at);
    const enum friction_regime next = friction_sliding_regime(&law, at.normal_force[contact]);
    if (next == FRICTION_LIFTED) {
        end_friction(q, contact);
        return;
    }
    set_friction_regime(q, contact, next);
    scene_now(v, q, &at);
    const struct friction_state rubbing = turning_rubbing(&q->turning, &at, contact);
    const double force_rate = turning_normal_force_rate(v, q, q->clock, &at, contact);
    const bool jumps = law.damping == 0.0 && law.static_coefficient > law.coefficient;
    if (jumps && friction_stick_event(&law, next, rubbing, force_rate) < 0.0) {
        stick(&law, next, rubbing, q, contact);
    }
}

static void stop_sliding(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    const struct friction_law law = scene_friction_law(v, q, contact);
    scene_now(v, q, &at);
    stick(&law, (enum friction_regime)q->contact[contact].friction_regime,
          turning_rubbing(&q->turning, &at, contact), q, contact);
}

/* The regime that the present force asks for, of friction that goes on. */
static void reconsider(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    const struct friction_law law = scene_friction_law(v, q, contact);
    const enum friction_regime regime = (enum friction_regime)q->contact[contact].friction_regime;
    scene_now(v, q, &at);
    const double force = at.normal_force[contact];
    if (regime == FRICTION_STICKING) {
        const struct friction_state rubbing = turning_rubbing(&q->turning, &at, contact);
        if (friction_stick_event(&law, regime, rubbing, 0.0) < 0.0) {
            break_away(v, q, contact);
        }
    } else if (force > 0.0 && regime == FRICTION_LIFTED) {
        begin_friction(v, q, contact);
    } else if (force > 0.0) {
        set_friction_regime(q, contact, friction_sliding_regime(&law, force));
    } else if (force < 0.0) {
        end_friction(q, contact);
    }
}

void turning_take_regime(const struct scene_values *v, struct scene_state *q, int contact,
                         enum contact_regime before)
{
    if (!contact_rubs(v, contact)) {
        return;
    }
    const bool rubbed = before == REGIME_COMPRESSION || before == REGIME_RESTITUTION;
    if (!contact_transmits(q, contact)) {
        end_friction(q, contact);
    } else if (!rubbed) {
        begin_friction(v, q, contact);
    } else {
        reconsider(v, q, contact);
    }
}

void turning_take_event(const struct scene_values *v, struct scene_state *q, int contact,
                        enum ode_event event)
{
    const enum friction_regime regime = (enum friction_regime)q->contact[contact].friction_regime;
    if (event == ODE_EVENT_STICK && regime == FRICTION_STICKING) {
        break_away(v, q, contact);
    } else if (event == ODE_EVENT_STICK) {
        stop_sliding(v, q, contact);
    } else if (event == ODE_EVENT_CAP) {
        set_friction_regime(q, contact, regime == FRICTION_CAPPED ? FRICTION_SLIDING : FRICTION_CAPPED);
    } else if (regime == FRICTION_LIFTED) {
        begin_friction(v, q, contact);
    } else {
        end_friction(q, contact);
    }
}

#endif
