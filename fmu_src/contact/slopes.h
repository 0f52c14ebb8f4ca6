/*
 * This file has the derivatives of the contact force. F_n is the normal force of the law, and the force on
 * the source without friction is F_src = -side F_n n.
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
    struct vec3 separation[JET_TERMS], axis[JET_TERMS]; /* c; the shape's axis, where there are caps */
    struct vec3 normal[JET_TERMS];
    double distance[JET_TERMS], gap[JET_TERMS], gap_rate[JET_TERMS];
    double normal_force[JET_TERMS];
    struct vec3 source_force[JET_TERMS]; /* -side F_n n */
};

/* The functions below give the series of the laws of friction (friction.h) along a path. */

/* This struct holds the arguments of F_t along a path: the series of F_n, v_t, xi and delta, and dv_0/ds.
 * `terms` is the number of coefficients that are wanted, 2 or JET_TERMS. */
struct friction_path {
    int terms;
    double normal_force[JET_TERMS], depth[JET_TERMS];
    struct vec3 slip[JET_TERMS], spring[JET_TERMS];
    double slip_velocity_slope;
};

/* Sets the series of F_t. At zero slip |v_t| grows with |s|; its coefficients are those for s > 0. */
void friction_force_terms(const struct friction_law *law, enum friction_regime regime,
                          const struct friction_path *path, struct vec3 force[JET_TERMS]);

/* Returns the change of xi' along a path, without what the normal turns (opposed_turned). */
CONTACT_COLD struct vec3 friction_spring_rate_change(const struct friction_law *law,
                                                     enum friction_regime regime,
                                                     const struct friction_path *path);

/* Sets the series of the part of a vector in which an opposed motion takes place (opposed_laid). */
void opposed_laid_terms(enum opposed part, int terms, const struct vec3 a[JET_TERMS],
                        const struct vec3 normal[JET_TERMS], struct vec3 laid[JET_TERMS]);

/* Sets the series of the energy stored in the tangential spring [J]. */
CONTACT_COLD void friction_stored_terms(const struct friction_law *law, enum friction_regime regime,
                                        const struct friction_path *path, double stored[JET_TERMS]);

/* Sets the series of the length and of the direction of a vector. The direction is zero where the vector is;
 * its length then has the coefficients for s > 0. */
void jet_direction(int terms, const struct vec3 a[JET_TERMS], double length[JET_TERMS],
                   struct vec3 unit[JET_TERMS]);

/* Sets the series of the part of c across a unit vector and of the component along it. */
void jet_across(int terms, const struct vec3 c[JET_TERMS], const struct vec3 direction[JET_TERMS],
                struct vec3 across[JET_TERMS], double along[JET_TERMS]);

/* This struct holds the laws and their regimes: of the normal force, and of friction and both resistances
 * (enum opposed). */
struct turning_laws {
    struct contact_law normal;
    struct friction_law rubbing[OPPOSED];
    enum contact_regime regime;
    enum friction_regime rubbing_regime[OPPOSED];
};

#endif
