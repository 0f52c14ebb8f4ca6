/* The singularity d = 0 of solid bodies: n is undefined there and reverses; the escape direction takes its
 * place. */
#ifndef CONTACT_SCENE_PRESENT_H
#define CONTACT_SCENE_PRESENT_H

#include "math/compiler.h"
#include "scene/evaluate.h"
#include "scene/scene_jet.h"

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
static inline enum contact_regime onset_note(const struct scene_values *v, struct scene_state *q,
                                             const struct scene_instant *at, int contact,
                                             enum contact_regime next)
{
    if (SCENE_ANY_RESTITUTION && SCENE_ANY_HERTZ) {
        return scene_damps_by_onset(v, contact) ? onset_take_damping(v, q, at, contact, next) : next;
    }
    return next;
}

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

/* Coefficient `order` of the energies along a path (scene_jet.h). */
double jet_of_kinetic(const struct scene_values *v, const struct scene_jet *along, int order);
double jet_of_potential(const struct scene_values *v, const struct scene_jet *along, int order);
double jet_of_stored(const struct scene_values *v, const struct scene_state *q, const struct scene_jet *along,
                     int order);

/* Shows a body's displacement, position and velocity: those given, or those of the present. */
void present_body(struct scene_values *v, int body, struct vec3 displacement, struct vec3 velocity);
void present_body_now(struct scene_values *v, const struct scene_state *q, int body);

#endif
