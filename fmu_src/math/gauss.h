/* Five-point Gauss-Legendre rule on [-1, 1]: exact to degree nine. Nodes 0, +-sqrt(5 -+ 2 sqrt(10/7))/3. */
#ifndef CONTACT_MATH_GAUSS_H
#define CONTACT_MATH_GAUSS_H

enum { GAUSS_NODES = 5 };

static const double GAUSS_NODE[GAUSS_NODES] = {-0.90617984593866399, -0.53846931010568309, 0.0,
                                               0.53846931010568309, 0.90617984593866399};
static const double GAUSS_WEIGHT[GAUSS_NODES] = {
    0.23692688505618909, 0.47862867049936647, 0.56888888888888889, 0.47862867049936647, 0.23692688505618909};

#endif
