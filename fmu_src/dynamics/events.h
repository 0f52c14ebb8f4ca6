/* What happens at an instant: a contact changes its regime, bodies begin or cease to touch, a peak is passed. */
#ifndef CONTACT_EVENTS_H
#define CONTACT_EVENTS_H

#include "dynamics/system.h"

#if SCENE_ANY_FREE

/*
 * Puts a contact into a new regime at the present instant: counts an onset when bodies begin to overlap, closes the
 * duration when they cease to, and books a jump of the stored energy (a finite cylinder's end switched the force) as
 * dissipated. Counts an event. The clock is rebased. `at` becomes the instant as system_place sees it from then on.
 */
void event_change_regime(const struct scene_values *v, struct motion *q, int contact,
                         enum contact_regime regime, struct system_instant *at);

/*
 * Regimes by the geometry of the present: at the start, and after inputs have jumped. `stored_before` is the stored
 * energy before the jump; the agent that moved a prescribed body has done the difference as external work. A gap within
 * its own rounding of zero leaves the regime as it is, unless `starting`.
 */
void event_settle_regimes(const struct scene_values *v, struct motion *q, double stored_before,
                          bool starting);

/* Begins a communication step: the peaks and the mean force are those from here on, `at` is the instant; and ends it. */
void event_begin_window(const struct scene_values *v, struct motion *q, struct system_instant *at);
void event_end_window(const struct scene_values *v, struct motion *q);

/* Takes the instant into account for the peaks of the communication step. */
void event_note_peaks(struct motion *q, const struct system_instant *at);

#endif
#endif
