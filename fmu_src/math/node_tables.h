/* Constants of collocation at the Gauss-Lobatto nodes of [-1, 1]. cmake/make_nodes.py computes all tables
 * as CMake runs and says what each array holds. */
#ifndef CONTACT_MATH_NODE_TABLES_H
#define CONTACT_MATH_NODE_TABLES_H

/* Both ends are nodes, so that the load is exact at the start, where the free oscillation is separated from
 * the particular solution. Twelve points integrate about one radian of a slow motion to full accuracy; more
 * points would need more sweeps. The cost of a sweep is the square of the number of points. Eight points
 * reach half as far, four a tenth. The numbers are multiples of four, because nodes.c computes four sums at a
 * time. */
enum lobatto_size { LOBATTO_FOUR, LOBATTO_EIGHT, LOBATTO_TWELVE, LOBATTO_SIZES };

enum { LOBATTO_MAX = 12 };

struct lobatto {
    int points;
    const double *node; /* [i], ascending */
    /* [j points + i]: the integral from -1 to node i of the polynomial that is 1 at node j and 0 at the
     * others */
    const double *integral;
    const double *monomial; /* [j points + k]: the coefficient of sigma^k in that polynomial */
};

extern const struct lobatto lobatto[LOBATTO_SIZES];

/* The right Radau nodes of [-1, 1]. Radau IIA with twelve stages has order 23 and damps away motion that is
 * too fast for a step. The start is no node, so the collocation polynomial does not follow fast motion at the
 * start. */
enum { RADAU_POINTS = 12 };

extern const struct lobatto radau;

/* Constants of Radau IIA with simplified Newton iterations, at the right Radau nodes of [0, 1]. */

struct radau_stages {
    int stages; /* s, even: all eigenvalues of A^-1 are complex, in s/2 pairs */
    const double *node, *integral, *inverse, *eigenvalue, *into, *back, *chebyshev, *bernstein;
};

enum { RADAU_MOST_STAGES = 12 };

extern const struct radau_stages radau_stages_4, radau_stages_8, radau_stages_12;

#endif
