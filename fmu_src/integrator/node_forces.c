/* Collocation with the contact forces at the stages as unknowns. Vectors are in the world frame. */
#include <math.h>
#include <string.h>

#include "integrator/node_forces.h"
#include "math/lu.h"
#include "scene/evaluate.h"

/* One contact at one stage. U is the velocity of the source at the point of contact less that of the
 * destination [m/s]; X is its integral [m]. The response changes by `by_force` dF + `by_velocity` dU +
 * `by_place` dX, whose rows are given. */
struct node {
    struct vec3 force;    /* on the source: the unknown [N] */
    struct vec3 arm[2];   /* from the centres of source and destination to the point of contact [m] */
    struct vec3 response; /* how far the force is from its laws [m/s] */
    bool rolls;           /* form of the response of friction (friction_response_of) */
    double steepness;     /* of that response where the slopes were taken */
    struct vec3 by_force[3], by_velocity[3], by_place[3];
};

/* How a body moves under a force: 1/m [1/kg], 1/I_1 [1/(kg m^2)], I_1/I_3 - 1; all zero if it is not free. */
struct mobility {
    bool moves;
    double by_mass, by_inertia, flatness;
};

/* Whether the inertia about the axis of a body differs from that across it: of cylinders only. */
static inline bool is_flat(const struct mobility *m)
{
    return SCENE_ANY_CYLINDER && m->flatness != 0.0;
}

/* The bodies at both ends of a contact, source first, and the indices in y of their velocities and spins; -1:
 * the body has none. */
struct node_ends {
    int body[2], speed[2], spin[2];
};

/* The source gets the force of a contact, the destination the opposite one. */
static const double SIGN_OF_END[2] = {1.0, -1.0};

struct iteration {
    struct general *g;
    struct node node[RADAU_MOST_STAGES][SCENE_CONTACTS];
    struct vec3 axis[RADAU_MOST_STAGES][SCENE_BODIES]; /* third axes of the bodies */
    struct mobility mobility[SCENE_BODIES];
    struct node_ends ends[SCENE_CONTACTS];
    struct turning_laws laws[SCENE_CONTACTS];
    double side[SCENE_CONTACTS];       /* +1: the source is outside the destination, -1: inside */
    double admittance[SCENE_CONTACTS]; /* scale of the responses that are forces [m/(N s)] */
    int among[ODE_MOST_STATES];        /* indices of states among those that are no places */
    bool stale; /* whether the slopes of a contact that rolls have changed by more than STALE */
    int factorizations;
};

/* The slopes of friction are taken anew where they have changed by this factor: by slopes that are much too
 * steep the corrections of the forces are small although the forces are far from the law. */
static const double STALE = 3.0;

static void prepare(struct iteration *it)
{
    const struct scene_values *v = it->g->ode.values;
    const struct radau_step *p = &it->g->step;
    const struct turning_layout layout = turning_layout_of(v);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        struct mobility *to = &it->mobility[i];
        to->by_mass = body_inverse_mass(v, i);
        if (body_turns_freely(v, i)) {
            to->by_inertia = 1.0 / body_inertia_of(v, i).transverse;
            to->flatness = body_flatness(v, i);
        }
        to->moves = to->by_mass > 0.0 || to->by_inertia > 0.0;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const double by_mass = scene_inverse_mass(v, j);
        const int body[2] = {contact_source(j), contact_destination(j)};
        it->laws[j] = turning_laws_of(v, it->g->state, j);
        it->side[j] = scene_contact_side(v, it->g->state, j);
        it->admittance[j] = p->length * (by_mass > 0.0 ? by_mass : 1.0);
        for (int end = 0; end < 2; ++end) {
            it->ends[j].body[end] = body[end];
            it->ends[j].spin[end] = layout.spin[body[end]];
            it->ends[j].speed[end] = body_is_free(v, body[end]) ? ode_body(v, body[end]) + 3 : -1;
        }
    }
    for (int j = 0; j < p->others; ++j) {
        it->among[p->other[j]] = j;
    }
}

/* Writes the rows of along e e^T plus those of a matrix that acts across e. */
static void put_rows(struct vec3 to[3], const double across[3][3], double along, struct vec3 e)
{
    for (int i = 0; i < 3; ++i) {
        const struct vec3 row = vec3_from(across[i]);
        to[i] = vec3_axpy(row, along * vec3_get(e, i) - vec3_dot(row, e), e);
    }
}

/* Sets the response of a contact and, if `anew`, its slopes. Along e = side n the response is a (F_n - F_n of
 * the law), with F_n = -F.e and the admittance a; across e it is the response of friction. */
static void respond(struct iteration *it, struct node *node, int contact, const struct scene_instant *at,
                    bool anew)
{
    const struct turning_laws *laws = &it->laws[contact];
    const struct contact_geometry *g = &at->geometry[contact];
    const double a = it->admittance[contact];
    const struct vec3 e = vec3_scale(it->side[contact], g->normal);
    const double normal_force = -vec3_dot(node->force, e);
    struct vec3 tangential = vec3_axpy(node->force, normal_force, e);
    double by_law = 0.0;
    struct contact_slopes slopes = {0.0, 0.0};
    enum friction_regime regime = FRICTION_LIFTED;
    if (laws->regime != REGIME_APART) {
        regime = laws->friction_regime;
        by_law = contact_force(&laws->normal, laws->regime, g->gap, g->gap_rate);
    }
    if (anew) {
        node->rolls = friction_rolls(&laws->friction, regime, normal_force, tangential, a);
    }
    const struct friction_response friction = friction_response_of(
        &laws->friction, regime, normal_force, at->turning.slip[contact], &tangential, node->rolls, a);
    node->force = vec3_axpy(tangential, -normal_force, e);
    node->response = vec3_axpy(friction.missed, a * (by_law - normal_force), e);
    if (!anew) {
        const double ratio = friction.steepness / node->steepness;
        it->stale = it->stale || (node->rolls && !(ratio < STALE && ratio * STALE > 1.0));
        return;
    }
    node->steepness = friction.steepness;
    if (laws->regime != REGIME_APART) {
        slopes = contact_force_slopes(&laws->normal, laws->regime, g->gap, g->gap_rate);
    }
    put_rows(node->by_force, friction.by_force, a, e);
    put_rows(node->by_velocity, friction.by_slip, -a * slopes.by_rate, e); /* g' = -e.U */
    for (int i = 0; i < 3; ++i) {
        node->by_force[i] = vec3_axpy(node->by_force[i], -vec3_get(friction.by_normal_force, i), e);
        node->by_place[i] = vec3_scale(-a * slopes.by_gap * vec3_get(e, i), e);
    }
}

/* Evaluates the motion of all contacts at the stages, their responses, and the rates without contact. */
static void evaluate_nodes(struct iteration *it, bool anew)
{
    struct general *g = it->g;
    struct radau_step *p = &g->step;
    struct scene_instant at;
    memcpy(p->point, p->y, (size_t)g->size * sizeof *p->point);
    it->stale = false;
    for (int i = 0; i < p->stages->stages; ++i) {
        const double clock = p->start + p->length * p->stages->node[i];
        radau_step_stage(p, i, p->point);
        ode_contact_motion(&g->ode, clock, p->point, &at);
        ode_rates_without_contact(&g->ode, clock, p->point, &at, p->rates + i * p->stride);
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            struct node *node = &it->node[i][j];
            node->arm[0] = at.turning.source_arm[j];
            node->arm[1] = at.turning.destination_arm[j];
            respond(it, node, j, &at, anew);
        }
        for (int j = 0; j < SCENE_BODIES; ++j) {
            if (is_flat(&it->mobility[j])) {
                it->axis[i][j] = quaternion_third_axis(at.turning.body[j].orientation);
            }
        }
    }
    p->evaluations += p->stages->stages;
}

static void add_vector(double *to, double factor, struct vec3 a)
{
    to[0] += factor * a.x;
    to[1] += factor * a.y;
    to[2] += factor * a.z;
}

/* Adds a force of a contact to the rates at a stage. */
static void add_force(struct iteration *it, int stage, int contact, struct vec3 force)
{
    const struct node_ends *ends = &it->ends[contact];
    double *rates = it->g->step.rates + stage * it->g->step.stride;
    for (int end = 0; end < 2; ++end) {
        const struct mobility *m = &it->mobility[ends->body[end]];
        if (ends->speed[end] >= 0) {
            add_vector(rates + ends->speed[end], SIGN_OF_END[end] * m->by_mass, force);
        }
        if (ends->spin[end] >= 0) {
            const struct vec3 torque = vec3_cross(it->node[stage][contact].arm[end], force);
            add_vector(rates + ends->spin[end], SIGN_OF_END[end] * m->by_inertia, torque);
        }
    }
}

/* Returns the change of U of a contact at a stage for changes of the states that are no places. */
static struct vec3 velocity_of(const struct iteration *it, int stage, int contact, const double *change)
{
    const struct node_ends *ends = &it->ends[contact];
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int end = 0; end < 2; ++end) {
        if (ends->speed[end] >= 0) {
            sum = vec3_axpy(sum, SIGN_OF_END[end], vec3_from(change + it->among[ends->speed[end]]));
        }
        if (ends->spin[end] >= 0) {
            const struct mobility *m = &it->mobility[ends->body[end]];
            struct vec3 turned = vec3_from(change + it->among[ends->spin[end]]);
            if (is_flat(m)) {
                const struct vec3 e = it->axis[stage][ends->body[end]];
                turned = vec3_axpy(turned, m->flatness * vec3_dot(turned, e), e);
            }
            const struct vec3 arm = it->node[stage][contact].arm[end];
            sum = vec3_axpy(sum, SIGN_OF_END[end], vec3_cross(turned, arm));
        }
    }
    return sum;
}

/* Adds the contact forces to the rates, and to the responses the effect that the integrals of these rates
 * will have: the stages still have the spins of the arms before. */
static void add_pending(struct iteration *it)
{
    struct radau_step *p = &it->g->step;
    const int s = p->stages->stages;
    for (int i = 0; i < s; ++i) {
        for (int c = 0; c < SCENE_CONTACTS; ++c) {
            add_force(it, i, c, it->node[i][c].force);
        }
    }
    radau_step_pending(p, p->scratch);
    for (int i = 0; i < s; ++i) {
        for (int c = 0; c < SCENE_CONTACTS; ++c) {
            struct node *node = &it->node[i][c];
            const struct vec3 more = velocity_of(it, i, c, p->scratch + i * p->width);
            node->response = vec3_add(node->response, vec3_make(vec3_dot(node->by_velocity[0], more),
                                                                vec3_dot(node->by_velocity[1], more),
                                                                vec3_dot(node->by_velocity[2], more)));
        }
    }
}

/* Adds to a block the product of its rows and M, the effect of a force at the arm `of` of a body on its
 * velocity at the arm `arm` at a stage: M = I / m - [arm] J^-1 [of]. */
static inline void add_mobility(const struct iteration *it, int stage, int body, struct vec3 arm,
                                struct vec3 of, double sign, const struct vec3 row[3], struct vec3 block[3])
{
    const struct mobility *m = &it->mobility[body];
    const double by_inertia = sign * m->by_inertia;
    const double alike = sign * m->by_mass + by_inertia * vec3_dot(arm, of);
    for (int k = 0; k < 3; ++k) {
        block[k] = vec3_axpy(block[k], alike, row[k]);
        block[k] = vec3_axpy(block[k], -by_inertia * vec3_dot(row[k], of), arm);
    }
    if (is_flat(m)) {
        const struct vec3 axis = it->axis[stage][body];
        const struct vec3 lever = vec3_cross(arm, axis);
        const struct vec3 turned = vec3_scale(by_inertia * m->flatness, vec3_cross(of, axis));
        for (int k = 0; k < 3; ++k) {
            block[k] = vec3_axpy(block[k], vec3_dot(row[k], lever), turned);
        }
    }
}

/* Writes the rows of contact c at stage i and the columns of contact d at stage j. */
static inline void put_node_block(const struct iteration *it, double once, double square, int i, int c, int j,
                                  int d)
{
    const struct radau_step *p = &it->g->step;
    const struct node *node = &it->node[i][c];
    const struct node *by = &it->node[j][d];
    double *to = p->all.re + 3 * (j * SCENE_CONTACTS + d) * p->all.stride + 3 * (i * SCENE_CONTACTS + c);
    struct vec3 row[3];
    struct vec3 block[3];
    for (int k = 0; k < 3; ++k) {
        row[k] = vec3_axpy(vec3_scale(once, node->by_velocity[k]), square, node->by_place[k]);
        block[k] = node == by ? node->by_force[k] : vec3_make(0.0, 0.0, 0.0);
    }
    for (int end = 0; end < 4; ++end) {
        const int a = end / 2;
        const int b = end % 2;
        const int body = it->ends[c].body[a];
        if (body == it->ends[d].body[b] && it->mobility[body].moves) {
            add_mobility(it, i, body, node->arm[a], by->arm[b], a == b ? 1.0 : -1.0, row, block);
        }
    }
    for (int k = 0; k < 3; ++k) {
        to[k] = block[k].x;
        to[p->all.stride + k] = block[k].y;
        to[2 * p->all.stride + k] = block[k].z;
    }
}

static bool factor_nodes(struct iteration *it)
{
    struct radau_step *p = &it->g->step;
    const int s = p->stages->stages;
    const double *twice = radau_step_twice(p);
    p->all.rows = 3 * SCENE_CONTACTS * s;
    for (int k = 0; k < s * s; ++k) {
        const double once = p->length * p->stages->integral[k];
        const double square = p->length * p->length * twice[k];
        for (int c = 0; c < SCENE_CONTACTS; ++c) {
            for (int d = 0; d < SCENE_CONTACTS; ++d) {
                put_node_block(it, once, square, k / s, c, k % s, d);
            }
        }
    }
    for (int k = 0; k < p->all.rows; ++k) { /* the zero behind each column */
        p->all.re[k * p->all.stride + p->all.rows] = 0.0;
    }
    it->factorizations += 1;
    return lu_factor(p->all);
}

/* Corrects the forces by the responses, and adds the corrections to the rates. */
static void correct_forces(struct iteration *it)
{
    struct radau_step *p = &it->g->step;
    const int count = p->stages->stages * SCENE_CONTACTS;
    double *side = p->side;
    for (int k = 0; k < count; ++k) {
        vec3_to(vec3_scale(-1.0, it->node[k / SCENE_CONTACTS][k % SCENE_CONTACTS].response), side + 3 * k);
    }
    side[p->all.rows] = 0.0;
    lu_solve(p->all, side, NULL);
    for (int k = 0; k < count; ++k) {
        const int stage = k / SCENE_CONTACTS;
        const int contact = k % SCENE_CONTACTS;
        struct vec3 *force = &it->node[stage][contact].force;
        const struct vec3 more = vec3_from(side + 3 * k);
        *force = vec3_add(*force, more);
        add_force(it, stage, contact, more);
    }
}

/* Guesses the forces from the rates of their impulses along the polynomial that the guess of the states goes
 * on from. Without a polynomial the forces are those at the start. */
static void guess_forces(struct iteration *it)
{
    const struct general *g = it->g;
    const struct radau_step *p = &g->step;
    const int first = ode_impulse(g->ode.values, 0);
    const int count = ode_dissipated(g->ode.values) - first;
    const bool goes_on = radau_step_goes_on(p);
    double rates[RADAU_MOST_STAGES * ODE_MOST_STATES];
    if (goes_on) {
        radau_step_guess_rates(p, first, count, rates);
    }
    for (int i = 0; i < p->stages->stages; ++i) {
        const double *from = goes_on ? rates + i * count : p->start_rates + first;
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            it->node[i][j].force = vec3_from(from + ode_impulse(g->ode.values, j) - first);
        }
    }
}

/* Writes the rates of all states at the stages under the forces found. */
static void finish_nodes(const struct iteration *it)
{
    struct general *g = it->g;
    struct radau_step *p = &g->step;
    struct vec3 force[SCENE_CONTACTS];
    memcpy(p->point, p->y, (size_t)g->size * sizeof *p->point);
    for (int i = 0; i < p->stages->stages; ++i) {
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            force[j] = it->node[i][j].force;
        }
        radau_step_stage(p, i, p->point);
        ode_rates_under(&g->ode, p->start + p->length * p->stages->node[i], p->point, force,
                        p->rates + i * p->stride);
    }
    p->evaluations += p->stages->stages;
}

/* Largest number of iterations, and of iterations with new slopes. More iterations would cost more than two
 * steps of half the length. */
enum { MOST_NODE_ITERATIONS = 16, MOST_FACTORIZATIONS = 5 };

/* Slopes are kept while each correction is less than this part of the one before. New slopes and their
 * factors cost about three iterations. */
static const double KEEPING_SLOPES = 0.4;

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
    if (p->iterations < 3) {
        return false; /* the first correction is that of the guess */
    }
    return contraction < 0.5 ? size * contraction / (1.0 - contraction) <= tolerance
                             : size <= NODE_ROUNDING_SHARE;
}

bool node_forces_apply(const struct general *g)
{
    bool elastic = false;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        elastic = elastic || contact_rubs_elastically(g->ode.values, j);
    }
    return !elastic && 3 * SCENE_CONTACTS <= g->step.others;
}

bool node_forces_solve(struct general *g, double tolerance)
{
    struct radau_step *p = &g->step;
    struct iteration it = {.g = g};
    double last = (double)INFINITY;
    bool anew = true;
    prepare(&it);
    guess_forces(&it);
    for (p->iterations = 1; p->iterations <= MOST_NODE_ITERATIONS; ++p->iterations) {
        evaluate_nodes(&it, anew);
        if (anew && !factor_nodes(&it)) {
            return false;
        }
        add_pending(&it);
        correct_forces(&it);
        const double size = radau_step_integrate(p);
        if (!isfinite(size)) {
            return false;
        }
        if (!it.stale && has_converged(p, size, last, tolerance)) {
            finish_nodes(&it);
            return true;
        }
        const bool slow = p->iterations > 2 && (it.stale || !(size < KEEPING_SLOPES * last));
        if (slow && (!(size < LARGEST_GROWTH * last) || it.factorizations == MOST_FACTORIZATIONS)) {
            return false;
        }
        anew = slow && !anew;
        last = size;
    }
    return false;
}
