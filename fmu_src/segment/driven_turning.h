/*
 * Contacts that turn or rub over a span of time in which all motion is given: neither body is free or turns
 * freely. No touch is missed (tumbling_touch.h). Within a contact impulses and energies are quadratures
 * (driven_quadrature.h).
 */
#ifndef CONTACT_SEGMENT_DRIVEN_TURNING_H
#define CONTACT_SEGMENT_DRIVEN_TURNING_H

#include "scene/turning.h"

#if SCENE_ANY_TURNING

/* So many panels a step may take: about a second. A contact takes some dozens. */
enum { DRIVEN_PANELS = 20000 };

/* Over `length` seconds from the present. Regimes and spring of q become those at the end; impulses, or means
 * in scenes without free bodies, peaks, energies and onsets are booked. False, q being undefined: so many
 * panels, or what a search for touches may take, were not enough. */
bool driven_turning_over(const struct scene_values *v, struct scene_state *q, double length, long panels);

#endif
#endif
