/*
 * The scene's bodies and contacts at one instant: positions, geometry, forces, accelerations.
 * Frame: world; SI units. Newton's law for each free body: m a = m gravity + external force + contact forces.
 */
#ifndef CONTACT_SCENE_EVALUATE_H
#define CONTACT_SCENE_EVALUATE_H

#include "contact/shape.h"
#include "contact/slopes.h"
#include "math/compiler.h"
#include "scene/scene_state.h"

/* What turns and rubs at one instant: known where scene_turns, and after turning_complete. */
struct turning_instant {
    struct body_turn body[SCENE_BODIES];         /* no rotation at all where a body does not turn */
    struct vec3 axis[SCENE_CONTACTS];            /* e_d as it has turned; zero of a sphere */
    struct vec3 source_arm[SCENE_CONTACTS];      /* p - x_src = r_s e [m] */
    struct vec3 destination_arm[SCENE_CONTACTS]; /* p - x_dst [m] */
    struct vec3 slip[SCENE_CONTACTS];            /* v_t [m/s] */
    struct vec3 friction_force[SCENE_CONTACTS];  /* F_t, part of the force on the source [N] */
    struct vec3 source_torque[SCENE_CONTACTS], destination_torque[SCENE_CONTACTS]; /* [N m] */
};

struct scene_instant {
    struct vec3 displacement[SCENE_BODIES]; /* u [m] */
    struct vec3 moved[SCENE_BODIES];        /* the part of u since clock 0 [m] */
    struct vec3 velocity[SCENE_BODIES];     /* v [m/s] */
    struct vec3 acceleration[SCENE_BODIES]; /* zero for a fixed body [m/s^2] */
    struct contact_geometry geometry[SCENE_CONTACTS];
    struct vec3 separation[SCENE_CONTACTS];   /* c = x_dst - x_src [m] */
    struct vec3 rate[SCENE_CONTACTS];         /* w = v_dst - v_src [m/s] */
    double normal_force[SCENE_CONTACTS];      /* F_n of the smooth law of the regime [N] */
    struct vec3 source_force[SCENE_CONTACTS]; /* of the contact, friction with it [N] */
    struct turning_instant turning;
};

/* One body of it. */
struct body_instant {
    struct vec3 origin;       /* u at clock 0 [m] */
    struct vec3 moved;        /* the part of u since then [m] */
    struct vec3 displacement; /* u [m] */
    struct vec3 velocity;     /* v [m/s] */
};

/* The shape of a contact: of a capped cylinder, in contact, the zone that the contact is in (shape.h). The
 * same without regard to zones; and as it is met at an instant, also where there is no contact. */
struct contact_shape scene_contact_shape(const struct scene_values *v, const struct scene_state *q,
                                         int contact);
struct contact_shape scene_whole_shape(const struct scene_values *v, const struct scene_state *q,
                                       int contact);

/* Of the same shape, where no more of it is wanted: +1: the source is outside the destination, -1: inside. */
int scene_contact_side(const struct scene_values *v, const struct scene_state *q, int contact);

/* Whether it is a finite cylinder without caps: the gap does not see its ends. */
bool scene_ends_suddenly(const struct scene_values *v, int contact);

struct contact_shape scene_shape_met(const struct scene_values *v, const struct scene_state *q,
                                     const struct scene_instant *at, int contact);
struct contact_law scene_contact_law(const struct scene_values *v, const struct scene_state *q, int contact);

/* Whether a contact has Hertz's law; and one whose damping is made from the speed of each onset. Constant
 * false in scenes without. */
bool scene_is_hertz(const struct scene_values *v, int contact);

bool scene_damps_by_onset(const struct scene_values *v, int contact);

/* One body at the present state of q. */
struct body_instant scene_body_now(const struct scene_values *v, const struct scene_state *q, int body);

/* u and v of every body at a clock; `bodies` (SCENE_BODIES of them) holds the free ones' states and may be
 * NULL where none is free. */
void scene_kinematics(const struct scene_values *v, const struct scene_state *q, double clock,
                      const struct body_state *bodies, struct scene_instant *at);

/* The same with another state of what turns and rubs than that of q: kinematics, all of it. */
void scene_kinematics_turning(const struct scene_values *v, const struct scene_state *q, double clock,
                              const struct body_state *bodies, const struct turning_state *turning,
                              struct scene_instant *at);
void scene_evaluate_turning(const struct scene_values *v, const struct scene_state *q, double clock,
                            const struct body_state *bodies, const struct turning_state *turning,
                            struct scene_instant *at);

/* The shape of a contact with the axis of the instant. */
struct contact_shape scene_contact_shape_at(const struct scene_values *v, const struct scene_state *q,
                                            const struct scene_instant *at, int contact);

/* The rest of the instant, accelerations and forces, in the regimes of q. */
void scene_forces(const struct scene_values *v, const struct scene_state *q, double clock,
                  struct scene_instant *at);

/* Everything of the instant, in the regimes of q. */
void scene_evaluate(const struct scene_values *v, const struct scene_state *q, double clock,
                    const struct body_state *bodies, struct scene_instant *at);

/* contact_within_extents, true at compile time in scenes of spheres. */
bool scene_within_extents(const struct contact_shape *shape, const struct contact_geometry *geometry);

/* How far the source is beyond a cylinder's ends, negative within [m]; minus infinity without ends. */
double scene_beyond_ends(const struct contact_shape *shape, const struct contact_geometry *geometry);

/* 1 / m of a free body, 0 of any other [1/kg]. */
double body_inverse_mass(const struct scene_values *v, int body);

/* Sum of the inverse masses of a contact's bodies: 1 / m_eff [1/kg]. */
double scene_inverse_mass(const struct scene_values *v, int contact);

/* How fast all but a contact's own normal force presses its bodies together: -g'' without that force, no less
 * than zero [m/s^2]. The instant has its forces. */
double scene_pressing_acceleration(const struct scene_values *v, const struct scene_state *q, double clock,
                                   const struct scene_instant *at, int contact);

/* Where nothing turns or rubs: the torque on the destination about its centre, c x F, as the source's lever
 * arm is along F [N m]. None where the destination is a sphere: scenes without SCENE_HAS_TORQUES do not
 * ask. */
struct vec3 scene_torque_of_force(const struct scene_instant *at, int contact);

/* Power of whatever moves and turns prescribed bodies against a contact [W]. */
double scene_driving_power(const struct scene_values *v, const struct scene_instant *at, int contact);

/* That of all contacts, and of the external forces and torques on free bodies [W]. */
double scene_external_power(const struct scene_values *v, const struct scene_state *q, double clock,
                            const struct scene_instant *at);

/*
 * Bodies that turn and contacts that rub, at one instant. Frame: world; SI units.
 *
 *   e = side n           from the source's centre to the nearest surface of the destination
 *   p = x_src + r_s e    where both forces act
 *   v_t                  slip: [v_src + omega_src x r_s e] - [v_dst + omega_dst x (p - x_dst)] across n
 *   F_src = -F_n e + F_t(v_t),   tau_src = r_s e x F_src,   tau_dst = (p - x_dst) x (-F_src)
 *
 * A turning axis moves past the source: the gap's rate is that of the motion as the destination's frame sees
 * it, g' = side n.(w - omega_dst x c).
 */

/* Moments of inertia about a body's axis and across it; a sphere's are alike [kg m^2]. */
struct body_inertia {
    double axial, transverse;
};

/* Of a body of free rotation, by its parameters. */
struct body_inertia body_inertia_of(const struct scene_values *v, int body);

/* The law of friction of a contact. */
struct friction_law scene_friction_law(const struct scene_values *v, const struct scene_state *q,
                                       int contact);

/* The orientation that a body starts with: the smallest rotation that takes z to its axis. */
struct quaternion turning_start_orientation(const struct scene_values *v, int body);

/* How many steps of a series it takes to say where the bodies whose rotation is prescribed have turned to
 * after `length` seconds: none around one direction, else as many as radians. */
double turning_prescribed_steps(const struct scene_values *v, const struct scene_state *q, double length);

/* Where a body of prescribed rotation has turned to at a clock. */
struct body_turn turning_prescribed_at(const struct scene_values *v, const struct scene_state *q,
                                       double clock, int body);

/* Orientation and angular velocity of every body, the axis of every destination. */
void turning_of_bodies(const struct scene_values *v, const struct scene_state *q, double clock,
                       const struct turning_state *turning, struct scene_instant *at);

/* Slip, friction and torques of a contact whose geometry and normal force are known; adds friction to the
 * force on the source. */
void turning_of_contact(const struct scene_values *v, const struct scene_state *q,
                        const struct turning_state *state, int contact, struct scene_instant *at);

/* All that turns and rubs, of an instant that is known but for that. */
void turning_complete(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at);

/* Moves turn_origin of all bodies that turn to the present; a part of scene_rebase. */
void turning_rebase(const struct scene_values *v, struct scene_state *q);

/* After new paths came into force: bodies whose axis was set are turned to it, the shortest way. */
void turning_take_axes(const struct scene_values *v, struct scene_state *q);

/* Orientations and angular velocities at the start; springs are at rest. */
void turning_place(const struct scene_values *v, struct scene_state *q);

/* Puts accumulated gaps and carried rates into the present instant where they are known. */
void scene_put_known_gaps(const struct scene_values *v, const struct scene_state *q,
                          struct scene_instant *at);

/* Bounds of the rounding errors of gaps, their rates and regime margins. */

/* Bound of the rounding error of the gap [m]: eight roundings of the terms that it is computed from, which
 * are locations, displacements and radii (of a shell nearly filled by the source the difference of the radii,
 * which is exact). Below it the sign of the gap means nothing. */
double rounding_of_gap(const struct scene_values *v, const struct scene_instant *at, int contact);

/* The same for the axial position of the source that is compared with the half length of a cylinder [m]. */
double rounding_of_axial(const struct scene_values *v, const struct scene_instant *at, int contact,
                         const struct contact_shape *shape);

/* The same for w and g', which are differences of the bodies' velocities [m/s]. */
double rounding_of_rate(const struct scene_instant *at, int contact);

/* The same for an event function of the law with these slopes (contact_event), of speeds that are right to
 * `tolerated` [m/s]. */
double rounding_of_event(const struct scene_values *v, const struct contact_law *law,
                         const struct contact_slopes *slopes, const struct scene_instant *at, int contact,
                         double tolerated);

/* What rounding alone does to the force of a contact, through g, n and n.w [N]. */
double rounding_of_force(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, int contact);

/* An offset that makes a regime's margin positive at the start of a phase although rounding, or an error of
 * the speeds by `tolerated` [m/s], may have left it at or below zero. Without it a root finder would miss the
 * fall of a margin that starts below zero, and would find many of one that stays near zero, as at rest. The
 * force is continuous there, so the delay changes little. */
double rounding_margin_offset(const struct scene_values *v, const struct scene_state *q,
                              const struct scene_instant *at, int contact, double tolerated);

/*
 * How what turns and rubs goes on from an instant (scene_evaluate): torques, angular accelerations, rates of
 * springs. World frame, SI units. Where a contact is apart all of its own are zero.
 */

/* All torques about the centre of a body of free rotation: of its contacts and the external one [N m]. */
struct vec3 turning_torque_on(const struct scene_values *v, const struct scene_state *q, double clock,
                              const struct scene_instant *at, int body);

/*
 * d omega/dt [rad/s^2]. Of a free top with the axis e: with omega_3 = omega.e, tau_3 = tau.e
 *   I_1 omega' = tau - (I_3 - I_1) (tau_3 / I_3 e + omega_3 omega x e)
 */
struct vec3 turning_acceleration(const struct scene_values *v, const struct scene_state *q, double clock,
                                 const struct scene_instant *at, int body);

/* The motion of a contact as contact/slopes.h has it, and its laws. */
struct turning_motion turning_motion_of(const struct turning_state *turning, const struct scene_instant *at,
                                        int contact);
struct turning_laws turning_laws_of(const struct scene_values *v, const struct scene_state *q, int contact);

/* F_n, slip and spring of a contact. */
struct friction_state turning_rubbing(const struct turning_state *turning, const struct scene_instant *at,
                                      int contact);

/* n', the rate of the normal [1/s]. */
struct vec3 turning_normal_rate(const struct scene_values *v, const struct scene_state *q,
                                const struct scene_instant *at, int contact);

/* xi', the turning with the normal included [m/s]. */
struct vec3 turning_spring_rate(const struct scene_values *v, const struct scene_state *q,
                                const struct turning_state *turning, const struct scene_instant *at,
                                int contact);

/* dF_n/dt [N/s]; of an instant with accelerations. */
double turning_normal_force_rate(const struct scene_values *v, const struct scene_state *q, double clock,
                                 const struct scene_instant *at, int contact);

/* -F_t.v_t, summed up over the contacts: what friction and its springs take [W]. */
double turning_friction_power(const struct scene_values *v, const struct scene_instant *at);

/* The singularity d = 0 of solid bodies: n is undefined there and reverses; the escape direction takes its
 * place. */

/* Whether d = 0 within rounding, by positions or by the accumulated gap. */
bool singularity_is_reached(const struct scene_values *v, const struct scene_instant *at, int contact,
                            const struct contact_shape *shape);

/* The escape direction, in which bodies leave d = 0: that of their relative velocity `rate`; at relative rest
 * that of `acceleration`, the relative one that counts; without both, `held`. */
struct vec3 singularity_escape(const struct contact_shape *shape, struct vec3 rate, struct vec3 acceleration,
                               struct vec3 held);

/* In which zone of a capped cylinder a contact is (shape.h): set when it begins, changed at the zone's edges,
 * forgotten when it ends. In scenes without capped cylinders nothing happens. */

/* Margin [m] of a contact that has no zone. */
#define NO_ZONE_MARGIN 1.0

/* After a regime has been set at the instant: the zone that is met then, or none without contact. */
void zones_follow(struct scene_state *q, const struct scene_instant *at, int contact);

/* The contact passes into the next zone. Whether n jumps there: the centre is inside the solid, or at the
 * circle of the rim. */
bool zones_pass(const struct scene_values *v, struct scene_state *q, const struct scene_instant *at,
                int contact);

/* The zone that is met at the instant, where that is another by more than rounding. */
void zones_settle(const struct scene_values *v, struct scene_state *q, const struct scene_instant *at,
                  int contact);

/* How far the source's centre is within the edges of the zone [m]. */
double zones_margin(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                    int contact);

/* As users see it, at the instant. */
enum zone zones_shown(const struct scene_values *v, const struct scene_state *q,
                      const struct scene_instant *at, int contact);

/*
 * The scene at its present clock. Where integration has accumulated a gap or carried its rate, both are more
 * accurate than positions and velocities tell and take the place of what those give.
 */

/* Everything of the instant; and without accelerations and forces. */
void scene_kinematics_now(const struct scene_values *v, const struct scene_state *q,
                          struct scene_instant *at);
void scene_now(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at);

/* Whether the gap of scene_now is the accumulated one, more accurate than positions give it: in contact, as
 * contact ends, and where a change of regime was foreseen. */
bool scene_gap_is_accumulated(const struct scene_state *q, const struct scene_instant *at, int contact);

/* Whether g' there is the carried one. */
bool scene_rate_is_known(const struct scene_state *q, const struct scene_instant *at, int contact);

/* Whether the source is within the extents of the destination, as users see it. In the plane of an open end
 * rounding takes either side of it, and the regime that is in force decides. */
bool scene_shown_within(const struct scene_values *v, const struct scene_state *q,
                        const struct scene_instant *at, int contact, const struct contact_shape *shape);

/* The regime that the geometry of the instant asks for. */
enum contact_regime scene_regime(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_instant *at, int contact);

/* Of a contact that goes on touching, whatever rounding makes of its gap: the regime that its law asks
 * for. */
enum contact_regime scene_regime_of_touching(const struct scene_values *v, const struct scene_state *q,
                                             const struct scene_instant *at, int contact);

/*
 * What a contact takes from its onset: with a coefficient of restitution the factor chi of Hunt and
 * Crossley's damping, such that chi v is the number that gives it, v the speed of approach [m/s].
 *
 * A start in overlap counts with the speed that its motion and its stored energy together would have at the
 * touch. Where the bodies touch without speed, v is the largest that their load gives them while it presses
 * them together from rest; so it is in place of any smaller one, of which a load leaves no trace. The load
 * leaves out what a plane adds that turns. Bodies that touch with no speed and no load have no damping.
 */

/* For onset_note. */
CONTACT_COLD enum contact_regime onset_take_damping(const struct scene_values *v, struct scene_state *q,
                                                    const struct scene_instant *at, int contact,
                                                    enum contact_regime next);

/* What chi changes by when gap and rate of a start in overlap change so; a change of the load alone counts as
 * none. */
CONTACT_COLD double onset_damping_slope(const struct scene_values *v, const struct scene_state *q,
                                        const struct scene_instant *at, int contact, double gap_slope,
                                        double rate_slope);

/* Before a contact enters the regime `next` at the instant `at`: the regime that it enters with the damping
 * of its onset. Nothing is done, and that is `next`, where it touches already, where it remains apart, or
 * where damping knows no onset. */
enum contact_regime onset_note(const struct scene_values *v, struct scene_state *q,
                               const struct scene_instant *at, int contact, enum contact_regime next);

/* Energies of the scene [J]. kinetic + potential + contact + dissipated - external work stays constant; with
 * what turns and rubs, kinetic + rotational + potential + contact + tangential + dissipated + friction -
 * external work. */

/* Sum of m v^2 / 2 over the free bodies. */
double energy_kinetic_of(const struct scene_values *v, const struct scene_instant *at);

/* Sum of omega I omega / 2 over the bodies of free rotation; what the tangential springs store. */
double energy_rotational_of(const struct scene_values *v, const struct scene_instant *at);
double energy_tangential_of(const struct scene_values *v, const struct scene_state *q,
                            const struct scene_instant *at);

/* Minus the sum of m gravity.x over the free bodies; zero at the world's origin. */
double energy_potential_of(const struct scene_values *v, const struct scene_instant *at);

/* What that changes by when gravity does. */
double energy_potential_change(const struct scene_values *v, const struct scene_instant *at,
                               struct vec3 more_gravity);

/* Sum of p_n g^2 / 2 over the contacts. */
double energy_stored(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at);

/* -(F_n + p_n g) g' of a contact, and the sum over all [W]. */
double energy_dissipated_power_of(const struct scene_values *v, const struct scene_state *q,
                                  const struct scene_instant *at, int contact);
double energy_dissipated_power(const struct scene_values *v, const struct scene_state *q,
                               const struct scene_instant *at);

/* Shows a body's displacement, position and velocity: those given, or those of the present. */
void present_body(struct scene_values *v, int body, struct vec3 displacement, struct vec3 velocity);
void present_body_now(struct scene_values *v, const struct scene_state *q, int body);

#endif
