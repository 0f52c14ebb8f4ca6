/* Constants of collocation at the right Radau nodes of [-1, 1]; source:
 * scripts/tools/make_lobatto.py radau. */
#ifndef CONTACT_MATH_RADAU_H
#define CONTACT_MATH_RADAU_H

#include "math/lobatto.h"

/* Radau IIA with so many stages has order 23 and damps away what is too fast for a step. The start is no
 * node: the collocation polynomial goes on from there in spite of what is fast there. */
enum { RADAU_POINTS = 12 };

extern const struct lobatto radau;

/* radau.integral twice: [j RADAU_POINTS + i] is the integral to node i of the integral of the polynomial
 * that is 1 at node j. */
extern const double radau_twice[RADAU_POINTS * RADAU_POINTS];

#endif
