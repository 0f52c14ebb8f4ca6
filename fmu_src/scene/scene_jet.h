/*
 * The jet of the scene along a path through the present instant, as contact/jet.h has it for one contact: in
 * time, or in the direction of a change of the inputs. Rarely called, hence `cold`: inlining is left to other
 * code.
 */
#ifndef CONTACT_SCENE_SCENE_JET_H
#define CONTACT_SCENE_SCENE_JET_H

#include "contact/jet.h"
#include "math/compiler.h"
#include "scene/evaluate.h"

#if SCENE_ANY_TURNING
/* Of a contact, as struct turning_instant has them; and what its spring stores. */
struct turning_jet {
    struct vec3 source_arm[JET_TERMS], destination_arm[JET_TERMS], slip[JET_TERMS];
    struct vec3 friction_force[JET_TERMS], source_torque[JET_TERMS], destination_torque[JET_TERMS];
    double stored[JET_TERMS];
};
#endif

struct scene_jet {
    struct vec3 displacement[SCENE_BODIES][JET_TERMS];
    struct vec3 velocity[SCENE_BODIES][JET_TERMS];
    struct vec3 force[SCENE_BODIES]; /* d/ds of the external forces on free bodies */
    /* d/ds of the factors, where they are automatic */
    struct contact_law law_slope[SCENE_CONTACTS];
    struct contact_jet contact[SCENE_CONTACTS];
#if SCENE_ANY_TURNING
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
    double friction[JET_TERMS]; /* energy that friction and its springs take, without the first term */
#endif
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

#endif
