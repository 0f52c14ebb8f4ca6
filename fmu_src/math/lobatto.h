/* Constants of collocation at the Gauss-Lobatto nodes of [-1, 1]; source: scripts/tools/make_lobatto.py. */
#ifndef CONTACT_MATH_LOBATTO_H
#define CONTACT_MATH_LOBATTO_H

/* Both ends are nodes, so that the load is exact at the start, where the free oscillation is separated from
 * the particular solution. Twelve points integrate about one radian of a slow motion to full accuracy; more
 * would need more sweeps. A sweep costs the square of their number: eight reach half as far, four a tenth.
 * Multiples of four, because nodal_values.c computes four sums at a time. */
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
