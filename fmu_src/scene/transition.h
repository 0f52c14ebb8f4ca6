/*
 * Transitions are changes of the regimes of law and friction, and the instants at which bodies begin or cease
 * to touch. The margins below tell how far a contact is from its next change of regime, for an integrator
 * that finds zeros of continuous functions. Each margin is increased in size by a few rounding errors. It is
 * therefore never zero right after a change, and rounding alone never changes its sign.
 */
#ifndef CONTACT_SCENE_TRANSITION_H
#define CONTACT_SCENE_TRANSITION_H

#include "scene/evaluate.h"
#include "scene/ode.h"

/* Returns the margin of an event of a contact: positive in the regimes before the change, negative in those
 * beyond it, and 1 where no change is possible. The margin of the touch is the larger of the gap and the
 * source's distance beyond the ends of a cylinder [m]. The margin of the law is F_n of the full law, or with
 * an approach-only dashpot the viscous part of F_n [N]. */
double regime_margin(const struct scene_instant *at, int contact, enum ode_event event);

/* Returns the first event of a contact whose margin has passed zero (enum ode_event), or -1. */
int regime_event(const struct scene_instant *at, int contact);

/* Changes the regime of friction after an event of friction (enum ode_event) at the present instant. */
void turning_take_event(struct scene_state *q, int contact, enum ode_event event);

/* Sets the regime of a contact and of its friction at the present instant, and notes an onset or the end of
 * the contact. */
void transition_set_regime(struct scene_state *q, int contact, enum contact_regime regime);

/*
 * Takes an event of a contact (enum ode_event) at the present instant, counts it, moves the origin of the
 * clock to the present and begins a phase. An event of friction changes its regime alone. Any other event
 * puts the contact into the `regime`. It counts an onset when bodies begin to overlap, and closes the
 * duration when they cease to. It books a jump of the stored energy, as where a finite cylinder's end
 * switches the force off, as dissipated. If the new regime is the present one, the contact passes into its
 * next zone. `at` becomes the instant of scene_kinematics_now afterwards.
 */
void transition_take_event(struct scene_state *q, int contact, int event, enum contact_regime regime,
                           struct scene_instant *at);

/*
 * A limit of friction that jumps stretches no spring. Before inputs or parameters make F_n jump, this
 * function therefore lets each opposed motion that slides without a dashpot stick, with the spring that
 * carries the friction force of the instant `at`. It sets `stopped` for each opposed motion of each contact:
 * whether it has stopped the motion. transition_hold_springs has to follow the jump.
 */
void transition_stop_sliding(struct scene_state *q, const struct scene_instant *at, bool *stopped);

/*
 * Sets the springs of elastic friction without a dashpot after a jump. A motion that transition_stop_sliding
 * has `stopped` slides on unless its limit of friction has grown; `stopped` is NULL where F_n itself has not
 * jumped. A motion that slides sticks if its limit now grows faster than the slip stretches the spring: the
 * rate of F_n jumps with gravity and with the force of another contact on one of the bodies.
 */
void transition_hold_springs(struct scene_state *q, const bool *stopped);

/*
 * Sets the regimes by the geometry of the present, at the start and after inputs have jumped. `stored_before`
 * [J] is the energy stored before the jump; the difference counts as external work of whatever moved the
 * prescribed body. A gap smaller than its rounding bound leaves the regime as it is, unless `starting`.
 */
void transition_settle_regimes(struct scene_state *q, double stored_before, bool starting);

/*
 * Sets the regimes of the contacts whose law has `changed`, and begins a phase. Contacts that touch go on
 * touching. `stored_before` [J] is the energy that all contacts stored before; the difference counts as
 * external work. The array `stopped` comes from transition_stop_sliding, called before the change.
 */
void transition_take_law(struct scene_state *q, const bool *changed, double stored_before,
                         const bool *stopped);

/* Begin and end a communication step, over which peaks and mean force are taken. Where the begin needs the
 * present instant, it sets `at` and returns true. transition_mark_step lets means and peaks begin anew, and
 * needs no instant. */
void transition_mark_step(struct scene_state *q);
bool transition_begin_step(struct scene_state *q, struct scene_instant *at);
void transition_end_step(struct scene_state *q);

#endif
