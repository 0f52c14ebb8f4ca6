/*
 * The contact's motion in local coordinates, as first-order equations for Radau IIA. The spring's force f
 * = p_n x and q = sqrt(m p_n) x' are the unknowns for x: they stay of order one however stiff the spring
 * is.
 */
#ifndef LASTING_LOCAL_H
#define LASTING_LOCAL_H

#include "problem.h"

enum { LOCAL_UNKNOWNS = 8 };

/* In the plane an angle and its rate suffice; in space n and H take their place (segment/collocation.h):
 * what the FMU solves. */
struct local {
    int unknowns;
    void (*start)(double *y);
    void (*rates)(const struct problem *p, const double *y, double *rate);
    void (*jacobian)(const struct problem *p, const double *y, double (*j)[LOCAL_UNKNOWNS]); /* j is zero */
    void (*position)(const struct problem *p, const double *y, double *x, double *z);
};

extern const struct local local_plane; /* f, q, angle, its rate */
extern const struct local local_space; /* f, q, n, H */

#endif
