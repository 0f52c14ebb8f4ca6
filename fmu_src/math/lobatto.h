/* Constants of collocation at the Gauss-Lobatto nodes of [-1, 1]; source: scripts/tools/make_lobatto.py. */
#ifndef CONTACT_MATH_LOBATTO_H
#define CONTACT_MATH_LOBATTO_H

/* Both ends are nodes, so that the load is exact where the oscillation is split off. With twelve points a
 * step takes a slow motion about one radian at full accuracy; more points cost more sweeps. With fewer a
 * sweep costs less, by their square: eight are for half that way, four for a tenth. Multiples of four: so
 * many sums are made at once (nodal_values.c). */
enum lobatto_size { LOBATTO_FOUR, LOBATTO_EIGHT, LOBATTO_TWELVE, LOBATTO_SIZES };

enum { LOBATTO_MAX = 12 };

struct lobatto {
    int points;
    const double *node; /* [i], ascending */
    /* [j points + i]: from -1 to node i, of the polynomial that is 1 at node j and 0 at the others */
    const double *integral;
    const double *monomial; /* [j points + k]: the coefficient of sigma^k in that polynomial */
};

extern const struct lobatto lobatto[LOBATTO_SIZES];

#endif
