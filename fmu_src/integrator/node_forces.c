/* This file solves the collocation with the contact forces at the stages as unknowns. Vectors are in the
 * world frame. */
#include <math.h>
#include <string.h>

#include "integrator/node_forces.h"
#include "math/lu.h"
#include "math/nodes.h"
#include "scene/evaluate.h"

/* The unknowns of a contact are the loads on its source: the force, and where it resists rolling or spinning
 * also the torque M of that resistance. A contact that rubs has ROWS unknowns for each. Without friction
 * there is one unknown, because the force has one direction; there are three if that direction turns much in
 * the step (SWINGING). */
enum { LOADS = OPPOSED > 1 ? 2 : 1, ROWS = 3, ROWS_WITHOUT_FRICTION = 1, MOST_ROWS = LOADS * ROWS };

/* Without friction there is room for so many unknowns at twelve stages, and for all three at eight. */
enum { ROWS_WHERE_IT_SWINGS = 2 };

/* How the responses of a contact change with a torque on one of its bodies, divided by 1/I_1 of the body. The
 * torque changes the motion, the place X, and the drives of springs. */
struct turned_rows {
    struct vec3 by_motion[MOST_ROWS], by_place[ROWS], by_drive[OPPOSED][ROWS];
};

/* This struct describes one contact at one stage. The motion of the source against the destination is the
 * velocity U at the point of contact and the angular velocity omega [m/s, rad/s]; X is the integral of U [m].
 * Each load has ROWS rows of the response: those of the force change by `by_force` dF + `by_motion` dU +
 * `by_place` dX, those of the torque by `by_force` dF + `by_torque` dM + `by_motion` domega. Where the
 * contact has one unknown, there is one row, and dF has the direction `push`. Rows with a spring change by
 * `by_spring` dxi as well; `by_drive` is their change by the drive of the spring (friction_spring_drive_of).
 *
 * A displacement dD of the source's centre against the destination's turns n, by which the rows of the force
 * change by `by_swing` dD. */
struct node {
    struct vec3 load[LOADS];    /* on the source: the unknowns [N, N m] */
    struct vec3 more[LOADS];    /* their last corrections */
    struct vec3 push;           /* unit vector of a normal force on the source that pushes it away [1] */
    struct vec3 arm[2];         /* from the centres of source and destination to the point of contact [m] */
    double response[MOST_ROWS]; /* how far the loads are from their laws [m/s, rad/s] */
    bool rolls[OPPOSED];        /* form of the response of friction (friction_missed) */
    double steepness[OPPOSED];  /* of that response where the slopes were taken */
    struct vec3 by_force[MOST_ROWS], by_motion[MOST_ROWS], by_torque[ROWS], by_place[ROWS], by_swing[ROWS];
    struct vec3 offset[2]; /* from the centres of the bodies to those of their parts in touch [m] */
    struct vec3 by_spring[OPPOSED][ROWS], by_drive[OPPOSED][ROWS];
    struct friction_spring_drive drive[OPPOSED];
    struct turned_rows turned[2]; /* of source and destination */
};

/* This struct describes one spring of a contact at all stages. Linearized, the spring changes by dxi_i = sum
 * `filter`_ij (rho_j + S dz_j). Here rho is the rate by the law less the rate of the polynomial, and S dz is
 * the change of the rate by the spring's drive. `weight` is the filter where F_t drives the spring. Where the
 * slip does, `weight` is the filter times the matrix of integration, because the forces give the rates of the
 * slip. */
struct node_spring {
    bool is_there, is_force;
    double filter[RADAU_MOST_STAGES * RADAU_MOST_STAGES], weight[RADAU_MOST_STAGES * RADAU_MOST_STAGES];
};

/* The symmetric matrix, by rows, that gives the angular velocity of a body from its L/I_1. */
struct rotation_by_spin {
    struct vec3 row[3];
};

static inline struct vec3 rotated_by(const struct rotation_by_spin *m, struct vec3 spin)
{
    return vec3_make(vec3_dot(m->row[0], spin), vec3_dot(m->row[1], spin), vec3_dot(m->row[2], spin));
}

/* This struct describes a body: the indices of its velocity and spin among the states that are no positions,
 * where -1 stands for none; 1/m [1/kg] and 1/I_1 [1/(kg m^2)], which are zero for a body that is not free. */
struct node_body {
    int speed, spin;
    double by_mass, by_inertia;
    struct rotation_by_spin rotation[RADAU_MOST_STAGES];
};

/* This struct describes a contact that transmits forces. */
struct node_contact {
    int contact;
    int body[2];  /* source and destination */
    int rows;     /* number of its unknowns at a stage */
    int loads;    /* number of its loads */
    bool rubs;    /* whether it has friction */
    bool springs; /* whether it has a spring */
    int island;   /* its number: contacts of an island stand together */
    int first;    /* sum of the rows of the contacts before it */
    double side;  /* +1: the source is outside the destination, -1: inside */
    struct turning_laws laws;
    /* of each load: the scale of its response [m/(N s), rad/(N m s)], and whether it moves a body */
    double admittance[2];
    bool is_felt[2];
};

/* The source gets the force of a contact, the destination the opposite one. */
static const double SIGN_OF_END[2] = {1.0, -1.0};

/* What respond_along_normal has set at all stages: the directions of a normal force, and the slopes of the
 * response by the velocity and by the place of the source along them. */
struct normals {
    double push[3][RADAU_MOST_STAGES], by_rate[RADAU_MOST_STAGES], by_gap[RADAU_MOST_STAGES];
};

struct iteration {
    struct general *g;
    int contacts, rows; /* that transmit forces; unknowns at a stage */
    struct node_contact contact[SCENE_CONTACTS];
    struct node node[RADAU_MOST_STAGES][SCENE_CONTACTS];
    struct normals normals[SCENE_CONTACTS];
    struct node_spring spring[1 + SCENE_ANY_SPRINGS * (SCENE_CONTACTS - 1)][OPPOSED];
    struct node_body body[SCENE_BODIES];
    bool has_springs;    /* whether a contact has springs */
    bool follows_places; /* whether the responses follow the changes of places to come */
    bool stale;          /* whether the slopes of a contact that rolls have changed by more than STALE */
    int factorizations;
};

/* The slopes of friction are taken anew where they have changed by this factor: by slopes that are much too
 * steep the corrections of the forces are small although the forces are far from the law. */
static const double STALE = 3.0;

/* This is the distance of columns in the matrix of a spring; each ends with a zero (math/lu.h). */
enum { SPRING_STRIDE = RADAU_MOST_STAGES + 4 };

/* Returns the index of the first unknown of a contact at a stage. The stages of one contact stand together,
 * so that bodies in a row make a band of the matrix. */
static inline int unknown_of(const struct iteration *it, int contact, int stage)
{
    const struct node_contact *c = &it->contact[contact];
    return it->g->step.stages->stages * c->first + stage * c->rows;
}

/* Returns the index of the load that opposes a motion: the force opposes the slip. */
static inline int load_of(int part)
{
    return part == OPPOSED_SLIP ? 0 : LOADS - 1;
}

/* Returns the index of a spring of a contact among the states that are no positions. */
static inline int index_of_spring(const struct iteration *it, int contact, int part)
{
    return it->g->step.among[it->g->ode.layout.spring[it->contact[contact].contact][part]];
}

static struct rotation_by_spin rotation_of(const struct scene_values *v, int body,
                                           struct quaternion orientation)
{
    struct rotation_by_spin to;
    for (int k = 0; k < 3; ++k) {
        const struct vec3 spin = {k == 0, k == 1, k == 2};
        to.row[k] = body_rotation_of(v, body, orientation, spin);
    }
    return to;
}

static inline bool moves(const struct iteration *it, int body)
{
    return it->body[body].by_mass > 0.0 || it->body[body].by_inertia > 0.0;
}

static void prepare_bodies(struct iteration *it)
{
    const struct scene_values *v = it->g->ode.values;
    const struct ode_layout *layout = &it->g->ode.layout;
    const int *among = it->g->step.among;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        struct node_body *to = &it->body[i];
        to->speed = layout->body[i] >= 0 ? among[layout->body[i] + 3] : -1;
        to->spin = layout->spin[i] >= 0 ? among[layout->spin[i]] : -1;
        to->by_mass = body_inverse_mass(v, i);
        to->by_inertia = body_turns_freely(v, i) ? 1.0 / body_inertia_of(v, i).x : 0.0;
        for (int stage = 0; to->by_inertia > 0.0 && stage < RADAU_MOST_STAGES; ++stage) {
            to->rotation[stage] =
                stage > 0 ? to->rotation[0] : rotation_of(v, i, it->g->state->turning.body[i].orientation);
        }
    }
}

/* Without friction a contact has one unknown, and the force has the direction n of the last iteration, where
 * h^2 F_n / (m_red d) is less than this number in a step of the length h: the iterations then converge. In
 * longer steps the bodies swing about each other by more than the iterations follow, and the whole force is
 * unknown.
 * A bearing that comes to rest, with balls nearly as wide as its grooves, takes 2.2e9 instructions for 50 ms;
 * with 4 and with 25 in place of 10 it takes 12 and 6 % more. */
static const double SWINGING = 10.0;

/* Whether the bodies of a contact swing about each other in a step of this length [s] by more than the
 * iterations with one unknown follow. */
static bool contact_swings(const struct general *g, int contact, double length)
{
    const struct scene_instant *at = &g->at_start;
    const struct contact_shape shape = scene_contact_shape_at(at, contact);
    const double pull = fabs(at->normal_force[contact]) * scene_inverse_mass(at->v, contact); /* [m/s^2] */
    return contact_turns(&shape, &at->geometry[contact]) &&
           length * length * pull > SWINGING * at->geometry[contact].distance;
}

/* Returns the number of unknowns at a stage of a contact that has so many without friction. */
static int rows_of_law(const struct scene_values *v, int contact, int without_friction)
{
    return SCENE_ANY_ROLLING && contact_resists(v, contact) ? MOST_ROWS
           : contact_rubs(v, contact)                       ? ROWS
                                                            : without_friction;
}

/* Returns the number of unknowns of a contact at a stage; zero where it transmits no force. */
static int rows_of(const struct general *g, int contact, double length)
{
    const bool swings =
        SCENE_ANY_CURVED && !contact_rubs(g->ode.values, contact) && contact_swings(g, contact, length);
    const int rows = rows_of_law(g->ode.values, contact, swings ? ROWS : ROWS_WITHOUT_FRICTION);
    return contact_transmits(g->state, contact) ? rows : 0;
}

/* Notes a contact that transmits forces, in a step of the length [s]. */
static void note_node_contact(struct iteration *it, int contact, double length)
{
    const struct scene_values *v = it->g->ode.values;
    const int bodies[2] = {contact_source(contact), contact_destination(contact)};
    const double by_inertia = it->body[bodies[0]].by_inertia + it->body[bodies[1]].by_inertia;
    const double square = contact_source_radius(v, contact) * contact_source_radius(v, contact);
    double by_mass = scene_inverse_mass(v, contact);
    struct node_contact *to = &it->contact[it->contacts];
    memcpy(to->body, bodies, sizeof bodies);
    to->contact = contact;
    to->rows = rows_of(it->g, contact, length);
    to->loads = SCENE_ANY_ROLLING && to->rows == MOST_ROWS ? LOADS : 1;
    to->rubs = contact_rubs(v, contact);
    to->springs = contact_has_springs(v, contact);
    it->has_springs = it->has_springs || to->springs;
    to->island = it->g->ode.layout.island[contact];
    to->first = it->rows;
    to->laws = turning_laws_of(it->g->state, contact);
    to->side = scene_contact_side(it->g->state, contact);
    to->is_felt[0] = by_mass > 0.0 || by_inertia > 0.0;
    to->is_felt[1] = by_inertia > 0.0;
    by_mass = to->is_felt[0] ? by_mass : 1.0; /* where neither body is free, any scale serves */
    to->admittance[0] = length * (by_mass > 0.0 ? by_mass : by_inertia * square);
    to->admittance[1] = length * (by_inertia > 0.0 ? by_inertia : by_mass / square);
    it->contacts += 1;
    it->rows += to->rows;
}

/* In a step of so many radians of the spring, rounding of the force moves the body by 1e4 times the rounding
 * of the penetration. The next step would follow this as an oscillation. */
static const double MANY_RADIANS = 100.0;

/* Whether the responses follow the changes of places to come. Contacts that share bodies then converge in two
 * or three iterations in place of three or four, because guessed forces that are out of balance move a body
 * far. A gap of a part of a compound is the difference of long lever arms, and at rest large forces cancel in
 * their sum: the forces of a tripod at rest have an error of 7e-11 N in place of 3e-9 N. For one contact this
 * costs more than it saves in short steps. */
static bool is_to_follow_places(const struct iteration *it)
{
    return SCENE_ANY_COMPOUND || it->contacts > 1 ||
           (it->contacts == 1 &&
            it->g->step.length * it->g->island[it->contact[0].island].frequency > MANY_RADIANS);
}

/* Lists the contacts that transmit forces, island by island. Those of which only one body moves come first,
 * because they have the fewest neighbours, and their elimination fills the least of the matrix. */
static void note_contacts(struct iteration *it)
{
    it->contacts = it->rows = 0;
    it->has_springs = false;
    for (int k = 0; k < 2 * it->g->ode.layout.groups; ++k) {
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            const bool both = moves(it, contact_source(j)) && moves(it, contact_destination(j));
            if (it->g->ode.layout.island[j] == k / 2 && both == (k % 2 == 1) &&
                contact_transmits(it->g->state, j)) {
                note_node_contact(it, j, it->g->step.length);
            }
        }
    }
    it->follows_places = is_to_follow_places(it);
}

/* Sets what is the same in all iterations: the motion of bodies that are not free, and the rates without
 * contact forces. */
static void prepare(struct iteration *it)
{
    struct general *g = it->g;
    struct radau_step *p = &g->step;
    prepare_bodies(it);
    note_contacts(it);
    memset(p->point, 0, (size_t)g->ode.layout.size * sizeof *p->point);
    memset(p->bare, 0, (size_t)(p->stages->stages * p->width) * sizeof *p->bare);
    for (int i = 0; i < p->stages->stages; ++i) {
        const double clock = p->start + p->length * p->stages->node[i];
        ode_other_motion(&g->ode, clock, &g->at_stage[i]);
        ode_rates_without_contact(&g->ode, clock, p->point);
        for (int j = 0; j < p->others; ++j) {
            p->bare[i * p->width + j] = p->point[p->other[j]];
        }
    }
}

/* Writes the rows of along e e^T plus those of a matrix that acts across e. */
static void put_rows(struct vec3 to[3], const struct vec3 across[3], double along, struct vec3 e)
{
    for (int i = 0; i < 3; ++i) {
        to[i] = vec3_axpy(across[i], along * vec3_get(e, i) - vec3_dot(across[i], e), e);
    }
}

/* Sets the response of a contact that does not rub, and if `anew` its slopes. The response is the admittance
 * a times the normal force of the law less F_n, where F_n = -F.e and e = side n. */
static void respond_along_normal(struct iteration *it, int stage, int index, const struct contact_geometry *g,
                                 bool anew)
{
    const struct node_contact *c = &it->contact[index];
    struct node *node = &it->node[stage][index];
    const double a = c->admittance[0];
    const struct vec3 e = vec3_scale(c->side, g->normal);
    const double normal_force = -vec3_dot(node->load[0], e);
    const double by_law = contact_force(&c->laws.normal, c->laws.regime, g->gap, g->gap_rate);
    node->push = vec3_scale(-1.0, e);
    node->load[0] = vec3_scale(normal_force, node->push);
    node->response[0] = a * (by_law - normal_force);
    if (anew) {
        struct normals *to = &it->normals[index];
        const struct contact_slopes slopes =
            contact_force_slopes(&c->laws.normal, c->laws.regime, g->gap, g->gap_rate);
        to->push[0][stage] = node->push.x;
        to->push[1][stage] = node->push.y;
        to->push[2][stage] = node->push.z;
        to->by_rate[stage] = a * slopes.by_rate; /* g' = -e.U */
        to->by_gap[stage] = a * slopes.by_gap;
        node->by_force[0] = vec3_scale(a, e);
        node->by_motion[0] = vec3_scale(-a * slopes.by_rate, e);
        node->by_place[0] = vec3_scale(-a * slopes.by_gap, e);
    }
}

/* Sets the rate of a spring and, if `slopes` is not NULL, how the response of its load changes with the
 * spring and with its drive. */
static void respond_with_spring(struct iteration *it, int stage, int index, int part,
                                const struct scene_instant *at, struct friction_state rubbing,
                                struct vec3 opposing, const struct friction_slopes *slopes)
{
    const struct node_contact *c = &it->contact[index];
    const struct friction_law *law = &c->laws.rubbing[part];
    const enum friction_regime regime = c->laws.rubbing_regime[part];
    const struct vec3 n = at->geometry[c->contact].normal;
    struct node *node = &it->node[stage][index];
    if (slopes) {
        node->drive[part] = friction_spring_drive_of(law, regime, rubbing);
        for (int r = 0; r < ROWS; ++r) {
            const struct vec3 by = opposed_laid((enum opposed)part, slopes->by_spring[r], n);
            node->by_spring[part][r] = by;
            node->by_drive[part][r] = friction_driven(&node->drive[part], by);
        }
    }
    const struct vec3 turned =
        opposed_turned((enum opposed)part, rubbing.spring, n, turning_normal_rate(at, c->contact));
    vec3_to(vec3_add(friction_spring_rate(law, regime, rubbing, opposing), turned),
            it->g->step.rates + stage * it->g->step.width + index_of_spring(it, index, part));
}

/* Returns how far an opposed motion of a contact is from its law, and if `slopes` is not NULL the derivatives
 * of that. `opposing` is the part of the load that opposes the motion. */
static struct vec3 respond_opposed(struct iteration *it, int stage, int index, int part,
                                   const struct scene_instant *at, double normal_force, struct vec3 *opposing,
                                   struct friction_slopes *slopes)
{
    const struct node_contact *c = &it->contact[index];
    const struct friction_law *law = &c->laws.rubbing[part];
    const enum friction_regime regime = c->laws.rubbing_regime[part];
    const int spring = it->g->ode.layout.spring[c->contact][part];
    const double a = c->admittance[load_of(part)];
    struct node *node = &it->node[stage][index];
    struct friction_state rubbing = turning_rubbing(at, c->contact, part);
    rubbing.normal_force = normal_force;
    if (SCENE_ANY_SPRINGS && spring >= 0) {
        rubbing.spring = opposed_laid((enum opposed)part, rubbing.spring, at->geometry[c->contact].normal);
    }
    if (slopes) {
        node->rolls[part] =
            c->is_felt[load_of(part)] && friction_rolls(law, regime, normal_force, *opposing, a);
    }
    const struct friction_missed missed =
        friction_missed(law, regime, rubbing, opposing, node->rolls[part], a, slopes);
    if (slopes) {
        node->steepness[part] = missed.steepness;
    }
    const double ratio = missed.steepness / node->steepness[part];
    it->stale = it->stale || (node->rolls[part] && !(ratio < STALE && ratio * STALE > 1.0));
    if (SCENE_ANY_SPRINGS && spring >= 0) {
        respond_with_spring(it, stage, index, part, at, rubbing, *opposing, slopes);
    }
    return missed.velocity;
}

/* Sets the response of the resistances to rolling and to spinning and, if `anew`, its slopes. */
static void respond_with_resistance(struct iteration *it, int stage, int index,
                                    const struct scene_instant *at, double normal_force, struct vec3 e,
                                    bool anew)
{
    struct node *node = &it->node[stage][index];
    struct vec3 torque = {0.0, 0.0, 0.0};
    struct vec3 missed = {0.0, 0.0, 0.0};
    memset(node->by_torque, 0, anew ? sizeof node->by_torque : 0);
    memset(node->by_force + ROWS, 0, anew ? sizeof node->by_torque : 0);
    memset(node->by_motion + ROWS, 0, anew ? sizeof node->by_torque : 0);
    for (int part = OPPOSED_ROLLING; part < OPPOSED; ++part) {
        struct friction_slopes by;
        struct vec3 opposing = opposed_laid((enum opposed)part, node->load[LOADS - 1], e);
        missed = vec3_add(
            missed, respond_opposed(it, stage, index, part, at, normal_force, &opposing, anew ? &by : NULL));
        torque = vec3_add(torque, opposing);
        for (int i = 0; anew && i < ROWS; ++i) {
            const struct vec3 by_torque = opposed_laid((enum opposed)part, by.by_force[i], e);
            const struct vec3 by_spin = opposed_laid((enum opposed)part, by.by_slip[i], e);
            struct vec3 *by_force = &node->by_force[ROWS + i];
            node->by_torque[i] = vec3_add(node->by_torque[i], by_torque);
            node->by_motion[ROWS + i] = vec3_add(node->by_motion[ROWS + i], by_spin);
            *by_force = vec3_axpy(*by_force, -vec3_get(by.by_normal_force, i), e);
        }
    }
    node->load[LOADS - 1] = torque;
    vec3_to(missed, node->response + ROWS);
}

/* Sets how the rows of the force change as the centres of the bodies move and n turns. `by_normal` are the
 * derivatives of these rows by e. A change dD turns e by -side/d times its part that turns n, and with e the
 * lever arms r_s e and r_s e - c (contact/shape.h). The iterations follow the turning of a destination that
 * tips, and the torques of the turned arms. */
static void put_swing(struct iteration *it, int stage, int index, const struct scene_instant *at,
                      const struct vec3 by_normal[ROWS])
{
    const struct node_contact *c = &it->contact[index];
    const struct contact_geometry *g = &at->geometry[c->contact];
    const struct contact_shape shape = scene_contact_shape_at(at, c->contact);
    const double turns = contact_turns(&shape, g) ? -c->side / g->distance : 0.0;
    struct node *node = &it->node[stage][index];
    for (int r = 0; r < ROWS; ++r) {
        struct vec3 by_arms = {0.0, 0.0, 0.0};
        struct vec3 by_turn = by_normal[r];
        if (SCENE_ANY_TURNING && scene_turns(it->g->ode.values)) {
            const struct vec3 rotation = at->turning.body[c->body[1]].angular_velocity;
            const struct vec3 spin = vec3_sub(at->turning.body[c->body[0]].angular_velocity, rotation);
            by_turn = vec3_axpy(by_turn, shape.source_radius, vec3_cross(node->by_motion[r], spin));
            by_arms = vec3_cross(rotation, node->by_motion[r]);
        }
        node->by_swing[r] = vec3_axpy(by_arms, turns, contact_turning_part(&shape, g, by_turn));
    }
    const struct vec3 arm = vec3_scale(shape.source_radius * c->side, g->normal);
    node->offset[0] = vec3_sub(node->arm[0], arm);
    node->offset[1] = vec3_sub(node->arm[1], vec3_sub(arm, at->separation[c->contact]));
}

/* Sets the response of a contact whose whole force is unknown and, if `anew`, its slopes. Along e it is that
 * of respond_along_normal; across e it is the response of friction, or without friction the admittance times
 * the force. */
CONTACT_NOT_FUSED CONTACT_FLATTEN static void respond_as_a_whole(struct iteration *it, int stage, int index,
                                                                 const struct scene_instant *at, bool anew)
{
    const struct node_contact *c = &it->contact[index];
    const struct turning_laws *laws = &c->laws;
    const struct contact_geometry *g = &at->geometry[c->contact];
    struct node *node = &it->node[stage][index];
    struct vec3 by_normal[ROWS];
    const double by_law = contact_force(&laws->normal, laws->regime, g->gap, g->gap_rate);
    const double a = c->admittance[0];
    struct friction_slopes friction;
    const struct vec3 e = vec3_scale(c->side, g->normal);
    const double normal_force = -vec3_dot(node->load[0], e);
    struct vec3 tangential = vec3_axpy(node->load[0], normal_force, e);
    if (SCENE_ANY_SPRINGS && anew && c->springs) { /* of the parts that have no spring */
        memset(node->by_spring, 0, sizeof node->by_spring);
        memset(node->by_drive, 0, sizeof node->by_drive);
    }
    struct vec3 missed = vec3_scale(a, tangential);
    if (SCENE_ANY_FRICTION && c->rubs) {
        missed = respond_opposed(it, stage, index, OPPOSED_SLIP, at, normal_force, &tangential,
                                 anew ? &friction : NULL);
    } else if (anew) {
        friction = (struct friction_slopes){.by_force = {{.x = a}, {.y = a}, {.z = a}}};
    }
    node->load[0] = vec3_axpy(tangential, -normal_force, e);
    vec3_to(vec3_axpy(missed, a * (by_law - normal_force), e), node->response);
    if (SCENE_ANY_ROLLING && c->loads > 1) {
        respond_with_resistance(it, stage, index, at, normal_force, e, anew);
    }
    if (!anew) {
        return;
    }
    const struct contact_slopes slopes =
        contact_force_slopes(&laws->normal, laws->regime, g->gap, g->gap_rate);
    const struct vec3 slip = SCENE_ANY_TURNING && scene_turns(it->g->ode.values)
                                 ? at->turning.slip[c->contact]
                                 : vec3_scale(-1.0, at->rate[c->contact]);
    put_rows(node->by_force, friction.by_force, a, e);
    put_rows(node->by_motion, friction.by_slip, -a * slopes.by_rate, e); /* g' = -e.U */
    for (int i = 0; i < ROWS; ++i) {
        const double along = a * vec3_get(e, i);
        node->by_force[i] = vec3_axpy(node->by_force[i], -vec3_get(friction.by_normal_force, i), e);
        node->by_place[i] = vec3_scale(-along * slopes.by_gap, e);
        by_normal[i] =
            vec3_axpy(vec3_scale(normal_force, node->by_force[i]), g->gap_rate, node->by_motion[i]);
        by_normal[i] = vec3_axpy(by_normal[i], along - vec3_get(friction.by_normal_force, i), tangential);
        by_normal[i] = vec3_axpy(by_normal[i], -along * slopes.by_rate, slip);
    }
    put_swing(it, stage, index, at, by_normal);
    const int spring = it->g->ode.layout.spring[c->contact][OPPOSED_SLIP];
    if (SCENE_ANY_MINDLIN && spring >= 0) { /* a change of k_t acts as one of xi (contact/friction.h) */
        const double stiffening = friction_stiffening(&laws->rubbing[OPPOSED_SLIP], -g->gap);
        const struct vec3 xi = vec3_scale(stiffening, vec3_from(it->g->step.point + spring));
        for (int i = 0; i < ROWS; ++i) {
            node->by_place[i] =
                vec3_axpy(node->by_place[i], vec3_dot(node->by_spring[OPPOSED_SLIP][i], xi), e);
        }
    }
}

/* Sets the motion of the contacts in touch, or of `all`, at a stage. */
CONTACT_NOINLINE CONTACT_NOT_FUSED CONTACT_FLATTEN static struct scene_instant *
move_to_stage(struct iteration *it, int stage, bool all)
{
    struct general *g = it->g;
    radau_step_stage(&g->step, stage, g->step.point);
    ode_contact_motion(&g->ode, g->step.point, all, &g->at_stage[stage]);
    return &g->at_stage[stage];
}

/* Adds the rates of the orientations on which contacts depend. */
static void put_orientation_rates(struct iteration *it, int stage, const struct scene_instant *at)
{
    const struct ode_layout *layout = &it->g->ode.layout;
    for (int i = 0; SCENE_ANY_TIPPING && i < SCENE_BODIES; ++i) {
        const int k = layout->orientation[i];
        if (k >= 0 && k < layout->coupled) {
            const struct quaternion given = quaternion_from(it->g->step.point + k);
            quaternion_to(quaternion_rate(given, at->turning.body[i].angular_velocity),
                          it->g->step.rates + stage * it->g->step.width + it->g->step.among[k]);
            it->body[i].rotation[stage] = rotation_of(it->g->ode.values, i, at->turning.body[i].orientation);
        }
    }
}

/* Sets the filter and the weight of a spring by its decays at the stages (struct node_spring). */
static void prepare_spring(struct iteration *it, int contact, int part)
{
    const struct radau_step *p = &it->g->step;
    const int s = p->stages->stages;
    const double *integral = p->stages->integral;
    struct node_spring *to = &it->spring[contact][part];
    to->is_there = it->g->ode.layout.spring[it->contact[contact].contact][part] >= 0;
    to->is_force = it->node[0][contact].drive[part].is_force;
    if (!to->is_there) {
        return;
    }
    double entries[RADAU_MOST_STAGES * SPRING_STRIDE] = {0.0};
    double side[SPRING_STRIDE] = {0.0};
    int pivot[RADAU_MOST_STAGES];
    for (int k = 0; k < s * s; ++k) { /* I + h A decay */
        const int i = k % s;
        const int j = k / s;
        entries[j * SPRING_STRIDE + i] =
            (i == j ? 1.0 : 0.0) + p->length * integral[i * s + j] * it->node[j][contact].drive[part].decay;
    }
    const struct lu_matrix matrix = {s, SPRING_STRIDE, entries, pivot};
    (void)lu_factor(matrix); /* should it fail, the iterations do not converge */
    for (int j = 0; j < s; ++j) {
        for (int i = 0; i < s; ++i) {
            side[i] = p->length * integral[i * s + j];
        }
        lu_solve(matrix, side);
        for (int i = 0; i < s; ++i) {
            to->filter[i * s + j] = side[i];
        }
    }
    for (int k = 0; k < s * s; ++k) {
        double sum = 0.0;
        for (int l = 0; l < s; ++l) {
            sum += to->filter[k / s * s + l] * integral[l * s + k % s];
        }
        to->weight[k] = to->is_force ? to->filter[k] : p->length * sum;
    }
}

/* Sets how the responses of a contact change with torques on its bodies. A torque M turns a body by J^-1 M,
 * which moves the contact by J^-1 M x arm. */
static void put_turned_rows(struct iteration *it, int stage, int contact)
{
    const struct node_contact *c = &it->contact[contact];
    struct node *node = &it->node[stage][contact];
    for (int end = 0; end < 2; ++end) {
        const struct node_body *body = &it->body[c->body[end]];
        const struct rotation_by_spin *rotation = &body->rotation[stage];
        const struct vec3 arm = node->arm[end];
        struct turned_rows *to = &node->turned[end];
        for (int r = 0; body->spin >= 0 && r < c->rows; ++r) {
            const struct vec3 by = node->by_motion[r];
            to->by_motion[r] = rotated_by(rotation, r < ROWS ? vec3_cross(arm, by) : by);
        }
        for (int r = 0; body->spin >= 0 && r < ROWS && r < c->rows; ++r) {
            struct vec3 by = vec3_cross(arm, node->by_place[r]);
            if (SCENE_ANY_COMPOUND && c->rows >= ROWS) {
                by = vec3_add(by, vec3_cross(node->offset[end], node->by_swing[r]));
            }
            to->by_place[r] = rotated_by(rotation, by);
            for (int part = 0; SCENE_ANY_SPRINGS && c->springs && part < OPPOSED; ++part) {
                const struct vec3 drive = node->by_drive[part][r];
                to->by_drive[part][r] =
                    rotated_by(rotation, part == OPPOSED_SLIP ? vec3_cross(arm, drive) : drive);
            }
        }
    }
}

/* Evaluates the motion of all contacts at the stages, their responses, and the rates without contact. */
CONTACT_NOT_FUSED CONTACT_FLATTEN static void evaluate_nodes(struct iteration *it, bool anew)
{
    struct radau_step *p = &it->g->step;
    const int s = p->stages->stages;
    const bool turns = SCENE_ANY_TURNING && scene_turns(it->g->ode.values);
    memcpy(p->rates, p->bare, (size_t)(s * p->width) * sizeof *p->rates);
    it->stale = false;
    for (int i = 0; i < s; ++i) {
        const struct scene_instant *at = move_to_stage(it, i, false);
        put_orientation_rates(it, i, at);
        for (int j = 0; j < it->contacts; ++j) {
            const struct node_contact *c = &it->contact[j];
            struct node *node = &it->node[i][j];
            memset(node->more, 0, it->has_springs ? sizeof node->more : 0);
            if (turns) {
                node->arm[0] = at->turning.source_arm[c->contact];
                node->arm[1] = at->turning.destination_arm[c->contact];
            }
            if (SCENE_ANY_ROLLING && c->loads > 1 && p->iterations == 1) {
                struct vec3 *torque = &node->load[LOADS - 1];
                *torque = vec3_sub(*torque, vec3_cross(node->arm[0], node->load[0]));
            }
            if ((SCENE_ANY_FRICTION || SCENE_ANY_CURVED) && c->rows >= ROWS) {
                respond_as_a_whole(it, i, j, at, anew);
            } else {
                respond_along_normal(it, i, j, &at->geometry[c->contact], anew);
            }
            if (anew && turns) {
                put_turned_rows(it, i, j);
            }
        }
    }
    for (int k = 0; SCENE_ANY_SPRINGS && anew && k < it->contacts * OPPOSED; ++k) {
        prepare_spring(it, k / OPPOSED, k % OPPOSED);
    }
    p->evaluations += s;
}

/* Adds loads of a contact to the rates at a stage. */
static void add_loads(struct iteration *it, int stage, int contact, const struct vec3 load[LOADS])
{
    const struct node_contact *ends = &it->contact[contact];
    double *rates = it->g->step.rates + stage * it->g->step.width;
    for (int end = 0; end < 2; ++end) {
        const struct node_body *body = &it->body[ends->body[end]];
        if (body->speed >= 0) {
            vec3_add_to(SIGN_OF_END[end] * body->by_mass, load[0], rates + body->speed);
        }
        if (body->spin >= 0) {
            struct vec3 torque = vec3_cross(it->node[stage][contact].arm[end], load[0]);
            if (SCENE_ANY_ROLLING && ends->loads > 1) {
                torque = vec3_add(torque, load[LOADS - 1]);
            }
            vec3_add_to(SIGN_OF_END[end] * body->by_inertia, torque, rates + body->spin);
        }
    }
}

/* The change of the motion of the source against the destination (struct node): the velocity of its centre;
 * and for each load the motion that it opposes, U and omega. */
struct motion_change {
    struct vec3 centre, opposed[2];
};

/* Returns that change at a stage. `change` holds the changes of all states but the places. */
static inline struct motion_change motion_of(const struct iteration *it, int stage, int contact,
                                             const double *change)
{
    struct motion_change sum = {.centre = {0.0, 0.0, 0.0}};
    for (int end = 0; end < 2; ++end) {
        const struct node_body *body = &it->body[it->contact[contact].body[end]];
        if (body->speed >= 0) {
            sum.centre = vec3_axpy(sum.centre, SIGN_OF_END[end], vec3_from(change + body->speed));
        }
        if (body->spin >= 0) {
            const struct vec3 turned = rotated_by(&body->rotation[stage], vec3_from(change + body->spin));
            const struct vec3 arm = it->node[stage][contact].arm[end];
            sum.opposed[0] = vec3_axpy(sum.opposed[0], SIGN_OF_END[end], vec3_cross(turned, arm));
            sum.opposed[1] = vec3_axpy(sum.opposed[1], SIGN_OF_END[end], turned);
        }
    }
    sum.opposed[0] = vec3_add(sum.opposed[0], sum.centre);
    return sum;
}

/* Returns the change of the place X of a contact at a stage as orientations change. A change dq of the unit
 * quaternion q turns a body by the vector part of 2 dq q*. */
static struct vec3 turned_of(const struct iteration *it, int stage, int contact, const double *change)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int end = 0; SCENE_ANY_COMPOUND && end < 2; ++end) {
        const int body = it->contact[contact].body[end];
        const int k = it->g->ode.layout.orientation[body];
        if (k >= 0 && k < it->g->ode.layout.coupled) {
            const struct quaternion q = it->g->at_stage[stage].turning.body[body].orientation;
            const struct quaternion dq = quaternion_from(change + it->g->step.among[k]);
            const struct vec3 turn = quaternion_vector(quaternion_product(dq, quaternion_inverse(q)));
            sum = vec3_axpy(sum, 2.0 * SIGN_OF_END[end], vec3_cross(turn, it->node[stage][contact].arm[end]));
        }
    }
    return sum;
}

/* Adds the rates that the orientation of a body gets by the changes `pending` of the spins. */
static void follow_spin(struct iteration *it, int body, const double *pending)
{
    const struct radau_step *p = &it->g->step;
    const int k = it->g->ode.layout.orientation[body];
    for (int stage = 0; stage < p->stages->stages; ++stage) {
        const struct quaternion q = it->g->at_stage[stage].turning.body[body].orientation;
        const struct vec3 spin = vec3_from(pending + stage * p->width + it->body[body].spin);
        const struct quaternion rate = quaternion_rate(q, rotated_by(&it->body[body].rotation[stage], spin));
        double *to = p->rates + stage * p->width + p->among[k];
        to[0] += rate.w;
        vec3_add_to(1.0, quaternion_vector(rate), to + 1);
    }
}

/* The changes to come of a spring at all stages, and those of its rate by its drive. */
struct spring_change {
    struct vec3 spring[RADAU_MOST_STAGES], driven[RADAU_MOST_STAGES];
};

/* Returns the part of a vector that changes a spring at a stage: where the spring lies, and across `unit` of
 * its drive, because a spring that only turns keeps its length. */
static struct vec3 part_of_spring(const struct iteration *it, int stage, int contact, int part, struct vec3 a)
{
    const struct vec3 n = it->g->at_stage[stage].geometry[it->contact[contact].contact].normal;
    return opposed_laid(OPPOSED_SLIP, opposed_laid((enum opposed)part, a, n),
                        it->node[stage][contact].drive[part].unit);
}

/* Returns the changes of a spring, where the states but the places change by `pending`. */
static struct spring_change change_of_spring(const struct iteration *it, int contact, int part,
                                             const double *pending)
{
    const struct radau_step *p = &it->g->step;
    const int s = p->stages->stages;
    const struct node_spring *spring = &it->spring[contact][part];
    const int at = index_of_spring(it, contact, part);
    struct vec3 missed[RADAU_MOST_STAGES];
    struct spring_change to;
    for (int i = 0; i < s; ++i) {
        const struct node *node = &it->node[i][contact];
        const struct motion_change moved = motion_of(it, i, contact, pending + i * p->width);
        const struct vec3 n = it->g->at_stage[i].geometry[it->contact[contact].contact].normal;
        const struct vec3 dz = (spring->is_force ? node->more : moved.opposed)[load_of(part)];
        to.driven[i] = friction_driven(&node->drive[part], opposed_laid((enum opposed)part, dz, n));
        missed[i] = vec3_add(to.driven[i], vec3_from(p->rates + i * p->width + at));
        for (int j = 0; j < s; ++j) {
            missed[i] = vec3_axpy(missed[i], -p->stages->inverse[i * s + j] / p->length,
                                  vec3_from(p->others_change + j * p->width + at));
        }
        missed[i] = part_of_spring(it, i, contact, part, missed[i]);
    }
    for (int i = 0; i < s; ++i) {
        struct vec3 sum = {0.0, 0.0, 0.0};
        for (int j = 0; j < s; ++j) {
            sum = vec3_axpy(sum, spring->filter[i * s + j], missed[j]);
        }
        to.spring[i] = part_of_spring(it, i, contact, part, sum);
    }
    return to;
}

/* Adds the effects of the changes to come of springs and of their drives, where the states but the places
 * change by p->scratch: to the responses or, once the forces are corrected, to the rates of the springs. */
static void follow_springs(struct iteration *it, bool corrected)
{
    const struct radau_step *p = &it->g->step;
    for (int k = 0; SCENE_ANY_SPRINGS && k < it->contacts * OPPOSED; ++k) {
        const int contact = k / OPPOSED;
        const int part = k % OPPOSED;
        if (!it->spring[contact][part].is_there) {
            continue;
        }
        const struct spring_change change = change_of_spring(it, contact, part, p->scratch);
        for (int i = 0; i < p->stages->stages; ++i) {
            struct node *node = &it->node[i][contact];
            for (int r = 0; r < ROWS && !corrected; ++r) {
                node->response[load_of(part) * ROWS + r] +=
                    vec3_dot(node->by_spring[part][r], change.spring[i]);
            }
            const struct vec3 rate = vec3_axpy(change.driven[i], -node->drive[part].decay, change.spring[i]);
            vec3_add_to(corrected ? 1.0 : 0.0, rate,
                        p->rates + i * p->width + index_of_spring(it, contact, part));
        }
    }
}

/* Adds the rates that orientations and springs get by the changes to come of spins, velocities and forces, so
 * that places of contacts on bodies that tip, and elastic forces, follow the forces at once. */
static void move_others(struct iteration *it)
{
    const struct radau_step *p = &it->g->step;
    const struct ode_layout *layout = &it->g->ode.layout;
    for (int i = 0; SCENE_ANY_TIPPING && i < SCENE_BODIES; ++i) {
        if (layout->orientation[i] >= 0 && layout->orientation[i] < layout->coupled) {
            radau_step_pending(p, it->body[i].spin, 3, p->rates, 1.0, p->scratch);
            follow_spin(it, i, p->scratch);
        }
    }
    if (it->has_springs) {
        radau_step_pending(p, 0, p->others, p->rates, 1.0, p->scratch);
        follow_springs(it, true);
    }
}

/* Adds the changes of the responses of a contact at a stage by the changes to come of places. */
static void add_pending_places(const struct iteration *it, int stage, int contact, struct node *node)
{
    const struct radau_step *p = &it->g->step;
    const double *more = p->more + stage * p->width;
    const struct motion_change moved = motion_of(it, stage, contact, more);
    const struct vec3 farther =
        vec3_add(moved.opposed[0], turned_of(it, stage, contact, p->scratch + stage * p->width));
    const int rows = it->contact[contact].rows;
    for (int r = 0; r < ROWS && r < rows; ++r) {
        node->response[r] += vec3_dot(node->by_place[r], farther);
        node->response[r] += rows < ROWS ? 0.0 : vec3_dot(node->by_swing[r], moved.centre);
    }
}

/* Adds the changes of the responses of a contact at a stage by the changes to come of the other states. */
static inline void add_pending_motion(const struct iteration *it, int stage, int contact, struct node *node)
{
    const double *to_come = it->g->step.scratch + stage * it->g->step.width;
    const struct motion_change faster = motion_of(it, stage, contact, to_come);
    const int rows = it->contact[contact].rows;
    for (int r = 0; r < rows; ++r) {
        node->response[r] += vec3_dot(node->by_motion[r], faster.opposed[r < ROWS ? 0 : 1]);
    }
}

/* Adds the contact forces to the rates. The integrals of these rates will change the states, and what these
 * changes do is added to the responses. In the first iteration the guesses of states and of forces are
 * independent; later lever arms, the directions of forces and springs have changed. */
CONTACT_NOT_FUSED CONTACT_FLATTEN static void add_pending(struct iteration *it)
{
    struct radau_step *p = &it->g->step;
    const int count = p->stages->stages * it->contacts;
    for (int k = 0; k < count; ++k) {
        const struct node *node = &it->node[k / it->contacts][k % it->contacts];
        add_loads(it, k / it->contacts, k % it->contacts, node->load);
    }
    radau_step_pending(p, 0, p->others, p->rates, 1.0, p->scratch);
    if (it->follows_places) {
        radau_step_pending(p, 0, p->others, p->scratch, 0.0, p->more);
    }
    for (int k = 0; k < count; ++k) {
        struct node *node = &it->node[k / it->contacts][k % it->contacts];
        add_pending_motion(it, k / it->contacts, k % it->contacts, node);
        if (it->follows_places) {
            add_pending_places(it, k / it->contacts, k % it->contacts, node);
        }
    }
    follow_springs(it, false);
}

/* This struct lists the bodies that two contacts share. `by_mass` is the sum of their 1/m. Each shared body
 * that turns has its 1/I_1 in `by_inertia`, and is at `end` of one contact and at `other_end` of the other
 * one. 1/m and 1/I_1 are negative where the body is the source of one contact and the destination of the
 * other one. */
struct shared_bodies {
    double by_mass;
    int count; /* of shared bodies that turn */
    int end[4], other_end[4];
    double by_inertia[4];
};

static struct shared_bodies shared_bodies_of(const struct iteration *it, int c, int d)
{
    struct shared_bodies shared = {.by_mass = 0.0};
    for (int k = 0; k < 4; ++k) {
        const int end = k / 2;
        const int other_end = k % 2;
        const int body = it->contact[c].body[end];
        const double sign = SIGN_OF_END[end] * SIGN_OF_END[other_end];
        if (body == it->contact[d].body[other_end]) {
            shared.by_mass += sign * it->body[body].by_mass;
            shared.end[shared.count] = end;
            shared.other_end[shared.count] = other_end;
            shared.by_inertia[shared.count] = sign * it->body[body].by_inertia;
            shared.count += it->body[body].by_inertia > 0.0;
        }
    }
    return shared;
}

/* The responses at one stage change with the forces at another. `once` and `square` weigh the first and the
 * second integral of these forces, which move the bodies. Of each spring, `by_slip` weighs its change by the
 * slip that the forces make, and `by_force` its change by the forces themselves. */
struct block_weights {
    double once, square;
    double by_slip[OPPOSED], by_force[OPPOSED];
};

/* Returns what the springs add to row r of the response, each with its weight: the spring of the slip to the
 * rows of the force, those of rolling and spinning to the rows of the torque. */
static inline struct vec3 row_of_springs(const struct vec3 by[OPPOSED][ROWS], const double weight[OPPOSED],
                                         int r)
{
    return r < ROWS ? vec3_scale(weight[OPPOSED_SLIP], by[OPPOSED_SLIP][r])
                    : vec3_axpy(vec3_scale(weight[OPPOSED - 1], by[OPPOSED - 1][r - ROWS]),
                                weight[OPPOSED / 2], by[OPPOSED / 2][r - ROWS]);
}

/* Writes the rows of one contact and the columns of another at a pair of stages. The rows change through the
 * bodies that both contacts share, and by the torques that the forces make. */
static inline void put_block(const struct iteration *it, const struct node *node,
                             const struct node_contact *of, const struct node *by,
                             const struct node_contact *from, const struct shared_bodies *shared,
                             const struct block_weights *w, double *to)
{
    const int stride = it->g->step.all.stride;
    const bool springs = SCENE_ANY_SPRINGS && of->springs;
    struct vec3 arm[4];
    for (int l = 0; l < shared->count; ++l) {
        arm[l] = vec3_scale(shared->by_inertia[l], by->arm[shared->other_end[l]]);
    }
    for (int r = 0; r < of->rows; ++r) {
        struct vec3 effect = {0.0, 0.0, 0.0};
        struct vec3 twist = {0.0, 0.0, 0.0};
        if (r < ROWS) {
            effect = vec3_axpy(vec3_scale(w->once, node->by_motion[r]), w->square, node->by_place[r]);
            effect = springs ? vec3_add(effect, row_of_springs(node->by_drive, w->by_slip, r)) : effect;
            effect = of->rows >= ROWS ? vec3_axpy(effect, w->square, node->by_swing[r]) : effect;
            effect = vec3_scale(shared->by_mass, effect);
        }
        effect = node == by ? vec3_add(effect, node->by_force[r]) : effect;
        for (int l = 0; l < shared->count; ++l) {
            const struct turned_rows *t = &node->turned[shared->end[l]];
            struct vec3 turn = vec3_scale(w->once, t->by_motion[r]);
            turn = r < ROWS ? vec3_axpy(turn, w->square, t->by_place[r]) : turn;
            turn = springs ? vec3_add(turn, row_of_springs(t->by_drive, w->by_slip, r)) : turn;
            effect = vec3_add(effect, vec3_cross(turn, arm[l]));
            twist = vec3_axpy(twist, shared->by_inertia[l], turn);
        }
        if (springs && of == from) {
            struct vec3 *own = r < ROWS ? &effect : &twist;
            *own = vec3_add(*own, row_of_springs(node->by_drive, w->by_force, r));
        }
        if (from->rows == ROWS_WITHOUT_FRICTION) {
            to[r] = vec3_dot(effect, by->push);
            continue;
        }
        to[r] = effect.x;
        to[stride + r] = effect.y;
        to[2 * stride + r] = effect.z;
        if (SCENE_ANY_ROLLING && from->loads > 1) {
            twist = node == by && r >= ROWS ? vec3_add(twist, node->by_torque[r - ROWS]) : twist;
            to[3 * stride + r] = twist.x;
            to[4 * stride + r] = twist.y;
            to[5 * stride + r] = twist.z;
        }
    }
}

/* Does the work of put_blocks where no body turns: two forces along the normals act through the masses. */
static void put_blocks_of_normals(const struct iteration *it, int c, int d, double by_mass)
{
    struct radau_step *p = &it->g->step;
    const int s = p->stages->stages;
    const struct normals *of = &it->normals[c];
    double slope[2][RADAU_MOST_STAGES]; /* response to 1 N over the step, by rate and by gap */
    for (int i = 0; i < s; ++i) {
        slope[0][i] = by_mass * p->length * of->by_rate[i];
        slope[1][i] = by_mass * p->length * p->length * of->by_gap[i];
    }
    for (int j = 0; j < s; ++j) {
        const double push[3] = {it->normals[d].push[0][j], it->normals[d].push[1][j],
                                it->normals[d].push[2][j]};
        double *to = p->all.re + unknown_of(it, d, j) * p->all.stride + unknown_of(it, c, 0);
        for (int i = 0; i < s; i += LANES) {
            const double2 alike = double2_at(of->push[0], i) * push[0] +
                                  double2_at(of->push[1], i) * push[1] + double2_at(of->push[2], i) * push[2];
            double2_put(to, i,
                        alike * (double2_at(p->stages->once + j * s, i) * double2_at(slope[0], i) +
                                 double2_at(p->stages->twice + j * s, i) * double2_at(slope[1], i)));
        }
        if (c == d) {
            to[j] -= it->contact[c].admittance[0];
        }
    }
}

/* This struct holds vectors at the stages of a step, one component after the other. */
struct stage_vectors {
    double x[RADAU_MOST_STAGES], y[RADAU_MOST_STAGES], z[RADAU_MOST_STAGES];
};

/* Adds what the forces at all stages do to a row of the response at one stage. The row changes by `motion`
 * and `place`, weighted by `once` and `square`. The forces act across the lever arms `arm`; with NULL they
 * act on the masses, and their effects start the sum. */
static inline void add_effects(int stages, const double *once, const double *square, struct vec3 motion,
                               struct vec3 place, const struct stage_vectors *arm, struct stage_vectors *sum)
{
    for (int j = 0; j < stages; j += LANES) {
        double2 x = double2_at(once, j) * motion.x + double2_at(square, j) * place.x;
        double2 y = double2_at(once, j) * motion.y + double2_at(square, j) * place.y;
        double2 z = double2_at(once, j) * motion.z + double2_at(square, j) * place.z;
        if (arm) {
            const double2 a[3] = {double2_at(arm->x, j), double2_at(arm->y, j), double2_at(arm->z, j)};
            const double2 turned[3] = {y * a[2] - z * a[1], z * a[0] - x * a[2], x * a[1] - y * a[0]};
            x = double2_at(sum->x, j) + turned[0];
            y = double2_at(sum->y, j) + turned[1];
            z = double2_at(sum->z, j) + turned[2];
        }
        double2_put(sum->x, j, x);
        double2_put(sum->y, j, y);
        double2_put(sum->z, j, z);
    }
}

/* Does the work of put_blocks for friction without springs, with several stages of the forces at a time. */
static void put_blocks_of_rubbing(const struct iteration *it, int c, int d,
                                  const struct shared_bodies *shared)
{
    const struct radau_step *p = &it->g->step;
    const int s = p->stages->stages;
    const int stride = p->all.stride;
    struct stage_vectors arm[4];
    for (int k = 0; k < shared->count * s; ++k) {
        const int l = k / s;
        const struct vec3 of =
            vec3_scale(p->length * shared->by_inertia[l], it->node[k % s][d].arm[shared->other_end[l]]);
        arm[l].x[k % s] = of.x;
        arm[l].y[k % s] = of.y;
        arm[l].z[k % s] = of.z;
    }
    for (int i = 0; i < s; ++i) {
        const struct node *node = &it->node[i][c];
        double *rows = p->all.re + unknown_of(it, d, 0) * stride + unknown_of(it, c, i);
        double square[RADAU_MOST_STAGES];
        for (int j = 0; j < s; ++j) {
            square[j] = p->length * p->stages->twice[j * s + i];
        }
        for (int r = 0; r < ROWS; ++r) {
            const struct vec3 place = vec3_add(node->by_place[r], node->by_swing[r]);
            const double by_mass = p->length * shared->by_mass;
            struct stage_vectors sum;
            add_effects(s, p->stages->integral + i * s, square, vec3_scale(by_mass, node->by_motion[r]),
                        vec3_scale(by_mass, place), NULL, &sum);
            for (int l = 0; l < shared->count; ++l) {
                const struct turned_rows *t = &node->turned[shared->end[l]];
                add_effects(s, p->stages->integral + i * s, square, t->by_motion[r], t->by_place[r], &arm[l],
                            &sum);
            }
            for (int j = 0; j < s; ++j) {
                double *to = rows + j * ROWS * stride + r;
                to[0] = sum.x[j];
                to[stride] = sum.y[j];
                to[2 * stride] = sum.z[j];
            }
            for (int k = 0; k < ROWS && c == d; ++k) {
                rows[(i * ROWS + k) * stride + r] += vec3_get(node->by_force[r], k);
            }
        }
    }
}

/* Writes the rows of contact c and the columns of contact d at all stages. */
CONTACT_FLATTEN static void put_blocks(const struct iteration *it, int c, int d)
{
    struct radau_step *p = &it->g->step;
    const int s = p->stages->stages;
    const struct node_contact *of = &it->contact[c];
    const struct node_contact *from = &it->contact[d];
    const struct shared_bodies shared = shared_bodies_of(it, c, d);
    if (shared.count == 0 && shared.by_mass == 0.0 && c != d) {
        return;
    }
    const bool along_normals = of->rows == ROWS_WITHOUT_FRICTION && from->rows == ROWS_WITHOUT_FRICTION;
    if (along_normals && !(SCENE_ANY_TURNING && scene_turns(it->g->ode.values))) {
        put_blocks_of_normals(it, c, d, shared.by_mass);
        return;
    }
    if (!of->springs && of->rows == ROWS && from->rows == ROWS) {
        put_blocks_of_rubbing(it, c, d, &shared);
        return;
    }
    for (int i = 0; i < s; ++i) {
        const struct node *node = &it->node[i][c];
        double *rows = p->all.re + unknown_of(it, c, i);
        for (int j = 0; j < s; ++j) {
            struct block_weights w = {.once = p->length * p->stages->once[j * s + i],
                                      .square = p->length * p->length * p->stages->twice[j * s + i]};
            for (int k = 0; SCENE_ANY_SPRINGS && of->springs && k < OPPOSED; ++k) {
                const struct node_spring *spring = &it->spring[c][k];
                const double weight = spring->is_there ? spring->weight[i * s + j] : 0.0;
                w.by_slip[k] = spring->is_force ? 0.0 : weight;
                w.by_force[k] = spring->is_force ? weight : 0.0;
            }
            double *to = rows + unknown_of(it, d, j) * p->all.stride;
            put_block(it, node, of, &it->node[j][d], from, &shared, &w, to);
        }
    }
}

/* Returns the part of the matrix that belongs to the island of contact *c, and moves *c on to the next
 * island. */
static struct lu_matrix part_of_island(const struct iteration *it, int *c)
{
    const int first = unknown_of(it, *c, 0);
    const int island = it->contact[*c].island;
    int rows = 0;
    for (; *c < it->contacts && it->contact[*c].island == island; ++*c) {
        rows += it->g->step.stages->stages * it->contact[*c].rows;
    }
    return lu_part(it->g->step.all, first, rows);
}

static bool factor_nodes(struct iteration *it)
{
    bool done = true;
    for (int c = 0, end = 0; done && c < it->contacts; c = end) {
        const struct lu_matrix part = part_of_island(it, &end);
        for (int k = 0; k < part.rows; ++k) { /* with the zero behind each column */
            memset(part.re + k * part.stride, 0, (size_t)(part.rows + 1) * sizeof *part.re);
        }
        for (int k = c; k < end; ++k) {
            for (int d = c; d < end; ++d) {
                put_blocks(it, k, d);
            }
        }
        done = lu_factor(part);
    }
    it->factorizations += 1;
    return done;
}

/* Corrects the forces by the responses, and adds the corrections to the rates. */
static void correct_forces(struct iteration *it)
{
    struct radau_step *p = &it->g->step;
    const int count = p->stages->stages * it->contacts;
    double *side = p->side;
    for (int k = 0; k < count; ++k) {
        const struct node *node = &it->node[k / it->contacts][k % it->contacts];
        const struct node_contact *c = &it->contact[k % it->contacts];
        for (int r = 0; r < c->rows; ++r) {
            side[unknown_of(it, k % it->contacts, k / it->contacts) + r] = -node->response[r];
        }
    }
    side[p->stages->stages * it->rows] = 0.0;
    for (int c = 0; c < it->contacts;) {
        const int first = unknown_of(it, c, 0);
        lu_solve(part_of_island(it, &c), side + first);
    }
    for (int k = 0; k < count; ++k) {
        struct node *node = &it->node[k / it->contacts][k % it->contacts];
        const struct node_contact *c = &it->contact[k % it->contacts];
        const double *by = side + unknown_of(it, k % it->contacts, k / it->contacts);
        for (int l = 0; l < c->loads; ++l) {
            node->more[l] = c->rows >= ROWS ? vec3_from(by + l * ROWS) : vec3_scale(by[0], node->push);
            node->load[l] = vec3_add(node->load[l], node->more[l]);
        }
        add_loads(it, k / it->contacts, k % it->contacts, node->more);
    }
}

/* Guesses the forces from the rates of their impulses along the polynomial that the guess of the states goes
 * on from. Without a polynomial the forces are those at the start. */
static void guess_forces(struct iteration *it)
{
    const struct radau_step *p = &it->g->step;
    const bool goes_on = radau_step_goes_on(p);
    double rates[RADAU_MOST_STAGES * 3];
    for (int j = 0; j < it->contacts; ++j) {
        for (int k = 0; k < it->contact[j].loads; ++k) { /* the guess of M contains the torque of the force */
            const int impulse = it->g->ode.layout.impulse[it->contact[j].contact] + 6 * k;
            if (goes_on) {
                radau_step_guess_rates(p, impulse, 3, rates);
            }
            for (int i = 0; i < p->stages->stages; ++i) {
                it->node[i][j].load[k] = vec3_from(goes_on ? rates + 3 * i : p->start_rates + impulse);
            }
        }
    }
}

/* Writes the rates of all states at the stages under the forces found. */
static void finish_nodes(struct iteration *it)
{
    struct general *g = it->g;
    struct radau_step *p = &g->step;
    struct vec3 force[SCENE_CONTACTS] = {{0.0, 0.0, 0.0}};
    struct vec3 torque[SCENE_CONTACTS] = {{0.0, 0.0, 0.0}};
    for (int i = 0; i < p->stages->stages; ++i) {
        for (int j = 0; j < it->contacts; ++j) {
            force[it->contact[j].contact] = it->node[i][j].load[0];
            if (SCENE_ANY_ROLLING && it->contact[j].loads > 1) {
                torque[it->contact[j].contact] = it->node[i][j].load[LOADS - 1];
            }
        }
        struct scene_instant *at = move_to_stage(it, i, true);
        scene_put_contact_forces(force, torque, g->ode.layout.met, at);
        ode_rates_at(&g->ode, p->point, at, p->rates + i * p->stride);
    }
    p->evaluations += p->stages->stages;
}

/* These are the largest numbers of iterations, and of iterations with new slopes. More iterations would cost
 * more than two steps of half the length. */
enum { MOST_NODE_ITERATIONS = 16, MOST_FACTORIZATIONS = 5 };

/* Slopes are kept while each correction is less than this part of the one before, and while no more than this
 * number of iterations is left at the present rate. New slopes and their factors cost about three iterations,
 * and then one or two are left. */
static const double KEEPING_SLOPES = 0.2;
static const double MOST_LEFT = 5.0;

/* Corrections that grow by more than this do not converge with new slopes either. */
static const double LARGEST_GROWTH = 2.0;

/* Corrections that shrink no more are rounding where they are below this part of the error allowed. */
static const double NODE_ROUNDING_SHARE = 0.25;

/* Whether corrections of this size, which were `last` before, have converged. */
static bool has_converged(const struct radau_step *p, double size, double last, double tolerance)
{
    const double contraction = size / last;
    if (size <= tolerance) {
        return true;
    }
    if (p->iterations == 1) {
        return false; /* this is the correction of the guess */
    }
    return contraction < 0.5 ? size * contraction / (1.0 - contraction) <= tolerance
                             : size <= NODE_ROUNDING_SHARE;
}

/* Whether corrections of this size, which were `last` before, shrink fast enough with the present slopes. */
static bool keeps_slopes(double size, double last, double tolerance)
{
    return size < KEEPING_SLOPES * last && log(size / tolerance) < MOST_LEFT * log(last / size);
}

int node_forces_unknowns(const struct scene_values *v)
{
    int count = 0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        count += rows_of_law(v, j, ROWS_WHERE_IT_SWINGS);
    }
    return count;
}

int node_forces_stages(const struct general *g, double length)
{
    int rows = 0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        rows += rows_of(g, j, length);
    }
    return rows > 0 ? radau_room(&g->step.problem) / rows : RADAU_MOST_STAGES;
}

size_t node_forces_memory(void)
{
    return sizeof(struct iteration);
}

/* The first correction moves springs by the guess of the forces, which is zero at a touch. Where the importer
 * moves both bodies of a contact, no other state shows that the forces have changed. With springs the first
 * correction is therefore never the last. */
bool node_forces_solve(struct general *g, double tolerance, void (*set_weights)(struct general *g))
{
    struct radau_step *p = &g->step;
    struct iteration *it = g->nodes;
    double last = (double)INFINITY;
    bool anew = true;
    it->g = g;
    it->factorizations = 0;
    prepare(it);
    guess_forces(it);
    memcpy(p->point, p->y, (size_t)g->ode.layout.size * sizeof *p->point);
    for (p->iterations = 1; p->iterations <= MOST_NODE_ITERATIONS; ++p->iterations) {
        evaluate_nodes(it, anew);
        if (anew && !factor_nodes(it)) {
            return false;
        }
        add_pending(it);
        correct_forces(it);
        move_others(it);
        const double size = radau_step_integrate(p, p->rates);
        if (!isfinite(size)) {
            return false;
        }
        if (p->iterations == 1 && set_weights) {
            set_weights(g);
        }
        const bool shows_springs = p->iterations > 1 || !it->has_springs;
        if (!it->stale && shows_springs && has_converged(p, size, last, tolerance)) {
            finish_nodes(it);
            return true;
        }
        const bool slow = p->iterations > 2 && (it->stale || !keeps_slopes(size, last, tolerance));
        if (slow && (!(size < LARGEST_GROWTH * last) || it->factorizations == MOST_FACTORIZATIONS)) {
            return false;
        }
        anew = slow && !anew;
        last = size;
    }
    return false;
}
