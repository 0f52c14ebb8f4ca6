#include "segment/driven_panel.h"

#include "scene/free_bodies.h"
#include "scene/present.h"

#if SCENE_ANY_TURNING

void driven_instant(const struct driven_contact *c, double clock, struct vec3 spring,
                    struct scene_instant *at)
{
    scene_kinematics(c->v, c->q, clock, free_bodies_now(c->q), at);
#if SCENE_ANY_FRICTION
    c->q->turning.spring[c->contact] = spring;
#else
    (void)spring;
#endif
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

#if SCENE_ANY_ELASTIC_FRICTION

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

#endif

bool driven_panel_make(const struct driven_contact *c, double from, double to, struct vec3 spring,
                       bool graded, struct driven_panel *panel)
{
    *panel = (struct driven_panel){.from = from, .to = to, .spring = spring};
    const double half = 0.5 * (to - from);
    for (int i = 0; i < GAUSS_NODES; ++i) {
        panel->node[i].clock = from + half * gauss_place(i, graded).at;
        panel->node[i].spring = spring;
    }
#if SCENE_ANY_ELASTIC_FRICTION
    if (contact_rubs_elastically(c->v, c->contact) && !put_springs(c, graded, spring, panel)) {
        return false;
    }
#endif
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

#endif
