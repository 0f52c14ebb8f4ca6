/*
 * How bodies turn in flight. Without a torque in closed form, from the origin of the clock, so that the
 * result does not depend on how the flight is cut into communication steps; under one by series from the
 * present.
 */
#ifndef CONTACT_SEGMENT_FLIGHT_TURNING_H
#define CONTACT_SEGMENT_FLIGHT_TURNING_H

#include "scene/evaluate.h"
#include "segment/axis_motion.h"

#if SCENE_ANY_ROTATION

/* A body of free rotation at a clock no earlier than the present. */
struct body_turn flight_turn_at(const struct scene_values *v, const struct scene_state *q, int body,
                                double clock);

/* The energy that a torque gives it until then [J]. */
double flight_torque_work(const struct scene_values *v, const struct scene_state *q, int body,
                          const struct body_turn *then);

/* Turns all bodies of free rotation, and books the work of torques; the clock is the caller's. */
void flight_turn_all(const struct scene_values *v, struct scene_state *q, double clock);

/* The axis of a body from the present on, which `at` shows; without contact forces on it. */
struct axis_motion flight_axis_motion(const struct scene_values *v, const struct scene_state *q,
                                      const struct body_turn *at, int body);

#endif
#endif
