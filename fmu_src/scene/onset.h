/*
 * What a contact takes from its onset: with a coefficient of restitution the factor chi of Hunt and
 * Crossley's damping, such that chi v is the number that gives it, v the speed of approach [m/s].
 *
 * A start in overlap counts with the speed that its motion and its stored energy together would have at the
 * touch. Where the bodies touch without speed, v is the largest that their load gives them while it presses
 * them together from rest; so it is in place of any smaller one, of which a load leaves no trace. The load
 * leaves out what a plane adds that turns. Bodies that touch with no speed and no load have no damping.
 */
#ifndef CONTACT_SCENE_ONSET_H
#define CONTACT_SCENE_ONSET_H

#include "math/compiler.h"
#include "scene/present.h"

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
#if SCENE_ANY_RESTITUTION && SCENE_ANY_HERTZ
    return scene_damps_by_onset(v, contact) ? onset_take_damping(v, q, at, contact, next) : next;
#else
    (void)v, (void)q, (void)at, (void)contact; /* nor has the scene that function */
    return next;
#endif
}

#endif
