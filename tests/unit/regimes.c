/* The table of all regimes of the normal law and of friction, under every choice of law, dashpot and
 * friction: each ends by an event wherever the laws ask for another one, also where rounding has chosen. */
#include <float.h>

#include "scene/ode.h"
#include "scene/transition.h"

#include "check.h"
#include "random.h"
#include "scene_model.h"

/* A choice of laws: one row of the table. */
struct choice {
    enum contact_force_law law;
    enum dashpot dashpot;
    enum friction friction;
    bool damped, tangentially_damped, breaks_away_late, has_largest, stiffens;
};

enum { CHOICES = 2 * 3 * 2 * 32, STATES = 60 };

static struct choice choice_of(int i)
{
    return (struct choice){i % 2 ? LAW_HERTZ : LAW_LINEAR,
                           (enum dashpot)((int)DASHPOT_NON_ADHESIVE + i / 2 % 3),
                           i / 6 % 2 ? FRICTION_ELASTIC : FRICTION_REGULARIZED,
                           (i / 12 & 1) != 0,
                           (i / 12 & 2) != 0,
                           (i / 12 & 4) != 0,
                           (i / 12 & 8) != 0,
                           i % 2 && (i / 12 & 16) != 0};
}

/* A sphere beside a fixed cylinder along z, whose normal is x: what the laws depend on is set by hand. */
static struct model model_of(struct choice choice)
{
    struct model m = scene_model();
    struct scene_values *v = &m.state.values;
    struct scene_contact_values *contact = &v->contact[0];
    contact->law = choice.law;
    contact->method = choice.damped ? METHOD_PENALTY_DYNAMIC : METHOD_PENALTY;
    contact->dashpot = choice.dashpot;
    contact->penalty_factor = 1e3;
    contact->hertz_stiffness = 1e4;
    contact->viscous_penalty_factor = 2.0;
    contact->hunt_crossley_factor = 0.5;
    contact->friction = choice.friction;
    contact->friction_coefficient = 0.5;
    contact->static_friction_coefficient = choice.breaks_away_late ? 0.7 : 0.5;
    contact->tangential_stiffness = 500.0;
    contact->tangential_law = choice.stiffens ? TANGENTIAL_LAW_MINDLIN : TANGENTIAL_LAW_LINEAR;
    contact->tangential_ratio = 0.8;
    contact->tangential_damping = choice.tangentially_damped ? 3.0 : 0.0;
    contact->maximum_friction_force = choice.has_largest ? 2.0 : 1e6;
    contact->slip_velocity_control = SLIP_VELOCITY_CONTROL_USER_DEFINED;
    contact->characteristic_slip_velocity = 0.1;
    scene_start_free(&m, SOURCE, vec3_make(0.59, 0.0, 0.0), vec3_make(-0.1, 0.0, 0.0));
    model_prepare(&m);
    return m;
}

/* The depth is that of the accumulated gap, which tells digits that positions do not. */
static void put_state(struct scene_state *q, double gap, struct vec3 velocity, struct vec3 spring)
{
    q->body[SOURCE].moved = vec3_make(gap + 0.01, 0.0, 0.0);
    q->body[SOURCE].velocity = velocity;
    q->contact[0].physics.accumulated_gap = gap;
    q->turning.spring[0][OPPOSED_SLIP] = spring;
}

/* Deep, shallow, and where a regime changes but for a few roundings, on either side. */
static void put_any_state(struct random *r, struct scene_state *q)
{
    static const double GAPS[] = {-1e-2, -1e-3, -1e-6, -1e-12, -1e-17, 0.0, 1e-17};
    static const double SLIPS[] = {0.0, 1e-9, 1e-3, 1.0};
    const double gap = GAPS[random_index(r, 7)];
    const double pushes_until[] = {0.0, 0.5, -1.0, 1.0, -500.0 * gap, 2.0, -1e-17, 1e-17};
    const double rate = pushes_until[random_index(r, 8)] * (1.0 + random_index(r, 3) * 4.0 * DBL_EPSILON);
    const double angle = random_between(r, 0.0, 6.3);
    const double turned = random_between(r, 0.0, 6.3);
    const double slip = SLIPS[random_index(r, 4)];
    const double length = SLIPS[random_index(r, 3)];
    put_state(q, gap, vec3_make(rate, slip * cos(angle), slip * sin(angle)),
              vec3_make(0.0, length * cos(turned), length * sin(turned)));
}

/* Less than this part of what a law compares decides nothing here: offsets are some hundred roundings. */
static const double BEYOND_DOUBT = 1e-6;

static bool is_below(double a, double b)
{
    return a < b - BEYOND_DOUBT * (1.0 + fabs(a) + fabs(b));
}

/* Whether the normal law, written out, asks for another regime beyond doubt. */
static bool law_is_wrong(struct choice choice, enum contact_regime regime, double gap, double rate)
{
    const double push =
        choice.law == LAW_HERTZ ? 1.0 - 0.5 * rate : -1e3 * gap - 2.0 * rate; /* as the header of the law */
    if (!choice.damped || choice.dashpot == DASHPOT_UNCLAMPED) {
        return regime != REGIME_COMPRESSION;
    }
    const double until = choice.dashpot == DASHPOT_APPROACH_ONLY ? -rate : push;
    return regime == REGIME_COMPRESSION ? is_below(until, 0.0) : is_below(0.0, until);
}

static double normal_force(struct choice choice, enum contact_regime regime, double gap, double rate)
{
    const bool damped = choice.damped && regime == REGIME_COMPRESSION;
    return choice.law == LAW_HERTZ ? 1e4 * pow(-gap, 1.5) * (1.0 - (damped ? 0.5 * rate : 0.0))
                                   : -1e3 * gap - (damped ? 2.0 * rate : 0.0);
}

static bool sliding_is_wrong(struct choice choice, enum friction_regime regime, double force,
                             double force_rate, const struct contact_geometry *g, const struct scene_state *q)
{
    const double k_t = choice.stiffens ? 0.8 * 1.5 * 1e4 * sqrt(-g->gap) : 500.0;
    const double grows = choice.stiffens ? 0.5 * g->gap_rate / g->gap : 0.0; /* k_t' / k_t */
    const double largest = choice.has_largest ? 2.0 : 1e6;
    const double c_t = choice.tangentially_damped ? 3.0 : 0.0;
    const struct vec3 slip = vec3_make(0.0, q->body[SOURCE].velocity.y, q->body[SOURCE].velocity.z);
    const struct vec3 spring = q->turning.spring[0][OPPOSED_SLIP];
    const double carried = vec3_norm(vec3_axpy(vec3_scale(k_t, spring), c_t, slip));
    const double mu_s = choice.breaks_away_late ? 0.7 : 0.5;
    if (regime == FRICTION_STICKING) {
        return choice.friction == FRICTION_REGULARIZED || is_below(fmin(mu_s * force, largest), carried);
    }
    if (regime == FRICTION_SLIDING ? is_below(largest, 0.5 * force) : is_below(0.5 * force, largest)) {
        return true;
    }
    const double limit = regime == FRICTION_SLIDING ? 0.5 * force : largest;
    if (choice.friction == FRICTION_REGULARIZED || !(vec3_norm(spring) > 0.0)) {
        return false;
    }
    const double limit_rate = regime == FRICTION_SLIDING ? 0.5 * force_rate : 0.0;
    return c_t > 0.0
               ? is_below(carried, limit)
               : is_below(vec3_dot(slip, spring) / vec3_norm(spring), (limit_rate - grows * limit) / k_t);
}

/* Whether friction is in a regime that is not its own at the present of q. */
static bool friction_is_wrong(struct choice choice, const struct scene_state *q, double gap, double rate)
{
    struct scene_instant at;
    const enum contact_regime regime = (enum contact_regime)q->contact[0].regime;
    const enum friction_regime friction = (enum friction_regime)q->contact[0].friction_regime[OPPOSED_SLIP];
    const double force = normal_force(choice, regime, gap, rate);
    const bool may_pull = choice.damped && choice.dashpot == DASHPOT_UNCLAMPED;
    if (friction == FRICTION_LIFTED) {
        return !may_pull || is_below(0.0, force);
    }
    if (is_below(force, 0.0)) {
        return may_pull;
    }
    scene_now(q, &at);
    const double force_rate = turning_normal_force_rate(&at, 0);
    return sliding_is_wrong(choice, friction, force, force_rate, &at.geometry[0], q);
}

/* The event functions are negative, and Model Exchange sees it as well. */
static void check_ends(const struct scene_ode *ode, struct scene_state *q, bool by_law)
{
    double y[ODE_MOST_STATES] = {0.0};
    double events[ODE_EVENTS];
    struct scene_instant at;
    bool ends = false;
    ode_pack(ode, y);
    ode_events(ode, q->clock, y, events);
    for (int e = 0; e < ODE_EVENTS; ++e) {
        ends = ends || events[e] < 0.0;
    }
    CHECK(ends);
    scene_now(q, &at);
    CHECK(by_law ? regime_event(&at, 0) == ODE_EVENT_LAW : regime_event(&at, 0) > ODE_EVENT_LAW);
}

/* Any state of touch, and whether the normal law or friction asks for another regime there. */
struct wrong {
    bool law, friction;
};

static struct wrong put_deep_state(struct random *r, struct choice choice, struct model *m)
{
    struct scene_state *q = &m->state.motion;
    const double gap = -random_between(r, 1e-4, 1e-2);
    const double rate = random_between(r, -4.0, 4.0);
    const struct vec3 velocity = vec3_make(rate, random_between(r, -2.0, 2.0), 0.0);
    const double length = random_index(r, 2) == 0 ? 0.05 : 1e-3;
    put_state(q, gap, velocity,
              vec3_make(0.0, random_between(r, -length, length), random_between(r, -length, length)));
    return (struct wrong){law_is_wrong(choice, (enum contact_regime)q->contact[0].regime, gap, rate),
                          friction_is_wrong(choice, q, gap, rate)};
}

/* The events of friction lead to a regime that is right. */
static void check_next(struct choice choice, struct model *m)
{
    struct scene_state *q = &m->state.motion;
    struct scene_instant at;
    enum { MOST_EVENTS = 4 };
    for (int i = 0; i < MOST_EVENTS; ++i) {
        scene_now(q, &at);
        const int event = regime_event(&at, 0);
        if (event > ODE_EVENT_LAW) {
            turning_take_event(q, 0, (enum ode_event)event);
        }
    }
    scene_now(q, &at);
    const struct contact_geometry *g = &at.geometry[0];
    CHECK(!friction_is_wrong(choice, q, g->gap, g->gap_rate));
}

/* From a state in which a pair of regimes is right to states in which it is wrong. */
static void check_pair(struct random *r, struct choice choice, struct model *m)
{
    struct scene_state *q = &m->state.motion;
    struct scene_ode ode = {
        .values = &m->state.values, .state = q, .layout = ode_layout_of(&m->state.values, NULL)};
    struct scene_instant at;
    struct wrong wrong = {true, true};
    for (int i = 0; i < 1000 && (wrong.law || wrong.friction); ++i) {
        wrong = put_deep_state(r, choice, m);
    }
    CHECK(!wrong.law && !wrong.friction);
    scene_now(q, &at);
    ode_begin(&ode, &at, 1e-12, 1e-15);
    for (int i = 0; i < 4; ++i) {
        wrong = put_deep_state(r, choice, m);
        if (wrong.law || wrong.friction) {
            check_ends(&ode, q, wrong.law);
        }
        if (!wrong.law && wrong.friction) {
            check_next(choice, m);
        }
    }
}

/* Into each regime of the normal law that the choice has, from apart and from the other one. */
static void check_regime(struct random *r, struct choice choice, struct model *m, enum contact_regime regime,
                         enum contact_regime before)
{
    struct scene_state *q = &m->state.motion;
    put_any_state(r, q);
    q->contact[0].friction_regime[OPPOSED_SLIP] =
        (int32_t)(before == REGIME_APART ? random_index(r, 4) : FRICTION_SLIDING);
    q->contact[0].regime = (int32_t)before;
    transition_set_regime(q, 0, regime);
    check_pair(r, choice, m);
}

TEST(every_regime_in_touch_has_an_event_that_ends_it)
{
    struct random r = {23};
    for (int i = 0; i < CHOICES; ++i) {
        const struct choice choice = choice_of(i);
        struct model m = model_of(choice);
        m.state.motion.v = &m.state.values;
        const bool eases = choice.damped && choice.dashpot == DASHPOT_APPROACH_ONLY;
        for (int k = 0; k < STATES; ++k) {
            const enum contact_regime regime = eases && k % 2 ? REGIME_RESTITUTION : REGIME_COMPRESSION;
            const enum contact_regime other = k % 2 ? REGIME_COMPRESSION : REGIME_RESTITUTION;
            check_regime(&r, choice, &m, regime, k % 4 < 2 || !eases ? REGIME_APART : other);
        }
    }
}

/* Where no dashpot pulls, friction acts in all of a contact. */
TEST(nothing_lifts_friction_where_nothing_pulls)
{
    struct random r = {29};
    for (int i = 0; i < CHOICES; ++i) {
        const struct choice choice = choice_of(i);
        struct model m = model_of(choice);
        struct scene_state *q = &m.state.motion;
        q->v = &m.state.values;
        for (int k = 0; k < STATES && !(choice.damped && choice.dashpot == DASHPOT_UNCLAMPED); ++k) {
            put_any_state(&r, q);
            q->contact[0].regime = (int32_t)(k % 2 ? REGIME_APART : REGIME_SEPARATING);
            transition_set_regime(q, 0, REGIME_COMPRESSION);
            CHECK(q->contact[0].friction_regime[OPPOSED_SLIP] != (int32_t)FRICTION_LIFTED);
        }
    }
}
