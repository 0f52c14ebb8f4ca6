/*
 * The jet of the scene along a path through the present instant, as contact/slopes.h has it for one
 * contact: in
 * time, or in the direction of a change of the inputs. Rarely called, hence `cold`: inlining is left to other
 * code.
 */
#ifndef CONTACT_SCENE_SCENE_JET_H
#define CONTACT_SCENE_SCENE_JET_H

#include "contact/slopes.h"
#include "math/compiler.h"
#include "scene/evaluate.h"

/* Of a contact, as struct turning_instant has them; and what its spring stores. */
struct turning_jet {
    struct vec3 source_arm[JET_TERMS], destination_arm[JET_TERMS], slip[JET_TERMS];
    struct vec3 friction_force[JET_TERMS], source_torque[JET_TERMS], destination_torque[JET_TERMS];
    double stored[JET_TERMS];
};

struct scene_jet {
    struct vec3 displacement[SCENE_BODIES][JET_TERMS];
    struct vec3 velocity[SCENE_BODIES][JET_TERMS];
    struct vec3 force[SCENE_BODIES]; /* d/ds of the external forces on free bodies */
    /* d/ds of the factors, where they are automatic */
    struct contact_law law_slope[SCENE_CONTACTS];
    struct contact_jet contact[SCENE_CONTACTS];
    struct vec3 angular_velocity[SCENE_BODIES][JET_TERMS];
    struct vec3 axis[SCENE_BODIES][JET_TERMS]; /* the third axis of the body's frame */
    struct quaternion orientation[SCENE_BODIES][JET_TERMS];
    /* d/ds of the orientation as an integrator outside gives it, of any length */
    struct quaternion given_orientation[SCENE_BODIES];
    struct vec3 torque[SCENE_BODIES]; /* d/ds of the external torques on bodies that turn freely */
    struct vec3 spring[SCENE_CONTACTS][JET_TERMS];
    double slip_velocity_slope[SCENE_CONTACTS]; /* d/ds of v_0 */
    struct turning_jet turning[SCENE_CONTACTS];
    bool jumps; /* the inputs: springs of contacts without a free body are laid onto the new tangent plane */
    double spring_lift[SCENE_CONTACTS]; /* of the jumps: what the springs had along the normals before [m] */
    double friction[JET_TERMS]; /* energy that friction and its springs take, without the first term */
    /* of what only scenes with free bodies have, without the first term */
    double time[JET_TERMS], dissipated[JET_TERMS], external_work[JET_TERMS];
};

/* Contacts from what is there of the bodies and the factors. */
CONTACT_COLD void jet_of_contacts(const struct scene_values *v, const struct scene_state *q,
                                  const struct scene_instant *at, struct scene_jet *along);

/* All of it in time: free bodies by Newton's law, prescribed ones by their velocity, which counts as the
 * derivative of their displacement. */
CONTACT_COLD void jet_in_time(const struct scene_values *v, const struct scene_state *q,
                              const struct scene_instant *at, struct scene_jet *along);

/* Bodies and contacts as they move: a prescribed displacement by its own derivatives, which need not be its
 * velocity; that is what the law sees. */
CONTACT_COLD void jet_of_motion(const struct scene_values *v, const struct scene_state *q,
                                const struct scene_instant *at, struct scene_jet *along);

/*
 * The jet of what turns and rubs: rotations of the bodies, and contacts whose axis turns,
 * with their torques, slip, friction and springs. Coefficients of order up to two.
 */

/* Coefficient `order` of a cross product. */
struct vec3 turning_jet_cross(const struct vec3 *a, const struct vec3 *b, int order);

/* The rotations of the bodies in time, as far as the instant tells them: of bodies that turn freely the
 * change of their angular acceleration is missing. And the rates of the springs. */
CONTACT_COLD void turning_jet_put_bodies(const struct scene_values *v, const struct scene_state *q,
                                         const struct scene_instant *at, struct scene_jet *along);

/* What is missing, from contacts that are known to the first order. */
CONTACT_COLD void turning_jet_put_changes(const struct scene_values *v, const struct scene_state *q,
                                          const struct scene_instant *at, struct scene_jet *along);

/* The change of the angular acceleration of a body that turns freely. */
CONTACT_COLD struct vec3 turning_jet_spin_change(const struct scene_values *v, const struct scene_state *q,
                                                 const struct scene_instant *at,
                                                 const struct scene_jet *along, int body);

/* A change of the axis of a body of prescribed rotation, component by component, of the input as given. */
CONTACT_COLD void turning_jet_move_axis(const struct scene_values *v, const struct scene_instant *at,
                                        int body, int component, double change, struct scene_jet *along);

/* A contact from what is there of bodies, springs and factors: all of it where something turns or rubs; where
 * nothing does, torques and slip of a contact that is known. */
CONTACT_COLD void turning_jet_of_contact(const struct scene_values *v, const struct scene_state *q,
                                         const struct scene_instant *at, int contact,
                                         struct scene_jet *along);

/* Coefficients of energies [J], and of the powers of what turns: of friction and its springs, of torques from
 * outside [W]. */
CONTACT_COLD double turning_jet_of_rotational(const struct scene_values *v, const struct scene_jet *along,
                                              int order);
CONTACT_COLD double turning_jet_of_tangential(const struct scene_values *v, const struct scene_state *q,
                                              const struct scene_jet *along, int order);
CONTACT_COLD double turning_jet_friction_power(const struct scene_values *v, const struct scene_jet *along,
                                               int order);
CONTACT_COLD double turning_jet_external_power(const struct scene_values *v, const struct scene_state *q,
                                               const struct scene_jet *along, int order);

/* What free bodies add to the jet of an instant. */

/* Half the change of a free body's acceleration with the external force and the contact forces [m/s^3 in
 * time]; the power of dissipation, and that of external forces on free bodies and of what moves prescribed
 * ones against the contacts [W], of order 0 or 1. */
struct vec3 free_bodies_half_jerk(const struct scene_values *v, const struct scene_jet *along, int body);
double free_bodies_dissipated_power(const struct scene_values *v, const struct scene_state *q,
                                    const struct scene_jet *along, int order);
double free_bodies_external_power(const struct scene_values *v, const struct scene_state *q,
                                  const struct scene_jet *along, int order);

/* Coefficient `order` of the energies along the path [J/s^order]. */
double jet_of_kinetic(const struct scene_values *v, const struct scene_jet *along, int order);
double jet_of_potential(const struct scene_values *v, const struct scene_jet *along, int order);
double jet_of_stored(const struct scene_values *v, const struct scene_state *q, const struct scene_jet *along,
                     int order);

#endif
