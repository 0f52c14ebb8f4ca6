/*
 * The force of contacts over a communication step when all motion is given: neither body is free, so the
 * separation is a polynomial of time, and so are the conditions at which the law changes. Between the roots
 * of these the force is smooth; its mean is a quadrature, its largest value found on dense output.
 */
#ifndef CONTACT_PRESCRIBED_GIVEN_H
#define CONTACT_PRESCRIBED_GIVEN_H

#include "scene/present.h"

/* Mean force, peak force and peak penetration of all contacts from the present until `length` seconds later,
 * into q->contact[]. The regimes of q become those at the end. False, and q as it was: that takes more than
 * about a second. */
bool given_force_over(const struct scene_values *v, struct scene_state *q, double length);

/* Puts the regimes of q to what the present instant asks for. */
void given_force_settle(const struct scene_values *v, struct scene_state *q);

/* Those of the present instant alone, with a mean force of zero: before the first step. */
void given_force_begin(const struct scene_values *v, struct scene_state *q);

#endif
