#include <float.h>

#include "flight/relative_path.h"
#include "flight/tumbling.h"
#include "math/polynomial.h"
#include "prescribed/driven.h"
#include "scene/dense_output.h"
#include "scene/evaluate.h"
#include "scene/present.h"

/*
 * Impulses and energies of a contact that turns or rubs while all motion is given, over the time in which it
 * touches: quadratures of smooth formulas, whose panels are halved until halves and whole
 * agree, from one change of a regime to the next, which is located.
 */

/* One contact over a span. */
struct driven_span {
    struct driven_contact c;
    struct driven_panel total; /* its size: of the contact so far; its spring: the present one */
    double sum[DRIVEN_TERMS];
    bool elastic;               /* friction has a spring */
    long *panels, *evaluations; /* that are left, of the quadrature and of the search for touches */
    long panel_cost;            /* in panels of bodies that do not turn about changing directions */
};

/* From one clock to another, between which the bodies touch. False: no panels are left. */
static bool driven_integrate(struct driven_span *s, double from, double end);

void driven_instant(const struct driven_contact *c, double clock, struct vec3 spring,
                    struct scene_instant *at)
{
    scene_kinematics(c->v, c->q, clock, c->q->body, at);
    if (SCENE_ANY_FRICTION) {
        c->q->turning.spring[c->contact] = spring;
    }
    scene_forces(c->v, c->q, clock, at);
}

static void put_vector(double *out, struct vec3 a)
{
    out[0] = a.x;
    out[1] = a.y;
    out[2] = a.z;
}

/* What is integrated, and in `scale` how large such quantities are made of. */
static void driven_rates(const struct driven_contact *c, const struct scene_instant *at,
                         double rate[DRIVEN_TERMS], double scale[DRIVEN_TERMS])
{
    const int j = c->contact;
    const struct turning_instant *turning = &at->turning;
    const struct contact_law law = scene_contact_law(c->v, c->q, j);
    const struct contact_geometry *g = &at->geometry[j];
    put_vector(rate + DRIVEN_FORCE, at->source_force[j]);
    put_vector(rate + DRIVEN_SOURCE_TORQUE, turning->source_torque[j]);
    put_vector(rate + DRIVEN_DESTINATION_TORQUE, turning->destination_torque[j]);
    rate[DRIVEN_DISSIPATED] = contact_dissipated_power(&law, (enum contact_regime)c->q->contact[j].regime,
                                                       at->normal_force[j], g->gap, g->gap_rate);
    rate[DRIVEN_FRICTION] = -vec3_dot(turning->friction_force[j], turning->slip[j]);
    rate[DRIVEN_WORK] = scene_driving_power(c->v, at, j);
    const double force = vec3_norm(at->source_force[j]);
    const double arm = vec3_norm(turning->source_arm[j]) + vec3_norm(turning->destination_arm[j]);
    const struct body_turn *source = &turning->body[contact_source(j)];
    const struct body_turn *destination = &turning->body[contact_destination(j)];
    const double speed =
        vec3_norm(at->velocity[contact_source(j)]) + vec3_norm(at->velocity[contact_destination(j)]) +
        arm * (vec3_norm(source->angular_velocity) + vec3_norm(destination->angular_velocity));
    for (int k = 0; k < DRIVEN_EVENT; ++k) {
        scale[k] = force * (k < DRIVEN_SOURCE_TORQUE ? 1.0 : k < DRIVEN_DISSIPATED ? arm : speed);
    }
    const enum contact_regime regime = (enum contact_regime)c->q->contact[j].regime;
    /* a spring may lose energy while the force is clipped to zero */
    scale[DRIVEN_DISSIPATED] += fabs(contact_stored_slope(&law, regime, g->gap)) * speed;
    const struct contact_slopes slopes = contact_event_slopes(&law, regime, g->gap, g->gap_rate);
    rate[DRIVEN_EVENT] = contact_has_events(&law) ? contact_event(&law, regime, g->gap, g->gap_rate) : 0.0;
    scale[DRIVEN_EVENT] = fabs(slopes.by_gap * g->gap) + fabs(slopes.by_rate) * vec3_norm(at->rate[j]);
}

/* Integrals from 0 to node i of [0, 1] of the polynomial that is 1 at node j and 0 at the other nodes of the
 * Gauss rule; computed from that definition with 30 digits. */
static const double COLLOCATION[GAUSS_NODES][GAUSS_NODES] = {
    {0.059231721264047272, -0.019570364359076037, 0.011254400818642956, -0.0055937936608121849,
     0.0015881129678659985},
    {0.12815100567004528, 0.11965716762484162, -0.0245921146196422, 0.010318280670683357,
     -0.002768994398769603},
    {0.1137762880042246, 0.26000465168064152, 0.14222222222222222, -0.020690316430958285,
     0.0046871545238699412},
    {0.12123243692686415, 0.22899605457899988, 0.30903655906408664, 0.11965716762484162,
     -0.0096875631419507397},
    {0.11687532956022855, 0.24490812891049542, 0.27319004362580149, 0.25888469960875927,
     0.059231721264047272}};

enum { UNKNOWNS = 3 * GAUSS_NODES };

/* What the rate of the spring depends on at a node, besides the spring. */
struct spring_node {
    struct friction_state rubbing;
    struct vec3 normal, normal_rate;
    double factor; /* of the rate, for the variable of a panel of length one [s] */
};

struct spring_problem {
    struct friction_law law;
    enum friction_regime regime;
    struct spring_node node[GAUSS_NODES];
    struct vec3 start;
};

static struct vec3 spring_rate_at(const struct spring_problem *p, int i, struct vec3 spring)
{
    const struct spring_node *node = &p->node[i];
    struct friction_state rubbing = node->rubbing;
    rubbing.spring = spring;
    const struct vec3 own = friction_spring_rate(&p->law, p->regime, rubbing);
    return vec3_axpy(own, -vec3_dot(spring, node->normal_rate), node->normal);
}

/* Row 3 i + a of I - A x J, and the residual. */
static void put_rows(const struct spring_problem *p, const struct vec3 x[GAUSS_NODES],
                     double m[UNKNOWNS][UNKNOWNS + 1])
{
    for (int i = 0; i < GAUSS_NODES; ++i) {
        struct vec3 residual = vec3_sub(p->start, x[i]);
        for (int j = 0; j < GAUSS_NODES; ++j) {
            const struct spring_node *node = &p->node[j];
            struct friction_state rubbing = node->rubbing;
            rubbing.spring = x[j];
            const double weight = COLLOCATION[i][j] * node->factor;
            const struct friction_slopes slopes = friction_spring_rate_slopes(&p->law, p->regime, rubbing);
            residual = vec3_axpy(residual, weight, spring_rate_at(p, j, x[j]));
            for (int a = 0; a < 3; ++a) {
                for (int b = 0; b < 3; ++b) {
                    const double slope =
                        slopes.by_spring[a][b] - vec3_get(node->normal, a) * vec3_get(node->normal_rate, b);
                    m[3 * i + a][3 * j + b] = (i == j && a == b) - weight * slope;
                }
            }
        }
        for (int a = 0; a < 3; ++a) {
            m[3 * i + a][UNKNOWNS] = vec3_get(residual, a);
        }
    }
}

/* Gauss elimination with the largest pivot of each column; false where there is none. */
static bool eliminate(double m[UNKNOWNS][UNKNOWNS + 1])
{
    for (int k = 0; k < UNKNOWNS; ++k) {
        int pivot = k;
        for (int i = k + 1; i < UNKNOWNS; ++i) {
            pivot = fabs(m[i][k]) > fabs(m[pivot][k]) ? i : pivot;
        }
        if (!(fabs(m[pivot][k]) > 0.0)) {
            return false;
        }
        for (int j = k; j <= UNKNOWNS; ++j) {
            const double swapped = m[k][j];
            m[k][j] = m[pivot][j];
            m[pivot][j] = swapped;
        }
        for (int i = 0; i < UNKNOWNS; ++i) {
            const double factor = i == k ? 0.0 : m[i][k] / m[k][k];
            for (int j = k; factor != 0.0 && j <= UNKNOWNS; ++j) {
                m[i][j] -= factor * m[k][j];
            }
        }
    }
    return true;
}

/* Newton's method, which converges in two or three steps where the panel is short enough. */
enum { NEWTON_STEPS = 12 };
static const double NEWTON_PART = 1e-14; /* of the spring or of its change, where the steps end */

static bool solve_spring(const struct spring_problem *p, struct vec3 x[GAUSS_NODES])
{
    for (int step = 0; step < NEWTON_STEPS; ++step) {
        double m[UNKNOWNS][UNKNOWNS + 1];
        put_rows(p, x, m);
        if (!eliminate(m)) {
            return false;
        }
        double change = 0.0;
        double size = vec3_norm(p->start);
        for (int i = 0; i < GAUSS_NODES; ++i) {
            const double *row[3] = {m[3 * i], m[3 * i + 1], m[3 * i + 2]};
            const struct vec3 by =
                vec3_make(row[0][UNKNOWNS] / row[0][3 * i], row[1][UNKNOWNS] / row[1][3 * i + 1],
                          row[2][UNKNOWNS] / row[2][3 * i + 2]);
            x[i] = vec3_add(x[i], by);
            change = fmax(change, vec3_norm(by));
            size = fmax(size, vec3_norm(x[i]));
        }
        if (!(change <= (double)INFINITY)) {
            return false;
        }
        if (change <= NEWTON_PART * size) {
            return true;
        }
    }
    return false;
}

/* The spring at the nodes, and at the end of the panel. */
static bool put_springs(const struct driven_contact *c, bool graded, struct vec3 start,
                        struct driven_panel *panel)
{
    struct spring_problem p = {.law = scene_friction_law(c->v, c->q, c->contact),
                               .regime = (enum friction_regime)c->q->contact[c->contact].friction_regime,
                               .start = start};
    struct vec3 x[GAUSS_NODES];
    for (int i = 0; i < GAUSS_NODES; ++i) {
        struct scene_instant at;
        driven_instant(c, panel->node[i].clock, start, &at);
        p.node[i] =
            (struct spring_node){.rubbing = {at.normal_force[c->contact], at.turning.slip[c->contact], start},
                                 .normal = at.geometry[c->contact].normal,
                                 .normal_rate = turning_normal_rate(c->v, c->q, &at, c->contact),
                                 .factor = (panel->to - panel->from) * gauss_place(i, graded).factor};
        x[i] = start;
    }
    if (!solve_spring(&p, x)) {
        return false;
    }
    panel->spring = start;
    for (int i = 0; i < GAUSS_NODES; ++i) {
        panel->node[i].spring = x[i];
        panel->spring =
            vec3_axpy(panel->spring, 0.5 * GAUSS_WEIGHT[i] * p.node[i].factor, spring_rate_at(&p, i, x[i]));
    }
    return true;
}

bool driven_panel_make(const struct driven_contact *c, double from, double to, struct vec3 spring,
                       bool graded, struct driven_panel *panel)
{
    *panel = (struct driven_panel){.from = from, .to = to, .spring = spring};
    const double half = 0.5 * (to - from);
    for (int i = 0; i < GAUSS_NODES; ++i) {
        panel->node[i].clock = from + half * gauss_place(i, graded).at;
        panel->node[i].spring = spring;
    }
    if (contact_rubs_elastically(c->v, c->contact) && !put_springs(c, graded, spring, panel)) {
        return false;
    }
    for (int i = 0; i < GAUSS_NODES; ++i) {
        struct scene_instant at;
        double rate[DRIVEN_TERMS];
        double scale[DRIVEN_TERMS];
        const double weight = half * GAUSS_WEIGHT[i] * gauss_place(i, graded).factor;
        driven_instant(c, panel->node[i].clock, panel->node[i].spring, &at);
        driven_rates(c, &at, rate, scale);
        for (int k = 0; k < DRIVEN_TERMS; ++k) {
            panel->sum[k] += weight * rate[k];
            panel->size[k] += weight * scale[k];
        }
        panel->node[i].normal = at.geometry[c->contact].normal;
        panel->node[i].slip = at.turning.slip[c->contact];
        panel->slipped += weight * vec3_norm(panel->node[i].slip);
    }
    return true;
}

struct vec3 driven_spring(const struct scene_state *q, int contact)
{
    if (SCENE_ANY_FRICTION) {
        return q->turning.spring[contact];
    }
    return vec3_make(0.0, 0.0, 0.0);
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

static void lay_spring(const struct driven_contact *c)
{
    struct scene_instant at;
    struct vec3 *spring = &c->q->turning.spring[c->contact];
    driven_instant(c, c->q->clock, *spring, &at);
    const struct vec3 n = at.geometry[c->contact].normal;
    *spring = vec3_axpy(*spring, -vec3_dot(*spring, n), n);
}

void driven_lay_springs(const struct scene_values *v, struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        lay_spring(&(struct driven_contact){v, q, j});
    }
}

/* Of what goes on touching while inputs jump: the spring lies across the new normal. */
static void settle_friction(const struct driven_contact *c, enum contact_regime before)
{
    const int j = c->contact;
    const double clock = c->q->clock;
    lay_spring(c);
    if (contact_rubs(c->v, j) && !contact_rubs_elastically(c->v, j)) {
        friction_from(c, clock);
    } else {
        follow_law(c, clock, before);
    }
}

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
    if (contact_rubs(c->v, c->contact) && contact_transmits(c->q, c->contact)) {
        friction_margins(c, clock, &at, margins);
    }
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
    if (SCENE_ANY_FRICTION && event != DRIVEN_LAW) {
        take_friction_event(c, clock, spring, event);
    }
}

void driven_begin(const struct driven_contact *c, double clock)
{
    struct scene_instant at;
    struct contact_state *state = &c->q->contact[c->contact];
    scene_kinematics(c->v, c->q, clock, c->q->body, &at);
    (void)onset_note(c->v, c->q, &at, c->contact, scene_regime_of_touching(c->v, c->q, &at, c->contact));
    state->regime = (int32_t)scene_regime_of_touching(c->v, c->q, &at, c->contact);
    friction_from(c, clock);
}

void driven_end(const struct driven_contact *c)
{
    c->q->contact[c->contact].regime = (int32_t)REGIME_APART;
    if (SCENE_ANY_FRICTION) {
        rub_with(c, FRICTION_STICKING, NO_SPRING);
    }
}

void driven_turning_settle(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    const struct driven_contact c = {v, q, contact};
    const enum contact_regime before = regime_of(&c);
    scene_kinematics(v, q, q->clock, q->body, &at);
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

/* How closely a panel and its two halves must agree, relative to what they are summed up of. The halves are a
 * thousand times better. */
static const double PANELS_AGREE = 1e-12;
/* The same relative to the whole span: where the normal reverses in the centre the force jumps, which is not
 * located but ends in panels so short that this is all they are. */
static const double JUMPS_AGREE = 1e-14;
/* How closely the integral of the law's event function must agree: so that its changes of sign show at the
 * nodes. */
static const double EVENTS_AGREE = 1e-6;

/* Near the touch Hertz's force goes with the power 3/2 of time (prescribed.c). */
static bool wants_graded(const struct driven_span *s, double from, double to)
{
    const double shallow = 0.1;
    const double clock[3] = {from, 0.5 * (from + to), to};
    double gap[3];
    if (!scene_is_hertz(s->c.v, s->c.contact)) {
        return false;
    }
    for (int i = 0; i < 3; ++i) {
        struct scene_instant at;
        scene_kinematics(s->c.v, s->c.q, clock[i], s->c.q->body, &at);
        gap[i] = at.geometry[s->c.contact].gap;
    }
    return fmax(gap[0], gap[2]) > shallow * gap[1];
}

static bool make_panel(const struct driven_span *s, double from, double to, struct vec3 spring,
                       struct driven_panel *panel)
{
    return driven_panel_make(&s->c, from, to, spring, wants_graded(s, from, to), panel);
}

/* Of the force, in time; what else is integrated has it times arms and speeds. */
static double rounding_part(const struct driven_span *s, const struct driven_panel *panel)
{
    struct scene_instant at;
    driven_instant(&s->c, panel->to, panel->spring, &at);
    const double noise = rounding_of_force(s->c.v, s->c.q, &at, s->c.contact) * (panel->to - panel->from);
    return panel->size[DRIVEN_FORCE] > 0.0 ? fmin(noise / panel->size[DRIVEN_FORCE], 1.0) : 1.0;
}

/* cos of the largest rotation of n between an end of a panel and the node next to it, 0.5 rad. Where it turns
 * further it may reverse, in the centre. */
static const double LARGEST_TURN_COSINE = 0.88;

/* In characteristic slip velocities: so fast a slip leaves nothing of exp(-|v_t|/v_0); the change of the slip
 * within which an interpolation follows that; so slow that friction is proportional to the slip. */
static const double SATURATED = 40.0, FOLLOWED = 2.0, PROPORTIONAL = 1e-6;

/* Regularized friction reverses with the slip within a layer that ends with exp(-|v_t|/v_0) and has a corner
 * of its slope in the middle. */
static bool sees_layer(const struct driven_span *s, struct vec3 slip, struct vec3 next)
{
    const double unit = scene_friction_law(s->c.v, s->c.q, s->c.contact).slip_velocity;
    const double speed = vec3_norm(slip);
    if (s->elastic || !contact_rubs(s->c.v, s->c.contact)) {
        return true;
    }
    if (vec3_dot(slip, next) < 0.0) {
        return fmax(speed, vec3_norm(next)) <= PROPORTIONAL * unit;
    }
    return speed > SATURATED * unit || vec3_norm(vec3_sub(next, slip)) <= FOLLOWED * unit;
}

/* Whether the nodes see what may happen on the way from an end of a panel to the first of them. Where the
 * bodies are concentric, to rounding, n has no meaning. */
static bool sees_end(const struct driven_span *s, const struct driven_panel *panel, double end, int node)
{
    struct scene_instant at;
    const int j = s->c.contact;
    driven_instant(&s->c, end, panel->spring, &at);
    const struct contact_geometry *g = &at.geometry[j];
    const bool has_direction = !g->degenerate && fabs(g->distance) > rounding_of_gap(s->c.v, &at, j);
    const double cosine = vec3_dot(g->normal, panel->node[node].normal);
    return (!has_direction || cosine > LARGEST_TURN_COSINE) &&
           sees_layer(s, at.turning.slip[j], panel->node[node].slip);
}

static bool sees_ends(const struct driven_span *s, const struct driven_panel *panel)
{
    return sees_end(s, panel, panel->from, 0) && sees_end(s, panel, panel->to, GAUSS_NODES - 1);
}

static bool panels_agree(const struct driven_span *s, const struct driven_panel *whole,
                         const struct driven_panel *left, const struct driven_panel *right)
{
    const double noise = rounding_part(s, whole);
    for (int k = 0; k < DRIVEN_TERMS; ++k) {
        const double size = left->size[k] + right->size[k];
        const double part = k == DRIVEN_EVENT ? EVENTS_AGREE : PANELS_AGREE + noise;
        const double allowed = part * size + JUMPS_AGREE * s->total.size[k] + DBL_MIN;
        if (!(fabs(left->sum[k] + right->sum[k] - whole->sum[k]) <= allowed)) {
            return false;
        }
    }
    const double way = vec3_norm(right->spring) + left->slipped + right->slipped;
    return (!s->elastic ||
            vec3_norm(vec3_sub(right->spring, whole->spring)) <= 4.0 * PANELS_AGREE * way + DBL_MIN) &&
           sees_ends(s, left) && sees_ends(s, right);
}

/* The quadrature resolves a panel by five nodes each half: no quantity has two extrema within a quarter. */
enum { PANEL_PARTS = 4 };

static void add_driven_panel(struct driven_span *s, const struct driven_panel *panel)
{
    struct scene_instant at;
    for (int k = 0; k < DRIVEN_TERMS; ++k) {
        s->sum[k] += panel->sum[k];
        s->total.size[k] += panel->size[k];
    }
    struct scene_output output = {.values = s->c.v, .state = s->c.q, .contact = s->c.contact};
    scene_output_note_peaks(&output, panel->from, panel->to, PANEL_PARTS,
                            &s->c.q->contact[s->c.contact].peaks);
    driven_instant(&s->c, panel->to, panel->spring, &at);
    const struct vec3 n = at.geometry[s->c.contact].normal;
    s->total.spring = vec3_axpy(panel->spring, -vec3_dot(panel->spring, n), n);
    counter_add(&s->c.q->counters.force_evaluations, GAUSS_NODES);
}

/* A place of a panel, and the event functions there. */
struct driven_place {
    double clock;
    struct driven_margins at;
};

/* Of both halves of a panel: the start, the nodes and the end. */
enum { PANEL_PLACES = 2 * GAUSS_NODES + 2 };

static void put_place(const struct driven_span *s, double clock, struct vec3 spring,
                      struct driven_place *place)
{
    place->clock = clock;
    driven_margins_at(&s->c, clock, spring, &place->at);
}

/* An event function without a spring, for root_lowest. */
struct driven_dip {
    const struct driven_span *span;
    int event;
};

static void driven_event_at(const void *data, double clock, double *value, double *slope)
{
    const struct driven_dip *dip = data;
    struct driven_margins at;
    driven_margins_at(&dip->span->c, clock, dip->span->total.spring, &at);
    *value = at.value[dip->event];
    *slope = (double)NAN; /* not needed */
}

/* Whether one of those falls below zero between three places, and to where from the first. */
static bool finds_dip(const struct driven_span *s, const struct driven_place place[3], double *after)
{
    for (int event = 0; event < DRIVEN_STICK; ++event) {
        const struct driven_dip dip = {s, event};
        struct root_place of[3];
        for (int i = 0; i < 3; ++i) {
            of[i] = (struct root_place){place[i].clock, place[i].at.value[event]};
        }
        if (root_may_dip(of)) {
            struct driven_margins low;
            *after = root_lowest(driven_event_at, &dip, of);
            driven_margins_at(&s->c, *after, s->total.spring, &low);
            if (low.value[event] < -low.noise[event]) {
                return true;
            }
        }
    }
    return false;
}

/* The first two places of both halves of a panel between which a regime ends; false: none. */
static bool finds_event(const struct driven_span *s, const struct driven_panel *left,
                        const struct driven_panel *right, struct driven_place *start, double *before,
                        double *after)
{
    struct driven_place place[PANEL_PLACES];
    int count = 1;
    put_place(s, left->from, s->total.spring, &place[0]);
    for (int i = 0; i < 2 * GAUSS_NODES; ++i) {
        const struct driven_panel *half = i < GAUSS_NODES ? left : right;
        put_place(s, half->node[i % GAUSS_NODES].clock, half->node[i % GAUSS_NODES].spring, &place[count++]);
    }
    put_place(s, right->to, right->spring, &place[count++]);
    *start = place[0];
    for (int i = 1; i < count; ++i) {
        *before = place[i - 1].clock;
        *after = place[i].clock;
        if (driven_event_passed(&place[i].at, &start->at) != DRIVEN_EVENTS) {
            return true;
        }
        if (i + 1 < count && finds_dip(s, &place[i - 1], after)) {
            return true;
        }
    }
    return false;
}

/* Halves the bracket of an event that is between `before` and `after` until the clock is known to rounding;
 * the panel that ends there, just past the event, and which event it is. */
static bool panel_to_event(const struct driven_span *s, const struct driven_place *start, double before,
                           double after, struct driven_panel *panel, enum driven_event *event)
{
    const struct vec3 first = s->total.spring;
    struct driven_margins now;
    panel->spring = first;
    while (after - before > 4.0 * DBL_EPSILON * fabs(after)) {
        const double middle = 0.5 * (before + after);
        if (!(middle > before && middle < after) ||
            (s->elastic && !make_panel(s, start->clock, middle, first, panel))) {
            break;
        }
        driven_margins_at(&s->c, middle, panel->spring, &now);
        *(driven_event_passed(&now, &start->at) != DRIVEN_EVENTS ? &after : &before) = middle;
    }
    if (!make_panel(s, start->clock, after, first, panel)) {
        return false;
    }
    driven_margins_at(&s->c, after, panel->spring, &now);
    *event = driven_event_passed(&now, &start->at);
    return *event != DRIVEN_EVENTS;
}

/* Where an event ends a regime in one of two panels: integrates up to it and changes the regime. Returns
 * whether there is one. */
static bool passes_event(struct driven_span *s, const struct driven_panel *left,
                         const struct driven_panel *right, double *clock)
{
    struct driven_panel panel;
    struct driven_place start;
    double before;
    double after;
    enum driven_event event;
    const struct contact_law law = scene_contact_law(s->c.v, s->c.q, s->c.contact);
    if (!(contact_has_events(&law) || contact_rubs(s->c.v, s->c.contact)) ||
        !finds_event(s, left, right, &start, &before, &after) ||
        !panel_to_event(s, &start, before, after, &panel, &event)) {
        return false;
    }
    add_driven_panel(s, &panel);
    driven_take_event(&s->c, panel.to, s->total.spring, event);
    s->total.spring = driven_spring(s->c.q, s->c.contact);
    counter_add(&s->c.q->counters.events, 1);
    *clock = panel.to;
    return true;
}

static bool driven_integrate(struct driven_span *s, double from, double end)
{
    double clock = from;
    double width = end - from;
    while (clock < end) {
        *s->panels -= s->panel_cost;
        if (*s->panels < 0) {
            return false;
        }
        const double to = width < end - clock ? clock + width : end;
        const double middle = 0.5 * (clock + to);
        const bool divides = middle > clock && middle < to;
        struct driven_panel whole;
        struct driven_panel left;
        struct driven_panel right;
        const struct vec3 start = s->total.spring;
        const bool made = make_panel(s, clock, to, start, &whole) &&
                          make_panel(s, clock, middle, start, &left) &&
                          make_panel(s, middle, to, left.spring, &right);
        if (divides && (!made || !panels_agree(s, &whole, &left, &right))) {
            width = 0.5 * (to - clock);
            continue;
        }
        width *= 2.0;
        if (made && divides && passes_event(s, &left, &right, &clock)) {
            continue;
        }
        if (made) { /* else one rounding of the clock, in which no force adds up to anything */
            add_driven_panel(s, &left);
            add_driven_panel(s, &right);
        }
        clock = to;
    }
    return true;
}

static struct axis_motion axis_from(const struct driven_span *s, const struct scene_instant *at, double clock)
{
    const int destination = contact_destination(s->c.contact);
    /* gcc wants to see a value in scenes where nothing turns, too */
    const struct vec3 axis = SCENE_ANY_TURNING ? at->turning.axis[s->c.contact] : vec3_make(0.0, 0.0, 0.0);
    if (body_turn_is_prescribed(s->c.v, destination) && body_shape(destination) != SHAPE_SPHERE) {
        struct body_path path = s->c.q->path[destination];
        path_shift(path.angular_velocity, 3, clock);
        path_shift(path.axis, 3, clock);
        return path.turn_follows == TURN_FOLLOWS_VELOCITY ? axis_motion_driven(axis, path.angular_velocity, 3)
                                                          : axis_motion_following(path.axis, 3);
    }
    return axis_motion_fixed(axis);
}

/* The motion from a clock on. */
static struct tumbling_path path_from(const struct driven_span *s, double clock)
{
    struct scene_instant at;
    scene_kinematics(s->c.v, s->c.q, clock, s->c.q->body, &at);
    const struct separation_path separation = separation_path_of(s->c.v, s->c.q, &at, clock, s->c.contact);
    struct tumbling_path path = {.shape = scene_contact_shape_at(s->c.v, s->c.q, &at, s->c.contact),
                                 .axis = axis_from(s, &at, clock),
                                 .rounding = rounding_of_gap(s->c.v, &at, s->c.contact)};
    for (int i = 0; i < TUMBLING_TERMS; ++i) {
        path.c[i] = separation.c[i];
    }
    return path;
}

/* So many evaluations of the gap in search of touches and partings, some tenths of a second; some dozens are
 * usual. */
static const long SEARCH_BUDGET = 1000000;

/* The clock of the next change, `end` where there is none. False where that is not found out. */
static bool finds_change(const struct driven_span *s, double clock, double end, enum tumbling_change change,
                         double *next)
{
    const struct tumbling_path path = path_from(s, clock);
    if (*s->evaluations <= 0) {
        return false;
    }
    const struct tumbling_result found = tumbling_first(&path, change, end - clock, *s->evaluations);
    *s->evaluations -= found.evaluations;
    *next = found.after < end - clock ? clock + found.after : end;
    return *next < end || !(found.searched < end - clock);
}

static void begin_contact(struct driven_span *s, double clock)
{
    struct scene_state *q = s->c.q;
    driven_begin(&s->c, clock);
    s->total.spring = driven_spring(q, s->c.contact);
    if (SCENE_ANY_FREE) {
        struct contact_record *record = &q->contact[s->c.contact].record;
        counter_add(&record->onsets, 1);
        record->onset_time = q->base + (q->base_tail + clock);
        record->touch_clock = clock;
    }
    counter_add(&q->counters.events, 1);
}

static void end_contact(struct driven_span *s, double clock)
{
    driven_end(&s->c);
    if (SCENE_ANY_FREE) {
        struct contact_record *record = &s->c.q->contact[s->c.contact].record;
        record->last_duration = clock - record->touch_clock;
    }
    counter_add(&s->c.q->counters.events, 1);
}

/* What a finite cylinder's end or a jump leaves of the stored energy is dissipated. */
static double stored_at(const struct driven_span *s, double clock)
{
    struct scene_instant at;
    const struct contact_law law = scene_contact_law(s->c.v, s->c.q, s->c.contact);
    scene_kinematics(s->c.v, s->c.q, clock, s->c.q->body, &at);
    const double gap = fmin(at.geometry[s->c.contact].gap, 0.0);
    return contact_stored_energy(&law, REGIME_COMPRESSION, gap);
}

static bool span_over(struct driven_span *s, double end)
{
    struct scene_state *q = s->c.q;
    const int j = s->c.contact;
    double clock = q->clock;
    s->total.spring = driven_spring(q, j);
    while (clock < end) {
        const bool touches = q->contact[j].regime != (int32_t)REGIME_APART;
        double next;
        if ((*s->panels)-- <= 0 || /* any number of changes ends */
            !finds_change(s, clock, end, touches ? TUMBLING_PARTING : TUMBLING_TOUCH, &next) ||
            (touches && !driven_integrate(s, clock, next))) {
            return false;
        }
        if (next < end && touches) {
            s->sum[DRIVEN_DISSIPATED] += stored_at(s, next);
            end_contact(s, next);
        } else if (next < end) {
            begin_contact(s, next);
            s->sum[DRIVEN_DISSIPATED] -= stored_at(s, next);
        }
        clock = next;
    }
    return true;
}

static struct vec3 vector_from(const double *a)
{
    return vec3_make(a[0], a[1], a[2]);
}

/* Of a span of this length [s]. */
static void book_span(const struct driven_span *s, double length)
{
    struct contact_state *state = &s->c.q->contact[s->c.contact];
    const struct vec3 force = vector_from(s->sum + DRIVEN_FORCE);
    const struct vec3 source = vector_from(s->sum + DRIVEN_SOURCE_TORQUE);
    const struct vec3 destination = vector_from(s->sum + DRIVEN_DESTINATION_TORQUE);
    if (SCENE_ANY_FREE) {
        state->physics.impulse = vec3_add(state->physics.impulse, force);
        state->torques.source_impulse = vec3_add(state->torques.source_impulse, source);
        state->torques.destination_impulse = vec3_add(state->torques.destination_impulse, destination);
        s->c.q->dissipated += s->sum[DRIVEN_DISSIPATED];
        s->c.q->friction_energy += s->sum[DRIVEN_FRICTION];
        s->c.q->external_work += s->sum[DRIVEN_WORK];
    } else {
        state->mean_force = vec3_scale(1.0 / length, force);
        state->torques.source_mean = vec3_scale(1.0 / length, source);
        state->torques.destination_mean = vec3_scale(1.0 / length, destination);
    }
    if (SCENE_ANY_FRICTION) {
        s->c.q->turning.spring[s->c.contact] = s->total.spring;
    }
}

/* So many steps of turning_prescribed_steps in all of its evaluations take as long as a panel does else. */
static const double STEPS_OF_PANEL = 5.0;

bool driven_turning_over(const struct scene_values *v, struct scene_state *q, double length, long panels)
{
    long evaluations = SEARCH_BUDGET;
    const double steps = turning_prescribed_steps(v, q, q->clock + length);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct driven_span s = {.c = {v, q, j},
                                .elastic = contact_rubs_elastically(v, j),
                                .panels = &panels,
                                .evaluations = &evaluations,
                                .panel_cost = 1 + (long)fmin(steps / STEPS_OF_PANEL, DRIVEN_PANELS)};
        if (!contact_is_driven(v, j)) {
            continue;
        }
        if (!span_over(&s, q->clock + length)) {
            return false;
        }
        book_span(&s, length);
    }
    return true;
}
