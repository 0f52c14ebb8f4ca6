/*
 * The rim of a capped cylinder in local coordinates: a circle of radius r_d about the axis e. The normal has
 * two curvatures there: with the direction a from the axis to the centre, which turns by the azimuth, and the
 * tilt of n from it,
 *
 *   n = cos(tilt) a - sin(tilt) e,   rho = r_d + d cos(tilt)
 *   azimuth' = round / rho^2,   round' = rho b.A,   b = e x a
 *   tilt' = over / d^2,         over' = -d (sin(tilt) push + cos(tilt) e.A),   push = round^2 / rho^3 + a.A
 *   d'' = f + F_n / m_red,      f = over^2 / d^3 + cos(tilt) push - sin(tilt) e.A
 *
 * with A the relative acceleration without the contact force. Vectors in the frame of the start: a, b, e.
 */
#ifndef CONTACT_TOUCH_RIM_LOCAL_H
#define CONTACT_TOUCH_RIM_LOCAL_H

#include "math/vec3.h"

/* Where a motion begins. */
struct rim_start {
    struct vec3 frame[3]; /* a, b, e */
    double radius;        /* r_d [m] */
    double distance, rho; /* d [m]; from the axis [m] */
    double tilt;          /* [rad] */
    double round, over;   /* [m^2/s] */
};

struct rim_state {
    double d, rho, azimuth, tilt;      /* [m], [rad] */
    double round, over;                /* [m^2/s] */
    double grown, tilted;              /* changes of d and of the tilt, with all their digits */
    double cosine, sine;               /* of the tilt */
    double turned_cosine, turned_sine; /* of the azimuth */
};

struct rim_slopes {
    double azimuth, tilt; /* [1/s] */
    double round, over;   /* [m^2/s^2] */
    double load;          /* f [m/s^2] */
};

/* The start from c across and along the axis, d as it is known better than by c, and c' (world). */
struct rim_start rim_start_of(struct vec3 axis, double radius, double half_height, struct vec3 c,
                              double distance, struct vec3 rate);

/* The state after changes of azimuth times rho/d at the start, tilt, `round` over that, `over`, so that
 * lengths and tolerances mean the same for both directions; and of d by `grown`. */
struct rim_state rim_state_of(const struct rim_start *start, const double change[4], double grown);

/* What these changes grow by, from slopes. */
void rim_change_rates(const struct rim_start *start, const struct rim_slopes *slopes, double rates[4]);

struct rim_slopes rim_slopes_at(const struct rim_state *at, struct vec3 acceleration);

/* The slopes of these rates with d. */
void rim_slopes_by_distance(const struct rim_start *start, const struct rim_state *at,
                            struct vec3 acceleration, double slopes[4]);

/* In the frame: n; c - c(0); c' with d' = `radial`. */
struct vec3 rim_normal(const struct rim_state *at);
struct vec3 rim_moved(const struct rim_start *start, const struct rim_state *at);
struct vec3 rim_velocity(const struct rim_state *at, double radial);

/* reach cos(tilt) and reach sin(tilt), which are zero where the zone of the rim ends, and two derivatives,
 * from those of the tilt. */
void rim_edges(const double tilt[3], double reach, double radial[3], double axial[3]);

#endif
