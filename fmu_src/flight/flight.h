/*
 * How bodies turn in flight. Without a torque in closed form, from the origin of the clock, so that the
 * result does not depend on how the flight is cut into communication steps; under one by series from the
 * present.
 */
#ifndef CONTACT_FLIGHT_FLIGHT_H
#define CONTACT_FLIGHT_FLIGHT_H

#include "flight/relative_path.h"
#include "flight/tumbling.h"
#include "scene/evaluate.h"

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

/*
 * Head-on flight: bodies that are apart and move along their normal alone, under a constant relative
 * acceleration along it. The gap is a parabola of time and its zero a root of a quadratic equation.
 */

/* Whether the separation, without a cylinder's axial part, moves so. Exactly so, not nearly: any other motion
 * leaves the normal. */
bool flight_is_head_on(const struct contact_shape *shape, const struct separation_path *separation,
                       struct vec3 normal);

/* The first touch in seconds from now, INFINITY: none within the horizon. False where a closer look is
 * needed: rounding (of the gap: `gap_rounding`) decides whether the bodies touch, or the source may pass the
 * centre of a hollow destination. */
bool flight_head_on_touch(const struct contact_shape *shape, const struct separation_path *separation,
                          const struct contact_geometry *now, double rounding, double horizon, double *touch);

/* How a separating contact ends: the gap opens (apart), or the law pushes again (compression); INFINITY:
 * never. */
struct flight_regime_end {
    double after; /* [s] */
    enum contact_regime regime;
    double gap; /* then [m] */
};

/* The end of a separating regime. `margin_rounding` is the rounding bound of the event function [N]. The
 * centre is not passed: the gap grows as long as the formula would pull. */
bool flight_head_on_regime_end(const struct contact_shape *shape, const struct contact_law *law,
                               const struct separation_path *separation, const struct contact_geometry *now,
                               double rounding, double margin_rounding, struct flight_regime_end *end);

/*
 * Motion without contact forces, in closed form: a free body's acceleration is gravity + force(t) / m with a
 * force of degree two at most, so its displacement is a polynomial of degree four. Evaluated from the origin
 * of the clock, so that the result does not depend on how the flight is cut into communication steps.
 */

/* No contact transmits a force: all are apart or separating. */
bool flight_is_free(const struct scene_state *q);

/* The external force on a body as a polynomial of time from a clock on. */
void flight_force(const struct scene_state *q, int body, double clock, struct vec3 force[3]);

/* Coefficients of a free body's velocity as a polynomial of time, by gravity and a force with the same
 * origin; returns how many it has: two while the force is steady. */
enum { FLIGHT_TERMS = 4 };
int flight_velocity(const struct scene_values *v, int body, struct vec3 start, const struct vec3 force[3],
                    struct vec3 velocity[FLIGHT_TERMS]);

/* Integral of s^i over [0, 1]: what makes displacements of velocities. */
static const double FLIGHT_MEAN[FLIGHT_TERMS] = {1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0};

/* How far a body moves with such a velocity, and the work that a force does on it [m], [J]. */
struct vec3 flight_displacement(const struct vec3 *velocity, int terms, double time);
double flight_work_along(const struct vec3 *velocity, int terms, const struct vec3 force[3], double time);

/* A free body's state `time` after `start`, and the work of the external force until then; `force` has its
 * origin there. */
struct body_state flight_from(const struct scene_values *v, int body, struct body_state start,
                              const struct vec3 force[3], double time);
double flight_work(const struct scene_values *v, int body, struct body_state start,
                   const struct vec3 force[3], double time);

/* A free body's state at a clock, from its origin. */
struct body_state flight_body_at(const struct scene_values *v, const struct scene_state *q, int body,
                                 double clock);

/* Moves all free bodies to `clock`, with the work of the external forces and, in separating contacts, the
 * stored energy that is lost. Only while flight_is_free. */
void flight_advance(const struct scene_values *v, struct scene_state *q, double clock);

/* flight_body_at where there is no force, bit for bit. */
static inline struct body_state flight_unforced_at(const struct scene_values *v, const struct scene_state *q,
                                                   int body, double clock)
{
    const struct vec3 start = q->origin[body].velocity;
    const struct vec3 mean = vec3_axpy(start, clock, vec3_scale(0.5, gravity(v)));
    return (struct body_state){vec3_scale(clock, mean), vec3_axpy(start, clock, gravity(v))};
}

/*
 * Deferred flight: without external forces the body states are closed forms of the clock, so they need not be
 * computed before somebody reads them. flight_deferrable_until says up to which clock that holds (0: not at
 * all): no contact changes, no direction becomes undefined, all numbers stay finite, and peaks and mean force
 * of the communication step are zero. flight_defer advances the clock alone, or returns false and does
 * nothing; flight_catch_up computes the body states. They depend on the clock only, not on when or how often
 * that is done.
 */
double flight_deferrable_until(const struct scene_values *v, const struct scene_state *q);
bool flight_defer(struct scene_state *q, double end_time);
void flight_catch_up(const struct scene_values *v, struct scene_state *q);

/* Replaces what an integrator has computed by the closed form where there is one: bodies without contact
 * forces, and the axial motion of bodies loaded by cylinders only, whose forces are perpendicular to the
 * axis. Touches and ends then occur exactly when next_regime_change says. */
void flight_restore(const struct scene_values *v, struct scene_state *q);

#endif
