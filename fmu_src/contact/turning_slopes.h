/*
 * How force, torques and the spring's rate of a contact that turns or rubs change with its motion: exact
 * directional derivatives, for implicit integration. World frame, SI units.
 *
 *   w_g = w - omega_d x c                          the rate of c as the destination sees it
 *   g' = side n.w_g
 *   v_t = -(w_g - n (n.w_g)) + r_s side (omega_s - omega_d) x n
 *   F_src = -side F_n n + F_t
 *   tau_src = r_s side n x F_src,   tau_dst = -(r_s side n - c) x F_src
 *   xi' = friction_spring_rate - n (xi.n')
 */
#ifndef CONTACT_CONTACT_TURNING_SLOPES_H
#define CONTACT_CONTACT_TURNING_SLOPES_H

#include "contact/friction.h"
#include "contact/geometry.h"
#include "contact/law.h"

/* The motion of a contact; or a change of it, whose `axis` is one of shape.axis. */
struct turning_motion {
    struct vec3 separation, rate;                      /* c [m], w [m/s] */
    struct vec3 source_rotation, destination_rotation; /* omega_s, omega_d [rad/s] */
    struct vec3 axis;                                  /* e_d */
    struct vec3 spring;                                /* xi [m] */
};

/* The laws and their regimes. */
struct turning_laws {
    struct contact_law normal;
    struct friction_law friction;
    enum contact_regime regime;
    enum friction_regime friction_regime;
};

/* What changes with it. */
struct turning_change {
    struct vec3 force;                             /* F_src [N] */
    struct vec3 source_torque, destination_torque; /* about the centres [N m] */
    struct vec3 spring_rate;                       /* xi' [m/s] */
    double dissipated_power, friction_power;       /* of the normal law; -F_t.v_t [W] */
};

/* All that does not depend on the direction of the change. */
struct turning_slopes {
    struct contact_shape shape;
    struct contact_geometry geometry;
    struct turning_motion motion;
    struct vec3 seen_rate, normal_rate, slip; /* w_g, n', v_t */
    struct vec3 across;                       /* the part of w_g that turns n */
    struct vec3 friction_force, force;        /* F_t, F_src */
    double normal_force, stored_slope, bend;  /* F_n and the slope and bend of the stored energy */
    double inverse_distance;                  /* 1 / d; 0 where n does not turn with c */
    struct contact_slopes normal_slopes;      /* of F_n */
    struct friction_slopes force_slopes, spring_slopes;
};

/* At a motion whose geometry is `at`, g' of which is side n.w_g. */
struct turning_slopes turning_slopes_at(const struct contact_shape *shape, const struct contact_geometry *at,
                                        const struct turning_motion *motion, const struct turning_laws *laws);

struct turning_change turning_slopes_along(const struct turning_slopes *s,
                                           const struct turning_motion *change);

#endif
