#include "segment/driven_regime.h"

#include "scene/free_bodies.h"
#include "scene/onset.h"
#include "scene/present.h"
#include "scene/rounding.h"
#include "scene/turning.h"

#if SCENE_ANY_TURNING

struct vec3 driven_spring(const struct scene_state *q, int contact)
{
#if SCENE_ANY_FRICTION
    return q->turning.spring[contact];
#else
    (void)q, (void)contact;
    return vec3_make(0.0, 0.0, 0.0);
#endif
}

static enum contact_regime regime_of(const struct driven_contact *c)
{
    return (enum contact_regime)c->q->contact[c->contact].regime;
}

static double event_rounding(const struct driven_contact *c, const struct contact_law *law,
                             enum contact_regime regime, const struct scene_instant *at)
{
    const struct contact_geometry *g = &at->geometry[c->contact];
    const struct contact_slopes slopes = contact_event_slopes(law, regime, g->gap, g->gap_rate);
    return rounding_of_event(c->v, law, &slopes, at, c->contact, 0.0);
}

#if SCENE_ANY_FRICTION

static const struct vec3 NO_SPRING = {0.0, 0.0, 0.0};

static void rub_with(const struct driven_contact *c, enum friction_regime regime, struct vec3 spring)
{
    c->q->contact[c->contact].friction_regime = (int32_t)regime;
    c->q->turning.spring[c->contact] = spring;
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
        return NO_SPRING;
    }
    const double limit = friction_limit(law, FRICTION_SLIDING, at->normal_force[c->contact]);
    const double length = fmin(limit, law->largest) / law->stiffness;
    const double least = FIRST_LENGTH * body_radius(c->v, contact_source(c->contact));
    return vec3_scale(fmax(length, least) / speed, slip);
}

/* Whether the dashpot may pull while the bodies overlap: F_n is then the law's push, and changes its sign. */
static bool may_pull(const struct contact_law *law)
{
    return law->dashpot == DASHPOT_UNCLAMPED && !contact_is_elastic(law);
}

/* Friction begins at an instant, its spring at rest. A force that only rounding keeps from being above zero
 * slides. */
static void start_friction(const struct driven_contact *c, double clock)
{
    const int j = c->contact;
    struct scene_instant at;
    const struct friction_law law = scene_friction_law(c->v, c->q, j);
    const struct contact_law normal = scene_contact_law(c->v, c->q, j);
    rub_with(c, FRICTION_STICKING, NO_SPRING);
    driven_instant(c, clock, NO_SPRING, &at);
    const double force = may_pull(&normal) ? at.normal_force[j] : fmax(at.normal_force[j], 0.0);
    const double rate = turning_normal_force_rate(c->v, c->q, clock, &at, j);
    enum friction_regime next = friction_onset_regime(&law, force, rate, at.turning.slip[j]);
    next = force < 0.0 ? FRICTION_LIFTED : next;
    const bool slides = next == FRICTION_SLIDING || next == FRICTION_CAPPED;
    rub_with(c, next, law.kind == FRICTION_ELASTIC && slides ? first_spring(c, &law, &at) : NO_SPRING);
}

/* As the regime of the law begins at an instant. */
static void friction_from(const struct driven_contact *c, double clock)
{
    if (contact_rubs(c->v, c->contact) && contact_transmits(c->q, c->contact)) {
        start_friction(c, clock);
    } else {
        rub_with(c, FRICTION_LIFTED, NO_SPRING);
    }
}

/* The part of what a friction's event function is a difference of that is rounding. */
static const double MARGIN_ROUNDING = 1e-13;

static void put_margin(struct driven_margins *margins, enum driven_event event, double value, double noise)
{
    margins->value[event] = value;
    margins->noise[event] = noise;
}

static void friction_margins(const struct driven_contact *c, double clock, const struct scene_instant *at,
                             struct driven_margins *margins)
{
    const int j = c->contact;
    const struct friction_law law = scene_friction_law(c->v, c->q, j);
    const enum friction_regime regime = (enum friction_regime)c->q->contact[j].friction_regime;
    const struct friction_state rubbing = turning_rubbing(&c->q->turning, at, j);
    const double force = fabs(at->normal_force[j]);
    const double force_noise = rounding_of_force(c->v, c->q, at, j) + MARGIN_ROUNDING * force;
    struct contact_law pull = scene_contact_law(c->v, c->q, j);
    if (may_pull(&pull)) {
        const struct contact_geometry *g = &at->geometry[j];
        const double push = contact_push(&pull, g->gap, g->gap_rate);
        pull.dashpot = DASHPOT_NON_ADHESIVE; /* whose event it is that the push ends */
        put_margin(margins, DRIVEN_LIFT, friction_lift_event(&law, regime, push),
                   event_rounding(c, &pull, REGIME_COMPRESSION, at));
    }
    put_margin(margins, DRIVEN_CAP, friction_cap_event(&law, regime, at->normal_force[j]),
               law.coefficient * force_noise);
    if (law.kind == FRICTION_ELASTIC) {
        const double rate = turning_normal_force_rate(c->v, c->q, clock, at, j);
        const bool by_speed = law.damping == 0.0 && regime != FRICTION_STICKING;
        const double scale = by_speed ? vec3_norm(rubbing.slip) : law.static_coefficient * force;
        put_margin(margins, DRIVEN_STICK, friction_stick_event(&law, regime, rubbing, rate),
                   MARGIN_ROUNDING * scale);
    }
}

/* At a corner of the force the slip may no longer stretch the spring, or the spring may be too long. One
 * event at most follows. */
static void reconsider_friction(const struct driven_contact *c, double clock)
{
    struct driven_margins margins;
    const struct vec3 spring = c->q->turning.spring[c->contact];
    driven_margins_at(c, clock, spring, &margins);
    const enum driven_event event = driven_event_passed(&margins, NULL);
    if (event > DRIVEN_LAW && event < DRIVEN_EVENTS) {
        driven_take_event(c, clock, spring, event);
    }
}

static void take_friction_event(const struct driven_contact *c, double clock, struct vec3 spring,
                                enum driven_event event)
{
    const int j = c->contact;
    struct scene_instant at;
    const struct friction_law law = scene_friction_law(c->v, c->q, j);
    const enum friction_regime before = (enum friction_regime)c->q->contact[j].friction_regime;
    driven_instant(c, clock, spring, &at);
    if (event == DRIVEN_LIFT && before == FRICTION_LIFTED) {
        start_friction(c, clock);
    } else if (event == DRIVEN_LIFT) {
        rub_with(c, FRICTION_LIFTED, NO_SPRING);
    } else if (event == DRIVEN_CAP) {
        rub_with(c, before == FRICTION_CAPPED ? FRICTION_SLIDING : FRICTION_CAPPED, spring);
    } else if (before == FRICTION_STICKING) {
        rub_with(c, friction_sliding_regime(&law, at.normal_force[j]), spring);
    } else {
        rub_with(c, FRICTION_STICKING,
                 friction_spring(&law, before, turning_rubbing(&c->q->turning, &at, j)));
    }
}

/* After the law's event: friction ends with the force, begins with it, and may stick at its corner. */
static void follow_law(const struct driven_contact *c, double clock, enum contact_regime before)
{
    if (!contact_rubs(c->v, c->contact)) {
        return;
    }
    if (before == REGIME_SEPARATING || !contact_transmits(c->q, c->contact)) {
        friction_from(c, clock);
    } else {
        reconsider_friction(c, clock);
    }
}

/* Of what goes on touching while inputs jump: the spring lies across the new normal. */
static void settle_friction(const struct driven_contact *c, enum contact_regime before)
{
    const int j = c->contact;
    struct scene_instant at;
    const double clock = c->q->clock;
    const struct vec3 spring = c->q->turning.spring[j];
    driven_instant(c, clock, spring, &at);
    const struct vec3 n = at.geometry[j].normal;
    c->q->turning.spring[j] = vec3_axpy(spring, -vec3_dot(spring, n), n);
    if (contact_rubs(c->v, j) && !contact_rubs_elastically(c->v, j)) {
        friction_from(c, clock);
    } else {
        follow_law(c, clock, before);
    }
}

#else /* nothing rubs */

static void friction_from(const struct driven_contact *c, double clock)
{
    (void)c, (void)clock;
}

static void follow_law(const struct driven_contact *c, double clock, enum contact_regime before)
{
    (void)c, (void)clock, (void)before;
}

static void settle_friction(const struct driven_contact *c, enum contact_regime before)
{
    (void)c, (void)before;
}

#endif

void driven_margins_at(const struct driven_contact *c, double clock, struct vec3 spring,
                       struct driven_margins *margins)
{
    struct scene_instant at;
    const struct contact_law law = scene_contact_law(c->v, c->q, c->contact);
    for (int i = 0; i < DRIVEN_EVENTS; ++i) {
        margins->value[i] = 1.0;
        margins->noise[i] = 0.0;
    }
    driven_instant(c, clock, spring, &at);
    if (contact_has_events(&law)) {
        const struct contact_geometry *g = &at.geometry[c->contact];
        margins->value[DRIVEN_LAW] = contact_event(&law, regime_of(c), g->gap, g->gap_rate);
        margins->noise[DRIVEN_LAW] = event_rounding(c, &law, regime_of(c), &at);
    }
#if SCENE_ANY_FRICTION
    if (contact_rubs(c->v, c->contact) && contact_transmits(c->q, c->contact)) {
        friction_margins(c, clock, &at, margins);
    }
#endif
}

enum driven_event driven_event_passed(const struct driven_margins *now, const struct driven_margins *start)
{
    for (int i = 0; i < DRIVEN_EVENTS; ++i) {
        /* the law's may jump, in the centre, so that it starts below zero on the other side */
        const double floor = start && i != DRIVEN_LAW ? fmin(start->value[i], 0.0) : 0.0;
        if (now->value[i] < floor - now->noise[i]) {
            return (enum driven_event)i;
        }
    }
    return DRIVEN_EVENTS;
}

void driven_take_event(const struct driven_contact *c, double clock, struct vec3 spring,
                       enum driven_event event)
{
    if (event == DRIVEN_LAW) {
        const struct contact_law law = scene_contact_law(c->v, c->q, c->contact);
        const enum contact_regime before = regime_of(c);
        c->q->contact[c->contact].regime = (int32_t)contact_regime_after(&law, before);
        follow_law(c, clock, before);
    }
#if SCENE_ANY_FRICTION
    if (event != DRIVEN_LAW) {
        take_friction_event(c, clock, spring, event);
    }
#else
    (void)spring;
#endif
}

void driven_begin(const struct driven_contact *c, double clock)
{
    struct scene_instant at;
    struct contact_state *state = &c->q->contact[c->contact];
    scene_kinematics(c->v, c->q, clock, free_bodies_now(c->q), &at);
    (void)onset_note(c->v, c->q, &at, c->contact, scene_regime_of_touching(c->v, c->q, &at, c->contact));
    state->regime = (int32_t)scene_regime_of_touching(c->v, c->q, &at, c->contact);
    friction_from(c, clock);
}

void driven_end(const struct driven_contact *c)
{
    c->q->contact[c->contact].regime = (int32_t)REGIME_APART;
#if SCENE_ANY_FRICTION
    rub_with(c, FRICTION_STICKING, NO_SPRING);
#endif
}

void driven_turning_settle(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    const struct driven_contact c = {v, q, contact};
    const enum contact_regime before = regime_of(&c);
    scene_kinematics(v, q, q->clock, free_bodies_now(q), &at);
    const enum contact_regime regime = scene_regime(v, q, &at, contact);
    const enum contact_regime next = onset_note(v, q, &at, contact, regime);
    q->contact[contact].regime = (int32_t)next;
    if (next == REGIME_APART) {
        driven_end(&c);
    } else if (before == REGIME_APART) {
        friction_from(&c, q->clock);
    } else {
        settle_friction(&c, before);
    }
}

#endif
