#include "prescribed/prescribed.h"

#include <float.h>
#include <string.h>

#include "flight/conservative_advancement.h"
#include "flight/relative_path.h"
#include "math/lu.h"
#include "math/nodes.h"
#include "math/polynomial.h"
#include "scene/dense_output.h"
#include "scene/evaluate.h"
#include "scene/transition.h"

/* These are the indices of the integrals: the impulses in the order of struct contact_impulses, that of the
 * force alone where nothing may turn [N s, N m s], and the energies in the order of struct scene_powers [J].
 * The last integral, of the law's event function, serves only to tell whether a panel resolves this function,
 * which may change where no force acts. */
enum {
    TERM_TORQUES = 3,
    TERM_DISSIPATED = TERM_TORQUES + 6 * SCENE_ANY_TURNING,
    TERM_EVENT = TERM_DISSIPATED + 3 * SCENE_ANY_FREE,
    TERMS = TERM_EVENT + SCENE_ANY_TURNING
};

/* This struct holds the integrals over an interval of time, or their integrands at an instant. */
struct integrals {
    double sum[TERMS];
    double size[TERMS];     /* of the absolute terms of each integrand, for its rounding */
    double lever[TERMS];    /* of d integrand / d force */
    double passed[OPPOSED]; /* of all terms whose difference an opposed motion is [m, rad] */
};

/* A panel has the nodes of a Lobatto rule (math/node_tables.h), which include its ends: nothing that happens
 * near an end escapes them. */
enum { PANEL_NODES = 8, PANEL_END = PANEL_NODES - 1 };
#define PANEL_RULE (&lobatto[LOBATTO_EIGHT])

/* This struct holds the clock of a node, the springs there (struct turning_state), and the event functions of
 * scene/ode.h. */
struct panel_node {
    double clock;
    struct vec3 spring[OPPOSED];
    double events[ODE_EVENTS_EACH];
};

/* This struct describes a panel of the Lobatto rule. Collocation at the nodes of the rule gives the springs.
 * Integrals and springs have the order 14 at the end of the panel. */
struct panel {
    struct integrals of;
    double noise; /* rounding of the force, the smaller of those at both ends [N] */
    double tilt;  /* rounding of n, the smaller of those at both ends [rad] */
    double depth; /* penetration, the smaller of those at both ends [m] */
    struct panel_node node[PANEL_NODES];
};

/* This struct describes the integration of one contact. The clock and the springs of q show how far it has
 * come. */
struct span {
    struct scene_state *q;
    int contact;
    struct integrals so_far;
    bool has_events;   /* panels locate the events of law and friction */
    long *panels;      /* panels that the quadrature may still make */
    long *evaluations; /* evaluations that the search for touches may still make; NULL: no search */
    long panel_cost;   /* cost of a panel; 1: nothing turns about a changing direction, no spring */
};

/* Cost of a panel with a spring, divided by the cost of a panel without. */
enum { ELASTIC_PANEL = 3 };

static struct span span_of(struct scene_state *q, int contact, long *panels)
{
    return (struct span){.q = q,
                         .contact = contact,
                         .panels = panels,
                         .panel_cost = contact_has_springs(q->v, contact) ? ELASTIC_PANEL : 1};
}

static enum contact_regime regime_of(const struct span *s)
{
    return (enum contact_regime)s->q->contact[s->contact].regime;
}

static void kinematics_at(const struct scene_state *q, double clock, struct scene_instant *at)
{
    scene_place_bodies(q, clock, at);
    scene_meet(NULL, at);
}

/* Computes the instant of a contact whose springs are given, in the present regimes of the contact. Their
 * formulas hold smoothly beyond the ends of the regimes. */
CONTACT_NOINLINE static void instant_at(const struct span *s, double clock, const struct vec3 *spring,
                                        struct scene_instant *at)
{
    bool met[SCENE_CONTACTS] = {false};
    met[s->contact] = true;
    scene_place_bodies(s->q, clock, at);
    if (SCENE_ANY_FRICTION) {
        memcpy(at->turning.spring[s->contact], spring, sizeof at->turning.spring[0]);
    }
    scene_meet(met, at);
    scene_forces(met, at);
}

/* Returns the integrands at an instant. */
static struct integrals integrands_at(const struct span *s, const struct scene_instant *at)
{
    struct integrals now = {.sum = {0.0}};
    const int j = s->contact;
    const struct contact_law law = scene_contact_law(s->q, j);
    const struct contact_geometry *g = &at->geometry[j];
    const double force = vec3_norm(at->source_force[j]);
    const struct contact_impulses impulse_rates = scene_impulse_rates(at, j);
    double arm = vec3_norm(at->separation[j]); /* length of both lever arms together [m] */
    double turning = 0.0; /* bound of the speeds that rotations give the contact points [m/s] */
    memcpy(now.sum, &impulse_rates, TERM_DISSIPATED * sizeof now.sum[0]);
    if (SCENE_ANY_TURNING && scene_turns(s->q->v)) {
        arm = vec3_norm(at->turning.source_arm[j]) + vec3_norm(at->turning.destination_arm[j]);
        for (int i = 1; contact_resists(s->q->v, j) && i < OPPOSED; ++i) {
            arm += scene_friction_law(s->q, j, i).coefficient; /* |M| is at most F_n times these levers */
        }
        turning = arm * turning_spin_size(at, j);
    }
    const double speed = vec3_norm(at->velocity[contact_source(j)]) +
                         vec3_norm(at->velocity[contact_destination(j)]) + turning;
    for (int k = 0; k < TERMS; ++k) {
        now.lever[k] = k < TERM_TORQUES ? 1.0 : k < TERM_DISSIPATED ? arm : k < TERM_EVENT ? speed : 0.0;
        now.size[k] = force * now.lever[k];
    }
    for (int k = 0; SCENE_ANY_TURNING && k < OPPOSED; ++k) {
        now.passed[k] = k == OPPOSED_SLIP ? speed : scene_turns(s->q->v) ? turning_spin_size(at, j) : 0.0;
    }
    if (SCENE_ANY_FREE) {
        const struct scene_powers power = scene_powers_of_contact(at, j);
        memcpy(now.sum + TERM_DISSIPATED, &power, sizeof power);
        /* the spring loses energy also while the force is clipped to zero */
        now.size[TERM_DISSIPATED] += fabs(contact_stored_slope(&law, regime_of(s), g->gap)) * speed;
    }
    if (SCENE_ANY_TURNING) {
        const struct contact_slopes slopes = contact_event_slopes(&law, regime_of(s));
        const bool ends = scene_turns(s->q->v) && contact_has_events(&law);
        now.sum[TERM_EVENT] = ends ? contact_event(&law, regime_of(s), g->gap, g->gap_rate) : 0.0;
        now.size[TERM_EVENT] = fabs(slopes.by_gap * g->gap) + fabs(slopes.by_rate) * speed;
    }
    return now;
}

/* Adds integrals, or integrands times a length of time. */
static void add_integrals(struct integrals *to, double weight, const struct integrals *more)
{
    for (int k = 0; k < TERMS; ++k) {
        to->sum[k] += weight * more->sum[k];
        to->size[k] += weight * more->size[k];
        to->lever[k] += weight * more->lever[k];
    }
    for (int k = 0; SCENE_ANY_TURNING && k < OPPOSED; ++k) {
        to->passed[k] += weight * more->passed[k];
    }
}

/* Returns the integral from 0 to a node of the polynomial that is 1 at node `of` and 0 at the other nodes of
 * a panel from 0 to 1. */
static double panel_integral(int node, int of)
{
    return 0.5 * PANEL_RULE->integral[of * PANEL_NODES + node];
}

/* The unknowns are the components of the spring at all nodes but the start. Each column of the matrix has a
 * zero behind its entries, as math/lu.h asks for. */
enum { UNKNOWNS = 3 * PANEL_END, COLUMN = UNKNOWNS + 1 };

/* The spring at one node and what else its rate depends on. */
struct spring_node {
    struct friction_state rubbing;
    struct vec3 normal, normal_rate;
};

struct spring_problem {
    enum opposed part;
    struct friction_law law;
    enum friction_regime regime;
    struct spring_node node[PANEL_NODES];
    double length; /* of the panel [s] */
};

/* Returns xi' [m/s] at a node. Sets the derivatives of xi' by the components of xi [1/s]. */
static struct vec3 spring_rate_at(const struct spring_problem *p, const struct spring_node *node,
                                  struct vec3 slopes[3])
{
    const struct friction_state *rubbing = &node->rubbing;
    struct friction_path path = {.terms = 2,
                                 .normal_force = {rubbing->normal_force},
                                 .depth = {rubbing->depth},
                                 .slip = {rubbing->slip},
                                 .spring = {rubbing->spring}};
    for (int b = 0; b < 3; ++b) {
        const struct vec3 along = vec3_make(b == 0, b == 1, b == 2);
        path.spring[1] = along;
        slopes[b] = vec3_add(friction_spring_rate_change(&p->law, p->regime, &path),
                             opposed_turned(p->part, along, node->normal, node->normal_rate));
    }
    const struct vec3 force = friction_force(&p->law, p->regime, *rubbing);
    return vec3_add(friction_spring_rate(&p->law, p->regime, *rubbing, force),
                    opposed_turned(p->part, rubbing->spring, node->normal, node->normal_rate));
}

/* Sets the matrix by columns, which is the identity minus the derivatives of the integrated rates, and the
 * residual [m]. */
static void put_equations(const struct spring_problem *p, double m[UNKNOWNS][COLUMN], double residual[COLUMN])
{
    for (int k = 0; k < UNKNOWNS; ++k) {
        m[k][k] = 1.0;
    }
    for (int i = 1; i < PANEL_NODES; ++i) {
        vec3_to(vec3_sub(p->node[0].rubbing.spring, p->node[i].rubbing.spring), residual + 3 * (i - 1));
    }
    for (int j = 0; j < PANEL_NODES; ++j) {
        struct vec3 slopes[3];
        const struct vec3 rate = spring_rate_at(p, &p->node[j], slopes);
        for (int k = 0; k < UNKNOWNS; ++k) {
            const double weight = panel_integral(1 + k / 3, j) * p->length;
            residual[k] += weight * vec3_get(rate, k % 3);
            for (int b = 0; j > 0 && b < 3; ++b) {
                m[3 * (j - 1) + b][k] -= weight * vec3_get(slopes[b], k % 3);
            }
        }
    }
}

/* Newton's method converges in two or three steps where the panel is short enough. */
enum { NEWTON_STEPS = 12 };
/* Largest last correction divided by the spring's length. The method squares errors, so that rounding alone
 * is left behind such a correction. */
static const double NEWTON_PART = 1e-9;

/* Solves the equations for the springs at the nodes. Returns false where the panel is too long for them. */
static bool solve_spring(struct spring_problem *p)
{
    for (int step = 0; step < NEWTON_STEPS; ++step) {
        double m[UNKNOWNS][COLUMN] = {{0.0}};
        double by[COLUMN] = {0.0};
        int pivot[UNKNOWNS];
        const struct lu_matrix matrix = {UNKNOWNS, COLUMN, &m[0][0], pivot};
        put_equations(p, m, by);
        if (!lu_factor(matrix)) {
            return false;
        }
        lu_solve(matrix, by);
        double change = 0.0;
        double size = vec3_norm(p->node[0].rubbing.spring);
        for (int i = 1; i < PANEL_NODES; ++i) {
            struct vec3 *spring = &p->node[i].rubbing.spring;
            const struct vec3 d = vec3_from(by + 3 * (i - 1));
            *spring = vec3_add(*spring, d);
            change = fmax(change, vec3_norm(d));
            size = fmax(size, vec3_norm(*spring));
        }
        if (!(change <= (double)INFINITY)) {
            return false;
        }
        if (change <= fmax(NEWTON_PART * size, DBL_MIN)) { /* a spring may decay to nothing */
            return true;
        }
    }
    return false;
}

/* Sets one spring at all nodes of the panel, from the springs at its start. Returns false where the panel is
 * too long for the equations to be solved. */
static bool put_spring(const struct span *s, int part, struct panel *panel)
{
    const int j = s->contact;
    struct spring_problem p = {.part = (enum opposed)part,
                               .law = scene_friction_law(s->q, j, part),
                               .regime = (enum friction_regime)s->q->contact[j].friction_regime[part],
                               .length = panel->node[PANEL_END].clock - panel->node[0].clock};
    for (int i = 0; i < PANEL_NODES; ++i) {
        struct scene_instant at;
        instant_at(s, panel->node[i].clock, panel->node[0].spring, &at);
        p.node[i] = (struct spring_node){.rubbing = turning_rubbing(&at, j, part),
                                         .normal = at.geometry[j].normal,
                                         .normal_rate = turning_normal_rate(&at, j)};
    }
    const bool solved = solve_spring(&p);
    for (int i = 0; i < PANEL_NODES; ++i) {
        panel->node[i].spring[part] = p.node[i].rubbing.spring;
    }
    return solved;
}

/* Rounding error of a slip or a gap rate, divided by the speeds whose difference it is. */
static const double SPEED_ROUNDINGS = 8.0 * DBL_EPSILON;

/* Returns the sum of the speeds of which the gap rate is a part: the relative velocity of the centres and the
 * turning of the destination [m/s]. */
static double relative_speed(const struct span *s, const struct scene_instant *at)
{
    const int j = s->contact;
    const double speed = vec3_norm(at->rate[j]);
    return scene_turns(s->q->v)
               ? speed + vec3_norm(at->turning.body[contact_destination(j)].angular_velocity) *
                             vec3_norm(at->separation[j])
               : speed;
}

/* Sets the event functions of the contact (scene/ode.h) at the present instant of q, raised by their
 * rounding. They are positive within the present regimes. */
static void put_events(const struct span *s, const struct scene_instant *at, double events[ODE_EVENTS_EACH])
{
    const int j = s->contact;
    const struct contact_law law = scene_contact_law(s->q, j);
    const double error = SPEED_ROUNDINGS * relative_speed(s, at); /* [m/s] */
    for (int i = 0; i < ODE_EVENTS_EACH; ++i) {
        events[i] = 1.0;
    }
    if (SCENE_ANY_FRICTION && contact_rubs(s->q->v, j) && contact_transmits(s->q, j)) {
        double offset[ODE_EVENTS_EACH];
        const double of_slip = error + SPEED_ROUNDINGS * vec3_norm(at->turning.slip[j]);
        turning_friction_events(at, j, of_slip, SPEED_ROUNDINGS, 0.0, offset, events);
    }
    if (contact_has_events(&law)) {
        const struct contact_geometry *g = &at->geometry[j];
        events[ODE_EVENT_LAW] =
            contact_event(&law, regime_of(s), g->gap, g->gap_rate) + rounding_of_event(at, j, error);
    }
}

/* Computes a panel; false where Newton's method finds no spring because the panel is too long. The bodies'
 * motion is prescribed, so that no spring acts on another: they are solved one by one. */
CONTACT_NOINLINE static bool panel_make(const struct span *s, double from, double to,
                                        const struct vec3 *spring, struct panel *panel)
{
    const double length = to - from;
    *panel = (struct panel){.noise = (double)INFINITY, .tilt = (double)INFINITY, .depth = (double)INFINITY};
    for (int i = 0; i < PANEL_NODES; ++i) {
        panel->node[i].clock = i < PANEL_END ? from + 0.5 * length * (1.0 + PANEL_RULE->node[i]) : to;
        memcpy(panel->node[i].spring, spring, sizeof panel->node[i].spring);
    }
    for (int k = 0; k < OPPOSED; ++k) {
        if (contact_has_spring(s->q->v, s->contact, k) && !put_spring(s, k, panel)) {
            return false;
        }
    }
    for (int i = 0; i < PANEL_NODES; ++i) {
        struct panel_node *node = &panel->node[i];
        struct scene_instant at;
        instant_at(s, node->clock, node->spring, &at);
        const struct integrals now = integrands_at(s, &at);
        add_integrals(&panel->of, length * panel_integral(PANEL_END, i), &now);
        if (i % PANEL_END == 0) {
            panel->noise = fmin(panel->noise, rounding_of_force(&at, s->contact));
            panel->tilt = fmin(panel->tilt, rounding_of_normal(&at, s->contact));
            panel->depth = fmin(panel->depth, -at.geometry[s->contact].gap);
        }
        if (s->has_events) {
            put_events(s, &at, node->events);
        }
    }
    if (SCENE_ANY_FREE) {
        counter_add(&s->q->counters.force_evaluations, PANEL_NODES);
    }
    return true;
}

/*
 * The regimes of law and friction of a contact that turns or rubs. All forces are smooth between two events.
 * scene/transition.c sets the regimes after an event, at the clock of q.
 */

/* These are tilts of n by rounding [rad]. Panels end before the centre and begin behind it where n is tilted
 * by more than TILT_NEAR. A spring is not laid across an n that may be tilted by TILT_LAYING. */
static const double TILT_NEAR = 1e-3;
static const double TILT_LAYING = 1e-6;

/* Lays the springs of a contact across or along its present normal (opposed_laid): they lose a part that is
 * rounding. Near the centre n is less exact than the springs, which stay as they are. */
static void lay_springs(struct scene_state *q, int contact)
{
    struct scene_instant at;
    kinematics_at(q, q->clock, &at);
    const bool is_noise = rounding_of_normal(&at, contact) > TILT_LAYING;
    for (int i = 0; SCENE_ANY_FRICTION && i < OPPOSED && !is_noise; ++i) {
        struct vec3 *spring = &q->turning.spring[contact][i];
        *spring = opposed_laid((enum opposed)i, *spring, at.geometry[contact].normal);
    }
}

void prescribed_lay_springs(struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_has_springs(q->v, j) && q->contact[j].regime != (int32_t)REGIME_APART) {
            lay_springs(q, j);
        }
    }
}

/* Returns the first event whose function is below zero, or ODE_EVENT_GAP if there is none. A function of
 * friction that is below zero at the start must fall to twice its value there. */
static int event_passed(const struct panel_node *now, const struct panel_node *start)
{
    for (int i = ODE_EVENT_LAW; i < ODE_EVENT_ZONE; ++i) {
        /* the law's function may jump in the centre, and start below zero on its other side */
        if (now->events[i] < (i == ODE_EVENT_LAW ? 0.0 : 2.0 * fmin(start->events[i], 0.0))) {
            return i;
        }
    }
    return ODE_EVENT_GAP;
}

/* This is the largest difference of a panel and its halves, divided by the size of their terms. The order 14
 * of the rule makes the error of the halves much smaller than this difference. */
static const double PANELS_AGREE = 1e-12;
/* This is the largest difference of a panel and its halves, divided by the integrals over the whole span.
 * Where the normal reverses in the centre the force jumps, and panels around the jump need not agree once
 * they are so short. */
static const double JUMPS_AGREE = 1e-14;
/* This is the largest relative difference of the integrals of the law's event function. A panel that resolves
 * the function so well shows its changes of sign at the nodes. */
static const double EVENTS_AGREE = 1e-6;

/* Whether a spring at the end of a panel and of its halves agrees, up to the rounding of the normal force and
 * of n. By a constant force L the spring changes by up to L / k_t, and not faster than by L / c_t. */
static bool springs_agree(const struct span *s, int part, const struct panel *whole, const struct panel *left,
                          const struct panel *right)
{
    const struct friction_law law = scene_friction_law(s->q, s->contact, part);
    const struct vec3 spring = right->node[PANEL_END].spring[part];
    const double length = whole->node[PANEL_END].clock - whole->node[0].clock;
    const double by_force = fmin(1.0 / friction_stiffness(&law, whole->depth), length / law.damping);
    const double noise = law.coefficient * fmin(left->noise, right->noise) * by_force +
                         vec3_norm(spring) * fmin(left->tilt, right->tilt);
    return vec3_norm(vec3_sub(spring, whole->node[PANEL_END].spring[part])) <=
           4.0 * PANELS_AGREE * (vec3_norm(spring) + whole->of.passed[part]) + noise;
}

/* Whether a panel and its halves agree. Near the centre n may be mere rounding at one or both ends of the
 * panel; the least rounding bound of the force at the ends and in the middle then holds for nearly all of the
 * time between. */
CONTACT_NOINLINE static bool panels_agree(const struct span *s, const struct panel *whole,
                                          const struct panel *left, const struct panel *right)
{
    const double noise = fmin(left->noise, right->noise);
    for (int k = 0; k < TERMS; ++k) {
        const double size = left->of.size[k] + right->of.size[k];
        const double allowed = SCENE_ANY_TURNING && k == TERM_EVENT
                                   ? EVENTS_AGREE * size + DBL_MIN
                                   : PANELS_AGREE * size + noise * whole->of.lever[k] +
                                         JUMPS_AGREE * s->so_far.size[k] + DBL_MIN;
        const bool overflows = isinf(size); /* a torque may overflow; shorter panels do not help */
        if (!overflows && !(fabs(left->of.sum[k] + right->of.sum[k] - whole->of.sum[k]) <= allowed)) {
            return false;
        }
    }
    for (int i = 0; i < OPPOSED; ++i) {
        if (contact_has_spring(s->q->v, s->contact, i) && !springs_agree(s, i, whole, left, right)) {
            return false;
        }
    }
    return true;
}

/* Makes both halves of the panel from the present to a clock. Returns false where they do not agree with the
 * whole. */
static bool make_halves(const struct span *s, double to, struct panel half[2])
{
    const double from = s->q->clock;
    const double middle = 0.5 * (from + to);
    const struct vec3 *spring = s->q->turning.spring[s->contact];
    struct panel whole;
    return panel_make(s, from, to, spring, &whole) && panel_make(s, from, middle, spring, &half[0]) &&
           panel_make(s, middle, to, half[0].node[PANEL_END].spring, &half[1]) &&
           panels_agree(s, &whole, &half[0], &half[1]);
}

/* This is the number of parts of a panel in the search for peaks. Each half of a panel has eight nodes, so
 * that no quantity has two extrema within a quarter of the panel. */
enum { PANEL_PARTS = 4 };

/* Adds panels to the integrals, notes their peaks, and moves the clock and the springs to their end. */
CONTACT_NOINLINE static void take_panels(struct span *s, const struct panel *panel, int count)
{
    struct scene_state *q = s->q;
    struct scene_output output = {.state = q, .contact = s->contact};
    const struct panel_node *end = &panel[count - 1].node[PANEL_END];
    for (int i = 0; i < count; ++i) {
        add_integrals(&s->so_far, 1.0, &panel[i].of);
    }
    scene_output_note_peaks(&output, q->clock, end->clock, PANEL_PARTS, &q->contact[s->contact].peaks);
    if (SCENE_ANY_FREE) {
        counter_add(&q->counters.force_evaluations, PANEL_PARTS + 1);
    }
    q->clock = end->clock;
    if (SCENE_ANY_FRICTION) {
        memcpy(q->turning.spring[s->contact], end->spring, sizeof end->spring);
    }
}

/* This is the number of nodes in both halves of a panel, which share one. */
enum { PANEL_PLACES = 2 * PANEL_NODES - 1 };

static const struct panel_node *panel_node_at(const struct panel half[2], int place)
{
    return place < PANEL_NODES ? &half[0].node[place] : &half[1].node[place - PANEL_END];
}

/* Whether an event function may fall below zero between the nodes and rise again, which shorter panels show.
 * The functions of sticking may jump and are not looked at. */
static bool events_may_dip(const struct panel half[2])
{
    for (int i = 2; i < PANEL_PLACES; ++i) {
        for (int event = ODE_EVENT_LAW; event < ODE_EVENT_ZONE; ++event) {
            struct root_place of[3];
            for (int k = 0; k < 3; ++k) {
                const struct panel_node *node = panel_node_at(half, i - 2 + k);
                of[k] = (struct root_place){node->clock, node->events[event]};
            }
            if (event != (int)ode_stick_event(ode_event_part((enum ode_event)event)) && root_may_dip(of)) {
                return true;
            }
        }
    }
    return false;
}

/* Panels that are computed for each one that the quadrature counts: a panel and its two halves. */
enum { PANELS_COMPARED = 3 };

/* Bisects between two clocks until that of an event is known to rounding. Makes the panel that ends just past
 * the event, and returns false where there is no such panel. */
static bool panel_to_event(const struct span *s, const struct panel_node *start, double before, double after,
                           struct panel *panel)
{
    int made = 0;
    while (after - before > 4.0 * DBL_EPSILON * fabs(after)) {
        struct scene_instant at;
        struct panel_node now = {.clock = 0.5 * (before + after)};
        const struct vec3 *spring = start->spring;
        if (!(now.clock > before && now.clock < after)) {
            break;
        }
        /* Where friction without a dashpot vanishes with F_n, its spring turns ever faster, and not every
         * panel beyond the event can be made. The events there do not depend on the spring. */
        if (contact_has_springs(s->q->v, s->contact)) {
            made += 1;
            spring = panel_make(s, start->clock, now.clock, spring, panel) ? panel->node[PANEL_END].spring
                                                                           : spring;
        }
        instant_at(s, now.clock, spring, &at);
        put_events(s, &at, now.events);
        *(event_passed(&now, start) != ODE_EVENT_GAP ? &after : &before) = now.clock;
    }
    *s->panels -= made * s->panel_cost / PANELS_COMPARED;
    return panel_make(s, start->clock, after, start->spring, panel);
}

/* Integrates up to the event before a node of a panel and changes the regime. Returns false where no panel
 * that ends at the event can be made, or where its halves do not agree with it: without a dashpot a spring of
 * friction turns fast where F_n vanishes at the event. A shorter panel may be possible. */
static bool pass_event(struct span *s, const struct panel half[2], int passed)
{
    struct panel panel;
    struct panel parts[2];
    const struct panel_node *start = &half[0].node[0];
    const struct panel_node *end = &panel.node[PANEL_END];
    const double before = panel_node_at(half, passed - 1)->clock;
    if (!panel_to_event(s, start, before, panel_node_at(half, passed)->clock, &panel)) {
        return false;
    }
    const int event = event_passed(end, start);
    if (event == ODE_EVENT_GAP ||
        (contact_has_springs(s->q->v, s->contact) && !make_halves(s, end->clock, parts))) {
        return false;
    }
    take_panels(s, &panel, 1);
    lay_springs(s->q, s->contact);
    if (event == ODE_EVENT_LAW) {
        const struct contact_law law = scene_contact_law(s->q, s->contact);
        transition_set_regime(s->q, s->contact, contact_regime_after(&law, regime_of(s)));
    } else if (SCENE_ANY_FRICTION) {
        turning_take_event(s->q, s->contact, (enum ode_event)event);
    }
    counter_add(&s->q->counters.events, 1);
    return true;
}

/*
 * The functions that follow lead through the centre. Where the source's centre passes exactly through the
 * destination's centre, axis or circle, n reverses and the forces jump. Panels end right before it and begin
 * right behind it.
 */

/* Most doublings of the time in which a source leaves the centre at its present relative speed. A source that
 * has not left the centre by then stays in it. */
enum { LEAVING_DOUBLINGS = 10 };

struct passage {
    double from, centre, to; /* clocks: the source comes near the centre, is in it, and has left it */
};

static bool comes_near(const struct span *s, double clock, struct scene_instant *at)
{
    kinematics_at(s->q, clock, at);
    return rounding_of_normal(at, s->contact) > TILT_NEAR;
}

/* Returns when a source in the centre has left it, or INFINITY if it stays. */
static double centre_left(const struct span *s, double clock)
{
    struct scene_instant at;
    kinematics_at(s->q, clock, &at);
    double time = rounding_of_gap(&at, s->contact) / (TILT_NEAR * relative_speed(s, &at));
    for (int i = 0; i < LEAVING_DOUBLINGS; ++i) {
        if (!comes_near(s, clock + time, &at)) {
            return clock + time;
        }
        time *= 2.0;
    }
    return (double)INFINITY;
}

/* Whether the source passes through the centre up to a clock. Bisects until the clock at which it comes near
 * the centre, or n ceases to be within 90 degrees of its start, is known to rounding. */
static bool finds_passage(const struct span *s, double to, struct passage *passage)
{
    const int j = s->contact;
    const double clock = s->q->clock;
    struct scene_instant at;
    if (!SCENE_ANY_CURVED || body_shape(contact_destination(j)) == SHAPE_PLANE) {
        return false;
    }
    double near = clock;
    passage->from = clock;
    if (!comes_near(s, clock, &at)) {
        const struct contact_geometry first = at.geometry[j];
        const bool ends_near = comes_near(s, to, &at);
        const int zone = at.geometry[j].zone;
        if ((SCENE_ANY_ZONES && first.zone != zone && first.zone != -zone) ||
            (!ends_near && vec3_dot(first.normal, at.geometry[j].normal) > 0.0)) {
            return false;
        }
        near = to;
        while (near - passage->from > 4.0 * DBL_EPSILON * fabs(near)) {
            const double middle = 0.5 * (passage->from + near);
            const bool passed =
                comes_near(s, middle, &at) || !(vec3_dot(first.normal, at.geometry[j].normal) > 0.0);
            *(passed ? &near : &passage->from) = middle;
        }
        if (!comes_near(s, near, &at)) {
            return false; /* n turns without a reversal */
        }
    }
    const double outward = scene_contact_side(s->q, j) * at.geometry[j].gap_rate; /* [m/s] */
    passage->centre = near + fmax(-at.geometry[j].distance / outward, 0.0);
    passage->to = centre_left(s, fmin(passage->centre, to));
    return passage->to < (double)INFINITY;
}

static int zone_at(const struct span *s, double clock)
{
    struct scene_instant at;
    kinematics_at(s->q, clock, &at);
    return at.geometry[s->contact].zone;
}

/* Returns the clock at which a panel up to `to` has to end, so that the source stays in one zone: the
 * curvature of the gap's path jumps at the edge of two. */
static double zone_left(const struct span *s, double to)
{
    const double clock = s->q->clock;
    const int zone = zone_at(s, clock);
    double before = clock;
    double after = 0.5 * (clock + to);
    if (zone_at(s, after) == zone) {
        before = after;
        after = to;
        if (zone_at(s, to) == zone) {
            return to;
        }
    }
    while (after - before > 4.0 * DBL_EPSILON * fabs(after)) {
        const double middle = 0.5 * (before + after);
        *(zone_at(s, middle) == zone ? &before : &after) = middle;
    }
    return before > clock ? after : to; /* a panel that begins at the edge has it behind itself */
}

/* Adds the integrals over a time so short that forces and speeds are those at a clock at one of its ends, and
 * notes the peaks there. */
static void add_instant(struct span *s, double clock, double time)
{
    struct scene_instant at;
    instant_at(s, clock, s->q->turning.spring[s->contact], &at);
    const struct integrals now = integrands_at(s, &at);
    contact_peaks_note(&s->q->contact[s->contact].peaks, scene_outward_force(&at, s->contact),
                       -at.geometry[s->contact].gap);
    add_integrals(&s->so_far, time, &now);
}

/* Adds the integrals of a passage through the centre that begins less than its own length after the present.
 * Sets the regimes behind the centre. */
CONTACT_COLD static void pass_centre(struct span *s, double end, const struct passage *passage)
{
    struct scene_state *q = s->q;
    const double to = fmin(passage->to, end);
    const double centre = fmin(passage->centre, to);
    struct scene_instant at;
    add_instant(s, q->clock, centre - q->clock);
    add_instant(s, centre, 0.0); /* the deepest place */
    q->clock = to;
    lay_springs(q, s->contact);
    kinematics_at(s->q, to, &at);
    transition_set_regime(q, s->contact, scene_regime(&at, s->contact, false));
    add_instant(s, to, to - centre);
    counter_add(&q->counters.events, 1);
}

/* Integrates from the present to the clock `end`; the bodies touch until then. Returns false where no panels
 * are left, at the clock reached. */
CONTACT_NOINLINE static bool integrate_between(struct span *s, double end)
{
    struct scene_state *q = s->q;
    const struct contact_law law = scene_contact_law(q, s->contact);
    const bool is_located = s->evaluations != NULL;
    double width = end - q->clock;
    s->has_events = is_located && (contact_has_events(&law) || contact_rubs(q->v, s->contact));
    while (q->clock < end) {
        if (*s->panels < s->panel_cost) {
            return false;
        }
        *s->panels -= s->panel_cost;
        double to = width < end - q->clock ? q->clock + width : end;
        struct passage passage;
        if (SCENE_ANY_ZONES && is_located) {
            to = zone_left(s, to);
        }
        if (is_located && finds_passage(s, to, &passage)) {
            if (!(passage.from - q->clock > passage.to - passage.from)) {
                pass_centre(s, end, &passage);
                continue;
            }
            to = passage.from;
        }
        const double middle = 0.5 * (q->clock + to);
        if (!(middle > q->clock && middle < to)) { /* one rounding of the clock: the integrals are zero */
            width *= 2.0;
            q->clock = to;
            continue;
        }
        struct panel half[2];
        if (!make_halves(s, to, half) || (s->has_events && events_may_dip(half))) {
            width = 0.5 * (to - q->clock);
            continue;
        }
        int passed = s->has_events ? 1 : PANEL_PLACES; /* the first node before which a regime ends */
        while (passed < PANEL_PLACES &&
               event_passed(panel_node_at(half, passed), &half[0].node[0]) == ODE_EVENT_GAP) {
            ++passed;
        }
        if (passed < PANEL_PLACES) {
            width = pass_event(s, half, passed) ? 2.0 * width : 0.5 * (to - q->clock);
            continue;
        }
        width *= 2.0;
        take_panels(s, half, 2);
        if (is_located) {
            lay_springs(q, s->contact);
        }
    }
    return true;
}

/* Adds the integrals of a span to the impulses and energies of the scene. */
static void book_span(const struct span *s)
{
    struct scene_state *q = s->q;
    struct contact_state *state = &q->contact[s->contact];
    struct contact_impulses *sum = &state->physics.impulse;
    const double *of = s->so_far.sum;
    sum->force = vec3_add(sum->force, vec3_from(of));
    if (SCENE_ANY_TURNING) {
        sum->destination_torque = vec3_add(sum->destination_torque, vec3_from(of + TERM_TORQUES));
        sum->source_torque = vec3_add(sum->source_torque, vec3_from(of + TERM_TORQUES + 3));
    }
    if (SCENE_ANY_FREE) {
        q->dissipated += of[TERM_DISSIPATED];
        q->external_work += of[TERM_DISSIPATED + 1];
        q->friction_energy += of[TERM_DISSIPATED + 2];
    }
}

#if SCENE_ANY_FREE

/* Where the panels are used up within one contact, all contacts are integrated anew, up to the clock that
 * this contact has reached. */
double prescribed_integrate(struct scene_state *q, double end, long *budget)
{
    const double start = q->clock;
    struct span span[SCENE_CONTACTS];
    struct contact_peaks before[SCENE_CONTACTS];
    long panels = *budget < PRESCRIBED_PANELS ? *budget : PRESCRIBED_PANELS;
    *budget -= panels;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        before[j] = q->contact[j].peaks;
        span[j] = span_of(q, j, &panels);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!contact_is_prescribed(q->v, j) || q->contact[j].regime == (int32_t)REGIME_APART) {
            continue;
        }
        const bool is_whole = integrate_between(&span[j], end);
        const double reached = q->clock;
        q->clock = start;
        if (!is_whole) {
            long anew = PRESCRIBED_PANELS;
            for (int k = 0; k < SCENE_CONTACTS; ++k) {
                q->contact[k].peaks = before[k];
            }
            return prescribed_integrate(q, reached, &anew);
        }
    }
    *budget += panels;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        book_span(&span[j]);
    }
    return end;
}

#endif

/* Most evaluations of the gap in the search for touches and partings of a step. Some dozens are usual; so
 * many take some tenths of a second of computing. Where a body turns about a changing direction, the rotor
 * makes an evaluation cost as much as TUMBLING_EVALUATION others. */
static const long SEARCH_BUDGET = 1000000;
enum { TUMBLING_EVALUATION = 20 };

/* Begins or ends contact. Energy that is stored there other than zero, as at the end of a finite cylinder or
 * by a jump of the regime, counts as dissipated. */
static void change_contact(struct span *s)
{
    struct scene_instant at;
    const int j = s->contact;
    const bool touches = regime_of(s) != REGIME_APART;
    const struct contact_law law = scene_contact_law(s->q, j);
    kinematics_at(s->q, s->q->clock, &at);
    if (SCENE_ANY_FREE) {
        const double stored = contact_stored_energy(&law, REGIME_COMPRESSION, fmin(at.geometry[j].gap, 0.0));
        s->so_far.sum[TERM_DISSIPATED] += touches ? stored : -stored;
    }
    const enum contact_regime next = touches ? REGIME_APART : scene_regime(&at, j, true);
    transition_set_regime(s->q, j, onset_note(s->q, &at, j, next)); /* a touch sets the dashpot */
    counter_add(&s->q->counters.events, 1);
}

/* Integrates a contact up to the clock `end`, piece by piece between touches and partings. Returns false
 * where the step has used up its panels or its evaluations. */
static bool integrate_located(struct span *s, double end)
{
    while (s->q->clock < end) {
        struct scene_instant at;
        const double clock = s->q->clock;
        if ((*s->panels)-- <= 0 || *s->evaluations <= 0) { /* each change costs a panel: the loop ends */
            return false;
        }
        kinematics_at(s->q, clock, &at);
        const struct advancement_path path = advancement_path_of(&at, clock, s->contact);
        const struct advancement_result found = advancement_first(&path, end - clock, *s->evaluations);
        const double next = found.after < end - clock ? clock + found.after : end;
        *s->evaluations -= found.evaluations;
        if ((next == end && found.searched < end - clock) ||
            (regime_of(s) != REGIME_APART && !integrate_between(s, next))) {
            return false;
        }
        s->q->clock = next;
        if (next < end) {
            change_contact(s);
        }
    }
    return true;
}

/* Returns about how many steps of a series the prescribed rotations take over `length` seconds: none where
 * the direction of rotation is constant, else one for each radian. */
static double steps_of_rotations(const struct scene_state *q, double length)
{
    double steps = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const struct vec3 *omega = q->path[i].angular_velocity;
        if (body_turn_is_prescribed(q->v, i) && !path_is_steady(omega, 3)) {
            steps += length * (vec3_norm(omega[0]) +
                               length * (vec3_norm(omega[1]) / 2.0 + length * vec3_norm(omega[2]) / 3.0));
        }
    }
    return steps;
}

/* Steps of steps_of_rotations that cost as much as the rest of a panel. */
static const double STEPS_OF_PANEL = 5.0;

#if !SCENE_ANY_FREE

/* This part serves scenes in which no body may be free: the regimes and forces of the present. */

void prescribed_settle(struct scene_state *q)
{
    if (SCENE_ANY_FRICTION && scene_turns(q->v)) {
        prescribed_lay_springs(q);
    }
    transition_settle_regimes(q, 0.0, true);
}

void prescribed_begin(struct scene_state *q)
{
    struct scene_instant at;
    prescribed_settle(q);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].physics.impulse = (struct contact_impulses){.force = {0.0, 0.0, 0.0}};
    }
    (void)transition_begin_step(q, &at);
}

#endif

bool prescribed_over(struct scene_state *q, double length, long panels)
{
    const double start = q->clock;
    const double end = start + length;
    const double steps = SCENE_ANY_TURNING ? steps_of_rotations(q, end) : 0.0;
    long evaluations = steps > 0.0 ? SEARCH_BUDGET / TUMBLING_EVALUATION : SEARCH_BUDGET;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct span s = span_of(q, j, &panels);
        if (!contact_is_prescribed(q->v, j)) {
            continue;
        }
        s.evaluations = &evaluations;
        s.panel_cost += (long)fmin(steps / STEPS_OF_PANEL, PRESCRIBED_PANELS);
        struct scene_instant at;
        kinematics_at(q, start, &at);
        const struct separation_path path = separation_path_of(&at, start, j);
        if (!scene_turns(q->v) && path_is_steady(path.c, SEPARATION_DEGREE + 1) &&
            path_is_steady(path.w, SEPARATION_DEGREE)) { /* the force of the present is the mean */
            if (regime_of(&s) != REGIME_APART) {
                add_instant(&s, start, length);
            }
        } else if (!integrate_located(&s, end)) {
            return false;
        }
        q->clock = start;
        book_span(&s);
    }
    return true;
}
