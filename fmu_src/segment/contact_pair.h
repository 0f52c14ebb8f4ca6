/*
 * A contact pair: two bodies that exchange a contact force, from one instant on, within one regime.
 *
 * Without that force the separation would follow the polynomial C(t), its rate W(t) (relative_path.h). With
 * it c = C + r, w = W + r' and m_red r'' = side F_n n, where 1/m_red is the sum of the free bodies' inverse
 * masses. Momentum is conserved exactly: the bodies deviate from their flights by -r m_red/m_s and +r
 * m_red/m_d, and the impulse on the source is -m_red r'. r is found by pair_oscillation.h, pair_collocation.h
 * or pair_taylor.h.
 */
#ifndef CONTACT_SEGMENT_CONTACT_PAIR_H
#define CONTACT_SEGMENT_CONTACT_PAIR_H

#include "segment/relative_path.h"
#include "segment/rim_local.h"

/* Below this [N/m] gap and rate are always known well enough: their rounding, some 1e-16 m and m/s, makes
 * forces that nobody sees beside a load. The stiffest contacts that are built have some 1e10. */
#define PAIR_STIFF 1e18

enum { PAIR_BODIES = 2 }; /* source, destination */

/* External work on one body that is due to r: factor times the integral of path(t).d^order r/dt^order dt.
 * Free: its external force (order 1). Prescribed: its velocity against the contact force (order 2). Fixed:
 * none (order 0). */
struct pair_work {
    struct vec3 path[3]; /* coefficients of time from the instant */
    double factor;
    int order;
};

struct contact_pair {
    struct contact_shape shape;
    struct contact_law law;
    /* k and c in the regime; of Hertz's law the slopes of the force at the start, for estimates */
    struct contact_coefficients coefficients;
    double hertz_stiffness; /* k_h; 0 under the linear law [N/m^1.5] */
    double chi;             /* the factor of Hunt and Crossley in the regime; 0 under the linear law [s/m] */
    /* C, W; of a cylinder the part along its axis too, but for C(0) at the axis */
    struct separation_path flight;
    double axial;         /* c.e_d of a cylinder [m] */
    struct vec3 normal;   /* n */
    double distance, gap; /* d [m], accumulated gap g [m] */
    /* rounding: added to c so that its length agrees with the accumulated gap, or with the direction taken at
     * the centre [m] */
    struct vec3 rounded;
    bool starts_rounded;      /* whether C(0) has it already, as at the centre */
    struct vec3 rate_rounded; /* rounding: added to w so that side n.w is the carried rate [m/s] */
    double carried_rate;      /* g' that is more than side n.w; NaN: that is as accurate [m/s] */
    bool rate_is_known;       /* carried, or exactly zero: without the rounding of velocities */
    bool has_mismatch;        /* whether W is other than C', by more than rounding */
    bool is_head_on;          /* pair_is_head_on */
    double reduced_mass;      /* m_red [kg] */
    double rate_rounding;     /* of g', by rounding [m/s] */
    struct pair_work work[PAIR_BODIES];
};

/* The quantities whose zeros are events, each with its first two derivatives with respect to the segment's
 * variable s. */
enum pair_quantity {
    PAIR_GAP,
    PAIR_GAP_RATE,
    PAIR_FORCE,
#if SCENE_ANY_CAPS
    PAIR_RADIAL,
    PAIR_AXIAL,
#endif
    PAIR_QUANTITIES
};

struct pair_sample {
    /* g [m], g' as the law sees it [m/s], F_n [N]; at a rim how far beyond side and cap the centre is [m] */
    double of[PAIR_QUANTITIES][3];
};

/* What has happened since the instant. */
struct pair_change {
    double time;              /* [s] */
    struct vec3 r, r_rate;    /* [m], [m/s] */
    double gap;               /* g now [m] */
    bool head_on;             /* whether gap and gap_rate tell all of the relative motion along n */
    double gap_rate;          /* g' now, where that is so [m/s] */
    double dissipated;        /* by the dashpot [J] */
    double work[PAIR_BODIES]; /* the integrals of pair_work [J] */
};

/* Whether the motion goes along n alone, under a constant acceleration along it; over a plane and along a
 * cylinder's axis the bodies may move as they like. */
bool pair_is_head_on(const struct contact_pair *p);

/* From the present instant `at`, taken at q->clock, for a contact in compression or restitution. */
void pair_make(struct contact_pair *p, const struct scene_values *v, const struct scene_state *q,
               const struct scene_instant *at, int contact);

/* dg/dt at the start [m/s]. It differs from g' where a prescribed velocity is not the derivative of its
 * displacement. */
double pair_gap_derivative(const struct contact_pair *p);

/* g'' by the turning of n alone, at such a distance: |w_t|^2 / d, of a rim less [m/s^2]. */
double pair_turning(const struct contact_pair *p, double distance);

/* The force that would keep the bodies at their present distance, |m_red (|w_t|^2 / d + n.A)| [N]. Near the
 * centre half the reach stands for d, since the bodies only pass there. */
double pair_load(const struct contact_pair *p);

#if SCENE_ANY_CAPS
/* Of a rim. */
struct rim_start pair_rim_start(const struct contact_pair *p);
#endif

/* The part of c perpendicular to a cylinder's axis. */
struct vec3 pair_across(const struct contact_pair *p, struct vec3 c);

/* The tangential part of such a vector, which turns n: without its component along n; none of a plane. */
struct vec3 pair_tangential(const struct contact_pair *p, struct vec3 across);

/* Rounding error of g' computed from the velocities after the change [m/s]; 0 where the error of the force
 * that it causes is negligible. */
double pair_rate_rounding_after(const struct contact_pair *p, const struct pair_change *change,
                                const struct scene_values *v, const struct scene_state *q, int contact);

/* Moves the bodies, books impulse, dissipated energy and external work; the clock is the caller's. */
void pair_apply(const struct contact_pair *p, const struct pair_change *change, const struct scene_values *v,
                struct scene_state *q, int contact);

#endif
