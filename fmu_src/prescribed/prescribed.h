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

/* Limit of the panels in a communication step, which take about a second. A contact takes some dozens. */
enum { PRESCRIBED_PANELS = 20000 };

/* Integrates the prescribed contacts over [q->clock, end], on which no regime changes, and books impulses,
 * energies, work and peaks. Each panel takes one step of the budget, but does not count in solver.steps.
 * Returns the clock reached, before `end` where the budget ran out; does not change q->clock. */
double prescribed_integrate(const struct scene_values *v, struct scene_state *q, double end, long *budget);

/* Integrates the prescribed contacts over `length` seconds from the present, through all changes of regimes.
 * It serves scenes without a free body, which get the mean force instead of its impulse, and force elements
 * that turn or rub. The regimes and the spring of q become those at the end. False, and q is undefined, where
 * PRESCRIBED_PANELS panels or the search for touches did not suffice. */
bool prescribed_over(const struct scene_values *v, struct scene_state *q, double length, long panels);

/* Sets the regimes of q by the present instant. */
void prescribed_settle(const struct scene_values *v, struct scene_state *q);

/* Settles the regimes; notes the force of the present instant as the peak, with a mean of zero. */
void prescribed_begin(const struct scene_values *v, struct scene_state *q);

/* Turns the springs of contacts that touch into the new tangent planes after inputs have jumped. */
void prescribed_lay_springs(const struct scene_values *v, struct scene_state *q);

#endif
