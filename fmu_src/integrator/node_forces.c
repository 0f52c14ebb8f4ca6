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

/* How a body moves under a force: 1/m [1/kg], 1/I_1 [1/(kg m^2)], I_1/I_3 - 1; all zero if it is not free.
 * Its rotation is `across` times L/I_1, plus the flatness times its part along the axis: across is 1, and 0
 * for a body that keeps its axis, which has a flatness of 1. */
struct mobility {
    bool moves;
    double by_mass, by_inertia, across, flatness;
};

/* Whether the inertia about the axis of a body differs from that across it: of cylinders only. */
static inline bool is_flat(const struct mobility *m)
{
    return SCENE_ANY_AXIS && m->flatness != 0.0;
}

/* The bodies at both ends of a contact, source first, and the indices of their velocities and spins among the
 * states that are no positions; -1 stands where a body has none. */
struct node_ends {
    int body[2], speed[2], spin[2];
};

/* The source gets the force of a contact, the destination the opposite one. */
static const double SIGN_OF_END[2] = {1.0, -1.0};

struct iteration {
    struct general *g;
    struct turning_layout layout;
    struct node node[RADAU_MOST_STAGES][SCENE_CONTACTS];
    struct vec3 axis[RADAU_MOST_STAGES][SCENE_BODIES]; /* third axes of the bodies */
    struct mobility mobility[SCENE_BODIES];
    struct node_ends ends[SCENE_CONTACTS];
    struct turning_laws laws[SCENE_CONTACTS];
    double side[SCENE_CONTACTS];       /* +1: the source is outside the destination, -1: inside */
    double admittance[SCENE_CONTACTS]; /* scale of the responses that are forces [m/(N s)] */
    int among[ODE_MOST_STATES];        /* indices of states among those that are no places */
    double *rates, *bare; /* [stages][width] rates of these states with and without the contact forces */
    bool stale;           /* whether the slopes of a contact that rolls have changed by more than STALE */
    int factorizations;
};

/* The slopes of friction are taken anew where they have changed by this factor: by slopes that are much too
 * steep the corrections of the forces are small although the forces are far from the law. */
static const double STALE = 3.0;

static void prepare_bodies(struct iteration *it)
{
    const struct scene_values *v = it->g->ode.values;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        struct mobility *to = &it->mobility[i];
        to->by_mass = body_inverse_mass(v, i);
        if (body_turns_freely(v, i)) {
            to->by_inertia = 1.0 / body_inertia_of(v, i).transverse;
            to->across = body_keeps_axis(i) ? 0.0 : 1.0;
            to->flatness = body_keeps_axis(i) ? 1.0 : body_flatness(v, i);
            for (int stage = 0; body_keeps_axis(i) && stage < RADAU_MOST_STAGES; ++stage) {
                it->axis[stage][i] = quaternion_third_axis(it->g->state->turning.body[i].orientation);
            }
        }
        to->moves = to->by_mass > 0.0 || to->by_inertia > 0.0;
    }
}

static void prepare_contacts(struct iteration *it)
{
    const struct scene_values *v = it->g->ode.values;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const double by_mass = scene_inverse_mass(v, j);
        const int body[2] = {contact_source(j), contact_destination(j)};
        it->laws[j] = turning_laws_of(v, it->g->state, j);
        it->side[j] = scene_contact_side(v, it->g->state, j);
        it->admittance[j] = it->g->step.length * (by_mass > 0.0 ? by_mass : 1.0);
        for (int end = 0; end < 2; ++end) {
            const int spin = it->layout.spin[body[end]];
            it->ends[j].body[end] = body[end];
            it->ends[j].spin[end] = spin >= 0 ? it->among[spin] : -1;
            it->ends[j].speed[end] = body_is_free(v, body[end]) ? it->among[ode_body(v, body[end]) + 3] : -1;
        }
    }
}

/* Sets what is the same in all iterations: the motion of bodies that are not free, and the rates without
 * contact forces. */
static void prepare(struct iteration *it)
{
    struct general *g = it->g;
    struct radau_step *p = &g->step;
    it->layout = turning_layout_of(g->ode.values);
    it->rates = p->rates;
    it->bare = p->residual;
    for (int j = 0; j < p->others; ++j) {
        it->among[p->other[j]] = j;
    }
    prepare_bodies(it);
    prepare_contacts(it);
    memset(p->point, 0, (size_t)g->size * sizeof *p->point);
    memset(it->bare, 0, (size_t)(p->stages->stages * p->width) * sizeof *it->bare);
    for (int i = 0; i < p->stages->stages; ++i) {
        const double clock = p->start + p->length * p->stages->node[i];
        ode_prescribed_motion(&g->ode, clock, &g->at_stage[i]);
        ode_rates_without_contact(&g->ode, &it->layout, clock, p->point);
        for (int j = 0; j < p->others; ++j) {
            it->bare[i * p->width + j] = p->point[p->other[j]];
        }
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
    const struct vec3 slip = at->turning.slip[contact];
    const bool touches = laws->regime != REGIME_APART;
    const enum friction_regime regime = touches ? laws->rubbing_regime[OPPOSED_SLIP] : FRICTION_LIFTED;
    const double by_law = touches ? contact_force(&laws->normal, laws->regime, g->gap, g->gap_rate) : 0.0;
    const double a = it->admittance[contact];
    const struct vec3 e = vec3_scale(it->side[contact], g->normal);
    const double normal_force = -vec3_dot(node->force, e);
    struct vec3 tangential = vec3_axpy(node->force, normal_force, e);
    if (anew) {
        node->rolls = friction_rolls(&laws->rubbing[OPPOSED_SLIP], regime, normal_force, tangential, a);
    }
    const struct friction_missed missed = friction_missed(&laws->rubbing[OPPOSED_SLIP], regime, normal_force,
                                                          slip, &tangential, node->rolls, a);
    node->force = vec3_axpy(tangential, -normal_force, e);
    node->response = vec3_axpy(missed.velocity, a * (by_law - normal_force), e);
    if (!anew) {
        const double ratio = missed.steepness / node->steepness;
        it->stale = it->stale || (node->rolls && !(ratio < STALE && ratio * STALE > 1.0));
        return;
    }
    node->steepness = missed.steepness;
    struct contact_slopes slopes = {0.0, 0.0};
    if (touches) {
        slopes = contact_force_slopes(&laws->normal, laws->regime, g->gap, g->gap_rate);
    }
    const struct friction_response friction = friction_response_of(
        &laws->rubbing[OPPOSED_SLIP], regime, normal_force, slip, tangential, node->rolls, a);
    put_rows(node->by_force, friction.by_force, a, e);
    put_rows(node->by_velocity, friction.by_slip, -a * slopes.by_rate, e); /* g' = -e.U */
    for (int i = 0; i < 3; ++i) {
        node->by_force[i] = vec3_axpy(node->by_force[i], -vec3_get(friction.by_normal_force, i), e);
        node->by_place[i] = vec3_scale(-a * slopes.by_gap * vec3_get(e, i), e);
    }
}

/* Sets the motion of all contacts at a stage. */
static struct scene_instant *move_to_stage(struct iteration *it, int stage)
{
    struct general *g = it->g;
    radau_step_stage(&g->step, stage, g->step.point);
    ode_contact_motion(&g->ode, &it->layout, g->step.point, &g->at_stage[stage]);
    return &g->at_stage[stage];
}

/* Adds the rates of the orientations on which contacts depend. */
static void put_orientation_rates(struct iteration *it, int stage, const struct scene_instant *at)
{
    for (int i = 0; SCENE_ANY_AXIS && i < SCENE_BODIES; ++i) {
        const int k = it->layout.orientation[i];
        if (k >= 0 && k < it->layout.coupled) {
            const double *y = it->g->step.point + k;
            const struct quaternion rate = quaternion_rate((struct quaternion){y[0], y[1], y[2], y[3]},
                                                           at->turning.body[i].angular_velocity);
            double *to = it->rates + stage * it->g->step.width + it->among[k];
            to[0] = rate.w;
            vec3_to(quaternion_vector(rate), to + 1);
            it->axis[stage][i] = quaternion_third_axis(at->turning.body[i].orientation);
        }
    }
}

/* Evaluates the motion of all contacts at the stages, their responses, and the rates without contact. */
static void evaluate_nodes(struct iteration *it, bool anew)
{
    struct radau_step *p = &it->g->step;
    const int s = p->stages->stages;
    memcpy(it->rates, it->bare, (size_t)(s * p->width) * sizeof *it->rates);
    it->stale = false;
    for (int i = 0; i < s; ++i) {
        const struct scene_instant *at = move_to_stage(it, i);
        put_orientation_rates(it, i, at);
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            struct node *node = &it->node[i][j];
            node->arm[0] = at->turning.source_arm[j];
            node->arm[1] = at->turning.destination_arm[j];
            respond(it, node, j, at, anew);
        }
    }
    p->evaluations += s;
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
    double *rates = it->rates + stage * it->g->step.width;
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
            sum = vec3_axpy(sum, SIGN_OF_END[end], vec3_from(change + ends->speed[end]));
        }
        if (ends->spin[end] >= 0) {
            const struct mobility *m = &it->mobility[ends->body[end]];
            struct vec3 turned = vec3_from(change + ends->spin[end]);
            if (is_flat(m)) {
                const struct vec3 e = it->axis[stage][ends->body[end]];
                turned = vec3_axpy(vec3_scale(m->across, turned), m->flatness * vec3_dot(turned, e), e);
            }
            const struct vec3 arm = it->node[stage][contact].arm[end];
            sum = vec3_axpy(sum, SIGN_OF_END[end], vec3_cross(turned, arm));
        }
    }
    return sum;
}

static struct vec3 rows_times(const struct vec3 row[3], struct vec3 a)
{
    return vec3_make(vec3_dot(row[0], a), vec3_dot(row[1], a), vec3_dot(row[2], a));
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
    radau_step_pending(p, it->rates, p->scratch);
    for (int i = 0; i < s; ++i) {
        for (int c = 0; c < SCENE_CONTACTS; ++c) {
            struct node *node = &it->node[i][c];
            const struct vec3 more = velocity_of(it, i, c, p->scratch + i * p->width);
            node->response = vec3_add(node->response, rows_times(node->by_velocity, more));
        }
    }
}

/* A body that two contacts share, and the ends of both contacts at which it is. */
struct shared_body {
    int body, end, other_end;
    /* 1/m, the part of 1/I_1 that acts in every direction, and the part that the axis adds; all are negative
     * where the ends differ */
    double by_mass, by_inertia, by_axis;
};

static int shared_bodies(const struct iteration *it, int c, int d, struct shared_body list[4])
{
    int count = 0;
    for (int k = 0; k < 4; ++k) {
        const int body = it->ends[c].body[k / 2];
        const struct mobility *m = &it->mobility[body];
        const double sign = k / 2 == k % 2 ? 1.0 : -1.0;
        if (body == it->ends[d].body[k % 2] && m->moves) {
            list[count++] = (struct shared_body){body,
                                                 k / 2,
                                                 k % 2,
                                                 sign * m->by_mass,
                                                 sign * m->by_inertia * m->across,
                                                 SCENE_ANY_AXIS ? sign * m->by_inertia * m->flatness : 0.0};
        }
    }
    return count;
}

/* Adds to a block the product of its rows and M, the effect of a force at the arm `of` of a body on its
 * velocity at the arm `arm`: M = I / m - [arm] J^-1 [of]. */
static inline void add_mobility(const struct shared_body *m, struct vec3 arm, struct vec3 of,
                                struct vec3 axis, const struct vec3 row[3], struct vec3 block[3])
{
    const double alike = m->by_mass + m->by_inertia * vec3_dot(arm, of);
    for (int k = 0; k < 3; ++k) {
        const double turned = m->by_inertia * vec3_dot(row[k], of);
        block[k] = vec3_make(block[k].x + alike * row[k].x - turned * arm.x,
                             block[k].y + alike * row[k].y - turned * arm.y,
                             block[k].z + alike * row[k].z - turned * arm.z);
    }
    if (SCENE_ANY_AXIS && m->by_axis != 0.0) {
        const struct vec3 lever = vec3_cross(arm, axis);
        const struct vec3 turned = vec3_scale(m->by_axis, vec3_cross(of, axis));
        for (int k = 0; k < 3; ++k) {
            block[k] = vec3_axpy(block[k], vec3_dot(row[k], lever), turned);
        }
    }
}

/* Writes the rows of contact c and the columns of contact d at all stages. */
static void put_blocks(const struct iteration *it, int c, int d)
{
    struct radau_step *p = &it->g->step;
    const int s = p->stages->stages;
    const double *twice = radau_step_twice(p);
    struct shared_body shared[4];
    const int count = shared_bodies(it, c, d, shared);
    for (int k = 0; k < s * s; ++k) {
        const double once = p->length * p->stages->integral[k];
        const double square = p->length * p->length * twice[k];
        const struct node *node = &it->node[k / s][c];
        const struct node *by = &it->node[k % s][d];
        double *to =
            p->all.re + 3 * (k % s * SCENE_CONTACTS + d) * p->all.stride + 3 * (k / s * SCENE_CONTACTS + c);
        struct vec3 row[3];
        struct vec3 block[3] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
        for (int r = 0; r < 3; ++r) {
            row[r] = vec3_axpy(vec3_scale(once, node->by_velocity[r]), square, node->by_place[r]);
        }
        for (int l = 0; l < count; ++l) {
            add_mobility(&shared[l], node->arm[shared[l].end], by->arm[shared[l].other_end],
                         it->axis[k / s][shared[l].body], row, block);
        }
        for (int r = 0; r < 3; ++r) {
            const struct vec3 own = node == by ? vec3_add(block[r], node->by_force[r]) : block[r];
            to[r] = own.x;
            to[p->all.stride + r] = own.y;
            to[2 * p->all.stride + r] = own.z;
        }
    }
}

static bool factor_nodes(struct iteration *it)
{
    struct radau_step *p = &it->g->step;
    p->all.rows = 3 * SCENE_CONTACTS * p->stages->stages;
    for (int c = 0; c < SCENE_CONTACTS; ++c) {
        for (int d = 0; d < SCENE_CONTACTS; ++d) {
            put_blocks(it, c, d);
        }
    }
    for (int k = 0; k < p->all.rows; ++k) { /* the zero behind each column */
        p->all.re[k * p->all.stride + p->all.rows] = 0.0;
    }
    it->factorizations += 1;
    return lu_factor(p->all);
}

/* Corrects the force of a contact at a stage and the rates there. */
static void correct_force(struct iteration *it, int stage, int contact, struct vec3 more)
{
    struct vec3 *force = &it->node[stage][contact].force;
    *force = vec3_add(*force, more);
    add_force(it, stage, contact, more);
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
        correct_force(it, k / SCENE_CONTACTS, k % SCENE_CONTACTS, vec3_from(side + 3 * k));
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
static void finish_nodes(struct iteration *it)
{
    struct general *g = it->g;
    struct radau_step *p = &g->step;
    struct vec3 force[SCENE_CONTACTS];
    for (int i = 0; i < p->stages->stages; ++i) {
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            force[j] = it->node[i][j].force;
        }
        ode_rates_under(&g->ode, p->start + p->length * p->stages->node[i], p->point, force,
                        move_to_stage(it, i), p->rates + i * p->stride);
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
    /* the unknowns are forces, neither springs nor torques; orientations move no place of a force */
    bool refused = SCENE_ANY_COMPOUND;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        refused = refused || contact_has_springs(g->ode.values, j) || contact_resists(g->ode.values, j);
    }
    return !refused && 3 * SCENE_CONTACTS <= g->step.others;
}

bool node_forces_solve(struct general *g, double tolerance)
{
    struct radau_step *p = &g->step;
    struct iteration it = {.g = g};
    double last = (double)INFINITY;
    bool anew = true;
    prepare(&it);
    guess_forces(&it);
    memcpy(p->point, p->y, (size_t)g->size * sizeof *p->point);
    for (p->iterations = 1; p->iterations <= MOST_NODE_ITERATIONS; ++p->iterations) {
        evaluate_nodes(&it, anew);
        if (anew && !factor_nodes(&it)) {
            return false;
        }
        add_pending(&it);
        correct_forces(&it);
        const double size = radau_step_integrate(p, it.rates);
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
