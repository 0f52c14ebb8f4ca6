/*
 * Contacts between bodies that the importer moves: neither body is free or turns freely, so that every force
 * is a function of time. Impulses, energies and work are integrals of smooth functions between two changes of
 * a regime. The time is divided into panels, each integrated by a Lobatto rule, and a panel is halved until
 * the sum over its halves agrees with the whole.
 *
 * Beside bodies that are free, a contact that neither turns nor rubs is integrated from one change of its
 * regime to the next, which integrator/prediction.c foresees. Everywhere else conservative advancement finds
 * the touches and misses none, and the events of law and friction are located between the nodes of the
 * panels.
 */
#ifndef CONTACT_PRESCRIBED_PRESCRIBED_H
#define CONTACT_PRESCRIBED_PRESCRIBED_H

#include "scene/scene_state.h"

/* This is the largest number of panels of a communication step. A contact takes some dozens; so many panels
 * take about a second of computing. */
enum { PRESCRIBED_PANELS = 20000 };

/* Integrates the prescribed contacts over [q->clock, end], on which no regime changes, and books impulses,
 * energies, work and peaks. Each panel takes one step of *budget, but does not count in solver.steps. Returns
 * the clock reached, which lies before `end` where the budget is used up. q->clock stays. */
double prescribed_integrate(struct scene_state *q, double end, long *budget);

/* Integrates the prescribed contacts over `length` seconds from the present, through all changes of regimes,
 * for scenes in which no body may be free and for force elements that turn or rub. The regimes and springs of
 * q become those at the end. Returns false where `panels` panels or the evaluations of the search for touches
 * are used up; q is then undefined. */
bool prescribed_over(struct scene_state *q, double length, long panels);

/* Lays the springs onto the present tangent planes, and sets the regimes of q to those of the present. */
void prescribed_settle(struct scene_state *q);

/* Begins a communication step with the regimes of the present instant and impulses of zero. */
void prescribed_begin(struct scene_state *q);

/* Lays the friction springs onto the new tangent planes after inputs have jumped. */
void prescribed_lay_springs(struct scene_state *q);

#endif
