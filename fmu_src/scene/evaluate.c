#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/law.h"
#include "math/compiler.h"
#include "math/rotor.h"
#include "scene/evaluate.h"

bool scene_is_hertz(const struct scene_values *v, int contact)
{
    return SCENE_ANY_HERTZ && contact_law(v, contact) == LAW_HERTZ;
}

bool scene_damps_by_onset(const struct scene_values *v, int contact)
{
    return SCENE_ANY_RESTITUTION && scene_is_hertz(v, contact) &&
           contact_viscous_control(v, contact) == VISCOUS_CONTROL_RESTITUTION;
}

/* Automatic moments of inertia are those of homogeneous solids: 2/5 m r^2 for a sphere; m r^2/2 about the
 * axis and m (3 r^2 + L^2)/12 across it for a cylinder. One that keeps its axis needs only the first. For a
 * torus with the tube's radius r they are m (R^2 + 3 r^2/4) and m (R^2/2 + 5 r^2/8). */
struct vec3 body_inertia_of(const struct scene_values *v, int body)
{
    const bool is_cylinder = SCENE_ANY_CYLINDER && body_shape(body) == SHAPE_CYLINDER;
    const bool is_torus = SCENE_ANY_TORUS && body_shape(body) == SHAPE_TORUS;
    const bool tilts = (is_cylinder && !body_keeps_axis(body)) || is_torus;
    const double m = body_mass(v, body);
    const double r = body_radius(v, body);
    const double length = body_length(v, body);
    double axial = (is_cylinder ? 0.5 : 0.4) * m * r * r;
    double transverse = m * (3.0 * r * r + length * length) / 12.0;
    if (body_is_compound(body)) {
        return body_principal_inertia(v, body);
    }
    if (is_torus) {
        const double ring = body_ring_radius(v, body);
        axial = m * (ring * ring + 0.75 * r * r);
        transverse = m * (0.5 * ring * ring + 0.625 * r * r);
    }
    if (body_inertia_control(v, body) == INERTIA_CONTROL_USER_DEFINED) {
        axial = body_axial_inertia(v, body);
        transverse = body_transverse_inertia(v, body);
    }
    transverse = tilts ? transverse : axial;
    return vec3_make(transverse, transverse, axial);
}

/* Returns R diag(d) R^T a, where R turns the frame of a body into the world's. With equal moments of inertia
 * d is the identity. */
static struct vec3 along_principal_axes(struct quaternion orientation, struct vec3 d, struct vec3 a)
{
    if (d.x == 1.0 && d.y == 1.0 && d.z == 1.0) {
        return a;
    }
    const struct vec3 in_body = quaternion_rotate(quaternion_inverse(orientation), a);
    return quaternion_rotate(orientation, vec3_make(d.x * in_body.x, d.y * in_body.y, d.z * in_body.z));
}

struct vec3 body_spin_of(const struct scene_values *v, int body, const struct body_turn *turn)
{
    const struct vec3 i = body_inertia_of(v, body);
    return along_principal_axes(turn->orientation, vec3_make(1.0, i.y / i.x, i.z / i.x),
                                turn->angular_velocity);
}

struct vec3 body_rotation_of(const struct scene_values *v, int body, struct quaternion orientation,
                             struct vec3 spin)
{
    const struct vec3 i = body_inertia_of(v, body);
    return along_principal_axes(orientation, vec3_make(1.0, i.x / i.y, i.x / i.z),
                                body_part_that_turns(v, body, spin));
}

struct vec3 scene_lever(const struct scene_instant *at, int contact, int end)
{
    if (!SCENE_ANY_COMPOUND) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
    return quaternion_rotate(at->turning.body[body].orientation,
                             end == 0 ? contact_source_part(contact) : contact_destination_part(contact));
}

/* Whether the tangential stiffness of a contact follows the normal one. */
static bool stiffens(const struct scene_values *v, int contact)
{
    return SCENE_ANY_MINDLIN && scene_is_hertz(v, contact) &&
           contact_tangential_law(v, contact) == TANGENTIAL_LAW_MINDLIN;
}

static struct contact_material material_of(const struct scene_values *v, int body)
{
    return (struct contact_material){body_youngs_modulus(v, body), body_poissons_ratio(v, body)};
}

double scene_hertz_modulus(const struct scene_values *v, int contact)
{
    return hertz_modulus(material_of(v, contact_source(contact)),
                         material_of(v, contact_destination(contact)));
}

/* Returns K [N/m^1.5], where k_t is `ratio` times dF_n/ddelta = 1.5 k_h sqrt(delta). It is at least the least
 * k_t, since k_h may be zero and the length of a sliding spring is L / k_t. */
static double mindlin_stiffness(const struct scene_state *q, int contact)
{
    const double ratio = contact_penalty_control(q->v, contact) == PENALTY_CONTROL_AUTOMATIC
                             ? mindlin_ratio(material_of(q->v, contact_source(contact)),
                                             material_of(q->v, contact_destination(contact)))
                             : contact_tangential_ratio(q->v, contact);
    return fmax(1.5 * ratio * q->contact[contact].parameters.factors.k, 1e-150);
}

static struct friction_law resistance_law(const struct scene_state *q, int contact, int part)
{
    const struct scene_values *v = q->v;
    const double r_s = contact_source_radius(v, contact);
    const double r_d = scene_contact_side(q, contact) * contact_destination_radius(v, contact);
    const bool on_plane = body_shape(contact_destination(contact)) == SHAPE_PLANE;
    const double lever = on_plane ? r_s : r_s * fabs(r_d) / fabs(r_s + r_d); /* R_r [m] */
    struct friction_law law = {.kind = (enum friction)contact_rolling(v, contact),
                               .coefficient = lever * contact_rolling_coefficient(v, contact),
                               .largest = (double)INFINITY,
                               .stiffness = contact_rolling_stiffness(v, contact),
                               .damping = contact_rolling_damping(v, contact),
                               .slip_velocity = contact_characteristic_rolling_rate(v, contact)};
    if (part == OPPOSED_SPINNING) {
        law.kind = (enum friction)contact_spinning(v, contact);
        law.coefficient = lever * contact_spinning_coefficient(v, contact);
        law.stiffness = contact_spinning_stiffness(v, contact);
        law.damping = contact_spinning_damping(v, contact);
        law.slip_velocity = contact_characteristic_spinning_rate(v, contact);
    }
    law.static_coefficient = law.coefficient;
    return law;
}

struct friction_law scene_friction_law(const struct scene_state *q, int contact, int part)
{
    const struct scene_values *v = q->v;
    _Static_assert((int)RESISTANCE_NONE == (int)FRICTION_NONE &&
                       (int)RESISTANCE_REGULARIZED == (int)FRICTION_REGULARIZED &&
                       (int)RESISTANCE_ELASTIC == (int)FRICTION_ELASTIC,
                   "a resistance is a law of friction");
    if (part != OPPOSED_SLIP) {
        return contact_resists(v, contact) ? resistance_law(q, contact, part)
                                           : (struct friction_law){.kind = FRICTION_NONE};
    }
    /* with F_max = 0 the coefficients count as zero, because no event tells that mu F_n passes zero */
    const double largest = contact_maximum_friction_force(v, contact);
    const double share = largest > 0.0 ? 1.0 : 0.0;
    return (struct friction_law){
        .kind = (enum friction)contact_friction(v, contact),
        .coefficient = share * contact_friction_coefficient(v, contact),
        .static_coefficient = share * contact_static_friction_coefficient(v, contact),
        .largest = largest,
        .stiffness =
            stiffens(v, contact) ? mindlin_stiffness(q, contact) : contact_tangential_stiffness(v, contact),
        .tangential = stiffens(v, contact) ? TANGENTIAL_LAW_MINDLIN : TANGENTIAL_LAW_LINEAR,
        .damping = contact_tangential_damping(v, contact),
        .slip_velocity = q->contact[contact].parameters.slip_velocity};
}

/* Adds the smallest rotation that takes the body's axis to `axis`; none where `axis` is zero. */
static struct quaternion turned_to(struct quaternion orientation, struct vec3 axis)
{
    if (!(vec3_max_abs(axis) > 0.0)) {
        return orientation;
    }
    const struct quaternion turn =
        quaternion_between(quaternion_third_axis(orientation), vec3_scale(1.0 / vec3_norm(axis), axis));
    return quaternion_unit(quaternion_product(turn, orientation));
}

/* Returns the orientation q at `clock` from that at 0, under the angular velocity omega(t) = sum omega_i
 * t^i. */
static struct quaternion turned_by(const struct vec3 *omega, double clock, struct quaternion q)
{
    if (clock == 0.0) {
        return q;
    }
    if (path_is_steady(omega, 3)) { /* the angular velocity is constant */
        return quaternion_unit(quaternion_product(quaternion_of_rotation(vec3_scale(clock, omega[0])), q));
    }
    return rotor_turned_after(omega, q, clock);
}

struct body_turn turning_prescribed_at(const struct scene_state *q, double clock, int body)
{
    const struct body_path *path = &q->path[body];
    struct body_turn at = {quaternion_identity(), path_at(path->angular_velocity, 3, clock)};
    if (body_is_compound(body) && path->turn_follows == TURN_FOLLOWS_AXIS_ALONE) {
        at.orientation = quaternion_unit(path->orientation);
    } else if (path->turn_follows != TURN_FOLLOWS_AXIS_ALONE) {
        at.orientation = turned_by(path->angular_velocity, clock, q->turn_origin[body].orientation);
    }
    if (body_has_axis(body) && path->turn_follows != TURN_FOLLOWS_VELOCITY) {
        at.orientation = turned_to(at.orientation, path_at(path->axis, 3, clock));
    }
    return at;
}

/* Moves turn_origin of all bodies that turn to the present. */
static void turning_rebase(struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_turns_freely(q->v, i)) {
            q->turn_origin[i] = q->turning.body[i];
        } else if (body_turn_is_prescribed(q->v, i)) {
            q->turn_origin[i] = turning_prescribed_at(q, q->clock, i);
            q->turning.body[i] = q->turn_origin[i];
        }
    }
}

void turning_take_axes(struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_turn_is_prescribed(q->v, i)) {
            struct body_turn *origin = &q->turn_origin[i];
            if (body_is_compound(i)) { /* both signs are one orientation; outputs are continuous */
                const struct quaternion given = quaternion_unit(q->path[i].orientation);
                const double sign = quaternion_dot(given, origin->orientation) < 0.0 ? -1.0 : 1.0;
                origin->orientation = quaternion_scale(sign, given);
            } else if (body_has_axis(i)) {
                origin->orientation = turned_to(origin->orientation, q->path[i].axis[0]);
            }
            origin->angular_velocity = q->path[i].angular_velocity[0];
            q->turning.body[i] = *origin;
        }
    }
}

static struct body_turn turn_at(const struct scene_state *q, double clock, int body)
{
    if (body_turn_is_prescribed(q->v, body)) {
        return turning_prescribed_at(q, clock, body);
    }
    if (!SCENE_ANY_ROTATION) {
        return (struct body_turn){quaternion_identity(), vec3_make(0.0, 0.0, 0.0)};
    }
    /* an importer's integrator may set the turn of a body that does not turn freely all the same */
    if (!body_turns_freely(q->v, body)) {
        return q->turn_origin[body];
    }
    struct body_turn turn = q->turning.body[body];
    turn.orientation = quaternion_unit(turn.orientation); /* an importer's integrator lets its length drift */
    return turn;
}

/* Sets arms and slip of a contact whose geometry is known, by its shape. */
static void put_arms_and_slip(const struct contact_shape *shape, int contact, struct scene_instant *at)
{
    struct turning_instant *turning = &at->turning;
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct vec3 arm =
        contact_source_arm(shape, g->normal, contact_foot(shape, g->zone, at->separation[contact]));
    turning->source_arm[contact] = arm;
    turning->destination_arm[contact] = vec3_sub(arm, at->separation[contact]);
    const struct vec3 past =
        vec3_sub(vec3_cross(turning->body[source].angular_velocity, arm),
                 vec3_cross(turning->body[destination].angular_velocity, turning->destination_arm[contact]));
    const struct vec3 slip = vec3_sub(past, at->rate[contact]);
    /* The part along n is taken away twice. After the first time rounding of the speeds is left along n, and
     * friction with a small v_0 would make a force of it. */
    const struct vec3 across = vec3_axpy(slip, -vec3_dot(slip, g->normal), g->normal);
    turning->slip[contact] = vec3_axpy(across, -vec3_dot(across, g->normal), g->normal);
    if (SCENE_ANY_COMPOUND) { /* until here the arms are from the centres of the spheres */
        turning->source_arm[contact] = vec3_add(arm, scene_lever(at, contact, 0));
        turning->destination_arm[contact] =
            vec3_add(turning->destination_arm[contact], scene_lever(at, contact, 1));
    }
}

struct vec3 turning_spin(const struct scene_instant *at, int contact)
{
    return vec3_sub(at->turning.body[contact_source(contact)].angular_velocity,
                    at->turning.body[contact_destination(contact)].angular_velocity);
}

double turning_spin_size(const struct scene_instant *at, int contact)
{
    return vec3_norm(at->turning.body[contact_source(contact)].angular_velocity) +
           vec3_norm(at->turning.body[contact_destination(contact)].angular_velocity);
}

static void put_torques(struct scene_instant *at, int contact)
{
    struct turning_instant *turning = &at->turning;
    const struct vec3 force = at->source_force[contact];
    turning->source_torque[contact] = vec3_cross(turning->source_arm[contact], force);
    turning->destination_torque[contact] = vec3_cross(force, turning->destination_arm[contact]);
    if (contact_resists(at->v, contact)) {
        const struct vec3 resistance = turning->resistance[contact];
        turning->source_torque[contact] = vec3_add(turning->source_torque[contact], resistance);
        turning->destination_torque[contact] = vec3_sub(turning->destination_torque[contact], resistance);
    }
}

/* Sets friction and torques of a contact whose slip and normal force are known. Adds friction to the force on
 * the source. */
static void turning_of_contact(int contact, struct scene_instant *at)
{
    struct turning_instant *turning = &at->turning;
    const bool rubs = contact_rubs(at->v, contact) && at->q->contact[contact].regime != (int32_t)REGIME_APART;
    turning->friction_force[contact] = vec3_make(0.0, 0.0, 0.0);
    if (SCENE_ANY_ROLLING) {
        turning->resistance[contact] = vec3_make(0.0, 0.0, 0.0);
    }
    for (int i = 0; rubs && i < contact_opposed(at->v, contact); ++i) {
        const struct friction_law law = scene_friction_law(at->q, contact, i);
        const enum friction_regime regime = (enum friction_regime)at->q->contact[contact].friction_regime[i];
        struct vec3 *sum = &turning->friction_force[contact];
        if (SCENE_ANY_ROLLING && i != OPPOSED_SLIP) {
            sum = &turning->resistance[contact];
        }
        *sum = vec3_add(*sum, friction_force(&law, regime, turning_rubbing(at, contact, i)));
    }
    at->source_force[contact] = vec3_add(at->source_force[contact], turning->friction_force[contact]);
    put_torques(at, contact);
}

void turning_complete(struct scene_instant *at)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        at->turning.body[i] = turn_at(at->q, at->clock, i);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_shape shape = scene_contact_shape(at->q, j);
        put_arms_and_slip(&shape, j, at);
        turning_of_contact(j, at);
    }
}

/* Without a spring the non-adhesive and the approach-only dashpot both end the force when the bodies stop
 * approaching. Non-adhesive is taken, because flight handles its separating regime in closed form. */
struct contact_law scene_contact_law(const struct scene_state *q, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    struct contact_law law = {.stiffness = state->parameters.factors.k,
                              .damping = scene_damps_by_onset(q->v, contact) ? state->onset_damping
                                                                             : state->parameters.factors.c,
                              .dashpot = (enum dashpot)contact_dashpot(q->v, contact),
                              .law = (enum contact_force_law)contact_law(q->v, contact)};
    if (law.dashpot == DASHPOT_APPROACH_ONLY && !(law.stiffness > 0.0)) {
        law.dashpot = DASHPOT_NON_ADHESIVE;
    }
    return law;
}

/* Returns the displacement of a body at clock 0. */
static struct vec3 origin_of(const struct scene_state *q, int body)
{
    if (body_is_free(q->v, body)) {
        return q->origin[body].displacement;
    }
    if (body_is_prescribed(q->v, body)) {
        return q->path[body].displacement[0];
    }
    return vec3_make(0.0, 0.0, 0.0);
}

struct vec3 scene_displacement_of(const struct scene_state *q, int body, struct vec3 moved)
{
    return vec3_add(origin_of(q, body), moved);
}

struct body_state scene_body_at(const struct scene_state *q, double clock, int body)
{
    if (body_is_free(q->v, body)) {
        return q->body[body];
    }
    if (body_is_prescribed(q->v, body)) {
        const struct body_path *path = &q->path[body];
        return (struct body_state){vec3_scale(clock, path_at(path->displacement + 1, 3, clock)),
                                   path_at(path->velocity, 3, clock)};
    }
    return (struct body_state){.moved = {0.0, 0.0, 0.0}};
}

/* Returns the rate of the separation c in the frame of the contact's shape [m/s], which turns with the
 * destination. The shape of skew cylinders does not turn, because both turn about their own axes only. */
static struct vec3 rate_in_destination(const struct scene_instant *at, int contact)
{
    if (body_turns(at->v, contact_destination(contact)) && !contact_has_skew_axes(at->v, contact)) {
        const struct vec3 omega = at->turning.body[contact_destination(contact)].angular_velocity;
        return vec3_sub(at->rate[contact], vec3_cross(omega, at->separation[contact]));
    }
    return at->rate[contact];
}

/* Sets the separation of a contact and its rate. The undeformed locations are subtracted first, then the
 * displacements at clock 0, then the displacements since: large common parts cancel before small ones are
 * added. Where a sphere is a part of a compound, its centre is at the end of a lever arm R o, which moves at
 * omega x R o. */
static void put_separation(int contact, struct scene_instant *at)
{
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct vec3 apart = vec3_sub(body_center(at->v, destination), body_center(at->v, source));
    const struct vec3 start =
        vec3_add(apart, vec3_sub(origin_of(at->q, destination), origin_of(at->q, source)));
    at->separation[contact] = vec3_add(start, vec3_sub(at->moved[destination], at->moved[source]));
    at->rate[contact] = vec3_sub(at->velocity[destination], at->velocity[source]);
    for (int end = 0; SCENE_ANY_COMPOUND && end < 2; ++end) {
        const struct vec3 lever = scene_lever(at, contact, end);
        const struct vec3 omega = at->turning.body[end == 0 ? source : destination].angular_velocity;
        const double sign = end == 0 ? -1.0 : 1.0;
        at->separation[contact] = vec3_axpy(at->separation[contact], sign, lever);
        at->rate[contact] = vec3_axpy(at->rate[contact], sign, vec3_cross(omega, lever));
    }
}

/* Whether a contact counts for an integrator. */
static inline bool is_met(const bool *met, int contact)
{
    return SCENE_CONTACTS == 1 || met == NULL || met[contact];
}

/* A distance d may count as zero only below this fraction of the bodies' size (contact_reach, gap_terms). */
static const double CENTRE = 1e-9;

/* Keeps the last valid n of a source that is led along in the centre, where rounding would turn n. At a
 * circle n stays across it. */
CONTACT_COLD CONTACT_NOINLINE static void keep_normal(int contact, struct vec3 rate, struct scene_instant *at)
{
    const struct contact_shape shape = scene_shape_met(at, contact);
    struct contact_geometry *g = &at->geometry[contact];
    struct vec3 last = at->q->contact[contact].physics.normal;
    if (contact_is_circle(&shape)) {
        last = vec3_axpy(last, -vec3_dot(last, g->circumferential), g->circumferential);
    }
    if (rounding_of_normal(at, contact) >= 1.0) {
        g->degenerate = true;
        g->normal = singularity_escape(&shape, last, shape.axis, g->normal);
        g->gap_rate = shape.side * vec3_dot(g->normal, rate);
    }
}

void scene_meet(const bool *met, struct scene_instant *at)
{
    const bool turns = scene_turns(at->v);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!is_met(met, j)) {
            continue;
        }
        put_separation(j, at);
        const struct contact_shape shape = scene_contact_shape_at(at, j);
        const struct vec3 rate = rate_in_destination(at, j);
        struct contact_geometry *g = &at->geometry[j];
        *g = contact_geometry_at(&shape, at->separation[j], rate, at->q->contact[j].physics.normal);
        if (SCENE_ANY_CURVED && g->distance < CENTRE * g->gap_terms && contact_is_prescribed(at->v, j)) {
            keep_normal(j, rate, at);
        }
        if (turns) {
            put_arms_and_slip(&shape, j, at);
        }
    }
}

void scene_place_body(struct body_state state, int body, struct scene_instant *at)
{
    at->moved[body] = state.moved;
    at->displacement[body] = scene_displacement_of(at->q, body, state.moved);
    at->velocity[body] = state.velocity;
}

void scene_place_bodies(const struct scene_state *q, double clock, struct scene_instant *at)
{
    const bool turns = scene_turns(q->v);
    at->v = q->v;
    at->q = q;
    at->clock = clock;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        scene_place_body(scene_body_at(q, clock, i), i, at);
        if (turns) {
            at->turning.body[i] = turn_at(q, clock, i);
        }
    }
    if (SCENE_ANY_TURNING) {
        memcpy(at->turning.spring, q->turning.spring, sizeof at->turning.spring);
    }
}

/* Sets the accelerations without contact forces. */
static inline void put_accelerations(struct scene_instant *at)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        at->acceleration[i] = body_is_free(at->v, i) ? vec3_axpy(gravity(at->v), 1.0 / body_mass(at->v, i),
                                                                 path_at(at->q->path[i].force, 3, at->clock))
                              : body_is_prescribed(at->v, i) ? path_slope(at->q->path[i].velocity, at->clock)
                                                             : vec3_make(0.0, 0.0, 0.0);
    }
}

/* Adds the force of a contact to the accelerations of its bodies. */
static inline void accelerate(int contact, struct scene_instant *at)
{
    const struct vec3 force = at->source_force[contact];
    struct vec3 *source = &at->acceleration[contact_source(contact)];
    struct vec3 *destination = &at->acceleration[contact_destination(contact)];
    *source = vec3_axpy(*source, body_inverse_mass(at->v, contact_source(contact)), force);
    *destination = vec3_axpy(*destination, -body_inverse_mass(at->v, contact_destination(contact)), force);
}

/* Sets the forces and torques of a contact that is left out. */
static void leave_out(int contact, struct scene_instant *at)
{
    const struct vec3 zero = {0.0, 0.0, 0.0};
    at->normal_force[contact] = 0.0;
    at->source_force[contact] = zero;
    if (SCENE_ANY_TURNING) {
        at->turning.slip[contact] = at->turning.friction_force[contact] = zero;
        at->turning.resistance[contact] = zero;
        at->turning.source_torque[contact] = at->turning.destination_torque[contact] = zero;
    }
}

void scene_forces(const bool *met, struct scene_instant *at)
{
    const bool turns = scene_turns(at->v);
    put_accelerations(at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!is_met(met, j)) {
            leave_out(j, at);
            continue;
        }
        const struct contact_geometry *g = &at->geometry[j];
        const enum contact_regime regime = (enum contact_regime)at->q->contact[j].regime;
        at->normal_force[j] = 0.0;
        if (regime != REGIME_APART) {
            const struct contact_law law = scene_contact_law(at->q, j);
            at->normal_force[j] = contact_force(&law, regime, g->gap, g->gap_rate);
        }
        at->source_force[j] = vec3_scale(-scene_contact_side(at->q, j) * at->normal_force[j], g->normal);
        if (SCENE_ANY_TURNING && turns) {
            turning_of_contact(j, at);
        }
        accelerate(j, at);
    }
}

void scene_put_contact_forces(const struct vec3 *force, const struct vec3 *torque, const bool *met,
                              struct scene_instant *at)
{
    put_accelerations(at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!is_met(met, j)) {
            leave_out(j, at);
            continue;
        }
        const struct vec3 e = vec3_scale(scene_contact_side(at->q, j), at->geometry[j].normal);
        at->source_force[j] = force[j];
        at->normal_force[j] = -vec3_dot(force[j], e);
        accelerate(j, at);
        if (scene_turns(at->v)) {
            at->turning.friction_force[j] = vec3_axpy(force[j], at->normal_force[j], e);
            if (SCENE_ANY_ROLLING) {
                at->turning.resistance[j] = torque[j];
            }
            put_torques(at, j);
        }
    }
}

double body_inverse_mass(const struct scene_values *v, int body)
{
    return body_is_free(v, body) ? 1.0 / body_mass(v, body) : 0.0;
}

double scene_inverse_mass(const struct scene_values *v, int contact)
{
    return body_inverse_mass(v, contact_source(contact)) + body_inverse_mass(v, contact_destination(contact));
}

struct contact_impulses scene_impulse_rates(const struct scene_instant *at, int contact)
{
    struct contact_impulses rates = {.force = at->source_force[contact]};
    if (scene_turns(at->v)) {
        rates.destination_torque = at->turning.destination_torque[contact];
        rates.source_torque = at->turning.source_torque[contact];
    } else if (body_shape(contact_destination(contact)) != SHAPE_SPHERE) {
        rates.destination_torque = vec3_cross(at->separation[contact], at->source_force[contact]);
    }
    return rates;
}

/* Returns the power [W] that the drives of prescribed motions and rotations spend against a contact. */
static double driving_power(const struct scene_instant *at, int contact)
{
    double power = 0.0;
    for (int end = 0; end < 2; ++end) {
        const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
        if (body_is_prescribed(at->v, body)) {
            const double along = vec3_dot(at->source_force[contact], at->velocity[body]);
            power += end == 0 ? -along : along;
        }
        if (body_turn_is_prescribed(at->v, body)) {
            power -= vec3_dot(end == 0 ? at->turning.source_torque[contact]
                                       : at->turning.destination_torque[contact],
                              at->turning.body[body].angular_velocity);
        }
    }
    return power;
}

static double size_along(struct vec3 axis, struct vec3 a)
{
    return fabs(axis.x * a.x) + fabs(axis.y * a.y) + fabs(axis.z * a.z);
}

/* Returns the sum of the lengths of the lever arms of a contact's spheres [m]. */
static double size_of_levers(int contact)
{
    return SCENE_ANY_COMPOUND
               ? vec3_norm(contact_source_part(contact)) + vec3_norm(contact_destination_part(contact))
               : 0.0;
}

/* Returns the sum of the sizes of the terms of c along an axis [m]. */
static double terms_along(const struct scene_instant *at, int contact, struct vec3 axis)
{
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct vec3 apart = vec3_sub(body_center(at->v, destination), body_center(at->v, source));
    return size_along(axis, apart) + size_along(axis, at->displacement[source]) +
           size_along(axis, at->displacement[destination]) + size_of_levers(contact);
}

double rounding_of_gap(const struct scene_instant *at, int contact)
{
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct contact_geometry *g = &at->geometry[contact];
    if (!SCENE_ANY_CURVED || body_shape(destination) == SHAPE_PLANE) {
        /* components in the plane do not count */
        return 8.0 * DBL_EPSILON * (terms_along(at, contact, g->normal) + g->gap_terms);
    }
    const struct vec3 apart = vec3_sub(body_center(at->v, destination), body_center(at->v, source));
    return 8.0 * DBL_EPSILON *
           (vec3_max_abs(apart) + vec3_max_abs(at->displacement[source]) +
            vec3_max_abs(at->displacement[destination]) + size_of_levers(contact) + g->gap_terms);
}

double rounding_of_axial(const struct scene_instant *at, int contact, const struct contact_shape *shape)
{
    const double all = contact_is_torus(shape) ? rounding_of_gap(at, contact) : 0.0;
    return all + 8.0 * DBL_EPSILON * (terms_along(at, contact, shape->axis) + shape->half_length);
}

double rounding_of_rate(const struct scene_instant *at, int contact)
{
    const double source = vec3_norm(at->velocity[contact_source(contact)]);
    const double destination = vec3_norm(at->velocity[contact_destination(contact)]);
    if (SCENE_ANY_COMPOUND) {
        const double turning = turning_spin_size(at, contact);
        return 8.0 * DBL_EPSILON * (source + destination + size_of_levers(contact) * turning);
    }
    return 8.0 * DBL_EPSILON * fmax(vec3_norm(at->rate[contact]), fmax(source, destination));
}

double rounding_of_normal(const struct scene_instant *at, int contact)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const bool on_plane = !SCENE_ANY_CURVED || body_shape(contact_destination(contact)) == SHAPE_PLANE ||
                          (SCENE_ANY_CAPS && abs(g->zone) == ZONE_CAP);
    return on_plane ? 0.0 : rounding_of_gap(at, contact) / fabs(g->distance);
}

double rounding_of_force(const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_slopes slopes = contact_force_slopes(&law, REGIME_COMPRESSION, g->gap, g->gap_rate);
    const double angle = fmin(8.0 * DBL_EPSILON + rounding_of_normal(at, contact), 1.0);
    return fabs(slopes.by_gap) * rounding_of_gap(at, contact) +
           angle * (fabs(slopes.by_rate) * vec3_norm(at->rate[contact]) + fabs(at->normal_force[contact]));
}

/* The sign of g' means nothing below the sum of the rounding of w, the rounding of n, the speed of an
 * oscillation as large as the gap's rounding bound, and the integrator's tolerance. */
double rounding_of_event(const struct scene_instant *at, int contact, double tolerated)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const double of_gap = rounding_of_gap(at, contact);
    const double angle = g->degenerate ? 0.0 : fmin(rounding_of_normal(at, contact), 1.0);
    const double spring = -contact_force_slopes(&law, REGIME_COMPRESSION, g->gap, g->gap_rate).by_gap;
    const double oscillation = sqrt(fmax(spring, 0.0) * scene_inverse_mass(at->v, contact));
    const double of_rate = vec3_norm(at->rate[contact]) * angle + rounding_of_rate(at, contact) +
                           oscillation * of_gap + tolerated;
    const struct contact_slopes slopes =
        contact_event_slopes(&law, (enum contact_regime)at->q->contact[contact].regime);
    return fabs(slopes.by_gap) * of_gap + fabs(slopes.by_rate) * of_rate;
}

double rounding_margin_offset(const struct scene_instant *at, int contact, double tolerated)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const enum contact_regime regime = (enum contact_regime)at->q->contact[contact].regime;
    const double event = contact_event(&law, regime, g->gap, g->gap_rate);
    return 2.0 * (fmax(-event, 0.0) + rounding_of_event(at, contact, tolerated));
}

/* Returns the accumulated gap [m], or DBL_MAX or INFINITY where none is known. */
static double accumulated_gap_of(const struct scene_state *q, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    if (contact_transmits(q, contact) || q->clock == 0.0) {
        return state->physics.accumulated_gap;
    }
    return q->clock == state->schedule.change_clock ? state->schedule.change_gap : (double)INFINITY;
}

/* Puts accumulated gaps and carried rates into the present instant. The penetration of a stiff contact at
 * rest is less than the rounding of d, so that the accumulated gap is needed. An accumulated gap that differs
 * from the one of positions by more than rounding is not used, because it shows that positions have been
 * changed since. */
static void scene_put_known_gaps(struct scene_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const double known = accumulated_gap_of(at->q, j);
        if (known < DBL_MAX && fabs(known - at->geometry[j].gap) <= rounding_of_gap(at, j)) {
            at->geometry[j].gap = known;
        }
        /* The rounding of velocities alone may make a force larger than the load, so that the carried rate is
         * needed. A larger difference shows that velocities have been changed since. */
        const struct contact_physics *physics = &at->q->contact[j].physics;
        if (contact_transmits(at->q, j) &&
            fabs(physics->carried_rate - at->geometry[j].gap_rate) < physics->rate_rounding) {
            at->geometry[j].gap_rate = physics->carried_rate;
        }
    }
}

bool scene_gap_is_accumulated(const struct scene_instant *at, int contact)
{
    return at->geometry[contact].gap == accumulated_gap_of(at->q, contact);
}

bool scene_rate_is_known(const struct scene_instant *at, int contact)
{
    const struct contact_state *state = &at->q->contact[contact];
    return state->physics.rate_rounding > 0.0 && contact_transmits(at->q, contact) &&
           at->geometry[contact].gap_rate == state->physics.carried_rate;
}

struct vec3 body_part_that_turns(const struct scene_values *v, int body, struct vec3 a)
{
    if (!body_keeps_axis(body)) {
        return a;
    }
    const struct vec3 e = body_unit_axis(v, body);
    return vec3_scale(vec3_dot(a, e), e);
}

void contact_load_add(int contact, int body, struct vec3 force, struct vec3 source_torque,
                      struct vec3 destination_torque, struct contact_load *sum)
{
    if (contact_source(contact) == body) {
        sum->force = vec3_add(sum->force, force);
        sum->torque = vec3_add(sum->torque, source_torque);
    }
    if (contact_destination(contact) == body) {
        sum->force = vec3_sub(sum->force, force);
        sum->torque = vec3_add(sum->torque, destination_torque);
    }
}

struct vec3 turning_torque_on(const struct scene_instant *at, int body)
{
    struct contact_load sum = {.force = {0.0, 0.0, 0.0}};
    struct vec3 torque = {0.0, 0.0, 0.0};
    if (body_turns_freely(at->v, body)) {
        torque = path_at(at->q->path[body].torque, 3, at->clock);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        contact_load_add(j, body, at->source_force[j], at->turning.source_torque[j],
                         at->turning.destination_torque[j], &sum);
    }
    return body_part_that_turns(at->v, body, vec3_add(torque, sum.torque));
}

struct vec3 turning_acceleration(const struct scene_instant *at, int body)
{
    if (body_turn_is_prescribed(at->v, body)) {
        return path_slope(at->q->path[body].angular_velocity, at->clock);
    }
    if (!body_turns_freely(at->v, body)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    const struct body_turn *turn = &at->turning.body[body];
    const struct vec3 torque = turning_torque_on(at, body);
    const struct vec3 gyration = vec3_cross(turn->angular_velocity, body_spin_of(at->v, body, turn));
    const struct vec3 by_torque = vec3_scale(1.0 / body_inertia_of(at->v, body).x, torque);
    return body_rotation_of(at->v, body, turn->orientation, vec3_sub(by_torque, gyration));
}

struct turning_laws turning_laws_of(const struct scene_state *q, int contact)
{
    struct turning_laws laws = {.normal = scene_contact_law(q, contact),
                                .regime = (enum contact_regime)q->contact[contact].regime};
    for (int i = 0; i < OPPOSED; ++i) {
        laws.rubbing[i] = scene_friction_law(q, contact, i);
        laws.rubbing_regime[i] = SCENE_ANY_FRICTION
                                     ? (enum friction_regime)q->contact[contact].friction_regime[i]
                                     : FRICTION_LIFTED;
    }
    return laws;
}

struct friction_state turning_rubbing(const struct scene_instant *at, int contact, int part)
{
    struct vec3 motion = at->turning.slip[contact];
    if (SCENE_ANY_ROLLING && part != OPPOSED_SLIP) {
        motion = opposed_laid((enum opposed)part, turning_spin(at, contact), at->geometry[contact].normal);
    }
    return (struct friction_state){.normal_force = at->normal_force[contact],
                                   .slip = motion,
                                   .spring = at->turning.spring[contact][part],
                                   .depth = -at->geometry[contact].gap,
                                   .depth_rate = -at->geometry[contact].gap_rate};
}

struct vec3 turning_normal_rate(const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_shape_met(at, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct vec3 omega = at->turning.body[contact_destination(contact)].angular_velocity;
    const struct vec3 turned =
        contact_is_skew(&shape) ? vec3_make(0.0, 0.0, 0.0) : vec3_cross(omega, g->normal);
    if (!contact_turns(&shape, g)) {
        return turned;
    }
    const struct vec3 across = contact_turning_part(&shape, g, rate_in_destination(at, contact));
    return vec3_axpy(turned, 1.0 / g->distance, across);
}

struct vec3 turning_spring_rate(const struct scene_instant *at, int contact, int part)
{
    const struct friction_law law = scene_friction_law(at->q, contact, part);
    const struct friction_state rubbing = turning_rubbing(at, contact, part);
    if (at->q->contact[contact].regime == (int32_t)REGIME_APART) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    const enum friction_regime regime = (enum friction_regime)at->q->contact[contact].friction_regime[part];
    const struct vec3 force = friction_force(&law, regime, rubbing);
    return vec3_add(friction_spring_rate(&law, regime, rubbing, force),
                    opposed_turned((enum opposed)part, rubbing.spring, at->geometry[contact].normal,
                                   turning_normal_rate(at, contact)));
}

/* Returns the acceleration of a body, or of the centre of its part that a contact meets [m/s^2]. */
static struct vec3 acceleration_of_end(const struct scene_instant *at, int contact, int end)
{
    const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
    if (!body_is_compound(body)) {
        return at->acceleration[body];
    }
    const struct vec3 lever = scene_lever(at, contact, end);
    const struct vec3 omega = at->turning.body[body].angular_velocity;
    const struct vec3 faster = vec3_cross(turning_acceleration(at, body), lever);
    const struct vec3 inward = vec3_cross(omega, vec3_cross(omega, lever));
    return vec3_add(at->acceleration[body], vec3_add(faster, inward));
}

/*
 * g'' = side (n'.w_g + n.w_g') with the rate w_g of c as the destination sees it, which turns with omega:
 *   w_g = w - omega x c,   w_g' = a_dst - a_src - omega' x c - omega x w,   n' = omega x n + T w_g / d
 */
double scene_gap_acceleration(const struct scene_instant *at, int contact)
{
    const int destination = contact_destination(contact);
    const struct contact_shape shape = scene_shape_met(at, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct vec3 seen = rate_in_destination(at, contact);
    struct vec3 change = vec3_sub(acceleration_of_end(at, contact, 1), acceleration_of_end(at, contact, 0));
    double turned = 0.0;
    if (scene_turns(at->v) && !contact_is_skew(&shape)) {
        const struct vec3 c = at->separation[contact];
        const struct vec3 omega = at->turning.body[destination].angular_velocity;
        const struct vec3 faster = turning_acceleration(at, destination);
        change = vec3_sub(change, vec3_add(vec3_cross(faster, c), vec3_cross(omega, at->rate[contact])));
        turned = vec3_dot(vec3_cross(omega, g->normal), seen);
    }
    turned += contact_turns(&shape, g) ? contact_turning_rate(&shape, g, seen) / g->distance : 0.0;
    return shape.side * (vec3_dot(g->normal, change) + turned);
}

double scene_pressing_acceleration(const struct scene_instant *at, int contact)
{
    const double own = at->normal_force[contact] * scene_inverse_mass(at->v, contact);
    return fmax(own - scene_gap_acceleration(at, contact), 0.0);
}

double turning_normal_force_rate(const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const double gap = fmin(g->gap, -FRICTION_LEAST_DEPTH);
    const struct contact_slopes slopes =
        contact_force_slopes(&law, (enum contact_regime)at->q->contact[contact].regime, gap, g->gap_rate);
    const double by_rate = slopes.by_rate == 0.0 ? 0.0 : slopes.by_rate * scene_gap_acceleration(at, contact);
    return slopes.by_gap * g->gap_rate + by_rate;
}

bool singularity_is_reached(const struct scene_instant *at, int contact, const struct contact_shape *shape)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const double reach = contact_reach(shape);
    if (!SCENE_ANY_CURVED || g->degenerate || !contact_may_reach_centre(shape)) {
        return SCENE_ANY_CURVED && g->degenerate;
    }
    return reach + g->gap <= 16.0 * DBL_EPSILON * reach ||
           (g->distance <= CENTRE * reach && g->distance <= rounding_of_gap(at, contact));
}

struct vec3 singularity_escape(const struct contact_shape *shape, struct vec3 rate, struct vec3 acceleration,
                               struct vec3 held)
{
    const struct vec3 ways[] = {contact_across(shape, rate), contact_across(shape, acceleration)};
    for (int i = 0; i < 2; ++i) {
        const double size = vec3_norm(ways[i]);
        if (size > 0.0) {
            return vec3_make(ways[i].x / size, ways[i].y / size, ways[i].z / size);
        }
    }
    return held;
}

double singularity_rate(const struct scene_instant *at, int contact)
{
    const struct contact_geometry *g = &at->geometry[contact];
    if (!SCENE_ANY_CURVED || g->distance > -g->gap) { /* less than half-way to the centre */
        return g->gap_rate;
    }
    const struct contact_shape shape = scene_shape_met(at, contact);
    const struct vec3 w = contact_across(&shape, at->rate[contact]);
    return (contact_is_circle(&shape) && g->distance <= rounding_of_gap(at, contact)) ||
                   singularity_is_reached(at, contact, &shape)
               ? shape.side * vec3_norm(vec3_axpy(w, -vec3_dot(w, g->circumferential), g->circumferential))
               : g->gap_rate;
}

double scene_outward_force(const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    return contact_force(&law, (enum contact_regime)at->q->contact[contact].regime, at->geometry[contact].gap,
                         singularity_rate(at, contact));
}

void zones_follow(struct scene_state *q, const struct scene_instant *at, int contact)
{
    struct contact_state *state = &q->contact[contact];
    const bool is_located = contact_is_prescribed(at->v, contact)
                                ? !SCENE_ANY_FREE || scene_turns(at->v)
                                : state->regime == (int32_t)REGIME_SEPARATING;
    if (state->regime == (int32_t)REGIME_APART || is_located) {
        state->zone = 0;
    } else if (SCENE_ANY_ZONES && state->zone == 0) {
        state->zone = at->geometry[contact].zone;
    }
}

bool zones_pass(struct scene_state *q, const struct scene_instant *at, int contact)
{
    const int zone = q->contact[contact].zone;
    if (!SCENE_ANY_ZONES || zone == 0) {
        return false;
    }
    const struct contact_shape shape = scene_contact_shape_at(at, contact);
    const struct vec3 c = at->separation[contact];
    const double outside = -zones_margin(at, contact);
    const double rounding = fmax(rounding_of_gap(at, contact), fabs(outside));
    /* the integrator of an importer may find the edge late */
    const int next =
        outside > 2.0 * rounding_of_gap(at, contact)
            ? contact_zone_at(&shape.solid, 0, c)
            : contact_zone_next(&shape.solid, zone, c, rate_in_destination(at, contact), rounding);
    q->contact[contact].zone = next;
    return contact_zone_jumps(&shape.solid, zone, next, c, at->geometry[contact].distance, rounding);
}

double zones_margin(const struct scene_instant *at, int contact)
{
    const int zone = at->q->contact[contact].zone;
    if (!SCENE_ANY_ZONES || zone == 0) {
        return 1.0;
    }
    const struct contact_shape shape = scene_contact_shape_at(at, contact);
    return contact_zone_margin(&shape.solid, zone, at->separation[contact]);
}

CONTACT_NOT_FUSED CONTACT_FLATTEN void scene_kinematics_now(const struct scene_state *q,
                                                            struct scene_instant *at)
{
    scene_place_bodies(q, q->clock, at);
    scene_meet(NULL, at);
    if (SCENE_ANY_FREE) {
        scene_put_known_gaps(at);
    }
}

void scene_now(const struct scene_state *q, struct scene_instant *at)
{
    scene_kinematics_now(q, at);
    scene_forces(NULL, at);
}

enum contact_regime scene_regime(const struct scene_instant *at, int contact, bool touching)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const struct contact_shape shape = scene_contact_shape(at->q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const double rate = singularity_rate(at, contact);
    return contact_regime_of(&law, touching ? fmin(g->gap, -DBL_MIN) : g->gap, rate,
                             touching || scene_beyond_ends(&shape, g) <= 0.0);
}

/* Returns the square of the speed at the touch [m^2/s^2] that the present speed and stored energy give. */
static double own_speed_squared(const struct scene_instant *at, int contact)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_law law = scene_contact_law(at->q, contact);
    const double stored = contact_stored_energy(&law, REGIME_COMPRESSION, g->gap);
    return g->gap_rate * g->gap_rate + 2.0 * stored * scene_inverse_mass(at->v, contact);
}

/*
 * Returns the speed at the onset [m/s]. A load that gives the acceleration a presses the bodies together from
 * rest, by m x'' = m a - k x^(3/2) with the penetration x. The speed v is largest at the depth x_0 where load
 * and contact force balance:
 *   x_0 = (m a/k)^(2/3),   v^2/2 = a x_0 - (2/5) (k/m) x_0^(5/2) = (3/5) a x_0
 */
static double onset_speed(const struct scene_instant *at, int contact)
{
    const double per_mass = scene_inverse_mass(at->v, contact);
    const double speed_squared = own_speed_squared(at, contact);
    if (!(per_mass > 0.0)) {
        return sqrt(speed_squared);
    }
    const struct contact_law law = scene_contact_law(at->q, contact);
    struct scene_instant apart = *at;
    scene_forces(NULL, &apart); /* the contact has no force yet */
    const double a = scene_pressing_acceleration(&apart, contact);
    const double depth = cbrt(pow(a / (contact_factors_of(&law, REGIME_COMPRESSION).k * per_mass), 2.0));
    return sqrt(fmax(speed_squared, 1.2 * a * depth));
}

enum contact_regime onset_note(struct scene_state *q, const struct scene_instant *at, int contact,
                               enum contact_regime next)
{
    struct contact_state *state = &q->contact[contact];
    if (!scene_damps_by_onset(at->v, contact) || next == REGIME_APART ||
        state->regime != (int32_t)REGIME_APART) {
        return next;
    }
    const double damping = state->parameters.factors.c / onset_speed(at, contact);
    state->onset_damping = isfinite(damping) ? damping : 0.0;
    return scene_regime(at, contact, true);
}

/* The factor chi v is given, so that d chi = -chi dv / v, where 2 v dv is the change of v^2. */
struct contact_law onset_law_slope(const struct scene_instant *at, int contact, double gap_slope,
                                   double rate_slope)
{
    const struct contact_state *state = &at->q->contact[contact];
    struct contact_law slope = {.law = LAW_HERTZ};
    if (!scene_damps_by_onset(at->v, contact) || state->regime == (int32_t)REGIME_APART ||
        !(state->onset_damping > 0.0)) {
        return slope;
    }
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_law law = scene_contact_law(at->q, contact);
    const double speed = state->parameters.factors.c / state->onset_damping;
    const double by_load = 1e-9; /* larger relative differences show that the load set the speed */
    if (own_speed_squared(at, contact) < (1.0 - by_load) * speed * speed) {
        return slope;
    }
    const double stored_slope = contact_stored_slope(&law, REGIME_COMPRESSION, g->gap);
    const double half =
        g->gap_rate * rate_slope + stored_slope * scene_inverse_mass(at->v, contact) * gap_slope;
    slope.damping = -state->onset_damping * half / (speed * speed);
    return slope;
}

/* Adds the clock to base + base_tail, by Knuth's two-sum, so that base_tail holds the rounding error
 * exactly. */
static void advance_base(struct scene_state *q)
{
    const double add = q->base_tail + q->clock;
    const double sum = q->base + add;
    const double shadow = sum - q->base;
    q->base_tail = (q->base - (sum - shadow)) + (add - shadow);
    q->base = sum;
    q->clock = 0.0;
}

/* Shifts the stored clocks of contacts to the new origin of the clock. */
static void shift_clocks(struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].record.touch_clock -= q->clock;
        q->contact[j].schedule.change_clock -= q->clock;
        q->contact[j].schedule.dead_band_clock -= q->clock;
        if (q->contact[j].regime == REGIME_APART || q->contact[j].regime == REGIME_SEPARATING) {
            /* The gap after the flight is unknown, unless the change of regime was predicted. */
            q->contact[j].physics.accumulated_gap =
                q->contact[j].schedule.change_clock == 0.0 ? q->contact[j].schedule.change_gap : DBL_MAX;
        }
    }
    q->horizon_clock -= q->clock;
}

void scene_rebase(struct scene_state *q)
{
    q->integrator_fresh = 1;
    if (SCENE_ANY_FREE) {
        q->deferrable_clock = 0.0;
        q->phase.end = 0.0;
    }
    for (int i = 0; SCENE_ANY_FREE && i < SCENE_BODIES; ++i) {
        q->origin[i].displacement = vec3_add(q->origin[i].displacement, q->body[i].moved);
        q->origin[i].velocity = q->body[i].velocity;
        q->body[i].moved = vec3_make(0.0, 0.0, 0.0);
    }
    if (scene_turns(q->v)) {
        turning_rebase(q);
    }
    if (q->clock == 0.0) {
        return;
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        body_path_shift(q->v, i, &q->path[i], q->clock);
    }
    if (SCENE_ANY_FREE) {
        shift_clocks(q);
    }
    advance_base(q);
}

double energy_potential(const struct scene_instant *at, struct vec3 field)
{
    double sum = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(at->v, i)) {
            const double centre = vec3_dot(field, body_center(at->v, i));
            sum -= body_mass(at->v, i) * (centre + vec3_dot(field, at->displacement[i]));
        }
    }
    return sum;
}

double body_rotational_energy(const struct scene_values *v, int body, const struct body_turn *turn)
{
    return 0.5 * body_inertia_of(v, body).x * vec3_dot(turn->angular_velocity, body_spin_of(v, body, turn));
}

double energy_stored(const struct scene_instant *at)
{
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const enum contact_regime regime = (enum contact_regime)at->q->contact[j].regime;
        if (regime != REGIME_APART) {
            const struct contact_law law = scene_contact_law(at->q, j);
            sum += contact_stored_energy(&law, regime, at->geometry[j].gap);
        }
    }
    return sum;
}

struct scene_energies scene_energies_of(const struct scene_instant *at)
{
    struct scene_energies sum = {.potential = energy_potential(at, gravity(at->v)),
                                 .stored = energy_stored(at)};
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(at->v, i)) {
            sum.kinetic += 0.5 * body_mass(at->v, i) * vec3_dot(at->velocity[i], at->velocity[i]);
        }
        if (body_turns_freely(at->v, i)) {
            sum.rotational += body_rotational_energy(at->v, i, &at->turning.body[i]);
        }
    }
    for (int k = 0; k < SCENE_CONTACTS * OPPOSED; ++k) {
        const int j = k / OPPOSED;
        const int part = k % OPPOSED;
        if (contact_has_spring(at->v, j, part) && at->q->contact[j].regime != (int32_t)REGIME_APART) {
            const struct friction_law law = scene_friction_law(at->q, j, part);
            const enum friction_regime regime = (enum friction_regime)at->q->contact[j].friction_regime[part];
            const struct friction_state rubbing = turning_rubbing(at, j, part);
            const struct vec3 spring = friction_spring(&law, regime, rubbing);
            sum.tangential += 0.5 * friction_stiffness(&law, rubbing.depth) * vec3_dot(spring, spring);
        }
    }
    return sum;
}

struct scene_powers scene_powers_of_contact(const struct scene_instant *at, int contact)
{
    const enum contact_regime regime = (enum contact_regime)at->q->contact[contact].regime;
    struct scene_powers power = {.external = driving_power(at, contact)};
    if (regime != REGIME_APART) {
        const struct contact_law law = scene_contact_law(at->q, contact);
        const struct contact_geometry *g = &at->geometry[contact];
        power.dissipated =
            -(at->normal_force[contact] + contact_stored_slope(&law, regime, g->gap)) * g->gap_rate;
    }
    if (contact_rubs(at->v, contact)) {
        power.friction -= vec3_dot(at->turning.friction_force[contact], at->turning.slip[contact]);
    }
    if (contact_resists(at->v, contact)) {
        power.friction -= vec3_dot(at->turning.resistance[contact], turning_spin(at, contact));
    }
    return power;
}
