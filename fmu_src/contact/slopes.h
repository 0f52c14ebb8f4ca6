/*
 * Derivatives of the contact force, for implicit integration.
 *
 * F_n is the normal force of the law, and the force on the source without friction is F_src = -side F_n n.
 */
#ifndef CONTACT_CONTACT_SLOPES_H
#define CONTACT_CONTACT_SLOPES_H

#include "contact/friction.h"
#include "contact/law.h"
#include "contact/shape.h"
#include "math/compiler.h"

/*
 * One contact along a path: every quantity is a series c[0] + c[1] s + c[2] s^2 + ..., computed from the
 * series of the separation c(s) and its rate w(s). If s is the time since the present, the coefficients are
 * time derivatives divided by factorials. If s is a step in some direction, the coefficients c[1] are
 * directional derivatives.
 *
 *   d' = n.c' (as n.e_d = 0),   d n = offset,   g = side (d - reach),   g_t = side n.w_g,   F_n by the law
 *
 * The prime is d/ds here, g_t is the gap rate, and w_g is w as the destination sees it (below). The present
 * regime applies; at the edge of a regime the derivatives are one-sided, from within the present regime.
 * Where d = 0, n is constant.
 */

enum { JET_TERMS = 3 };

struct contact_jet {
    struct vec3 normal[JET_TERMS];
    double distance[JET_TERMS], gap[JET_TERMS], gap_rate[JET_TERMS];
    double normal_force[JET_TERMS];
    struct vec3 source_force[JET_TERMS]; /* -side F_n n */
};

/* Return coefficient `order` of a product of two series; taylor_multiply (math/series.h) serves for
 * numbers. */
double jet_dot(const struct vec3 *a, const struct vec3 *b, int order);
struct vec3 jet_scale(const double *a, const struct vec3 *b, int order);

/* The series of the laws of friction (friction.h) along a path. */

/* The arguments of F_t along a path: the series of F_n, v_t, xi and delta, and dv_0/ds. */
struct friction_path {
    double normal_force[JET_TERMS], depth[JET_TERMS];
    struct vec3 slip[JET_TERMS], spring[JET_TERMS];
    double slip_velocity_slope;
};

/* Returns coefficient `order` of F_t from the coefficients 0..order of the path. At zero slip the speed |v_t|
 * grows with |s|; its coefficients are those for s > 0. */
CONTACT_COLD struct vec3 friction_force_term(const struct friction_law *law, enum friction_regime regime,
                                             const struct friction_path *path, int order);

/* Sets the series of an opposed motion (contact/friction.h) from those of the slip, omega and n. */
CONTACT_COLD void opposed_terms(enum opposed part, const struct vec3 slip[JET_TERMS],
                                const struct vec3 omega[JET_TERMS], const struct vec3 normal[JET_TERMS],
                                struct vec3 motion[JET_TERMS]);

/* Returns coefficient `order`, 0 or 1, of the rate at which n turns a spring (opposed_turned). */
CONTACT_COLD struct vec3 opposed_turned_term(enum opposed part, const struct vec3 spring[JET_TERMS],
                                             const struct vec3 normal[JET_TERMS], int order);

/* Returns coefficient `order` of the energy stored in the tangential spring [J]. */
CONTACT_COLD double friction_stored_term(const struct friction_law *law, enum friction_regime regime,
                                         const struct friction_path *path, int order);

/* Sets the series of the length of a vector. */
CONTACT_COLD void jet_length(const struct vec3 a[JET_TERMS], double length[JET_TERMS]);

/* Sets coefficients 1 and 2 of the quotient a / by; quotient[0] is given. */
CONTACT_COLD void jet_divide(const struct vec3 a[JET_TERMS], const double by[JET_TERMS],
                             struct vec3 quotient[JET_TERMS]);

/* Sets the series of the part of c across an axis, of the component along the axis, and of the length rho of
 * the part across. */
CONTACT_COLD void jet_of_axis_distance(const struct vec3 c[JET_TERMS], const struct vec3 axis[JET_TERMS],
                                       struct vec3 across[JET_TERMS], double axial[JET_TERMS],
                                       double rho[JET_TERMS]);

/*
 * Exact directional derivatives of the force, the torques and the spring's rate of a contact that rotates or
 * has friction. The direction is a change of the motion. Implicit integration needs them. World frame, SI
 * units.
 *
 *   w_g = w - omega_d x c                          the rate of c as the destination sees it
 *   g' = side n.w_g
 *   v_t = -(w_g - n (n.w_g)) + r_s side (omega_s - omega_d) x n
 *   F_src = -side F_n n + F_t
 *   tau_src = r_s side n x F_src + M,   tau_dst = -(r_s side n - c) x F_src - M
 *   xi' = friction_spring_rate + opposed_turned, and likewise theta'
 *
 * The shape of skew cylinders does not turn, so that w_g = w. The place a e_s of the source's nearest point
 * adds to the arm r_s n.
 */

/* Returns the change of F_t or of the spring's rate for given changes of F_n, slip and spring. */
struct vec3 friction_slopes_along(const struct friction_slopes *slopes, double normal_force, struct vec3 slip,
                                  struct vec3 spring);

/* The motion of a contact, or a change of this motion in which `axis` is the change of shape.axis. */
struct turning_motion {
    struct vec3 separation, rate;                      /* c [m], w [m/s] */
    struct vec3 source_rotation, destination_rotation; /* omega_s, omega_d [rad/s] */
    struct vec3 axis;                                  /* e_d */
    struct vec3 spring[OPPOSED];                       /* xi [m], theta of rolling and spinning [rad] */
};

/* The laws and their regimes: of the normal force, and of friction and both resistances (enum opposed). */
struct turning_laws {
    struct contact_law normal;
    struct friction_law rubbing[OPPOSED];
    enum contact_regime regime;
    enum friction_regime rubbing_regime[OPPOSED];
};

/* The change of the force, torques and powers of a contact due to a change of its motion. */
struct turning_change {
    struct vec3 force;                             /* F_src [N] */
    struct vec3 source_torque, destination_torque; /* about the centres [N m] */
    struct vec3 spring_rate[OPPOSED];              /* xi' [m/s], theta' [rad/s] */
    double dissipated_power;                       /* by the law of the normal force [W] */
    double friction_power;                         /* -F_t.v_t - M.omega [W] */
};

/* The slopes of a contact at one motion; turning_slopes_along computes every directional derivative by
 * them. */
struct turning_slopes {
    struct contact_shape shape;
    struct contact_geometry geometry;
    struct turning_motion motion;
    struct vec3 seen_rate, normal_rate, spin; /* w_g, n', omega */
    struct vec3 across;                       /* the part of w_g that turns n */
    struct vec3 opposed[OPPOSED];             /* v_t and both parts of omega */
    struct vec3 opposing[OPPOSED], force;     /* F_t and both parts of M; F_src */
    double normal_force, stored_slope, bend;  /* F_n, and dE_c/dg and d^2E_c/dg^2 of the stored energy */
    double inverse_distance;                  /* 1 / d; 0 where n does not turn with c */
    double stiffening;                        /* dk_t / (k_t ddelta) [1/m] */
    struct contact_slopes normal_slopes;      /* derivatives of F_n by g and g' */
    struct friction_slopes force_slopes[OPPOSED], spring_slopes[OPPOSED];
    int parts; /* number of opposed motions with a law: all, or the slip alone */
};

/* Returns the slopes at a motion whose geometry is `at`, with g' = side n.w_g. */
struct turning_slopes turning_slopes_at(const struct contact_shape *shape, const struct contact_geometry *at,
                                        const struct turning_motion *motion, const struct turning_laws *laws);

struct turning_change turning_slopes_along(const struct turning_slopes *s,
                                           const struct turning_motion *change);

#endif
