#include "segment/driven_friction.h"

#include "scene/turning.h"

#if SCENE_ANY_TURNING

#if SCENE_ANY_FRICTION

struct driven_margin driven_margin_at(const struct driven_contact *c, double clock, struct vec3 spring)
{
    const int j = c->contact;
    struct scene_instant at;
    driven_instant(c, clock, spring, &at);
    const struct friction_law law = scene_friction_law(c->v, c->q, j);
    const enum friction_regime regime = (enum friction_regime)c->q->contact[j].friction_regime;
    const struct friction_state rubbing = turning_rubbing(&c->q->turning, &at, j);
    const double rate = turning_normal_force_rate(c->v, c->q, clock, &at, j);
    const double force = fabs(at.normal_force[j]);
    const bool by_speed = law.damping == 0.0 && regime != FRICTION_STICKING;
    const double stick = friction_stick_event(&law, regime, rubbing, rate);
    const double cap = friction_cap_event(&law, regime, at.normal_force[j]);
    const double lift = friction_lift_event(&law, regime, at.normal_force[j]);
    struct driven_margin least = {stick, by_speed ? vec3_norm(rubbing.slip) : law.static_coefficient * force,
                                  DRIVEN_STICK};
    if (cap < 0.0 && cap < least.value) {
        least = (struct driven_margin){cap, law.coefficient * force, DRIVEN_CAP};
    }
    if (lift < 0.0 && !(least.value < 0.0)) {
        least = (struct driven_margin){lift, force, DRIVEN_LIFT};
    }
    return least;
}

/* The part of what an event function is a difference of that is rounding. */
static const double MARGIN_ROUNDING = 1e-13;

bool driven_margin_is_below(struct driven_margin margin, double floor)
{
    return margin.value < fmin(floor, 0.0) - MARGIN_ROUNDING * margin.scale;
}

/* Where no force tells how long the spring is: of the source's radius. */
static const double FIRST_LENGTH = 1e-4;

/* Of sliding without a dashpot the state is the spring's direction; it begins with that of the slip. */
static struct vec3 first_spring(const struct driven_contact *c, const struct friction_law *law,
                                const struct scene_instant *at)
{
    const struct vec3 slip = at->turning.slip[c->contact];
    const double speed = vec3_norm(slip);
    if (law->damping > 0.0 || !(speed > 0.0)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    const double limit = friction_limit(law, FRICTION_SLIDING, at->normal_force[c->contact]);
    const double length = fmin(limit, law->largest) / law->stiffness;
    const double least = FIRST_LENGTH * body_radius(c->v, contact_source(c->contact));
    return vec3_scale(fmax(length, least) / speed, slip);
}

/* Friction begins at an instant, its spring at rest. */
static void start_friction(const struct driven_contact *c, double clock)
{
    const int j = c->contact;
    struct scene_instant at;
    const struct friction_law law = scene_friction_law(c->v, c->q, j);
    const struct vec3 none = {0.0, 0.0, 0.0};
    c->q->contact[j].friction_regime = (int32_t)FRICTION_STICKING;
    driven_instant(c, clock, none, &at);
    if (!contact_rubs_elastically(c->v, j)) {
        return;
    }
    const double rate = turning_normal_force_rate(c->v, c->q, clock, &at, j);
    const enum friction_regime next =
        friction_onset_regime(&law, at.normal_force[j], rate, at.turning.slip[j]);
    const bool slides = next == FRICTION_SLIDING || next == FRICTION_CAPPED;
    c->q->contact[j].friction_regime = (int32_t)next;
    c->q->turning.spring[j] = slides ? first_spring(c, &law, &at) : none;
}

void driven_take_event(const struct driven_contact *c, double clock, struct vec3 spring,
                       enum driven_event event)
{
    const int j = c->contact;
    int32_t *regime = &c->q->contact[j].friction_regime;
    struct scene_instant at;
    driven_instant(c, clock, spring, &at);
    const struct friction_law law = scene_friction_law(c->v, c->q, j);
    const enum friction_regime before = (enum friction_regime) * regime;
    if (event == DRIVEN_LIFT && before == FRICTION_LIFTED) {
        start_friction(c, clock);
    } else if (event == DRIVEN_LIFT) {
        *regime = (int32_t)FRICTION_LIFTED;
        c->q->turning.spring[j] = vec3_make(0.0, 0.0, 0.0);
    } else if (event == DRIVEN_STICK && before != FRICTION_STICKING) {
        c->q->turning.spring[j] = friction_spring(&law, before, turning_rubbing(&c->q->turning, &at, j));
        *regime = (int32_t)FRICTION_STICKING;
    } else {
        *regime = (int32_t)friction_sliding_regime(&law, at.normal_force[j]);
    }
}

void driven_friction_begin(const struct scene_values *v, struct scene_state *q, double clock, int contact)
{
    const struct driven_contact c = {v, q, contact};
    q->turning.spring[contact] = vec3_make(0.0, 0.0, 0.0);
    if (contact_rubs(v, contact)) {
        start_friction(&c, clock);
    }
}

void driven_friction_end(struct scene_state *q, int contact)
{
    q->turning.spring[contact] = vec3_make(0.0, 0.0, 0.0);
    q->contact[contact].friction_regime = (int32_t)FRICTION_STICKING;
}

struct vec3 driven_spring(const struct scene_state *q, int contact)
{
    return q->turning.spring[contact];
}

void driven_friction_settle(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    const struct driven_contact c = {v, q, contact};
    driven_instant(&c, q->clock, q->turning.spring[contact], &at);
    const struct vec3 n = at.geometry[contact].normal;
    const struct vec3 spring = q->turning.spring[contact];
    q->turning.spring[contact] = vec3_axpy(spring, -vec3_dot(spring, n), n);
    const struct driven_margin margin = driven_margin_at(&c, q->clock, q->turning.spring[contact]);
    if (driven_margin_is_below(margin, 0.0)) {
        driven_take_event(&c, q->clock, q->turning.spring[contact], margin.event);
    }
}

#else

void driven_friction_begin(const struct scene_values *v, struct scene_state *q, double clock, int contact)
{
    (void)v, (void)q, (void)clock, (void)contact;
}

void driven_friction_end(struct scene_state *q, int contact)
{
    (void)q, (void)contact;
}

struct vec3 driven_spring(const struct scene_state *q, int contact)
{
    (void)q, (void)contact;
    return vec3_make(0.0, 0.0, 0.0);
}

#endif

#endif
