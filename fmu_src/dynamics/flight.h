/*
 * Motion without contact forces, in closed form: a free body's acceleration is gravity + force(t) / m with a force of
 * degree two at most, so its displacement is a polynomial of degree four. Evaluated from the origin of the clock, so that
 * the result does not depend on how the flight is cut into communication steps.
 */
#ifndef CONTACT_FLIGHT_H
#define CONTACT_FLIGHT_H

#include "dynamics/system.h"

#if SCENE_ANY_FREE

/* No contact transmits a force: all are apart or released. */
bool flight_is_free(const struct motion *q);

/* The external force on a body as a polynomial of time from a clock on. */
void flight_force(const struct motion *q, int body, double clock, struct vec3 force[3]);

/* Coefficients of a free body's velocity as a polynomial of time, by gravity and a force with the same origin; returns how many it has:
 * two while the force is steady. */
enum { FLIGHT_TERMS = 4 };
int flight_velocity(const struct scene_values *v, int body, struct vec3 start, const struct vec3 force[3],
                    struct vec3 velocity[FLIGHT_TERMS]);

/* Integral of s^i over [0, 1]: what makes displacements of velocities. */
static const double FLIGHT_MEAN[FLIGHT_TERMS] = {1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0};

/* A free body's state `time` after `start`, and the work of the external force until then; `force` has its origin there. */
struct body_state flight_from(const struct scene_values *v, int body, struct body_state start,
                              const struct vec3 force[3], double time);
double flight_work(const struct scene_values *v, int body, struct body_state start,
                   const struct vec3 force[3], double time);

/* A free body's state at a clock, from its origin. */
struct body_state flight_body_at(const struct scene_values *v, const struct motion *q, int body,
                                 double clock);

/* Moves all free bodies to `clock`, with the work of the external forces and, in released contacts, the stored energy
 * that is lost. Only while flight_is_free. */
void flight_advance(const struct scene_values *v, struct motion *q, double clock);

/* flight_body_at where there is no force, digit for digit. */
static inline struct body_state flight_falling_at(const struct scene_values *v, const struct motion *q,
                                                  int body, double clock)
{
    const struct vec3 start = q->origin[body].velocity;
    const struct vec3 mean = vec3_axpy(start, clock, vec3_scale(0.5, gravity(v)));
    return (struct body_state){vec3_scale(clock, mean), vec3_axpy(start, clock, gravity(v))};
}

/*
 * Gliding: in flight without external forces nobody has to know where the bodies are until somebody asks. flight_quiet_until
 * says up to which clock that holds (0: not at all): no contact changes, no direction loses its meaning, every number stays
 * finite, and the communication step, whose peaks and mean force are zero, is like the next. flight_glide then moves the
 * clock alone, or does nothing and returns false; flight_arrive has the bodies follow. The clock alone says where, so that it
 * does not matter when or how often they do.
 */
double flight_quiet_until(const struct scene_values *v, const struct motion *q);
bool flight_glide(struct motion *q, double end_time);
void flight_arrive(const struct scene_values *v, struct motion *q);

/* Puts right what an integrator made of motion that is known in closed form: bodies that nothing presses on, and the axial
 * motion of bodies that only a cylinder presses on, which it does perpendicularly to its axis. Touches and ends are then
 * passed exactly when encounter_next said. */
void flight_restore(const struct scene_values *v, struct motion *q);

#endif
#endif
