/*
 * How bodies rotate and move in flight. Without a torque the rotation is a closed form from the origin of the
 * clock, so that the result does not depend on the communication steps. Under a torque the rotation is a
 * power series from the present.
 */
#ifndef CONTACT_FLIGHT_FLIGHT_H
#define CONTACT_FLIGHT_FLIGHT_H

#include "flight/conservative_advancement.h"
#include "flight/relative_path.h"
#include "scene/evaluate.h"

/* Returns the motion of a freely turning body's axis without contact forces from now on, or of any direction
 * of a compound body; `at` is the present rotation and `direction` that of the axis. */
struct axis_motion flight_axis_motion(const struct scene_state *q, const struct body_turn *at, int body,
                                      struct vec3 direction);

/* Turns a freely turning body to a clock and books the work of its external torque, but does not move the
 * clock. */
void flight_turn(struct scene_state *q, int body, double clock);

/*
 * Head-on flight: bodies without contact forces move along their normal alone, with a constant relative
 * acceleration. The gap is a parabola of time, and the time of its zero is the root of a quadratic equation.
 */

/* Returns the part of a term of the motion that changes the gap in head-on flight: for a plane its part along
 * n, for a cylinder its part across the axis. */
struct vec3 flight_part_that_counts(const struct contact_shape *shape, struct vec3 normal, struct vec3 a);

/* Whether flight is head-on: the separation, without a cylinder's axial part, moves exactly along the normal
 * as a parabola of time. */
bool flight_is_head_on(const struct contact_shape *shape, const struct separation_path *separation,
                       struct vec3 normal);

/* Sets the time until the first touch [s]; INFINITY: no touch within the horizon. Returns false where the
 * rounding of the gap decides whether the bodies touch, or the source may pass the centre of a hollow
 * destination. */
bool flight_head_on_touch(const struct contact_shape *shape, const struct separation_path *separation,
                          const struct contact_geometry *now, double rounding, double horizon, double *touch);

/*
 * Motion without contact forces, in closed form. The acceleration of a free body is gravity + force(t) / m
 * with a force of degree two at most, so its displacement is a polynomial of degree four at most. The
 * polynomial is evaluated from the origin of the clock, so that the result does not depend on the
 * communication steps.
 */

/* Whether no contact transmits a force: all contacts are apart or separating. */
bool flight_is_free(const struct scene_state *q);

/* Whether a body rests, or flies under a constant force. */
bool flight_is_steady(const struct scene_state *q, int body);

/* The external force on a free body [N] and its velocity without contact forces [m/s], as polynomials of the
 * time since a clock. The velocity has two terms under a constant force. */
enum { FLIGHT_TERMS = 4 };
struct free_flight {
    struct vec3 force[3], velocity[FLIGHT_TERMS];
    int terms; /* of the velocity */
};

/* Returns the flight of a free body that has a velocity at a clock. */
struct free_flight free_flight_of(const struct scene_state *q, int body, double clock, struct vec3 velocity);

/* These are the integrals of s^i over [0, 1]; multiplied by them, velocity coefficients become displacement
 * coefficients. */
static const double FLIGHT_MEAN[FLIGHT_TERMS] = {1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0};

/* Returns the displacement in `time` seconds by the coefficients of a velocity [m]. */
struct vec3 flight_displacement(const struct vec3 *velocity, int terms, double time);

/* Return the work of the external force over the first `time` seconds of a flight [J]. */
double flight_work_along(const struct free_flight *f, double time);
double flight_work(const struct scene_state *q, int body, struct vec3 velocity, double clock, double time);

/* Flies a free body for `time` seconds, and adds what contact forces change [m, m/s]. Books the work of the
 * external force along the flight alone. */
void flight_deviate(struct scene_state *q, int body, double time, struct vec3 moved, struct vec3 velocity);

/* Returns a free body's state at a clock, by the polynomial from the clock's origin. */
struct body_state flight_body_at(const struct scene_state *q, int body, double clock);

/* Moves all free bodies to `clock` while flight_is_free. Books the work of the external forces, and the
 * stored energy that separating contacts lose. */
void flight_advance(struct scene_state *q, double clock);

/* Returns the energy stored by separating contacts [J]. Their force is zero, so that this energy is
 * dissipated as the gap opens. Prescribed contacts count only if `all`, because where quadrature moves them
 * it books that energy. */
double flight_stored_energy(const struct scene_state *q, bool all);

/* Returns the state of a free body without external force at a clock. */
static inline struct body_state flight_unforced_at(const struct scene_state *q, int body, double clock)
{
    const struct vec3 start = q->origin[body].velocity;
    const struct vec3 mean = vec3_axpy(start, clock, vec3_scale(0.5, gravity(q->v)));
    return (struct body_state){vec3_scale(clock, mean), vec3_axpy(start, clock, gravity(q->v))};
}

/*
 * In a deferred flight, which has no external forces, the body states are closed forms of the clock, so they
 * are computed only when they are read. flight_deferrable_until returns the clock until which deferring is
 * allowed (0: not at all): no contact has a force or changes, no direction becomes undefined, and all numbers
 * stay finite. flight_defer advances the clock alone, or returns false and does nothing; in flight the peaks
 * and the mean force of the communication step are then zero. Where only the means and peaks of the last step
 * keep flight_defer from that, flight_end_means ends them and returns true. flight_catch_up computes the body
 * states at the present clock.
 */
double flight_deferrable_until(const struct scene_state *q);
bool flight_defer(struct scene_state *q, double end_time);
bool flight_end_means(struct scene_state *q, double end_time);
void flight_catch_up(struct scene_state *q);

/* Whether no force acts on a free body but weight and contact, and speeds, places and energies stay far from
 * overflow up to a clock. */
bool flight_stays_finite(const struct scene_state *q, double clock);

/* Replaces an integrator's result by the closed form where there is one: for bodies without contact forces,
 * and for the axial motion of bodies loaded only by cylinders, whose forces are perpendicular to the axis.
 * Touches and passages of end planes then occur exactly at the clocks of prediction_of. */
void flight_restore(struct scene_state *q);

#endif
