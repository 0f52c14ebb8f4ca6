/*
 * Contacts between bodies that the importer moves: neither body is free or turns freely, so that every
 * force is a function of time. Impulses, energies and work are quadratures of smooth formulas between two
 * changes of a regime. A panel of time is halved until both halves agree with the whole.
 *
 * Where nothing turns or rubs the separation is a polynomial of time, and so are the conditions at which
 * the law changes: their roots are the events. Where a body turns or a contact rubs, touches come from
 * conservative advancement, which misses none, and the events of law and friction are located between the
 * nodes.
 */
#ifndef CONTACT_PRESCRIBED_PRESCRIBED_H
#define CONTACT_PRESCRIBED_PRESCRIBED_H

#include "scene/scene_state.h"

/* A step may take so many panels: about a second. A contact takes some dozens. */
enum { PRESCRIBED_PANELS = 20000 };

/* Integrates the prescribed contacts over [q->clock, end], on which no regime changes, and books impulses,
 * energies, work and peaks. Each panel takes one step of the budget, but does not count in solver.steps.
 * Returns the clock reached, before `end` where the budget ran out; does not change q->clock. */
double prescribed_integrate(const struct scene_values *v, struct scene_state *q, double end, long *budget);

/* The same over `length` seconds from the present, through all changes of regimes: in a scene without a
 * free body, and in a force element that turns or rubs. Scenes without a free body get the mean force
 * instead of its impulse. The regimes and the spring of q become those at the end. False, and q is
 * undefined, where so many panels or the search for touches were not enough. */
bool prescribed_over(const struct scene_values *v, struct scene_state *q, double length, long panels);

/* Puts the regimes of q to what the present instant asks for. */
void prescribed_settle(const struct scene_values *v, struct scene_state *q);

/* Settles the regimes; notes the force of the present instant as the peak, with a mean of zero. */
void prescribed_begin(const struct scene_values *v, struct scene_state *q);

/* After inputs have jumped, the springs of contacts that touch lie across the new normals. */
void prescribed_lay_springs(const struct scene_values *v, struct scene_state *q);

#endif
