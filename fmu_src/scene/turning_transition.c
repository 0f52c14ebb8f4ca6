#include "scene/turning_transition.h"

#include "scene/present.h"

#if SCENE_ANY_FRICTION

static void set_friction_regime(struct scene_state *q, int contact, enum friction_regime regime)
{
    q->contact[contact].friction_regime = (int32_t)regime;
}

/* Whether the dashpot pulls. Its lift event looks at the push, so this does, too: friction that is lifted has
 * an event that ends it. */
static bool is_lifted(const struct scene_values *v, const struct scene_state *q,
                      const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    return contact_may_pull(&law) && contact_push(&law, g->gap, g->gap_rate) < 0.0;
}

/* A force that is not above zero where nothing pulls is rounding, or about to grow. */
static enum friction_regime sliding_regime(const struct friction_law *law, double normal_force)
{
    return normal_force > 0.0 ? friction_sliding_regime(law, normal_force) : FRICTION_SLIDING;
}

/* The spring is at rest; what it stored counts as dissipated from now on (energy.friction). */
static void end_friction(struct scene_state *q, int contact)
{
    set_friction_regime(q, contact, FRICTION_LIFTED);
    q->turning.spring[contact] = vec3_make(0.0, 0.0, 0.0);
}

/*
 * What the normal force comes to in an impact [N]: the spring's where it has stored the energy of the
 * approach. An energy goes with the power 2 of the depth, under Hertz's law 5/2. Zero where nothing tells.
 */
static double impact_force(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const double per_mass = scene_inverse_mass(v, contact);
    const double at_one_metre = contact_stored_energy(&law, REGIME_COMPRESSION, -1.0);
    const double rate = at->geometry[contact].gap_rate;
    if (!(per_mass > 0.0) || !(at_one_metre > 0.0)) {
        return 0.0;
    }
    const double part = 0.5 * rate * rate / (per_mass * at_one_metre);
    const double depth = pow(part, contact_is_hertz(&law) ? 0.4 : 0.5);
    return -contact_stored_slope(&law, REGIME_COMPRESSION, -depth);
}

/* A spring's length where no force tells: of the source's radius. */
static const double TYPICAL_LENGTH = 1e-4;

/* Of sliding without a dashpot the state is the spring's direction, that of the slip as it begins, with a
 * typical length. */
static struct vec3 first_direction(const struct scene_values *v, const struct scene_state *q,
                                   const struct scene_instant *at, const struct friction_law *law,
                                   int contact)
{
    const struct vec3 slip = at->turning.slip[contact];
    const double speed = vec3_norm(slip);
    if (law->damping > 0.0 || !(speed > 0.0)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    const double force = fmax(at->normal_force[contact], impact_force(v, q, at, contact));
    const double length = fmin(law->coefficient * force, law->largest) / law->stiffness;
    const double typical = length > 0.0 ? length : TYPICAL_LENGTH * body_radius(v, contact_source(contact));
    return vec3_scale(typical / speed, slip);
}

static void begin_friction(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    end_friction(q, contact);
    scene_now(v, q, &at);
    const double force = at.normal_force[contact];
    const struct friction_law law = scene_friction_law(v, q, contact);
    const double force_rate = turning_normal_force_rate(v, q, q->clock, &at, contact);
    const struct vec3 slip = at.turning.slip[contact];
    const enum friction_regime next = friction_onset_regime(&law, force, force_rate, slip);
    set_friction_regime(q, contact, next);
    if (law.kind == FRICTION_ELASTIC && next != FRICTION_STICKING) {
        q->turning.spring[contact] = first_direction(v, q, &at, &law, contact);
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
    const enum friction_regime next = sliding_regime(&law, at.normal_force[contact]);
    if (is_lifted(v, q, &at, contact)) {
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

/* At a corner of the law, where the force falls more slowly from then on or begins to rise, and where a
 * given velocity jumps, the slip may no longer stretch the spring. */
static void keep_sliding(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    const struct friction_law law = scene_friction_law(v, q, contact);
    scene_now(v, q, &at);
    const enum friction_regime next = sliding_regime(&law, at.normal_force[contact]);
    const struct friction_state rubbing = turning_rubbing(&q->turning, &at, contact);
    const double force_rate = turning_normal_force_rate(v, q, q->clock, &at, contact);
    set_friction_regime(q, contact, next);
    if (friction_stick_event(&law, next, rubbing, force_rate) < 0.0) {
        stick(&law, next, rubbing, q, contact);
    }
}

/* The regime that the present force asks for. */
static void reconsider(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    const struct friction_law law = scene_friction_law(v, q, contact);
    const enum friction_regime regime = (enum friction_regime)q->contact[contact].friction_regime;
    scene_now(v, q, &at);
    if (is_lifted(v, q, &at, contact)) {
        end_friction(q, contact);
    } else if (regime == FRICTION_LIFTED) {
        begin_friction(v, q, contact);
    } else if (regime == FRICTION_STICKING) {
        const struct friction_state rubbing = turning_rubbing(&q->turning, &at, contact);
        if (friction_stick_event(&law, regime, rubbing, 0.0) < 0.0) {
            break_away(v, q, contact);
        }
    } else {
        keep_sliding(v, q, contact);
    }
}

void turning_take_regime(const struct scene_values *v, struct scene_state *q, int contact,
                         enum contact_regime before)
{
    if (!contact_rubs(v, contact)) {
        return;
    }
    const bool rubbed = before == REGIME_COMPRESSION || before == REGIME_RESTITUTION;
    const bool rubs = contact_transmits(q, contact);
    if (!rubs || !rubbed) {
        end_friction(q, contact);
    }
    if (rubs) {
        reconsider(v, q, contact);
    }
}

void turning_take_event(const struct scene_values *v, struct scene_state *q, int contact,
                        enum ode_event event)
{
    const enum friction_regime regime = (enum friction_regime)q->contact[contact].friction_regime;
    if (regime == FRICTION_STICKING && (event == ODE_EVENT_STICK || event == ODE_EVENT_CAP)) {
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
