/* Constants of collocation at the Gauss-Lobatto nodes of [-1, 1]; source: scripts/make_lobatto.py. */
#ifndef CONTACT_LOBATTO_H
#define CONTACT_LOBATTO_H

/* Both ends are nodes, so that the load is exact where the oscillation is split off. With twelve points a step takes a
 * slow motion about one radian at full accuracy; fewer points cost more steps, more points more sweeps. */
enum { LOBATTO_POINTS = 12 };

extern const double lobatto_node[LOBATTO_POINTS];

/* [j][i]: the integral from -1 to node i of the polynomial that is 1 at node j and 0 at the others. */
extern const double lobatto_integral[LOBATTO_POINTS][LOBATTO_POINTS];

/* [j][k]: the coefficient of sigma^k in that polynomial. */
extern const double lobatto_monomial[LOBATTO_POINTS][LOBATTO_POINTS];

#endif
