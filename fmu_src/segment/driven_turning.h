/*
 * Contacts that turn or rub over a span of time in which all motion is given: neither body is free or turns
 * freely. No touch is missed (tumbling_touch.h). Within a contact impulses and energies are quadratures
 * (driven_quadrature.h).
 */
#ifndef CONTACT_SEGMENT_DRIVEN_TURNING_H
#define CONTACT_SEGMENT_DRIVEN_TURNING_H

#include "scene/turning.h"

#if SCENE_ANY_TURNING

/* Over `length` seconds from the present. Regimes and spring of q become those at the end; impulses, or means
 * in scenes without free bodies, peaks, energies and onsets are booked. False: `budget` panels were not
 * enough. */
bool driven_turning_over(const struct scene_values *v, struct scene_state *q, double length, long *budget);

/* Puts the regimes of contact and friction to what the present asks for: at the start, and after inputs have
 * jumped. */
void driven_turning_settle(const struct scene_values *v, struct scene_state *q, int contact);

#endif
#endif
