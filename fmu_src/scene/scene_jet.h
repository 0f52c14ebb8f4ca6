/*
 * The jet of the scene consists of Taylor coefficients of order up to two along a path through the present
 * instant, in time or along a change of the inputs. contact/slopes.h has the jet of one contact. CONTACT_COLD
 * marks the functions that are called rarely; the Jacobian of the ODE calls jet_of_contact for each of its
 * columns.
 */
#ifndef CONTACT_SCENE_SCENE_JET_H
#define CONTACT_SCENE_SCENE_JET_H

#include "contact/slopes.h"
#include "math/compiler.h"
#include "scene/evaluate.h"

/* The jet of one contact's entries in struct turning_instant, and of the energy that its springs store. */
struct turning_jet {
    struct vec3 source_arm[JET_TERMS], destination_arm[JET_TERMS];
    struct vec3 friction_force[JET_TERMS], source_torque[JET_TERMS], destination_torque[JET_TERMS];
    double stored[JET_TERMS]; /* energy of the springs of friction, rolling and spinning [J] */
    struct vec3 spin[JET_TERMS], resistance[JET_TERMS]; /* omega and M; M only where SCENE_ANY_ROLLING */
    struct vec3 motion[OPPOSED][JET_TERMS];             /* the opposed motions (contact/friction.h) */
};

struct scene_jet {
    struct vec3 displacement[SCENE_BODIES][JET_TERMS];
    struct vec3 velocity[SCENE_BODIES][JET_TERMS];
    struct vec3 force[SCENE_BODIES]; /* d/ds of the external forces on free bodies */
    /* d/ds of the law's factors, where these are automatic, and of the diagonal that they follow */
    struct contact_law law_slope[SCENE_CONTACTS];
    double diagonal_slope[SCENE_CONTACTS];
    struct contact_jet contact[SCENE_CONTACTS];
    struct vec3 angular_velocity[SCENE_BODIES][JET_TERMS];
    struct quaternion orientation[SCENE_BODIES][JET_TERMS];
    /* d/ds of the orientation that an importer's integrator sets, a quaternion of any length */
    struct quaternion given_orientation[SCENE_BODIES];
    struct vec3 torque[SCENE_BODIES]; /* d/ds of the external torques on bodies that turn freely */
    struct vec3 spring[SCENE_CONTACTS][OPPOSED][JET_TERMS];
    double slip_velocity_slope[SCENE_CONTACTS]; /* d/ds of v_0 */
    struct turning_jet turning[SCENE_CONTACTS];
    bool touching; /* contacts that are apart are left out: their terms are zero */
    int terms;     /* number of terms of contacts that are wanted, 2 or JET_TERMS */
    /* the springs before the inputs jump [m, rad]: the jump lays those of contacts without a free body
     * (opposed_laid); NULL: no input jumps */
    const struct vec3 (*spring_before)[OPPOSED];
    double friction[JET_TERMS]; /* energy that friction and its springs take; the first term is zero */
    /* only in scenes with free bodies; the first terms are zero */
    double time[JET_TERMS], dissipated[JET_TERMS], external_work[JET_TERMS];
};

/* Begins a path through the instant: sets the first terms of the bodies, and all other terms to zero. */
void jet_begin(const struct scene_instant *at, struct scene_jet *along);

/* Computes the part of one contact, which is not apart, from the bodies and the factors. If `rubs`, this part
 * has the slip, friction and torques. */
void jet_of_contact(const struct scene_instant *at, int contact, bool rubs, struct scene_jet *along);

/* Computes the parts of the contacts that `met` marks; NULL marks all. */
CONTACT_COLD void jet_of_contacts(const struct scene_instant *at, const bool *met, bool rubs,
                                  struct scene_jet *along);

/* Computes the whole jet in time. Free bodies follow Newton's law; prescribed bodies follow their velocity,
 * which counts as the derivative of their displacement. */
CONTACT_COLD void jet_in_time(const struct scene_instant *at, struct scene_jet *along);

/* Computes the jet in time of the contacts in touch, in which prescribed displacements follow their own
 * derivatives. These need not be the prescribed velocity, which the force law sees. `met` tells of which
 * contacts gaps and normal forces are wanted; NULL: all terms of all contacts. */
CONTACT_COLD void jet_of_motion(const struct scene_instant *at, const bool *met, struct scene_jet *along);

/* Returns half the rate of the angular acceleration of a body that turns freely [rad/s^3 in time]. */
CONTACT_COLD struct vec3 turning_jet_half_jerk(const struct scene_instant *at, const struct scene_jet *along,
                                               int body);

/* Returns the change of a spring's rate [m/s, rad/s] along the path, from the first-order terms of its
 * contact. */
CONTACT_COLD struct vec3 turning_jet_spring_change(const struct scene_instant *at,
                                                   const struct scene_jet *along, int contact, int part);

/* Puts the terms of the third axis of a body's frame. */
void jet_axis_of(const struct scene_jet *along, int body, struct vec3 axis[JET_TERMS]);

/* Puts the change of the orientation at the instant by a change of one component of the `given` quaternion,
 * which has any length and either sign. The change of its direction alone turns the body and its axis. */
CONTACT_COLD void turning_jet_move_orientation(const struct scene_instant *at, int body,
                                               struct quaternion given, int component, double change,
                                               struct scene_jet *along);

/* Returns coefficient `order` of the sums of the forces and torques of the contacts of a body. */
struct contact_load jet_load_on(const struct scene_jet *along, int body, int order);

/* Returns half the rate of a free body's acceleration by external and contact forces [m/s^3 in time]. */
struct vec3 free_bodies_half_jerk(const struct scene_values *v, const struct scene_jet *along, int body);

/* Return coefficient `order`, 0 or 1, of the powers [W], of all or by one contact. */
struct scene_powers jet_powers_of_contact(const struct scene_state *q, const struct scene_jet *along,
                                          int contact, int order);
struct scene_powers jet_powers_of(const struct scene_instant *at, const struct scene_jet *along, int order);

/* Returns the coefficients of one order of the energies along the path [J/s^order in time]. */
struct scene_energies jet_energies_of(const struct scene_state *q, const struct scene_jet *along, int order);

#endif
