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

/* The integrals over an interval of time. Springs follow by collocation at the same Gauss nodes, and have
 * order ten at the end. */
struct panel {
    double from, to;        /* clocks [s] */
    double sum[TERMS];      /* the integrals */
    double size[TERMS];     /* the integrals of the absolute terms of each integrand, for its rounding */
    double lever[TERMS];    /* the integrals of d integrand / d force */
    struct springs springs; /* at the end */
    double moved[OPPOSED];  /* the integrals of the lengths of the opposed motions [m, rad] */
    double passed[OPPOSED]; /* the integrals of all terms whose difference the motion is, for its rounding */
    struct {
        double clock;
        struct springs springs;
        struct vec3 slip, spin, normal;
    } node[GAUSS_NODES];
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

/* COLLOCATION[i][j] is the integral from 0 to node i of the polynomial that is 1 at node j and 0 at the other
 * nodes of the Gauss rule on [0, 1]. The numbers were computed from this definition with 30 digits. */
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

/* The unknowns are the components of the spring at all nodes. Each column of the matrix has a zero behind its
 * entries, as math/lu.h asks for. */
enum { UNKNOWNS = 3 * GAUSS_NODES, COLUMN = UNKNOWNS + 1 };

/* The arguments of the spring's rate at one node; the spring itself is the unknown. */
struct spring_node {
    struct friction_state rubbing;
    struct vec3 normal, normal_rate;
    double factor; /* d time / d variable of the panel, which runs from 0 to 1 [s] */
};

struct spring_problem {
    enum opposed part;
    struct friction_law law;
    enum friction_regime regime;
    struct spring_node node[GAUSS_NODES];
    struct vec3 start;
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
static void put_equations(const struct spring_problem *p, const struct vec3 x[GAUSS_NODES],
                          double m[UNKNOWNS][COLUMN], double residual[COLUMN])
{
    struct vec3 rate[GAUSS_NODES];
    for (int j = 0; j < GAUSS_NODES; ++j) {
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
        for (int i = 0; i < GAUSS_NODES; ++i) {
            const double weight = COLLOCATION[i][j] * node->factor;
            for (int a = 0; a < 3; ++a) {
                for (int b = 0; b < 3; ++b) {
                    const double slope = vec3_get(by_spring[b], a) + vec3_get(across, a) * vec3_get(along, b);
                    m[3 * j + b][3 * i + a] = (i == j && a == b) - weight * slope;
                }
            }
        }
    }
    for (int i = 0; i < GAUSS_NODES; ++i) {
        struct vec3 left = vec3_sub(p->start, x[i]);
        for (int j = 0; j < GAUSS_NODES; ++j) {
            left = vec3_axpy(left, COLLOCATION[i][j] * p->node[j].factor, rate[j]);
        }
        vec3_to(left, residual + 3 * i);
    }
}

/* Newton's method converges in two or three steps where the panel is short enough. */
enum { NEWTON_STEPS = 12 };
/* Largest last correction divided by the spring's length; and the largest one that rounding may leave where a
 * spring turns fast. */
static const double NEWTON_PART = 1e-14;
static const double NEWTON_NOISE = 1e-12;

/* Solves the equations for the springs x at the nodes. False: the panel is too long. */
static bool solve_spring(const struct spring_problem *p, struct vec3 x[GAUSS_NODES])
{
    double change = 0.0;
    double size = 0.0;
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
        change = 0.0;
        size = vec3_norm(p->start);
        for (int i = 0; i < GAUSS_NODES; ++i) {
            const struct vec3 d = vec3_from(by + 3 * i);
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
    return change <= NEWTON_NOISE * size;
}

static enum friction_regime rubbing_regime(const struct prescribed_contact *c, int part)
{
    return (enum friction_regime)c->q->contact[c->contact].friction_regime[part];
}

/* Sets one spring at the nodes and at the end of the panel. False: the panel is too long. */
static bool put_spring(const struct prescribed_contact *c, bool graded, const struct springs *start, int part,
                       struct panel *panel)
{
    struct spring_problem p = {.part = (enum opposed)part,
                               .law = scene_friction_law(c->v, c->q, c->contact, part),
                               .regime = rubbing_regime(c, part),
                               .start = start->of[part]};
    struct vec3 x[GAUSS_NODES];
    for (int i = 0; i < GAUSS_NODES; ++i) {
        struct scene_instant at;
        instant_at(c, panel->node[i].clock, start, &at);
        p.node[i] = (struct spring_node){.rubbing = turning_rubbing(&c->q->turning, &at, c->contact, part),
                                         .normal = at.geometry[c->contact].normal,
                                         .normal_rate = turning_normal_rate(c->v, c->q, &at, c->contact),
                                         .factor = (panel->to - panel->from) * gauss_place(i, graded).factor};
        x[i] = p.start;
    }
    if (!solve_spring(&p, x)) {
        return false;
    }
    struct vec3 *end = &panel->springs.of[part];
    *end = p.start;
    for (int i = 0; i < GAUSS_NODES; ++i) {
        panel->node[i].springs.of[part] = x[i];
        *end = vec3_axpy(*end, 0.5 * GAUSS_WEIGHT[i] * p.node[i].factor, spring_rate_at(&p, i, x[i]));
    }
    return true;
}

/* Sets the springs of friction, rolling and spinning at the nodes of the panel. The bodies' motion is
 * prescribed, so that no spring acts on another: they are solved one by one. */
static bool put_springs(const struct prescribed_contact *c, bool graded, const struct springs *start,
                        struct panel *panel)
{
    bool solved = true;
    for (int i = 0; i < OPPOSED; ++i) {
        solved =
            solved && (!contact_has_spring(c->v, c->contact, i) || put_spring(c, graded, start, i, panel));
    }
    return solved;
}

/* Depth at an end of a panel as a fraction of the depth in its middle, below which the panel is graded
 * (math/nodes.h). Near the touch Hertz's force is proportional to the power 3/2 of time, which graded nodes
 * follow better. Elsewhere nodes without grading converge faster. */
static const double SHALLOW = 0.1;

static bool wants_grading(const struct prescribed_contact *c, double from, double to)
{
    const double clock[3] = {from, 0.5 * (from + to), to};
    double gap[3];
    if (!scene_is_hertz(c->v, c->contact)) {
        return false;
    }
    for (int i = 0; i < 3; ++i) {
        struct scene_instant at;
        kinematics_at(c, clock[i], &at);
        gap[i] = at.geometry[c->contact].gap;
    }
    return fmax(gap[0], gap[2]) > SHALLOW * gap[1];
}

/* Computes a panel; false where Newton's method finds no spring because the panel is too long. */
CONTACT_NOINLINE static bool panel_make(const struct prescribed_contact *c, double from, double to,
                                        const struct springs *springs, struct panel *panel)
{
    const double half = 0.5 * (to - from);
    const bool graded = wants_grading(c, from, to);
    *panel = (struct panel){.from = from, .to = to, .springs = *springs};
    for (int i = 0; i < GAUSS_NODES; ++i) {
        panel->node[i].clock = from + half * gauss_place(i, graded).at;
        panel->node[i].springs = *springs;
    }
    if (contact_has_springs(c->v, c->contact) && !put_springs(c, graded, springs, panel)) {
        return false;
    }
    for (int i = 0; i < GAUSS_NODES; ++i) {
        struct scene_instant at;
        double rate[TERMS];
        double scale[TERMS];
        double lever[TERMS];
        const double weight = half * GAUSS_WEIGHT[i] * gauss_place(i, graded).factor;
        instant_at(c, panel->node[i].clock, &panel->node[i].springs, &at);
        panel->passed[OPPOSED_SLIP] += weight * rates_at(c, &at, rate, scale, lever);
        for (int k = 0; k < TERMS; ++k) {
            panel->sum[k] += weight * rate[k];
            panel->size[k] += weight * scale[k];
            panel->lever[k] += weight * lever[k];
        }
        panel->node[i].normal = at.geometry[c->contact].normal;
        if (SCENE_ANY_TURNING) {
            panel->node[i].slip = at.turning.slip[c->contact];
            panel->node[i].spin = turning_spin(&at, c->contact);
            panel->moved[OPPOSED_SLIP] += weight * vec3_norm(panel->node[i].slip);
            for (int k = 1; k < OPPOSED; ++k) {
                const struct friction_state at_node = turning_rubbing(&c->q->turning, &at, c->contact, k);
                panel->moved[k] += weight * vec3_norm(at_node.slip);
                panel->passed[k] += weight * turning_spin_size(&at, c->contact);
            }
        }
    }
    if (SCENE_ANY_FREE) {
        counter_add(&c->q->counters.force_evaluations, GAUSS_NODES);
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

/* Largest difference of a panel and its halves, divided by the size of their terms. The order ten of the
 * Gauss rule makes the error of the halves a thousandth of this difference. */
static const double PANELS_AGREE = 1e-12;
/* Largest difference of a panel and its halves, divided by the integrals over the whole span. Where the
 * normal reverses in the centre the force jumps, and panels around the jump need not agree once they are so
 * short. */
static const double JUMPS_AGREE = 1e-14;
/* Largest relative difference of the integrals of the law's event function. A panel that resolves the
 * function so well shows its changes of sign at the nodes. */
static const double EVENTS_AGREE = 1e-6;

/* The cosine of the largest rotation of n between an end of a panel and the node next to it, 0.5 rad. An n
 * that turns further may reverse, in the centre. */
static const double LARGEST_TURN_COSINE = 0.88;

/* Slip speeds divided by v_0. Above SATURATED the term exp(-|v_t|/v_0) is rounding. Over a change by FOLLOWED
 * the interpolation between nodes follows this term. Below PROPORTIONAL friction is proportional to the
 * slip. */
static const double SATURATED = 40.0;
static const double FOLLOWED = 2.0;
static const double PROPORTIONAL = 1e-6;

/* A slip that is below this part of itself at the node next to an end may reverse close behind that node. The
 * nodes then show nothing of the corner, because the layer bends between the end and the node alone. */
static const double NEARLY_REVERSED = 0.03;

/* Whether two slips at neighbouring nodes resolve the layer of small slips in which regularized friction
 * reverses. The layer has the shape exp(-|v_t|/v_0), with a corner of the slope in its middle. */
static bool sees_layer(const struct friction_law *law, struct vec3 slip, struct vec3 next)
{
    const double unit = law->slip_velocity;
    const double speed = vec3_norm(slip);
    if (law->kind != FRICTION_REGULARIZED) {
        return true;
    }
    if (vec3_dot(slip, next) < NEARLY_REVERSED * speed * speed) {
        return fmax(speed, vec3_norm(next)) <= PROPORTIONAL * unit;
    }
    return speed > SATURATED * unit || vec3_norm(vec3_sub(next, slip)) <= FOLLOWED * unit;
}

/* Whether both the layer of small slips and those of slow rolling and spinning are resolved between an end of
 * a panel and the node next to it. */
static bool sees_layers(const struct span *s, const struct scene_instant *at, const struct panel *panel,
                        int node)
{
    const int j = s->c.contact;
    const struct friction_law law = scene_friction_law(s->c.v, s->c.q, j, OPPOSED_SLIP);
    if (!sees_layer(&law, at->turning.slip[j], panel->node[node].slip)) {
        return false;
    }
    if (!contact_resists(s->c.v, j)) {
        return true;
    }
    const struct friction_law rolling = scene_friction_law(s->c.v, s->c.q, j, OPPOSED_ROLLING);
    const struct friction_law spinning = scene_friction_law(s->c.v, s->c.q, j, OPPOSED_SPINNING);
    const struct vec3 normal[2] = {at->geometry[j].normal, panel->node[node].normal};
    const struct vec3 spin[2] = {turning_spin(at, j), panel->node[node].spin};
    const double along[2] = {vec3_dot(spin[0], normal[0]), vec3_dot(spin[1], normal[1])};
    return sees_layer(&rolling, vec3_axpy(spin[0], -along[0], normal[0]),
                      vec3_axpy(spin[1], -along[1], normal[1])) &&
           sees_layer(&spinning, vec3_scale(along[0], normal[0]), vec3_scale(along[1], normal[0]));
}

/* Whether n and the slip change so little between an end of a panel and the node next to it that the nodes
 * show every event. Where the bodies are concentric to rounding n has no meaning. */
static bool sees_end(const struct span *s, const struct scene_instant *at, const struct panel *panel,
                     int node)
{
    const int j = s->c.contact;
    const struct contact_geometry *g = &at->geometry[j];
    const bool has_direction = !g->degenerate && fabs(g->distance) > rounding_of_gap(s->c.v, at, j);
    const double cosine = vec3_dot(g->normal, panel->node[node].normal);
    return !(has_direction && !(cosine > LARGEST_TURN_COSINE)) &&
           (!SCENE_ANY_FRICTION || sees_layers(s, at, panel, node));
}

/* Whether sees_end holds at the ends of both halves of a panel; `at` holds the instants at the panel's
 * ends. */
static bool sees_ends(const struct span *s, const struct panel *left, const struct panel *right,
                      const struct scene_instant at[2])
{
    struct scene_instant middle;
    instant_at(&s->c, left->to, &left->springs, &middle);
    return sees_end(s, &at[0], left, 0) && sees_end(s, &middle, left, GAUSS_NODES - 1) &&
           sees_end(s, &middle, right, 0) && sees_end(s, &at[1], right, GAUSS_NODES - 1);
}

/* Whether a spring at the end of a panel and of its halves agrees, up to the rounding of the opposed motion,
 * of the normal force [N] at a depth [m] and of n [rad]. By a constant force L the spring changes by up to
 * L / k_t, and not faster than by L / c_t. */
static bool springs_agree(const struct span *s, int part, const struct panel *whole, const struct panel *left,
                          const struct panel *right, double force_noise, double depth, double tilt)
{
    const struct friction_law law = scene_friction_law(s->c.v, s->c.q, s->c.contact, part);
    const struct vec3 spring = right->springs.of[part];
    const double way = vec3_norm(spring) + left->moved[part] + right->moved[part];
    const double by_force =
        fmin(1.0 / friction_stiffness(&law, depth), (right->to - left->from) / law.damping);
    const double noise = law.coefficient * force_noise * by_force + vec3_norm(spring) * tilt;
    return vec3_norm(vec3_sub(spring, whole->springs.of[part])) <=
           4.0 * PANELS_AGREE * way + SPEED_ROUNDINGS * whole->passed[part] + noise;
}

/* Whether a panel and its halves agree. Near the centre n may be mere rounding at one end of the panel; the
 * rounding bound of the force at the other end then holds for nearly all of the time between. */
CONTACT_NOINLINE static bool panels_agree(const struct span *s, const struct panel *whole,
                                          const struct panel *left, const struct panel *right)
{
    struct scene_instant at[2];
    instant_at(&s->c, left->from, &left->springs, &at[0]);
    instant_at(&s->c, right->to, &right->springs, &at[1]);
    const double noise = fmin(rounding_of_force(s->c.v, s->c.q, &at[0], s->c.contact),
                              rounding_of_force(s->c.v, s->c.q, &at[1], s->c.contact));
    const double tilt = fmin(rounding_of_normal(s->c.v, &at[0], s->c.contact),
                             rounding_of_normal(s->c.v, &at[1], s->c.contact));
    const double depth = -fmax(at[0].geometry[s->c.contact].gap, at[1].geometry[s->c.contact].gap);
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
        if (contact_has_spring(s->c.v, s->c.contact, i) &&
            !springs_agree(s, i, whole, left, right, noise, depth, tilt)) {
            return false;
        }
    }
    return sees_ends(s, left, right, at);
}

/* Parts of a panel in the search for peaks. Each half of a panel has five nodes, so that no quantity has two
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

/* Number of places in both halves of a panel: the start, the nodes and the end. */
enum { PANEL_PLACES = 2 * GAUSS_NODES + 2 };

static void put_place(const struct span *s, double clock, const struct springs *springs, struct place *place)
{
    place->clock = clock;
    events_at(&s->c, clock, springs, place->at);
}

/* An event function of a contact without a spring, as the argument of root_lowest. */
struct dip {
    const struct span *span;
    int event;
};

static void dip_at(const void *data, double clock, double *value, double *slope)
{
    const struct dip *dip = data;
    double at[ODE_EVENTS_EACH];
    events_at(&dip->span->c, clock, &dip->span->springs, at);
    *value = at[dip->event];
    *slope = (double)NAN; /* not needed */
}

/* Whether an event function of a contact without a spring falls below zero between three places. *after
 * becomes the clock at which the function is lowest. */
static bool finds_dip(const struct span *s, const struct place place[3], double *after)
{
    for (int event = ODE_EVENT_LAW; event < ODE_EVENT_ZONE; ++event) {
        const struct dip dip = {s, event};
        struct root_place of[3];
        for (int i = 0; i < 3; ++i) {
            of[i] = (struct root_place){place[i].clock, place[i].at[event]};
        }
        if (event != (int)ode_stick_event(ode_event_part((enum ode_event)event)) && root_may_dip(of)) {
            double low;
            double slope;
            *after = root_lowest(dip_at, &dip, of);
            dip_at(&dip, *after, &low, &slope);
            if (low < 0.0) {
                return true;
            }
        }
    }
    return false;
}

/* Finds the first two neighbouring places of a panel between which a regime ends; false: there are none. */
static bool finds_event(const struct span *s, const struct panel *left, const struct panel *right,
                        struct place *start, double *before, double *after)
{
    struct place place[PANEL_PLACES];
    int count = 1;
    put_place(s, left->from, &s->springs, &place[0]);
    for (int i = 0; i < 2 * GAUSS_NODES; ++i) {
        const struct panel *half = i < GAUSS_NODES ? left : right;
        put_place(s, half->node[i % GAUSS_NODES].clock, &half->node[i % GAUSS_NODES].springs,
                  &place[count++]);
    }
    put_place(s, right->to, &right->springs, &place[count++]);
    *start = place[0];
    for (int i = 1; i < count; ++i) {
        *before = place[i - 1].clock;
        *after = place[i].clock;
        if (event_passed(place[i].at, start->at) != ODE_EVENT_GAP) {
            return true;
        }
        if (i + 1 < count && finds_dip(s, &place[i - 1], after)) {
            return true;
        }
    }
    return false;
}

/* Panels that are computed for each one that the quadrature counts: a panel and its two halves. */
enum { PANELS_COMPARED = 3 };

/* Bisects between `before` and `after` until the clock of an event is known to rounding. Makes the panel that
 * ends just past the event. False: there is no such panel or no event. */
static bool panel_to_event(const struct span *s, const struct place *start, double before, double after,
                           struct panel *panel, int *event)
{
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

/* Whether an event ends a regime in the halves of a panel. If so, integrates up to the event and changes the
 * regime. */
static bool passes_event(struct span *s, const struct panel *left, const struct panel *right, double *clock)
{
    struct panel panel;
    struct place start;
    double before;
    double after;
    int event;
    const struct contact_law law = scene_contact_law(s->c.v, s->c.q, s->c.contact);
    if (!(contact_has_events(&law) || contact_rubs(s->c.v, s->c.contact)) ||
        !finds_event(s, left, right, &start, &before, &after) ||
        !panel_to_event(s, &start, before, after, &panel, &event)) {
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
    take_regime(c, to, scene_regime(c->v, c->q, &at, c->contact));
    s->springs = springs_of(c->q, c->contact);
    add_instant(s, to, to - passage->centre);
    counter_add(&c->q->counters.events, 1);
}

/* Adds the integrals between two clocks, between which the bodies touch. Returns the clock reached, which
 * lies before `end` where no panels are left. */
CONTACT_NOINLINE static double integrate_between(struct span *s, double from, double end)
{
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
        if (divides && (!made || !panels_agree(s, &whole, &left, &right))) {
            width = 0.5 * (to - clock);
            continue;
        }
        width *= 2.0;
        if (s->evaluations != NULL && made && divides && passes_event(s, &left, &right, &clock)) {
            continue;
        }
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
enum { ELASTIC_PANEL = 2 };

static struct span span_of(const struct scene_values *v, struct scene_state *q, int contact, double length,
                           long *panels)
{
    return (struct span){.c = {v, q, contact},
                         .length = length,
                         .elastic = contact_has_springs(v, contact),
                         .panels = panels,
                         .panel_cost = contact_has_springs(v, contact) ? ELASTIC_PANEL : 1};
}

/* Adds the integrals of a span to the impulses and energies of the scene. Scenes in which no body may be free
 * keep means over the span instead. */
static void book_span(const struct span *s)
{
    struct scene_state *q = s->c.q;
    struct contact_state *state = &q->contact[s->c.contact];
    const struct vec3 force = vec3_from(s->sum + TERM_FORCE);
    struct contact_torques *torques = &state->torques;
    if (SCENE_ANY_FREE) {
        state->physics.impulse = vec3_add(state->physics.impulse, force);
        q->dissipated += s->sum[TERM_DISSIPATED];
        q->external_work += s->sum[TERM_WORK];
    } else {
        state->mean_force = vec3_scale(1.0 / s->length, force);
    }
    if (SCENE_ANY_TURNING) {
        const struct vec3 source = vec3_from(s->sum + TERM_SOURCE_TORQUE);
        const struct vec3 destination = vec3_from(s->sum + TERM_DESTINATION_TORQUE);
        if (SCENE_ANY_FREE) {
            torques->source_impulse = vec3_add(torques->source_impulse, source);
            torques->destination_impulse = vec3_add(torques->destination_impulse, destination);
            q->friction_energy += s->sum[TERM_FRICTION];
        } else {
            torques->source_mean = vec3_scale(1.0 / s->length, source);
            torques->destination_mean = vec3_scale(1.0 / s->length, destination);
        }
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
    (void)onset_note(c->v, c->q, &at, c->contact, scene_regime_of_touching(c->v, c->q, &at, c->contact));
    take_regime(c, clock, scene_regime_of_touching(c->v, c->q, &at, c->contact));
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

static void book_mean(struct contact_state *state, struct vec3 force, struct vec3 torque)
{
    state->mean_force = force;
    if (SCENE_HAS_TORQUES) {
        state->torques.destination_mean = torque;
    }
}

void prescribed_settle(const struct scene_values *v, struct scene_state *q)
{
    struct scene_instant at;
    scene_kinematics_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct prescribed_contact c = {v, q, j};
        const enum contact_regime next = onset_note(v, q, &at, j, scene_regime(v, q, &at, j));
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
    scene_kinematics_now(v, q, &at);
    scene_forces(v, q, q->clock, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct contact_state *state = &q->contact[j];
        state->peaks = (struct contact_peaks){0.0, 0.0};
        book_mean(state, vec3_make(0.0, 0.0, 0.0), vec3_make(0.0, 0.0, 0.0));
        if (state->regime != REGIME_APART) {
            contact_peaks_note(&state->peaks, at.normal_force[j], -at.geometry[j].gap);
        }
    }
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
        book_mean(state, at.source_force[j],
                  SCENE_HAS_TORQUES ? scene_torque_of_force(&at, j) : vec3_make(0.0, 0.0, 0.0));
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
