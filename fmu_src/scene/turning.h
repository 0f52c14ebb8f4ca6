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
#ifndef CONTACT_SCENE_TURNING_H
#define CONTACT_SCENE_TURNING_H

#include "scene/evaluate.h"

/* Moments of inertia about a body's axis and across it; a sphere's are alike [kg m^2]. */
struct body_inertia {
    double axial, transverse;
};

/* Of a body of free rotation, by its parameters. */
struct body_inertia body_inertia_of(const struct scene_values *v, int body);

/* The law of friction of a contact. */
struct friction_law scene_friction_law(const struct scene_values *v, const struct scene_state *q,
                                       int contact);

#if SCENE_ANY_TURNING

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

#endif
#endif
