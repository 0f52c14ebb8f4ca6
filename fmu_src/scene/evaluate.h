/*
 * This file has the scene's bodies and contacts at one instant: positions, geometry, forces and accelerations
 * in the world frame, in SI units. Each free body follows Newton's law: m a = m gravity + external force +
 * contact forces.
 */
#ifndef CONTACT_SCENE_EVALUATE_H
#define CONTACT_SCENE_EVALUATE_H

#include "contact/shape.h"
#include "contact/slopes.h"
#include "math/compiler.h"
#include "scene/scene_state.h"

/* This struct holds rotations and friction at one instant. Where scene_turns they are computed with the
 * forces, else by turning_complete alone. */
struct turning_instant {
    struct body_turn body[SCENE_BODIES];         /* identity and zero for a body that does not turn */
    struct vec3 source_arm[SCENE_CONTACTS];      /* p - x_src = r_s e, of a compound R o + r_s e [m] */
    struct vec3 destination_arm[SCENE_CONTACTS]; /* p - x_dst [m] */
    struct vec3 slip[SCENE_CONTACTS];            /* v_t [m/s] */
    struct vec3 friction_force[SCENE_CONTACTS];  /* F_t, part of the force on the source [N] */
    /* the torque M by which a contact resists rolling and spinning, a part of source_torque [N m] */
    struct vec3 resistance[SCENE_CONTACTS];
    struct vec3 source_torque[SCENE_CONTACTS], destination_torque[SCENE_CONTACTS]; /* [N m] */
    struct vec3 spring[SCENE_CONTACTS][OPPOSED]; /* as in struct turning_state */
};

struct scene_instant {
    /* The instant belongs to these values and to this state, which must live as long as it does.
     * scene_place_bodies sets them and the clock. */
    const struct scene_values *v;
    const struct scene_state *q;
    double clock;                           /* [s] */
    struct vec3 displacement[SCENE_BODIES]; /* u [m] */
    struct vec3 moved[SCENE_BODIES];        /* the part of u since clock 0 [m] */
    struct vec3 velocity[SCENE_BODIES];     /* v [m/s] */
    struct vec3 acceleration[SCENE_BODIES]; /* zero for a fixed body [m/s^2] */
    struct contact_geometry geometry[SCENE_CONTACTS];
    /* c = x_dst - x_src and w = v_dst - v_src of the centres; where a body is a compound, of its part */
    struct vec3 separation[SCENE_CONTACTS];   /* [m] */
    struct vec3 rate[SCENE_CONTACTS];         /* [m/s] */
    double normal_force[SCENE_CONTACTS];      /* F_n of the smooth law of the regime [N] */
    struct vec3 source_force[SCENE_CONTACTS]; /* contact force, friction included [N] */
    struct turning_instant turning;
};

/* scene_contact_shape returns the shape of a contact; where the shape is divided into zones and the bodies
 * are in contact it is the shape of the present zone (shape.h). scene_whole_shape returns the shape without
 * zones. */
struct contact_shape scene_contact_shape(const struct scene_state *q, int contact);
struct contact_shape scene_whole_shape(const struct scene_state *q, int contact);

/* Returns the side that the source is on: +1 outside the destination, -1 inside. */
int scene_contact_side(const struct scene_state *q, int contact);

/* Whether the destination is a finite cylinder without caps, at whose ends contact ends suddenly. */
bool scene_ends_suddenly(const struct scene_values *v, int contact);

/* Returns the shape of the zone that the source faces at an instant. */
struct contact_shape scene_shape_met(const struct scene_instant *at, int contact);

/* Returns the law of the normal force of a contact, with its present damping. */
struct contact_law scene_contact_law(const struct scene_state *q, int contact);

/* Whether a contact has Hertz's law. Constant false in scenes without it. */
bool scene_is_hertz(const struct scene_values *v, int contact);

/* Whether a contact has Hertz's law and its damping follows from the speed at each onset. */
bool scene_damps_by_onset(const struct scene_values *v, int contact);

/* scene_body_at returns the motion of a body at a clock, for a free body the motion that q holds.
 * scene_displacement_of returns u [m] of a body that has `moved` [m] since clock 0. */
struct body_state scene_body_at(const struct scene_state *q, double clock, int body);
struct vec3 scene_displacement_of(const struct scene_state *q, int body, struct vec3 moved);

/*
 * An integrator may leave contacts out that are apart: `met` says for each contact whether it counts; NULL
 * stands for all. A contact that is left out has no geometry, and all of its forces and torques are zero.
 */

/* Sets the motion of the bodies alone, and the springs. Free motions, free rotations and springs are those of
 * q; scene_place_body puts one body elsewhere. */
void scene_place_bodies(const struct scene_state *q, double clock, struct scene_instant *at);
void scene_place_body(struct body_state state, int body, struct scene_instant *at);

/* Computes the geometry of the contacts of an instant that has the motion of the bodies. */
void scene_meet(const bool *met, struct scene_instant *at);

/* Returns the shape of a contact with the destination's axis at the instant. */
struct contact_shape scene_contact_shape_at(const struct scene_instant *at, int contact);

/* Completes an instant that has kinematics by the accelerations and forces in the regimes of at->q. */
void scene_forces(const bool *met, struct scene_instant *at);

/* Returns how far the source's centre is beyond the destination's end planes [m], at most zero within;
 * -INFINITY without ends. A race ends at the cylinder rho = R; no source that touches an outer race has
 * rho > 2 R. */
double scene_beyond_ends(const struct contact_shape *shape, const struct contact_geometry *geometry);

/* Returns 1 divided by the mass of a free body [1/kg]; zero for any other body. */
double body_inverse_mass(const struct scene_values *v, int body);

/* Returns the sum of the inverse masses of a contact's bodies [1/kg], the inverse of the effective mass. */
double scene_inverse_mass(const struct scene_values *v, int contact);

/* Returns g'' of a contact [m/s^2]. `at` must have forces. */
double scene_gap_acceleration(const struct scene_instant *at, int contact);

/* Returns the acceleration that presses a contact's bodies together [m/s^2]: -g'' without the contact's own
 * normal force, at least zero. The function divides this force by the effective mass, and leaves out the
 * turning that the force causes. `at` must have forces. */
double scene_pressing_acceleration(const struct scene_instant *at, int contact);

/* Returns the rates of a contact's impulses [N, N m]. Where nothing turns or rubs, the torque on the
 * destination is c x F, because the lever arm of the source is along F, and zero where the destination is a
 * sphere. */
struct contact_impulses scene_impulse_rates(const struct scene_instant *at, int contact);

/*
 * Bodies that turn and contacts that rub, at one instant. Frame: world; SI units.
 *
 *   e = side n           from the source's centre to the nearest surface of the destination
 *   p = x_src + r_s e    the point where the normal and the friction force act
 *   v_t                  slip: [v_src + omega_src x r_s e] - [v_dst + omega_dst x (p - x_dst)] across n
 *   F_src = -F_n e + F_t(v_t),   tau_src = r_s e x F_src + M,   tau_dst = (p - x_dst) x (-F_src) - M
 *
 * M is the resistance to rolling and spinning (contact/friction.h).
 *
 * The axis of a turning destination moves past the source. The gap's rate is therefore the one in the
 * destination's frame, g' = side n.(w - omega_dst x c).
 */

/* Returns the principal moments of inertia of a body that turns freely [kg m^2]. The third is that about the
 * body's axis, where it has one. The first is the unit of its spin below. */
struct vec3 body_inertia_of(const struct scene_values *v, int body);

/* Return the spin L / I_1 of a body [rad/s] from its rotation, and its angular velocity from the spin. L is
 * R diag(I) R^T omega, where R is the matrix of the orientation. */
struct vec3 body_spin_of(const struct scene_values *v, int body, const struct body_turn *turn);
struct vec3 body_rotation_of(const struct scene_values *v, int body, struct quaternion orientation,
                             struct vec3 spin);

/* Returns R o [m], from the centre of mass of a compound body to the centre of the part that a contact meets
 * at its source (end 0) or destination (end 1). The function returns zero for other bodies. */
struct vec3 scene_lever(const struct scene_instant *at, int contact, int end);

/* Returns the effective modulus E* of the bodies of a contact [Pa]. */
double scene_hertz_modulus(const struct scene_values *v, int contact);

/* Returns the law that opposes one of a contact's motions (enum opposed, contact/friction.h): friction
 * opposes the slip, and a resistance opposes rolling or spinning. With the radii r_s and r_d, where r_d of a
 * cylinder is its radius and of a torus that of its tube, both resistances have the lever
 *   R_r = r_s r_d / (r_s + r_d) outside,   r_s r_d / (r_d - r_s) inside,   r_s on a plane
 * R_r is constant: the caps and the rims of a cylinder have that of its side. */
struct friction_law scene_friction_law(const struct scene_state *q, int contact, int part);

/* Returns the orientation and angular velocity of a body of prescribed rotation at a clock. */
struct body_turn turning_prescribed_at(const struct scene_state *q, double clock, int body);

/* Completes an instant that has kinematics, arms and slips by given contact forces [N] and resistances to
 * rolling and spinning [N m] on the sources, one for each contact: accelerations, F_n, and where scene_turns
 * torques and F_t. */
void scene_put_contact_forces(const struct vec3 *force, const struct vec3 *torque, const bool *met,
                              struct scene_instant *at);

/* Adds rotations, friction and torques to an instant that has geometry and normal forces. */
void turning_complete(struct scene_instant *at);

/* Turns bodies of prescribed rotation to the axes of new paths by the smallest rotation. */
void turning_take_axes(struct scene_state *q);

/* Returns a bound of the rounding error of the gap [m], below which the sign of the gap means nothing: eight
 * roundings of locations, displacements and radii, from which the gap is computed. For a shell that the
 * source nearly fills, the difference of the radii counts instead, which is exact. */
double rounding_of_gap(const struct scene_instant *at, int contact);

/* Returns a bound of the rounding error of the source's axial position [m], which is compared with L/2. */
double rounding_of_axial(const struct scene_instant *at, int contact, const struct contact_shape *shape);

/* Returns a bound of the angle by which rounding of positions tilts n [rad]. The bound is infinite in the
 * centre, and 0 on a plane or a cap, where the axis gives n. */
double rounding_of_normal(const struct scene_instant *at, int contact);

/* Returns a bound of the rounding error of w and g' [m/s], which are differences of the bodies'
 * velocities. */
double rounding_of_rate(const struct scene_instant *at, int contact);

/* Returns a bound of the error of the law's event function (contact_event) by rounding and by an error of the
 * speeds of `tolerated` [m/s]. */
double rounding_of_event(const struct scene_instant *at, int contact, double tolerated);

/* Returns a bound of the error of a contact's normal force by the rounding of g, n and n.w [N]. */
double rounding_of_force(const struct scene_instant *at, int contact);

/* Returns an offset that makes the law's event function positive at the start of a phase, although rounding
 * or an error of the speeds of `tolerated` [m/s] may have left the function at or below zero. Without the
 * offset a root finder would miss the fall of a function that starts below zero, and would find many falls of
 * one that stays near zero, as at rest. The offset delays the event a little, which matters little, because
 * the force is continuous there. */
double rounding_margin_offset(const struct scene_instant *at, int contact, double tolerated);

/*
 * The functions below give torques, angular accelerations and rates of springs at an instant with forces, in
 * the world frame, in SI units. A contact that is apart has zero torques and a zero rate of its spring.
 */

/* Returns the part of an angular velocity or a torque that turns a body: all of it, or for a body that keeps
 * its axis the part along the axis. A bearing takes the torques across that axis; the model leaves it out. */
struct vec3 body_part_that_turns(const struct scene_values *v, int body, struct vec3 a);

/* This struct holds the sums of the forces [N] and torques [N m] of the contacts of a body. contact_load_add
 * adds those of one contact, whose force on the source is `force`. */
struct contact_load {
    struct vec3 force, torque;
};
void contact_load_add(int contact, int body, struct vec3 force, struct vec3 source_torque,
                      struct vec3 destination_torque, struct contact_load *sum);

/* Returns the part that turns a body of the sum of contact torques and external torque about its centre
 * [N m]. */
struct vec3 turning_torque_on(const struct scene_instant *at, int body);

/* Returns d omega/dt of a body [rad/s^2]. For a body that turns freely under the torque tau it is the
 * angular velocity (body_rotation_of) of the spin tau / I_1 - omega x L / I_1. */
struct vec3 turning_acceleration(const struct scene_instant *at, int body);

/* Returns the laws of a contact. */
struct turning_laws turning_laws_of(const struct scene_state *q, int contact);

/* Returns the normal force, and of an opposed motion of a contact (contact/friction.h) the motion and the
 * spring. */
struct friction_state turning_rubbing(const struct scene_instant *at, int contact, int part);

/* Returns n', the rate of the normal [1/s]. */
struct vec3 turning_normal_rate(const struct scene_instant *at, int contact);

/* Returns the rate of a spring, xi' [m/s] or theta' [rad/s], with its turning by the normal included. */
struct vec3 turning_spring_rate(const struct scene_instant *at, int contact, int part);

/* Returns the rate of the normal force [N/s]. The instant must have accelerations. */
double turning_normal_force_rate(const struct scene_instant *at, int contact);

/* Returns omega, the angular velocity of the source as the destination sees it [rad/s], and the size of the
 * terms whose difference omega is. */
struct vec3 turning_spin(const struct scene_instant *at, int contact);
double turning_spin_size(const struct scene_instant *at, int contact);

/* Whether d = 0 within rounding, by positions or by the accumulated gap. Solid bodies may reach this
 * singularity, where n is undefined and reverses; the escape direction takes the place of n. */
bool singularity_is_reached(const struct scene_instant *at, int contact, const struct contact_shape *shape);

/* Returns the escape direction, in which bodies leave d = 0 because the distance can only grow there. It is
 * the direction of their relative velocity `rate`, for a cylinder of its part across the axis. At relative
 * rest it is that of `acceleration`, the relative acceleration by all but this contact. Without an
 * acceleration it is `held`, the direction that n had before. */
struct vec3 singularity_escape(const struct contact_shape *shape, struct vec3 rate, struct vec3 acceleration,
                               struct vec3 held);

/* Return g' [m/s] and F_n [N]. Where d is 0 within rounding, n has no digits, and the sign of g' would decide
 * on the dashpot's force and on the regime. There the functions return the values of a source that leaves. */
double singularity_rate(const struct scene_instant *at, int contact);
double scene_outward_force(const struct scene_instant *at, int contact);

/* The zone of a capped cylinder or of skew cylinders that a contact is in (shape.h) is set when the contact
 * begins, changed at the zone's edges, and forgotten when the contact ends. Other scenes have no zones. */

/* Sets the zone after a change of regime: a contact whose law gives a force takes the zone of the instant,
 * and one that is apart or separates loses its zone. A prescribed contact has a zone also while it separates.
 * It has none where something turns or no body may be free, because the quadrature there finds the edges of
 * zones itself. Without a zone the nearest one holds. */
void zones_follow(struct scene_state *q, const struct scene_instant *at, int contact);

/* Sets the next zone of the contact, or the zone that the centre is in if it is clearly beyond the edge.
 * Returns whether n jumps at the edge: it does where the centre is inside the solid or at the circle of the
 * rim. */
bool zones_pass(struct scene_state *q, const struct scene_instant *at, int contact);

/* Returns how far the source's centre is inside the edges of the zone [m]; 1 m where there is no zone. */
double zones_margin(const struct scene_instant *at, int contact);

/*
 * Computes the scene at its present clock. Gaps and rates that integration has accumulated replace those made
 * from positions and velocities, because they have more digits.
 */

/* scene_kinematics_now leaves out accelerations and forces; scene_now computes the whole instant. */
void scene_kinematics_now(const struct scene_state *q, struct scene_instant *at);
void scene_now(const struct scene_state *q, struct scene_instant *at);

/* Whether the gap of scene_now is the accumulated one, which is more accurate than positions give it. Such a
 * gap exists in contact, as contact ends, and where a change of regime was foreseen. */
bool scene_gap_is_accumulated(const struct scene_instant *at, int contact);

/* Whether g' of scene_now is the rate that the last segment of the contact has left (`carried_rate`). */
bool scene_rate_is_known(const struct scene_instant *at, int contact);

/* Returns the regime that the law gives for the gap, the gap rate and the axial position of the instant. A
 * contact that goes on `touching` is not apart, even if rounding shows an open gap. */
enum contact_regime scene_regime(const struct scene_instant *at, int contact, bool touching);

/*
 * Damping by the onset: with a coefficient of restitution, the damping factor chi [s/m] of Hunt and Crossley
 * follows from the speed of approach v at the onset [m/s], because the number chi v is a function of the
 * coefficient.
 *
 * A start in overlap takes the speed at the touch that its motion and stored energy would have had. Where the
 * load would press the bodies together faster from rest than they approach, v is the largest speed that the
 * load gives. Bodies that touch with no speed and no load have no damping.
 */

/* Returns the derivative of a contact's law at a start in overlap, from the derivatives of the gap and of the
 * gap rate. Only chi changes. A change of the load does not count. */
CONTACT_COLD struct contact_law onset_law_slope(const struct scene_instant *at, int contact, double gap_slope,
                                                double rate_slope);

/* Sets the damping of an onset before a contact enters the regime `next` at the instant `at`, and returns the
 * regime that the contact enters with it. Returns `next` where the contact touches already, remains apart, or
 * has no damping by the onset. */
enum contact_regime onset_note(struct scene_state *q, const struct scene_instant *at, int contact,
                               enum contact_regime next);

/* The functions below give the energies of the scene [J]. The sum kinetic + potential + contact +
 * dissipated - external work stays constant. Where something turns or rubs, rotational + tangential +
 * friction are added to this sum. */

/* `stored` is the energy of the normal forces, `tangential` that of the springs of friction. */
struct scene_energies {
    double kinetic, potential, rotational, stored, tangential;
};
struct scene_energies scene_energies_of(const struct scene_instant *at);

/* Returns the rotational energy omega.L / 2 of a body. */
double body_rotational_energy(const struct scene_values *v, int body, const struct body_turn *turn);

/* Returns the potential energy in a field g [m/s^2], minus the sum of m g.x over the free bodies; the field
 * is gravity, or a change of gravity. */
double energy_potential(const struct scene_instant *at, struct vec3 field);

/* Returns the energy that the normal forces of all contacts store. */
double energy_stored(const struct scene_instant *at);

/* This struct holds powers [W] of one contact, or summed over bodies and contacts: those that dashpots
 * dissipate; those of the external forces and torques, and of the drives of prescribed motions and rotations
 * against contacts; those that friction with its springs and the resistances to rolling and spinning take,
 * -F_t.v_t - M.omega. */
struct scene_powers {
    double dissipated, external, friction;
};
struct scene_powers scene_powers_of_contact(const struct scene_instant *at, int contact);

#endif
