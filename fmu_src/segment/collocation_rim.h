/*
 * Collocation at the rim of a capped cylinder, a circle of radius r_d about the axis e. The normal has two
 * curvatures there: with the direction a from the axis to the centre, which turns by the azimuth, and the
 * tilt of n from it,
 *
 *   n = cos(tilt) a - sin(tilt) e,   rho = r_d + d cos(tilt)
 *   azimuth' = round / rho^2,   round' = rho b.A,   b = e x a
 *   tilt' = over / d^2,         over' = -d (sin(tilt) push + cos(tilt) e.A),   push = round^2 / rho^3 + a.A
 *   f = over^2 / d^3 + cos(tilt) push - sin(tilt) e.A
 *
 * The rows of the result are those of n and H elsewhere: n.x the azimuth times rho/d at the start, h.x
 * `round` over that; n.y the tilt, h.y `over`; n.z and h.z zero. So lengths and tolerances mean the same. The
 * frame is a, b, e.
 */
#ifndef CONTACT_SEGMENT_COLLOCATION_RIM_H
#define CONTACT_SEGMENT_COLLOCATION_RIM_H

#include "segment/collocation.h"

/* Whether the step is at a rim, and turns; never, at compile time, where no cylinder has caps. */
static inline bool collocation_at_rim(const struct collocation *p)
{
#ifdef CONTACT_NO_CAPS
    (void)p;
    return false;
#else
    return p->local.at_rim;
#endif
}

/* Frame, momenta and what acts; the first guess. */
void collocation_rim_begin(struct collocation *p);
double collocation_rim_load_at_start(const struct collocation *p);
void collocation_rim_guess(struct collocation *p, double half);

/* half^2 f [m] at the nodes, and half of its softening, -half^2 df/dx. */
void collocation_rim_load(const struct collocation *p, double *values, double *softening);

/* The momenta, then the angles by them; returns the largest change [m]. */
double collocation_rim_turn(struct collocation *p);

/* half n.E at the nodes [m]. */
void collocation_rim_mismatch(const struct collocation *p, double *values);

/* c - c(0) and n at a node, in the world, the oscillation left out. */
void collocation_rim_at_node(const struct collocation *p, int node, struct vec3 *moved, struct vec3 *normal);

struct collocation_change collocation_rim_change_at(const struct collocation *p, double s);

/* Below: what the files of the rim share. */

struct rim_state {
    double d, rho, azimuth, tilt; /* [m], [rad] */
    double round, over;           /* [m^2/s] */
};

struct rim_slopes {
    double azimuth, tilt; /* [1/s] */
    double round, over;   /* [m^2/s^2] */
    double load;          /* f without mismatch [m/s^2] */
};

/* With rows of n and H as they are, or at a node, the oscillation left out. */
struct rim_state rim_state_of(const struct collocation *p, struct vec3 n, struct vec3 h, double x);
struct rim_state rim_state_at_start(const struct collocation *p);
struct rim_state rim_state_at_node(const struct collocation *p, int i);

struct rim_slopes rim_slopes_at(const struct rim_state *at, struct vec3 acceleration);

/* What y adds to the rows. */
struct collocation_correction rim_correction(const struct collocation *p, const struct rim_state *at,
                                             struct vec3 acceleration, double y, double y_rate);

#endif
