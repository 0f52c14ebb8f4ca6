/* Five-point Gauss-Legendre rule on [-1, 1]: exact to degree nine. Nodes 0, +-sqrt(5 -+ 2 sqrt(10/7))/3. */
#ifndef CONTACT_MATH_GAUSS_H
#define CONTACT_MATH_GAUSS_H

enum { GAUSS_NODES = 5 };

static const double GAUSS_NODE[GAUSS_NODES] = {-0.90617984593866399, -0.53846931010568309, 0.0,
                                               0.53846931010568309, 0.90617984593866399};
static const double GAUSS_WEIGHT[GAUSS_NODES] = {
    0.23692688505618909, 0.47862867049936647, 0.56888888888888889, 0.47862867049936647, 0.23692688505618909};

/* A place in a panel from 0 to 2, and what its weight is multiplied with. */
struct gauss_place {
    double at, factor;
};

/*
 * Of node i. `graded`: the variable is u with t = u^2 (3 - 2 u), so that nodes crowd at both ends of the
 * panel and roots of t there, as in a force that begins with t^(3/2), become polynomials of u.
 */
static inline struct gauss_place gauss_place(int i, int graded)
{
    const double u = 0.5 * (1.0 + GAUSS_NODE[i]);
    return graded ? (struct gauss_place){2.0 * u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u)}
                  : (struct gauss_place){1.0 + GAUSS_NODE[i], 1.0};
}

#endif
