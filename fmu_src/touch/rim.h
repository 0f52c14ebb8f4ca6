/*
 * A circle about the axis e is described in local coordinates: the rim of a capped cylinder, of radius r_d,
 * or the middle of a torus's tube, of radius R in place of r_d. The normal n has two curvatures there. Its
 * coordinates are the azimuth, by which the direction a from the axis to the centre turns, and the tilt of n
 * from a. Their momenta are h and L:
 *
 *   n = cos(tilt) a - sin(tilt) e,   rho = r_d + d cos(tilt),   b = e x a
 *   azimuth' = h / rho^2,   h' = rho b.A
 *   tilt' = L / d^2,        L' = -d (sin(tilt) push + cos(tilt) e.A),   push = h^2 / rho^3 + a.A
 *   d'' = f + F_n / m_red,  f = L^2 / d^3 + cos(tilt) push - sin(tilt) e.A
 *
 * A centre or the axis of an endless cylinder is such a circle of radius zero about any axis through it.
 *
 * A is the relative acceleration without the contact force. Vectors are in the frame of the start: a, e, b.
 * A motion in a plane through the axis has only the first two components.
 */
#ifndef CONTACT_TOUCH_RIM_H
#define CONTACT_TOUCH_RIM_H

#include "math/vec3.h"

/* The start of a motion. */
struct rim_start {
    struct vec3 frame[3];                   /* a, e, b */
    double radius;                          /* r_d [m] */
    double distance;                        /* d [m] */
    double rho;                             /* distance of the centre from the axis [m] */
    double tilt;                            /* [rad] */
    double cosine, sine;                    /* of the tilt */
    double azimuth_momentum, tilt_momentum; /* [m^2/s] */
};

/* This struct holds cosines and sines of both angles. */
struct rim_angles {
    double cosine, sine;               /* of the tilt */
    double turned_cosine, turned_sine; /* of the azimuth */
};

struct rim_state {
    double d, rho;                          /* [m] */
    double azimuth_momentum, tilt_momentum; /* [m^2/s] */
    double grown;                           /* change of d, not rounded by a difference [m] */
    struct rim_angles by;
};

struct rim_slopes {
    double azimuth, tilt;                   /* [1/s] */
    double azimuth_momentum, tilt_momentum; /* [m^2/s^2] */
    double load;                            /* f [m/s^2]; the other slopes are rates of the state */
};

/* Returns the start of a motion from c and c' in the world. The caller passes `distance`, which is d, because
 * it has less rounding than d computed from c. */
struct rim_start rim_start_of(struct vec3 axis, double radius, double half_height, struct vec3 c,
                              double distance, struct vec3 rate);

/* Returns the state after d has grown by `grown`, and azimuth, tilt, h and L by `change`. */
struct rim_state rim_state_of(const struct rim_start *start, const double change[4], double grown,
                              struct rim_angles by);

/* Returns the cosines and sines of azimuth and tilt, after the azimuth has changed by `turned` and the tilt
 * by `tilted` since the start [rad]. */
struct rim_angles rim_angles_of(const struct rim_start *start, double turned, double tilted);

struct rim_slopes rim_slopes_at(const struct rim_state *at, struct vec3 acceleration);

/* Sets the derivatives with respect to d of the rates of azimuth, tilt and both momenta (rim_slopes). */
void rim_slopes_by_distance(const struct rim_state *at, struct vec3 acceleration, double slopes[4]);

/* These functions return n, c - c(0) [m], and c' - c'(0) [m/s] where d' is first `before` and then `radial`,
 * in the frame. Where n turns, the differences have the rounding of d and of the speeds; a motion that does
 * not turn loses no digits. */
struct vec3 rim_normal(const struct rim_state *at);
struct vec3 rim_moved(const struct rim_start *start, const struct rim_state *at);
struct vec3 rim_gained(const struct rim_start *start, const struct rim_state *at, double before,
                       double radial);

#endif
