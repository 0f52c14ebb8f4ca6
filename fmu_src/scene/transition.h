/*
 * Transitions: changes of the regimes of law and friction, and the instants at which bodies begin or cease to
 * touch. The margins below tell how far a contact is from its next change of regime, for an integrator that
 * finds zeros of continuous functions. Each margin is increased in size by a few rounding errors. It is
 * therefore never zero right after a change, and rounding alone never changes its sign.
 */
#ifndef CONTACT_SCENE_TRANSITION_H
#define CONTACT_SCENE_TRANSITION_H

#include "scene/evaluate.h"
#include "scene/ode.h"

/* Returns the larger of the gap and the source's distance beyond the ends of a cylinder [m]: positive without
 * contact, negative in contact. */
double regime_touch_margin(const struct scene_instant *at, int contact);

/* Returns the force whose zero changes the regime [N]: F_n of the full law, or with an approach-only dashpot
 * the viscous part of F_n. The force is positive in compression, negative in restitution and while
 * separating, and 1 N where the law has no events. */
double regime_dashpot_margin(const struct scene_instant *at, int contact);

/* Returns the distance of the source's centre from the edges of the contact's zone [m]; 1 m where the
 * contact has no zone. */
double regime_zone_margin(const struct scene_instant *at, int contact);

/* Returns one of the event functions of friction (contact/friction.h): for sticking and sliding, for the
 * largest friction force, or for a dashpot that pulls. It is positive in the regimes before the change,
 * negative in those beyond, and 1 where no change is possible. */
double regime_friction_margin(const struct scene_instant *at, int contact, enum ode_event event);

/* Returns the event of friction whose margin has passed zero, or ODE_EVENT_GAP where none has. */
enum ode_event regime_friction_event(const struct scene_instant *at, int contact);

/* Returns the regime by the touch margin and the dashpot margin: the present one unless a margin has passed
 * zero. */
enum contact_regime regime_by_margins(const struct scene_instant *at, int contact);

/*
 * Sets friction after a contact has changed its regime from `before` at the present instant. Where the force
 * begins, friction begins with a spring at rest, and sticks if sticking persists. Where the force ends,
 * friction ends, and the energy in its spring is dissipated. Else friction goes on in the regime that the new
 * force asks for. Nothing is done where the contact does not rub.
 */
void turning_take_regime(struct scene_state *q, int contact, enum contact_regime before);

/* Changes the regime of friction after an event of friction (enum ode_event) at the present instant. */
void turning_take_event(struct scene_state *q, int contact, enum ode_event event);

/* Sets the regime of a contact and of its friction at the present instant, and notes an onset or the end of
 * the contact. */
void transition_set_regime(struct scene_state *q, int contact, enum contact_regime regime);

/*
 * Puts a contact into a new regime at the present instant. Counts an onset when bodies begin to overlap, and
 * closes the duration when they cease to. Books a jump of the stored energy, as where a finite cylinder's end
 * switches the force off, as dissipated. Counts an event, and moves the origin of the clock to the present.
 * `at` becomes the instant of scene_kinematics_now afterwards. If the new regime is the present one, the
 * contact passes into its next zone.
 */
void transition_change_regime(struct scene_state *q, int contact, enum contact_regime regime,
                              struct scene_instant *at);

/* Changes the regime of friction after an event and begins a phase. The regime of the law stays. */
void transition_change_friction(struct scene_state *q, int contact, enum ode_event event,
                                struct scene_instant *at);

/*
 * Sets the regimes by the geometry of the present, at the start and after inputs have jumped. `stored_before`
 * [J] is the energy stored before the jump; the difference counts as external work of whatever moved the
 * prescribed body. A gap smaller than its rounding bound leaves the regime as it is, unless `starting`.
 */
void transition_settle_regimes(struct scene_state *q, double stored_before, bool starting);

/*
 * Sets the regimes of the contacts whose law has `changed`, and begins a phase. Contacts that touch go on
 * touching. `stored_before` [J] is the energy that all contacts stored before; the difference counts as
 * external work.
 */
void transition_take_law(struct scene_state *q, const bool *changed, double stored_before);

/* Scales the error bound of a contact's force [N] to the new factors. Errors of the gap and its rate make
 * this error, and the factors multiply them. */
void transition_scale_force_error(struct scene_state *q, int contact, struct contact_coefficients next);

/* Begin and end a communication step, over which peaks and mean force are taken. `at` becomes the present
 * instant. */
void transition_begin_step(struct scene_state *q, struct scene_instant *at);
void transition_end_step(struct scene_state *q);

#endif
