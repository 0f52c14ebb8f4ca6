/*
 * Event indicators with a hysteresis: the distance of a contact from its next change of regime, for an
 * integrator that finds zeros of continuous functions. Each is increased in size by a few roundings, so that
 * it is never zero right after a change and rounding alone changes no sign.
 */
#ifndef CONTACT_SCENE_TRANSITION_H
#define CONTACT_SCENE_TRANSITION_H

#include "scene/evaluate.h"
#include "scene/ode.h"

/* The larger of the gap and the source's distance beyond the ends of its cylinder [m]: positive without
 * contact, negative in contact. */
double regime_touch_margin(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at, int contact);

/* The force at which the dashpot changes the law [N]: F_n of the full law, or under an approach-only dashpot
 * its viscous part; positive in compression, negative in restitution and while separating; 1 N where nothing
 * changes. */
double regime_dashpot_margin(const struct scene_values *v, const struct scene_state *q,
                             const struct scene_instant *at, int contact);

/* Distance of the source's centre from the edges of the contact's zone of a capped cylinder [m]; 1 m where
 * the contact has no zone. */
double regime_zone_margin(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, int contact);

/* The event functions of friction (contact/friction.h): for sticking and sliding, for the largest friction
 * force, for a dashpot that pulls. Each is negative beyond its change and 1 where no change is possible. */
double regime_friction_margin(const struct scene_values *v, const struct scene_state *q,
                              const struct scene_instant *at, int contact, enum ode_event event);

/* The event of friction whose margin has passed zero; ODE_EVENT_GAP: none has. */
enum ode_event regime_friction_event(const struct scene_values *v, const struct scene_state *q,
                                     const struct scene_instant *at, int contact);

/* The regime that follows from touch and dashpot: the present one unless a margin has passed zero. */
enum contact_regime regime_by_margins(const struct scene_values *v, const struct scene_state *q,
                                      const struct scene_instant *at, int contact);

/*
 * After a contact has changed its regime from `before` at the present instant: friction begins with a spring
 * at rest, sticking where that persists; or ends, and what its spring stores is dissipated; or goes on, in
 * the regime that the new force asks for. Nothing is done where the contact does not rub.
 */
void turning_take_regime(const struct scene_values *v, struct scene_state *q, int contact,
                         enum contact_regime before);

/* Changes the regime of friction after one of friction's own events (scene/ode.h) at the present instant. */
void turning_take_event(const struct scene_values *v, struct scene_state *q, int contact,
                        enum ode_event event);

/* Transitions: a contact changes its regime, bodies begin or cease to touch; peaks and communication
 * steps. */

/*
 * Puts a contact into a new regime at the present instant: counts an onset when bodies begin to overlap,
 * closes the duration when they cease to, and books a jump of the stored energy (a finite cylinder's end
 * switched the force) as dissipated. Counts an event and rebases the clock. `at` becomes the instant of
 * scene_kinematics_now afterwards. Where the new regime is the present one, the contact passes into the next
 * zone of a capped cylinder.
 */
void transition_change_regime(const struct scene_values *v, struct scene_state *q, int contact,
                              enum contact_regime regime, struct scene_instant *at);

/* transition_change_regime after an event of friction alone (scene/ode.h). */
void transition_change_friction(const struct scene_values *v, struct scene_state *q, int contact,
                                enum ode_event event, struct scene_instant *at);

/* transition_change_regime for bodies that the importer integrates: they stay where they are, peaks are not
 * noted, and the zone is the nearest. */
void transition_switch_regime(const struct scene_values *v, struct scene_state *q, int contact,
                              enum contact_regime regime);
void transition_switch_friction(const struct scene_values *v, struct scene_state *q, int contact,
                                enum ode_event event);

/*
 * Sets the regimes by the geometry of the present: at the start, and after inputs have jumped.
 * `stored_before` is the stored energy before the jump; the difference is external work of whatever moved the
 * prescribed body. A gap within its rounding bound of zero leaves the regime as it is, unless `starting`.
 */
void transition_settle_regimes(const struct scene_values *v, struct scene_state *q, double stored_before,
                               bool starting);

/*
 * Sets the regimes by the new law after the law of some contacts has changed, and begins a phase. Contacts
 * that touch go on touching. `stored_before` [J] is the energy that all contacts stored before; the
 * difference counts as external work.
 */
void transition_take_law(const struct scene_values *v, struct scene_state *q, const bool *changed,
                         double stored_before);

/* Scales the known error of a contact's force, which is an error of gap and rate, by the new factors. */
void transition_scale_force_error(struct scene_state *q, int contact, struct contact_coefficients next);

/* Begins a communication step, over which peaks and mean force are taken; `at` becomes the present instant.
 * Ends the communication step. */
void transition_begin_step(const struct scene_values *v, struct scene_state *q, struct scene_instant *at);
void transition_end_step(const struct scene_values *v, struct scene_state *q);

#endif
