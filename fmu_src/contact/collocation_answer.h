/* How x answers the load within a collocated step; for collocation.c only. */
#ifndef CONTACT_COLLOCATION_ANSWER_H
#define CONTACT_COLLOCATION_ANSWER_H

#include "contact/collocation.h"

struct oscillator collocation_oscillator(const struct collocation *p);

/* The largest that x comes to in the step, roughly [m]. */
double collocation_size_of_excess(const struct collocation *p);

/* The load, given at the nodes, into x; `softening` is what the load takes from the oscillator's square as it answers y. Returns
 * the largest change of a coefficient, scaled as if x were of the size of d: the force, which follows from x, is to be as accurate
 * as the position, however small x is. */
double collocation_answer(struct collocation *p, const double *values, double softening);

#endif
