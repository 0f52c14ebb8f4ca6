/* Transitions: a contact changes its regime, bodies begin or cease to touch; peaks and communication
 * steps. */
#ifndef CONTACT_SCENE_TRANSITION_H
#define CONTACT_SCENE_TRANSITION_H

#include "scene/ode.h"
#include "scene/present.h"

/*
 * Puts a contact into a new regime at the present instant: counts an onset when bodies begin to overlap,
 * closes the duration when they cease to, and books a jump of the stored energy (a finite cylinder's end
 * switched the force) as dissipated. Counts an event. The clock is rebased. `at` becomes the instant as
 * scene_kinematics_now sees it from then on. The regime that the contact has already: it passes into the next
 * zone of a capped cylinder.
 */
void transition_change_regime(const struct scene_values *v, struct scene_state *q, int contact,
                              enum contact_regime regime, struct scene_instant *at);

#if SCENE_ANY_FRICTION
/* Takes over a change of friction alone, after one of its own event functions (scene/ode.h); the rest as
 * above. */
void transition_change_friction(const struct scene_values *v, struct scene_state *q, int contact,
                                enum ode_event event, struct scene_instant *at);
#endif

/* The same for bodies that an integrator outside moves: they stay where they are, and peaks are not noted.
 * The zone is then the nearest. */
void transition_switch_regime(const struct scene_values *v, struct scene_state *q, int contact,
                              enum contact_regime regime);
#if SCENE_ANY_FRICTION
void transition_switch_friction(const struct scene_values *v, struct scene_state *q, int contact,
                                enum ode_event event);
#endif

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
