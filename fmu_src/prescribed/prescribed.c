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

/* One contact. A search sets regimes and springs in q before it knows whether they are reached: q serves as
 * working memory. */
struct prescribed_contact {
    const struct scene_values *v;
    struct scene_state *q;
    int contact;
};

/* The indices of the integrals: impulse of the force on the source [N s]; impulses of the torques on source
 * and destination [N m s]; the energy dissipated by the normal law, the energy taken by friction, and the
 * work of whoever moves the bodies [J]. The last integral, of the law's event function, serves only to tell
 * whether a panel resolves this function, which may change where no force acts. */
enum {
    TERM_FORCE = 0,
    TERM_SOURCE_TORQUE = 3,
    TERM_DESTINATION_TORQUE = TERM_SOURCE_TORQUE + 3 * SCENE_ANY_TURNING,
    TERM_DISSIPATED = TERM_DESTINATION_TORQUE + 3 * SCENE_ANY_TURNING,
    TERM_FRICTION = TERM_DISSIPATED + SCENE_ANY_FREE,
    TERM_WORK = TERM_FRICTION + SCENE_ANY_FREE,
    TERM_EVENT = TERM_WORK + SCENE_ANY_FREE,
    TERMS = TERM_EVENT + SCENE_ANY_TURNING
};

/* The springs of a contact: xi of elastic friction [m], theta of elastic rolling and spinning [rad]. */
struct springs {
    struct vec3 of[OPPOSED];
};

/* A panel has the nodes of a Lobatto rule (math/node_tables.h), which include its ends: nothing that happens
 * near an end escapes them. */
enum { PANEL_NODES = 8, PANEL_END = PANEL_NODES - 1 };
#define PANEL_RULE (&lobatto[LOBATTO_EIGHT])

/* The integrals over an interval of time, by the Lobatto rule. The springs are found by collocation at the
 * nodes of this rule. Integrals and springs have the order 14 at the end of the panel. */
struct panel {
    double from, to;        /* clocks [s] */
    double sum[TERMS];      /* the integrals */
    double size[TERMS];     /* the integrals of the absolute terms of each integrand, for its rounding */
    double lever[TERMS];    /* the integrals of d integrand / d force */
    struct springs springs; /* at the end */
    double moved[OPPOSED];  /* the integrals of the lengths of the opposed motions [m, rad] */
    double passed[OPPOSED]; /* the integrals of all terms whose difference the motion is, for its rounding */
    double noise;           /* rounding of the force, the smaller of those at both ends [N] */
    double tilt;            /* rounding of n, the smaller of those at both ends [rad] */
    double depth;           /* penetration, the smaller of those at both ends [m] */
    struct {
        double clock;
        struct springs springs;
    } node[PANEL_NODES];
};

/* One contact over a length of time. */
struct span {
    struct prescribed_contact c;
    double length;          /* [s], from q->clock on */
    double sum[TERMS];      /* the integrals so far */
    double size[TERMS];     /* the integrals of their absolute terms so far */
    struct springs springs; /* at present */
    bool elastic;           /* some opposed motion has a spring */
    long *panels;           /* panels that the quadrature may still make */
    long *evaluations;      /* evaluations that the search for touches may still make; NULL: no search */
    long panel_cost;        /* cost of a panel; 1: nothing turns about a changing direction, no spring */
};

static enum contact_regime regime_of(const struct prescribed_contact *c)
{
    return (enum contact_regime)c->q->contact[c->contact].regime;
}

static void kinematics_at(const struct prescribed_contact *c, double clock, struct scene_instant *at)
{
    scene_kinematics(c->v, c->q, clock, c->q->body, at);
}

static void put_springs_of(const struct prescribed_contact *c, const struct springs *springs)
{
    if (SCENE_ANY_FRICTION) {
        memcpy(c->q->turning.spring[c->contact], springs->of, sizeof springs->of);
    }
}

/* Computes the instant of a contact in its present regimes, whose formulas hold smoothly beyond their
 * ends. */
CONTACT_NOINLINE static void instant_at(const struct prescribed_contact *c, double clock,
                                        const struct springs *springs, struct scene_instant *at)
{
    bool met[SCENE_CONTACTS] = {false};
    met[c->contact] = true;
    put_springs_of(c, springs);
    scene_evaluate(c->v, c->q, clock, c->q->body, &c->q->turning, met, at);
}

/* Sets the torques, the power that friction takes, and the sum of the lengths of both lever arms [m]. Returns
 * a bound of the speeds that the bodies' rotations give the contact points [m/s]. */
static double torque_rates(const struct prescribed_contact *c, const struct scene_instant *at,
                           double rate[TERMS], double *arm)
{
    *arm = 0.0;
    if (!SCENE_ANY_TURNING) {
        return 0.0;
    }
    const int j = c->contact;
    const struct turning_instant *turning = &at->turning;
    if (!scene_turns(c->v)) {
        vec3_to(scene_torque_of_force(at, j), rate + TERM_DESTINATION_TORQUE);
        *arm = vec3_norm(at->separation[j]);
        return 0.0;
    }
    vec3_to(turning->source_torque[j], rate + TERM_SOURCE_TORQUE);
    vec3_to(turning->destination_torque[j], rate + TERM_DESTINATION_TORQUE);
    if (SCENE_ANY_FREE) {
        rate[TERM_FRICTION] = turning_friction_power_of(c->v, at, j);
    }
    *arm = vec3_norm(turning->source_arm[j]) + vec3_norm(turning->destination_arm[j]);
    if (contact_resists(c->v, j)) { /* |M| is at most F_n times these levers */
        for (int i = 1; i < OPPOSED; ++i) {
            *arm += scene_friction_law(c->v, c->q, j, i).coefficient;
        }
    }
    return *arm * turning_spin_size(at, j);
}

/* Sets the integrands (`rate`), the size of their terms (`scale`) and d integrand / d force (`lever`).
 * Returns the sum of the speeds whose difference is the slip [m/s]. */
static double rates_at(const struct prescribed_contact *c, const struct scene_instant *at, double rate[TERMS],
                       double scale[TERMS], double lever[TERMS])
{
    const int j = c->contact;
    const struct contact_law law = scene_contact_law(c->v, c->q, j);
    const struct contact_geometry *g = &at->geometry[j];
    const double force = vec3_norm(at->source_force[j]);
    double arm = 0.0;
    for (int k = 0; k < TERMS; ++k) {
        rate[k] = 0.0;
    }
    vec3_to(at->source_force[j], rate + TERM_FORCE);
    const double turning = torque_rates(c, at, rate, &arm);
    const double speed = vec3_norm(at->velocity[contact_source(j)]) +
                         vec3_norm(at->velocity[contact_destination(j)]) + turning;
    for (int k = 0; k < TERMS; ++k) {
        lever[k] = k < TERM_SOURCE_TORQUE ? 1.0 : k < TERM_DISSIPATED ? arm : k < TERM_EVENT ? speed : 0.0;
        scale[k] = force * lever[k];
    }
    if (SCENE_ANY_FREE) {
        rate[TERM_DISSIPATED] = energy_dissipated_power_of(c->v, c->q, at, j);
        rate[TERM_WORK] = scene_driving_power(c->v, at, j);
        /* the spring loses energy also while the force is clipped to zero */
        scale[TERM_DISSIPATED] += fabs(contact_stored_slope(&law, regime_of(c), g->gap)) * speed;
    }
    if (SCENE_ANY_TURNING) {
        const struct contact_slopes slopes = contact_event_slopes(&law, regime_of(c), g->gap, g->gap_rate);
        const bool ends = scene_turns(c->v) && contact_has_events(&law);
        rate[TERM_EVENT] = ends ? contact_event(&law, regime_of(c), g->gap, g->gap_rate) : 0.0;
        scale[TERM_EVENT] = fabs(slopes.by_gap * g->gap) + fabs(slopes.by_rate) * speed;
    }
    return speed;
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

/* The arguments of the spring's rate at one node; the spring itself is the unknown. */
struct spring_node {
    struct friction_state rubbing;
    struct vec3 normal, normal_rate;
};

struct spring_problem {
    enum opposed part;
    struct friction_law law;
    enum friction_regime regime;
    struct spring_node node[PANEL_NODES];
    struct vec3 start;
    double length; /* of the panel [s] */
};

/* Returns xi' [m/s] at node i for a spring xi [m]. */
static struct vec3 spring_rate_at(const struct spring_problem *p, int i, struct vec3 spring)
{
    const struct spring_node *node = &p->node[i];
    struct friction_state rubbing = node->rubbing;
    rubbing.spring = spring;
    return vec3_add(friction_spring_rate(&p->law, p->regime, rubbing),
                    opposed_turned(p->part, spring, node->normal, node->normal_rate));
}

/* Sets the matrix by columns, which is the identity minus the derivatives of the integrated rates, and the
 * residual [m]. */
static void put_equations(const struct spring_problem *p, const struct vec3 x[PANEL_NODES],
                          double m[UNKNOWNS][COLUMN], double residual[COLUMN])
{
    struct vec3 rate[PANEL_NODES];
    for (int j = 0; j < PANEL_NODES; ++j) {
        const struct spring_node *node = &p->node[j];
        struct friction_state rubbing = node->rubbing;
        rubbing.spring = x[j];
        rate[j] = spring_rate_at(p, j, x[j]);
        struct friction_path path = {.normal_force = {rubbing.normal_force},
                                     .depth = {rubbing.depth},
                                     .slip = {rubbing.slip},
                                     .spring = {x[j]}};
        struct vec3 by_spring[3];
        for (int b = 0; b < 3; ++b) {
            path.spring[1] = vec3_make(b == 0, b == 1, b == 2);
            by_spring[b] = friction_spring_rate_change(&p->law, p->regime, &path);
        }
        const bool spins = p->part == OPPOSED_SPINNING;
        const struct vec3 across = spins ? node->normal_rate : vec3_scale(-1.0, node->normal);
        const struct vec3 along =
            spins ? node->normal : node->normal_rate; /* opposed_turned: across (along.xi) */
        for (int i = 1; j > 0 && i < PANEL_NODES; ++i) {
            const double weight = panel_integral(i, j) * p->length;
            for (int a = 0; a < 3; ++a) {
                for (int b = 0; b < 3; ++b) {
                    const double slope = vec3_get(by_spring[b], a) + vec3_get(across, a) * vec3_get(along, b);
                    m[3 * (j - 1) + b][3 * (i - 1) + a] = (i == j && a == b) - weight * slope;
                }
            }
        }
    }
    for (int i = 1; i < PANEL_NODES; ++i) {
        struct vec3 left = vec3_sub(p->start, x[i]);
        for (int j = 0; j < PANEL_NODES; ++j) {
            left = vec3_axpy(left, panel_integral(i, j) * p->length, rate[j]);
        }
        vec3_to(left, residual + 3 * (i - 1));
    }
}

/* Newton's method converges in two or three steps where the panel is short enough. */
enum { NEWTON_STEPS = 12 };
/* Largest last correction divided by the spring's length. The method squares errors, so that rounding alone
 * is left behind such a correction. */
static const double NEWTON_PART = 1e-9;

/* Solves the equations for the springs x at the nodes. False: the panel is too long. */
static bool solve_spring(const struct spring_problem *p, struct vec3 x[PANEL_NODES])
{
    for (int step = 0; step < NEWTON_STEPS; ++step) {
        double m[UNKNOWNS][COLUMN] = {{0.0}};
        double by[COLUMN] = {0.0};
        int pivot[UNKNOWNS];
        const struct lu_matrix matrix = {UNKNOWNS, COLUMN, &m[0][0], pivot};
        put_equations(p, x, m, by);
        if (!lu_factor(matrix)) {
            return false;
        }
        lu_solve(matrix, by);
        double change = 0.0;
        double size = vec3_norm(p->start);
        for (int i = 1; i < PANEL_NODES; ++i) {
            const struct vec3 d = vec3_from(by + 3 * (i - 1));
            x[i] = vec3_add(x[i], d);
            change = fmax(change, vec3_norm(d));
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

static enum friction_regime rubbing_regime(const struct prescribed_contact *c, int part)
{
    return (enum friction_regime)c->q->contact[c->contact].friction_regime[part];
}

/* Sets one spring at the nodes and at the end of the panel. False: the panel is too long. */
static bool put_spring(const struct prescribed_contact *c, const struct springs *start, int part,
                       struct panel *panel)
{
    struct spring_problem p = {.part = (enum opposed)part,
                               .law = scene_friction_law(c->v, c->q, c->contact, part),
                               .regime = rubbing_regime(c, part),
                               .start = start->of[part],
                               .length = panel->to - panel->from};
    struct vec3 x[PANEL_NODES];
    for (int i = 0; i < PANEL_NODES; ++i) {
        struct scene_instant at;
        instant_at(c, panel->node[i].clock, start, &at);
        p.node[i] = (struct spring_node){.rubbing = turning_rubbing(&c->q->turning, &at, c->contact, part),
                                         .normal = at.geometry[c->contact].normal,
                                         .normal_rate = turning_normal_rate(c->v, c->q, &at, c->contact)};
        x[i] = p.start;
    }
    if (!solve_spring(&p, x)) {
        return false;
    }
    for (int i = 0; i < PANEL_NODES; ++i) {
        panel->node[i].springs.of[part] = x[i];
    }
    panel->springs.of[part] = x[PANEL_END];
    return true;
}

/* Sets the springs of friction, rolling and spinning at the nodes of the panel. The bodies' motion is
 * prescribed, so that no spring acts on another: they are solved one by one. */
static bool put_springs(const struct prescribed_contact *c, const struct springs *start, struct panel *panel)
{
    bool solved = true;
    for (int i = 0; i < OPPOSED; ++i) {
        solved = solved && (!contact_has_spring(c->v, c->contact, i) || put_spring(c, start, i, panel));
    }
    return solved;
}

/* Computes a panel; false where Newton's method finds no spring because the panel is too long. */
CONTACT_NOINLINE static bool panel_make(const struct prescribed_contact *c, double from, double to,
                                        const struct springs *springs, struct panel *panel)
{
    const double length = to - from;
    *panel = (struct panel){.from = from, .to = to, .springs = *springs};
    panel->noise = panel->tilt = panel->depth = (double)INFINITY;
    for (int i = 0; i < PANEL_NODES; ++i) {
        panel->node[i].clock = i < PANEL_END ? from + 0.5 * length * (1.0 + PANEL_RULE->node[i]) : to;
        panel->node[i].springs = *springs;
    }
    if (contact_has_springs(c->v, c->contact) && !put_springs(c, springs, panel)) {
        return false;
    }
    for (int i = 0; i < PANEL_NODES; ++i) {
        struct scene_instant at;
        double rate[TERMS];
        double scale[TERMS];
        double lever[TERMS];
        const double weight = length * panel_integral(PANEL_END, i);
        instant_at(c, panel->node[i].clock, &panel->node[i].springs, &at);
        panel->passed[OPPOSED_SLIP] += weight * rates_at(c, &at, rate, scale, lever);
        for (int k = 0; k < TERMS; ++k) {
            panel->sum[k] += weight * rate[k];
            panel->size[k] += weight * scale[k];
            panel->lever[k] += weight * lever[k];
        }
        if (i % PANEL_END == 0) {
            panel->noise = fmin(panel->noise, rounding_of_force(c->v, c->q, &at, c->contact));
            panel->tilt = fmin(panel->tilt, rounding_of_normal(c->v, &at, c->contact));
            panel->depth = fmin(panel->depth, -at.geometry[c->contact].gap);
        }
        if (SCENE_ANY_TURNING) {
            panel->moved[OPPOSED_SLIP] += weight * vec3_norm(at.turning.slip[c->contact]);
            for (int k = 1; k < OPPOSED; ++k) {
                const struct friction_state at_node = turning_rubbing(&c->q->turning, &at, c->contact, k);
                panel->moved[k] += weight * vec3_norm(at_node.slip);
                panel->passed[k] += weight * turning_spin_size(&at, c->contact);
            }
        }
    }
    if (SCENE_ANY_FREE) {
        counter_add(&c->q->counters.force_evaluations, PANEL_NODES);
    }
    return true;
}

/*
 * The regimes of law and friction of a contact that turns or rubs. All forces are smooth between two events.
 * scene/transition.c sets the regimes after an event, at the clock of q.
 */

static const struct springs NO_SPRINGS = {.of = {{0.0, 0.0, 0.0}}};

static struct springs springs_of(const struct scene_state *q, int contact)
{
    struct springs springs = NO_SPRINGS;
    if (SCENE_ANY_FRICTION) {
        memcpy(springs.of, q->turning.spring[contact], sizeof springs.of);
    }
    return springs;
}

/* Tilts of n by rounding [rad]. Panels end before the centre and begin behind it where n is tilted by more
 * than TILT_NEAR. A spring is not laid across an n that may be tilted by TILT_LAYING. */
static const double TILT_NEAR = 1e-3;
static const double TILT_LAYING = 1e-6;

/* Returns springs laid across or along the normal at a clock (opposed_laid): they lose a part that is
 * rounding. Near the centre n is less exact than the springs, which stay as they are. */
static struct springs laid_springs(const struct prescribed_contact *c, double clock, struct springs springs)
{
    struct scene_instant at;
    instant_at(c, clock, &springs, &at);
    const struct vec3 n = at.geometry[c->contact].normal;
    const bool is_noise = rounding_of_normal(c->v, &at, c->contact) > TILT_LAYING;
    for (int i = 0; i < OPPOSED && !is_noise; ++i) {
        springs.of[i] = opposed_laid((enum opposed)i, springs.of[i], n);
    }
    return springs;
}

/* Rounding error of a slip or a gap rate, divided by the speeds whose difference it is. A spring that sticks
 * integrates the error of the slip. */
static const double SPEED_ROUNDINGS = 8.0 * DBL_EPSILON;

/* Returns the sum of the speeds of which the gap rate is a part: the relative velocity of the centres and the
 * turning of the destination [m/s]. */
static double relative_speed(const struct prescribed_contact *c, const struct scene_instant *at)
{
    const int j = c->contact;
    const double speed = vec3_norm(at->rate[j]);
    return scene_turns(c->v) ? speed + vec3_norm(at->turning.body[contact_destination(j)].angular_velocity) *
                                           vec3_norm(at->separation[j])
                             : speed;
}

/* Sets the event functions of scene/ode.h, raised by their rounding. They are positive within the present
 * regimes. */
static void events_at(const struct prescribed_contact *c, double clock, const struct springs *springs,
                      double events[ODE_EVENTS_EACH])
{
    const double present = c->q->clock;
    struct scene_instant at;
    const struct contact_law law = scene_contact_law(c->v, c->q, c->contact);
    for (int i = 0; i < ODE_EVENTS_EACH; ++i) {
        events[i] = 1.0;
    }
    instant_at(c, clock, springs, &at);
    const double error = SPEED_ROUNDINGS * relative_speed(c, &at); /* [m/s] */
    if (SCENE_ANY_FRICTION && contact_rubs(c->v, c->contact) && contact_transmits(c->q, c->contact)) {
        struct scene_ode ode = {.values = c->v, .state = c->q};
        c->q->clock = clock;
        const double of_slip = error + SPEED_ROUNDINGS * vec3_norm(at.turning.slip[c->contact]);
        turning_friction_events(&ode, &at, c->contact, of_slip, SPEED_ROUNDINGS, 0.0, events);
        c->q->clock = present;
    }
    if (contact_has_events(&law)) {
        const struct contact_geometry *g = &at.geometry[c->contact];
        events[ODE_EVENT_LAW] = contact_event(&law, regime_of(c), g->gap, g->gap_rate) +
                                rounding_of_event(c->v, c->q, &at, c->contact, error);
    }
}

/* Returns the first event whose function is below zero, or ODE_EVENT_GAP if there is none. A function of
 * friction that is below zero at the start must fall to twice its value there. */
static int event_passed(const double *now, const double *start)
{
    for (int i = ODE_EVENT_LAW; i < ODE_EVENT_ZONE; ++i) {
        /* the law's function may jump in the centre, and start below zero on its other side */
        if (now[i] < (i == ODE_EVENT_LAW ? 0.0 : 2.0 * fmin(start[i], 0.0))) {
            return i;
        }
    }
    return ODE_EVENT_GAP;
}

static void lay_springs(const struct prescribed_contact *c)
{
    const struct springs laid = laid_springs(c, c->q->clock, springs_of(c->q, c->contact));
    put_springs_of(c, &laid);
}

void prescribed_lay_springs(const struct scene_values *v, struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        lay_springs(&(struct prescribed_contact){v, q, j});
    }
}

/* Puts the law into a regime at a clock, and friction after it. */
static void take_regime(const struct prescribed_contact *c, double clock, enum contact_regime regime)
{
    const double present = c->q->clock;
    c->q->clock = clock;
    transition_set_regime(c->v, c->q, c->contact, regime);
    c->q->clock = present;
}

/* Sets the regimes and springs after an event. */
static void take_regime_event(const struct prescribed_contact *c, double clock, int event)
{
    const double present = c->q->clock;
    if (event == ODE_EVENT_LAW) {
        const struct contact_law law = scene_contact_law(c->v, c->q, c->contact);
        take_regime(c, clock, contact_regime_after(&law, regime_of(c)));
    } else if (SCENE_ANY_FRICTION) {
        c->q->clock = clock;
        turning_take_event(c->v, c->q, c->contact, (enum ode_event)event);
        c->q->clock = present;
    }
}

/* Largest difference of a panel and its halves, divided by the size of their terms. The order 14 of the rule
 * makes the error of the halves much smaller than this difference. */
static const double PANELS_AGREE = 1e-12;
/* Largest difference of a panel and its halves, divided by the integrals over the whole span. Where the
 * normal reverses in the centre the force jumps, and panels around the jump need not agree once they are so
 * short. */
static const double JUMPS_AGREE = 1e-14;
/* Largest relative difference of the integrals of the law's event function. A panel that resolves the
 * function so well shows its changes of sign at the nodes. */
static const double EVENTS_AGREE = 1e-6;

/* Whether a spring at the end of a panel and of its halves agrees, up to the rounding of the opposed motion,
 * of the normal force and of n. By a constant force L the spring changes by up to L / k_t, and not faster
 * than by L / c_t. */
static bool springs_agree(const struct span *s, int part, const struct panel *whole, const struct panel *left,
                          const struct panel *right)
{
    const struct friction_law law = scene_friction_law(s->c.v, s->c.q, s->c.contact, part);
    const struct vec3 spring = right->springs.of[part];
    const double way = vec3_norm(spring) + left->moved[part] + right->moved[part];
    const double by_force =
        fmin(1.0 / friction_stiffness(&law, whole->depth), (right->to - left->from) / law.damping);
    const double noise = law.coefficient * fmin(left->noise, right->noise) * by_force +
                         vec3_norm(spring) * fmin(left->tilt, right->tilt);
    return vec3_norm(vec3_sub(spring, whole->springs.of[part])) <=
           4.0 * PANELS_AGREE * way + SPEED_ROUNDINGS * whole->passed[part] + noise;
}

/* Whether a panel and its halves agree. Near the centre n may be mere rounding at one or both ends of the
 * panel; the least rounding bound of the force at the ends and in the middle then holds for nearly all of the
 * time between. */
CONTACT_NOINLINE static bool panels_agree(const struct span *s, const struct panel *whole,
                                          const struct panel *left, const struct panel *right)
{
    const double noise = fmin(left->noise, right->noise);
    for (int k = 0; k < TERMS; ++k) {
        const double size = left->size[k] + right->size[k];
        const double allowed =
            SCENE_ANY_TURNING && k == TERM_EVENT
                ? EVENTS_AGREE * size + DBL_MIN
                : PANELS_AGREE * size + noise * whole->lever[k] + JUMPS_AGREE * s->size[k] + DBL_MIN;
        const bool overflows = isinf(size); /* a torque may overflow; shorter panels do not help */
        if (!overflows && !(fabs(left->sum[k] + right->sum[k] - whole->sum[k]) <= allowed)) {
            return false;
        }
    }
    for (int i = 0; i < OPPOSED; ++i) {
        if (contact_has_spring(s->c.v, s->c.contact, i) && !springs_agree(s, i, whole, left, right)) {
            return false;
        }
    }
    return true;
}

/* Parts of a panel in the search for peaks. Each half of a panel has eight nodes, so that no quantity has two
 * extrema within a quarter of the panel. */
enum { PANEL_PARTS = 4 };

CONTACT_NOINLINE static void note_peaks_between(const struct span *s, double from, double to)
{
    struct scene_output output = {.values = s->c.v, .state = s->c.q, .contact = s->c.contact};
    scene_output_note_peaks(&output, from, to, PANEL_PARTS, &s->c.q->contact[s->c.contact].peaks);
    if (SCENE_ANY_FREE) {
        counter_add(&s->c.q->counters.force_evaluations, PANEL_PARTS + 1);
    }
}

static void add_sums(struct span *s, const struct panel *panel)
{
    for (int k = 0; k < TERMS; ++k) {
        s->sum[k] += panel->sum[k];
        s->size[k] += panel->size[k];
    }
    s->springs = panel->springs;
}

/* A clock within a panel, and the event functions there. */
struct place {
    double clock;
    double at[ODE_EVENTS_EACH];
};

/* Number of places in both halves of a panel, which share a node. */
enum { PANEL_PLACES = 2 * PANEL_NODES - 1 };

static void put_place(const struct span *s, double clock, const struct springs *springs, struct place *place)
{
    place->clock = clock;
    events_at(&s->c, clock, springs, place->at);
}

/* Computes all places of a panel; false where an event function may fall below zero between them and rise
 * again, which shorter panels show. The functions of sticking may jump and are not looked at. */
static bool put_places(const struct span *s, const struct panel *left, const struct panel *right,
                       struct place place[PANEL_PLACES])
{
    for (int i = 0; i < PANEL_PLACES; ++i) {
        const struct panel *half = i < PANEL_NODES ? left : right;
        const int node = i < PANEL_NODES ? i : i - PANEL_END;
        put_place(s, half->node[node].clock, &half->node[node].springs, &place[i]);
    }
    for (int i = 2; i < PANEL_PLACES; ++i) {
        for (int event = ODE_EVENT_LAW; event < ODE_EVENT_ZONE; ++event) {
            struct root_place of[3];
            for (int k = 0; k < 3; ++k) {
                of[k] = (struct root_place){place[i - 2 + k].clock, place[i - 2 + k].at[event]};
            }
            if (event != (int)ode_stick_event(ode_event_part((enum ode_event)event)) && root_may_dip(of)) {
                return false;
            }
        }
    }
    return true;
}

/* Returns the first place of a panel before which a regime ends, or PANEL_PLACES if none does. */
static int place_passed(const struct place place[PANEL_PLACES])
{
    int i = 1;
    while (i < PANEL_PLACES && event_passed(place[i].at, place[0].at) == ODE_EVENT_GAP) {
        ++i;
    }
    return i;
}

/* Whether a contact has events that its panels have to locate. */
static bool span_has_events(const struct span *s)
{
    const struct contact_law law = scene_contact_law(s->c.v, s->c.q, s->c.contact);
    return s->evaluations != NULL && (contact_has_events(&law) || contact_rubs(s->c.v, s->c.contact));
}

/* Panels that are computed for each one that the quadrature counts: a panel and its two halves. */
enum { PANELS_COMPARED = 3 };

/* Bisects between the places `passed` and before until the clock of an event is known to rounding. Makes the
 * panel that ends just past the event. False: there is no such panel or no event. */
static bool panel_to_event(const struct span *s, const struct place *place, int passed, struct panel *panel,
                           int *event)
{
    const struct place *start = &place[0];
    double before = place[passed - 1].clock;
    double after = place[passed].clock;
    const struct springs first = s->springs;
    double now[ODE_EVENTS_EACH];
    int made = 0;
    panel->springs = first;
    while (after - before > 4.0 * DBL_EPSILON * fabs(after)) {
        const double middle = 0.5 * (before + after);
        made += s->elastic;
        if (!(middle > before && middle < after)) {
            break;
        }
        /* Where friction without a dashpot vanishes with F_n, its spring turns ever faster, and not every
         * panel beyond the event can be made. The events there do not depend on the spring. */
        if (s->elastic && !panel_make(&s->c, start->clock, middle, &first, panel)) {
            panel->springs = first;
        }
        events_at(&s->c, middle, &panel->springs, now);
        *(event_passed(now, start->at) != ODE_EVENT_GAP ? &after : &before) = middle;
    }
    *s->panels -= made * s->panel_cost / PANELS_COMPARED;
    if (!panel_make(&s->c, start->clock, after, &first, panel)) {
        return false;
    }
    events_at(&s->c, after, &panel->springs, now);
    *event = event_passed(now, start->at);
    return *event != ODE_EVENT_GAP;
}

/* Integrates up to the event before a place of a panel and changes the regime. False: no panel that ends at
 * the event can be made; a shorter one may. */
static bool pass_event(struct span *s, const struct place *place, int passed, double *clock)
{
    struct panel panel;
    int event;
    if (!panel_to_event(s, place, passed, &panel, &event)) {
        return false;
    }
    add_sums(s, &panel);
    note_peaks_between(s, panel.from, panel.to);
    s->springs = laid_springs(&s->c, panel.to, s->springs);
    put_springs_of(&s->c, &s->springs);
    take_regime_event(&s->c, panel.to, event);
    s->springs = springs_of(s->c.q, s->c.contact);
    counter_add(&s->c.q->counters.events, 1);
    *clock = panel.to;
    return true;
}

/*
 * The way through the centre. Where the source's centre passes exactly through the destination's centre, axis
 * or circle, n reverses and the forces jump. Panels end right before it and begin right behind it.
 */

/* Most doublings of the time in which a source leaves the centre at its present relative speed. A source that
 * has not left the centre by then stays in it. */
enum { LEAVING_DOUBLINGS = 10 };

struct passage {
    double from, centre, to; /* clocks: the source comes near the centre, is in it, and has left it */
};

static bool comes_near(const struct span *s, double clock, struct scene_instant *at)
{
    kinematics_at(&s->c, clock, at);
    return rounding_of_normal(s->c.v, at, s->c.contact) > TILT_NEAR;
}

/* Bisects between two clocks until the one at which the source comes near the centre (`normal` NULL), or n
 * ceases to be within 90 degrees of `normal`, is known to rounding. */
static void bisect_passage(const struct span *s, const struct vec3 *normal, double *before, double *after)
{
    struct scene_instant at;
    while (*after - *before > 4.0 * DBL_EPSILON * fabs(*after)) {
        const double middle = 0.5 * (*before + *after);
        const bool near = comes_near(s, middle, &at);
        const bool passed = normal ? !(vec3_dot(*normal, at.geometry[s->c.contact].normal) > 0.0) : near;
        *(passed ? after : before) = middle;
    }
}

/* Returns when a source in the centre has left it, or INFINITY if it stays. */
static double centre_left(const struct span *s, double clock)
{
    struct scene_instant at;
    kinematics_at(&s->c, clock, &at);
    double time = rounding_of_gap(s->c.v, &at, s->c.contact) / (TILT_NEAR * relative_speed(&s->c, &at));
    for (int i = 0; i < LEAVING_DOUBLINGS; ++i) {
        if (!comes_near(s, clock + time, &at)) {
            return clock + time;
        }
        time *= 2.0;
    }
    return (double)INFINITY;
}

/* Whether the source passes through the centre between two clocks. */
static bool finds_passage(const struct span *s, double clock, double to, struct passage *passage)
{
    const int j = s->c.contact;
    struct scene_instant first;
    struct scene_instant last;
    if (!SCENE_ANY_CURVED || body_shape(contact_destination(j)) == SHAPE_PLANE) {
        return false;
    }
    *passage = (struct passage){clock, clock, clock};
    if (!comes_near(s, clock, &first)) {
        const struct vec3 normal = first.geometry[j].normal;
        const bool ends_near = comes_near(s, to, &last);
        const int zones[2] = {first.geometry[j].zone, last.geometry[j].zone};
        if ((SCENE_ANY_ZONES && zones[0] != zones[1] && zones[0] != -zones[1]) ||
            (!ends_near && vec3_dot(normal, last.geometry[j].normal) > 0.0)) {
            return false;
        }
        double before = clock;
        passage->centre = to;
        if (!ends_near) {
            bisect_passage(s, &normal, &before, &passage->centre);
        }
        if (!comes_near(s, passage->centre, &last)) {
            return false; /* n turns without a reversal */
        }
        double near = passage->centre;
        bisect_passage(s, NULL, &passage->from, &near);
    }
    passage->to = centre_left(s, passage->centre);
    return passage->to < (double)INFINITY;
}

static int zone_at(const struct span *s, double clock)
{
    struct scene_instant at;
    kinematics_at(&s->c, clock, &at);
    return at.geometry[s->c.contact].zone;
}

/* Returns the clock at which a panel from `clock` to `to` has to end, so that the source stays in one zone:
 * the curvature of the gap's path jumps at the edge of two. */
static double zone_left(const struct span *s, double clock, double to)
{
    double before = 0.5 * (clock + to);
    double after = to;
    const int zone = zone_at(s, before);
    if (zone_at(s, to) == zone) {
        if (zone_at(s, clock) == zone) {
            return to;
        }
        after = before;
        before = clock;
    }
    const int from = zone_at(s, before);
    while (after - before > 4.0 * DBL_EPSILON * fabs(after)) {
        const double middle = 0.5 * (before + after);
        *(zone_at(s, middle) == from ? &before : &after) = middle;
    }
    return before > clock ? after : to; /* a panel that begins at the edge has it behind itself */
}

/* Adds the integrals over a time so short that forces and speeds are those at a clock at one of its ends. */
static void add_instant(struct span *s, double clock, double time)
{
    const struct prescribed_contact *c = &s->c;
    const int j = c->contact;
    struct scene_instant at;
    double rate[TERMS];
    double scale[TERMS];
    double lever[TERMS];
    instant_at(c, clock, &s->springs, &at);
    (void)rates_at(c, &at, rate, scale, lever);
    for (int k = 0; k < TERMS; ++k) {
        s->sum[k] += time * rate[k];
        s->size[k] += time * scale[k];
    }
    for (int i = 0; s->elastic && i < OPPOSED; ++i) {
        const struct friction_law law = scene_friction_law(c->v, c->q, j, i);
        const struct friction_state rubbing = turning_rubbing(&c->q->turning, &at, j, i);
        const struct vec3 own = friction_spring_rate(&law, rubbing_regime(c, i), rubbing);
        s->springs.of[i] = vec3_axpy(s->springs.of[i], time, own);
    }
}

/* Adds the integrals of a passage from a clock shortly before it. Sets the regimes behind the centre. */
CONTACT_COLD static void pass_centre(struct span *s, double clock, double end, const struct passage *passage)
{
    const struct prescribed_contact *c = &s->c;
    const double to = fmin(passage->to, end);
    struct scene_instant at;
    add_instant(s, clock, passage->centre - clock);
    instant_at(c, passage->centre, &s->springs, &at);
    contact_peaks_note(&c->q->contact[c->contact].peaks, at.normal_force[c->contact],
                       -at.geometry[c->contact].gap);
    s->springs = laid_springs(c, to, s->springs);
    kinematics_at(c, to, &at);
    put_springs_of(c, &s->springs);
    take_regime(c, to, scene_regime(c->v, c->q, &at, c->contact, false));
    s->springs = springs_of(c->q, c->contact);
    add_instant(s, to, to - passage->centre);
    counter_add(&c->q->counters.events, 1);
}

/* Adds the integrals between two clocks, between which the bodies touch. Returns the clock reached, which
 * lies before `end` where no panels are left. */
CONTACT_NOINLINE static double integrate_between(struct span *s, double from, double end)
{
    const bool has_events = span_has_events(s);
    double clock = from;
    double width = end - from;
    while (clock < end) {
        if (*s->panels < s->panel_cost) {
            return clock;
        }
        *s->panels -= s->panel_cost;
        double to = width < end - clock ? clock + width : end;
        struct passage passage;
        if (SCENE_ANY_ZONES && s->evaluations != NULL) {
            to = zone_left(s, clock, to);
        }
        if (s->evaluations != NULL && finds_passage(s, clock, to, &passage)) {
            if (!(passage.from - clock > passage.centre - passage.from)) {
                pass_centre(s, clock, end, &passage);
                clock = fmin(passage.to, end);
                continue;
            }
            to = passage.from;
        }
        const double middle = 0.5 * (clock + to);
        const bool divides = middle > clock && middle < to;
        struct panel whole;
        struct panel left;
        struct panel right;
        const bool made = panel_make(&s->c, clock, to, &s->springs, &whole) &&
                          panel_make(&s->c, clock, middle, &s->springs, &left) &&
                          panel_make(&s->c, middle, to, &left.springs, &right);
        struct place place[PANEL_PLACES];
        if (divides && (!made || !panels_agree(s, &whole, &left, &right) ||
                        (has_events && !put_places(s, &left, &right, place)))) {
            width = 0.5 * (to - clock);
            continue;
        }
        const int passed = has_events && made && divides ? place_passed(place) : PANEL_PLACES;
        if (passed < PANEL_PLACES) {
            width = pass_event(s, place, passed, &clock) ? 2.0 * width : 0.5 * (to - clock);
            continue;
        }
        width *= 2.0;
        if (made) { /* else the time between is one rounding of the clock, and the integrals are zero */
            add_sums(s, &left);
            add_sums(s, &right);
            note_peaks_between(s, clock, to);
            if (s->evaluations != NULL) {
                s->springs = laid_springs(&s->c, to, s->springs);
            }
        }
        clock = to;
    }
    return clock;
}

/* Cost of a panel with a spring, divided by the cost of a panel without. */
enum { ELASTIC_PANEL = 3 };

static struct span span_of(const struct scene_values *v, struct scene_state *q, int contact, double length,
                           long *panels)
{
    return (struct span){.c = {v, q, contact},
                         .length = length,
                         .elastic = contact_has_springs(v, contact),
                         .panels = panels,
                         .panel_cost = contact_has_springs(v, contact) ? ELASTIC_PANEL : 1};
}

/* Adds the integrals of a span to the impulses and energies of the scene. */
static void book_span(const struct span *s)
{
    struct scene_state *q = s->c.q;
    struct contact_state *state = &q->contact[s->c.contact];
    struct contact_torques *torques = &state->torques;
    state->physics.impulse = vec3_add(state->physics.impulse, vec3_from(s->sum + TERM_FORCE));
    if (SCENE_ANY_TURNING) {
        torques->source_impulse = vec3_add(torques->source_impulse, vec3_from(s->sum + TERM_SOURCE_TORQUE));
        torques->destination_impulse =
            vec3_add(torques->destination_impulse, vec3_from(s->sum + TERM_DESTINATION_TORQUE));
    }
    if (SCENE_ANY_FREE) {
        q->dissipated += s->sum[TERM_DISSIPATED];
        q->external_work += s->sum[TERM_WORK];
        q->friction_energy += SCENE_ANY_TURNING ? s->sum[TERM_FRICTION] : 0.0;
    }
    if (scene_turns(s->c.v)) {
        put_springs_of(&s->c, &s->springs);
    }
}

#if SCENE_ANY_FREE

/* Integrates and books all prescribed contacts. Where the panels are used up before `end`, nothing is booked.
 * Returns the clock reached. */
static double integrate_contacts(const struct scene_values *v, struct scene_state *q, double end,
                                 long *panels)
{
    struct span span[SCENE_CONTACTS] = {0};
    struct contact_peaks before[SCENE_CONTACTS];
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        before[j] = q->contact[j].peaks;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_is_prescribed(v, j) && q->contact[j].regime != (int32_t)REGIME_APART) {
            span[j] = span_of(v, q, j, end - q->clock, panels);
            const double reached = integrate_between(&span[j], q->clock, end);
            if (reached < end) {
                for (int i = 0; i <= j; ++i) {
                    q->contact[i].peaks = before[i];
                }
                return reached;
            }
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (span[j].panels != NULL) {
            book_span(&span[j]);
        }
    }
    return end;
}

/* Where the panels are used up within one contact, all contacts are integrated anew, up to the clock that
 * this contact has reached. */
double prescribed_integrate(const struct scene_values *v, struct scene_state *q, double end, long *budget)
{
    const long allowed = *budget < PRESCRIBED_PANELS ? *budget : PRESCRIBED_PANELS;
    long panels = allowed;
    const double reached = integrate_contacts(v, q, end, &panels);
    *budget -= allowed - panels;
    if (!(reached < end)) {
        return end;
    }
    panels = PRESCRIBED_PANELS;
    return integrate_contacts(v, q, reached, &panels) < reached ? q->clock : reached;
}

#endif

/* Most evaluations of the gap in the search for touches and partings of a step. Some dozens are usual; so
 * many take some tenths of a second of computing. */
static const long SEARCH_BUDGET = 1000000;

/* Sets *next to the clock of the next touch or parting, or to `end`. False: the evaluations are used up. */
static bool finds_change(const struct span *s, double clock, double end, enum advancement_change change,
                         double *next)
{
    struct scene_instant at;
    if (*s->evaluations <= 0) {
        return false;
    }
    kinematics_at(&s->c, clock, &at);
    const struct advancement_path path = advancement_path_of(s->c.v, s->c.q, &at, clock, s->c.contact);
    const struct advancement_result found = advancement_first(&path, change, end - clock, *s->evaluations);
    *s->evaluations -= found.evaluations;
    *next = found.after < end - clock ? clock + found.after : end;
    return *next < end || !(found.searched < end - clock);
}

static void begin_contact(struct span *s, double clock)
{
    const struct prescribed_contact *c = &s->c;
    struct scene_instant at;
    kinematics_at(c, clock, &at);
    (void)onset_note(c->v, c->q, &at, c->contact, scene_regime(c->v, c->q, &at, c->contact, true));
    take_regime(c, clock, scene_regime(c->v, c->q, &at, c->contact, true));
    s->springs = springs_of(c->q, c->contact);
}

/* Books the energy stored at a clock, times `sign`, as dissipated. It is other than zero where contact begins
 * or ends at the end of a finite cylinder, or by a jump of the regime. */
static void book_stored(struct span *s, double clock, double sign)
{
    if (SCENE_ANY_FREE) {
        struct scene_instant at;
        const struct contact_law law = scene_contact_law(s->c.v, s->c.q, s->c.contact);
        kinematics_at(&s->c, clock, &at);
        const double gap = fmin(at.geometry[s->c.contact].gap, 0.0);
        s->sum[TERM_DISSIPATED] += sign * contact_stored_energy(&law, REGIME_COMPRESSION, gap);
    }
}

/* Integrates from touch to parting to touch. */
static bool integrate_located(struct span *s)
{
    struct scene_state *q = s->c.q;
    const int j = s->c.contact;
    const double end = q->clock + s->length;
    double clock = q->clock;
    s->springs = springs_of(q, j);
    while (clock < end) {
        const bool touches = q->contact[j].regime != (int32_t)REGIME_APART;
        double next;
        if ((*s->panels)-- <= 0 || /* each change costs a panel, so that the loop ends */
            !finds_change(s, clock, end, touches ? ADVANCEMENT_PARTING : ADVANCEMENT_TOUCH, &next) ||
            (touches && integrate_between(s, clock, next) < next)) {
            return false;
        }
        if (next < end && touches) {
            book_stored(s, next, 1.0);
            take_regime(&s->c, next, REGIME_APART);
        } else if (next < end) {
            begin_contact(s, next);
            book_stored(s, next, -1.0);
        }
        counter_add(&q->counters.events, next < end);
        clock = next;
    }
    return true;
}

/* Steps of turning_prescribed_steps that cost as much as the rest of a panel. */
static const double STEPS_OF_PANEL = 5.0;

#if !SCENE_ANY_FREE

/* This part serves scenes in which no body may be free: the regimes and forces of the present. */

void prescribed_settle(const struct scene_values *v, struct scene_state *q)
{
    struct scene_instant at;
    scene_kinematics_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct prescribed_contact c = {v, q, j};
        const enum contact_regime next = onset_note(v, q, &at, j, scene_regime(v, q, &at, j, false));
        if (SCENE_ANY_FRICTION && scene_turns(v) && next != REGIME_APART && regime_of(&c) != REGIME_APART) {
            lay_springs(&c);
        }
        take_regime(&c, q->clock, next);
    }
}

void prescribed_begin(const struct scene_values *v, struct scene_state *q)
{
    struct scene_instant at;
    prescribed_settle(v, q);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].physics.impulse = vec3_make(0.0, 0.0, 0.0);
        q->contact[j].torques = (struct contact_torques){0};
    }
    transition_begin_step(v, q, &at);
}

/* Whether nothing moves against anything. The force of the present is then the mean. */
static bool takes_steady(const struct span *s)
{
    struct scene_instant at;
    const int j = s->c.contact;
    struct contact_state *state = &s->c.q->contact[j];
    scene_kinematics_now(s->c.v, s->c.q, &at);
    const struct separation_path path = separation_path_of(s->c.v, s->c.q, &at, s->c.q->clock, j);
    if (scene_turns(s->c.v) || !path_is_steady(path.c, SEPARATION_DEGREE + 1) ||
        !path_is_steady(path.w, SEPARATION_DEGREE)) {
        return false;
    }
    if (state->regime != (int32_t)REGIME_APART) {
        scene_forces(s->c.v, s->c.q, s->c.q->clock, &at);
        state->physics.impulse = vec3_scale(s->length, at.source_force[j]);
        if (SCENE_HAS_TORQUES) {
            state->torques.destination_impulse = vec3_scale(s->length, scene_torque_of_force(&at, j));
        }
    }
    return true;
}

#endif

bool prescribed_over(const struct scene_values *v, struct scene_state *q, double length, long panels)
{
    long evaluations = SEARCH_BUDGET;
    const double steps = SCENE_ANY_TURNING ? turning_prescribed_steps(v, q, q->clock + length) : 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct span s = span_of(v, q, j, length, &panels);
        if (!contact_is_prescribed(v, j)) {
            continue;
        }
#if !SCENE_ANY_FREE
        if (takes_steady(&s)) {
            continue;
        }
#endif
        s.evaluations = &evaluations;
        s.panel_cost += (long)fmin(steps / STEPS_OF_PANEL, PRESCRIBED_PANELS);
        if (!integrate_located(&s)) {
            return false;
        }
        book_span(&s);
    }
    return true;
}
