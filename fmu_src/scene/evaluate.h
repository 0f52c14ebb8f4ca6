/*
 * The scene's bodies and contacts at one instant: positions, geometry, forces, accelerations.
 * Frame: world; SI units. Newton's law for each free body: m a = m gravity + external force + contact forces.
 */
#ifndef CONTACT_SCENE_EVALUATE_H
#define CONTACT_SCENE_EVALUATE_H

#include "contact/geometry.h"
#include "scene/topology.h"

#if SCENE_ANY_TURNING
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
#endif

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
#if SCENE_ANY_TURNING
    struct turning_instant turning;
#endif
};

/* One body of it. */
struct body_instant {
    struct vec3 origin;       /* u at clock 0 [m] */
    struct vec3 moved;        /* the part of u since then [m] */
    struct vec3 displacement; /* u [m] */
    struct vec3 velocity;     /* v [m/s] */
};

/* The shape of a contact: of a capped cylinder, in contact, the zone that the contact is in (zone.h). The
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
static inline bool scene_is_hertz(const struct scene_values *v, int contact)
{
    return SCENE_ANY_HERTZ && contact_law(v, contact) == LAW_HERTZ;
}

static inline bool scene_damps_by_onset(const struct scene_values *v, int contact)
{
    return SCENE_ANY_RESTITUTION && scene_is_hertz(v, contact) &&
           contact_viscous_control(v, contact) == VISCOUS_CONTROL_RESTITUTION;
}

/* One body at the present state of q. */
struct body_instant scene_body_now(const struct scene_values *v, const struct scene_state *q, int body);

/* u and v of every body at a clock; `bodies` (SCENE_BODIES of them) holds the free ones' states and may be
 * NULL where none is free. */
void scene_kinematics(const struct scene_values *v, const struct scene_state *q, double clock,
                      const struct body_state *bodies, struct scene_instant *at);

#if SCENE_ANY_TURNING
/* The same with another state of what turns and rubs than that of q: kinematics, all of it. */
void scene_kinematics_turning(const struct scene_values *v, const struct scene_state *q, double clock,
                              const struct body_state *bodies, const struct turning_state *turning,
                              struct scene_instant *at);
void scene_evaluate_turning(const struct scene_values *v, const struct scene_state *q, double clock,
                            const struct body_state *bodies, const struct turning_state *turning,
                            struct scene_instant *at);
#endif

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

/* How fast all but a contact's own normal force presses its bodies together: -g'' without that, no less than
 * zero [m/s^2]. What turns the bodies themselves is left out. */
double scene_pressing_acceleration(const struct scene_values *v, const struct scene_state *q,
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

#endif
