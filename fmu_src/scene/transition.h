/*
 * How far a contact is from its next change of regime, for an integrator that finds zeros of continuous
 * functions: event indicators with a hysteresis. Each is widened by a few rounding errors to the side where
 * it is, so that it is never zero right after a change and rounding alone changes nothing.
 */
#ifndef CONTACT_SCENE_TRANSITION_H
#define CONTACT_SCENE_TRANSITION_H

#include "scene/evaluate.h"
#include "scene/ode.h"

/* The gap, or how far the source is beyond the ends of its cylinder where that is more [m]: positive without
 * contact, negative in contact. */
double regime_touch_margin(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at, int contact);

/* The force at which the dashpot changes the law [N]: F_n of the full law, or under an approach-only dashpot
 * its viscous part; positive in compression, negative in restitution and while separating; 1 N where nothing
 * changes. */
double regime_dashpot_margin(const struct scene_values *v, const struct scene_state *q,
                             const struct scene_instant *at, int contact);

/* How far the source's centre is within the edges of the zone of a capped cylinder that the contact is in;
 * 1 m where there is none [m]. */
double regime_zone_margin(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, int contact);

/* The event functions of friction (contact/friction.h), negative on the other side of their change: that of
 * a contact that slides, that of friction at its largest force, that of a dashpot that pulls; 1 where nothing
 * changes. */
double regime_friction_margin(const struct scene_values *v, const struct scene_state *q,
                              const struct scene_instant *at, int contact, enum ode_event event);

/* The event of friction whose margin has passed zero; ODE_EVENT_GAP: none has. */
enum ode_event regime_friction_event(const struct scene_values *v, const struct scene_state *q,
                                     const struct scene_instant *at, int contact);

/* The regime that follows from touch and dashpot: the present one unless a margin has passed zero. */
enum contact_regime regime_by_margins(const struct scene_values *v, const struct scene_state *q,
                                      const struct scene_instant *at, int contact);

/* Changes of the regime of friction, besides those of the contact: who rubs begins to stick or to slide. */

/*
 * After a contact has changed its regime from `before` at the present instant: friction begins with a spring
 * at rest, sticking where that persists; or ends, and what its spring stores is dissipated; or goes on, in
 * the regime that the new force asks for. Nothing is done where the contact does not rub.
 */
void turning_take_regime(const struct scene_values *v, struct scene_state *q, int contact,
                         enum contact_regime before);

/* After one of friction's own events (scene/ode.h) at the present instant. */
void turning_take_event(const struct scene_values *v, struct scene_state *q, int contact,
                        enum ode_event event);

/* Transitions: a contact changes its regime, bodies begin or cease to touch; peaks and communication
 * steps. */

/*
 * Puts a contact into a new regime at the present instant: counts an onset when bodies begin to overlap,
 * closes the duration when they cease to, and books a jump of the stored energy (a finite cylinder's end
 * switched the force) as dissipated. Counts an event. The clock is rebased. `at` becomes the instant as
 * scene_kinematics_now sees it from then on. The regime that the contact has already: it passes into the next
 * zone of a capped cylinder.
 */
void transition_change_regime(const struct scene_values *v, struct scene_state *q, int contact,
                              enum contact_regime regime, struct scene_instant *at);

/* Takes over a change of friction alone, after one of its own event functions (scene/ode.h); the rest as
 * above. */
void transition_change_friction(const struct scene_values *v, struct scene_state *q, int contact,
                                enum ode_event event, struct scene_instant *at);

/* The same for bodies that an integrator outside moves: they stay where they are, and peaks are not noted.
 * The zone is then the nearest. */
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
 * After the law of some contacts has changed: regimes by the new law. All contacts stored
 * `stored_before` [J]; the difference is external work of whoever changed it. Who touches goes on touching. A
 * phase begins.
 */
void transition_take_law(const struct scene_values *v, struct scene_state *q, const bool *changed,
                         double stored_before);

/* What is known of the error of a force is one of the gap and its rate: it grows with the factors. */
void transition_scale_force_error(struct scene_state *q, int contact, struct contact_coefficients next);

/* Begins a communication step, from which peaks and mean force count; `at` becomes the present instant. And
 * ends it. */
void transition_begin_step(const struct scene_values *v, struct scene_state *q, struct scene_instant *at);
void transition_end_step(const struct scene_values *v, struct scene_state *q);

#endif
