/* This file declares the constants of collocation at the Gauss-Lobatto nodes of [-1, 1]. cmake/make_nodes.py
 * computes all tables as CMake runs and says what each array holds. */
#ifndef CONTACT_MATH_NODE_TABLES_H
#define CONTACT_MATH_NODE_TABLES_H

/* Both ends are nodes, so that the load is exact at the start, where the free oscillation is separated from
 * the particular solution. Twelve points integrate about one radian of a slow motion to full accuracy; more
 * points would need more sweeps. The cost of a sweep is the square of the number of points. Eight points
 * reach half as far. The numbers are multiples of four, because nodes.c computes four sums at a time. */
enum lobatto_size { LOBATTO_EIGHT, LOBATTO_TWELVE, LOBATTO_SIZES };

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

/*
 * These are the constants of Radau IIA at the right Radau nodes of [0, 1].
 *
 * A step is a polynomial of its place sigma in [0, 1]. Its pace says how the time tau, a part of the step's
 * length, follows from sigma:
 *
 *   even        tau = sigma
 *   touch       tau = sigma^2; a force that grows with tau^(3/2) from the start on is a polynomial
 *   release     tau = 1 + e - (sqrt(e) + (1 - sigma) (sqrt(1 + e) - sqrt(e)))^2, e = RADAU_REST; a force that
 *               falls with (1 + e - tau)^(3/2) is a polynomial
 */
enum radau_pace { RADAU_EVEN, RADAU_FROM_TOUCH, RADAU_TO_RELEASE, RADAU_PACES };

/* A step to a release ends this part of its length before the release. At the release itself the pace would
 * be zero, and A singular. */
#define RADAU_REST (1.0 / 1024.0)

struct radau_stages {
    int stages;
    enum radau_pace pace;
    /* `node` holds the times tau of the stages, `place` their sigma */
    const double *node, *integral, *inverse, *once, *twice, *place, *chebyshev, *bernstein;
};

enum { RADAU_MOST_STAGES = 12 };

extern const struct radau_stages radau_stages_4, radau_stages_8, radau_stages_12;
extern const struct radau_stages radau_stages_touch, radau_stages_release; /* of twelve stages */

#endif
