/*
 * A pair that presses, from one instant on, within one regime of its contact.
 *
 * Without the contact force the separation would follow the polynomial C(t), its rate W(t) (approach.h). With it c = C + r, w = W + r',
 * and m_red r'' = side F_n n with 1/m_red the sum of the free bodies' inverse masses. Momentum is exact: the bodies leave
 * their flights by -r m_red/m_s and +r m_red/m_d, and the impulse on the source is -m_red r'. Two ways to r: press_series.h,
 * press_collocation.h.
 */
#ifndef CONTACT_PRESS_H
#define CONTACT_PRESS_H

#include "dynamics/approach.h"

#if SCENE_ANY_FREE

enum { PRESS_ENDS = 2 }; /* source, destination */

/* What the contact's deviation from flight adds to the external work done on one of the bodies: factor times the integral of
 * path(t).d^order r/dt^order dt. Free: its external force on the way (order 1). Prescribed: whatever moves it, against the
 * contact force (order 2). Fixed: nothing (order 0). */
struct press_work {
    struct vec3 path[3]; /* coefficients of time from the instant */
    double factor;
    int order;
};

struct press {
    struct contact_shape shape;
    struct contact_law law;
    struct contact_coefficients by; /* F_n = -(k g + c g') */
    struct separation flight; /* C, W; of a cylinder the part along its axis too, but for C(0) at the axis */
    struct vec3 normal;       /* n */
    double distance, gap;     /* d [m], g as carried along [m] */
    struct vec3
        rounded; /* what c lacks for d to be that of the carried gap, or that at the centre: rounding [m] */
    struct vec3 rate_rounded; /* what w lacks for g' to be the carried one: rounding [m/s] */
    double carried_rate;      /* g' as carried along; NaN: as w tells [m/s] */
    double reduced_mass;      /* m_red [kg] */
    double rate_resolution;   /* of g', by rounding [m/s] */
    struct press_work work[PRESS_ENDS];
};

/* The three quantities that decide what happens to a contact, each with its first two derivatives with respect to the piece's own
 * variable s. */
enum press_quantity { PRESS_GAP, PRESS_RATE, PRESS_FORCE, PRESS_QUANTITIES };

struct press_sample {
    double of[PRESS_QUANTITIES][3]; /* g [m], g' as the law sees it [m/s], F_n [N] */
};

/* What has happened since the instant. */
struct press_change {
    double time;             /* [s] */
    struct vec3 r, r_rate;   /* [m], [m/s] */
    double gap;              /* g now [m] */
    double dissipated;       /* by the dashpot [J] */
    double work[PRESS_ENDS]; /* the integrals of press_work [J] */
};

/* From the present instant `at`, taken at q->clock, for a contact in a pressing or receding regime. */
void press_make(struct press *p, const struct scene_values *v, const struct motion *q,
                const struct system_instant *at, int contact);

/* dg/dt at the start, which is not g' where bodies are led otherwise than they move [m/s] */
double press_closing(const struct press *p);

/* Size of the force that would hold the bodies at their distance now; close to the centre, where they only pass, at half their size [N]. */
double press_load(const struct press *p);

/* c without a cylinder's axial part. */
struct vec3 press_across(const struct press *p, struct vec3 c);

/* Of such a vector what is along the contact, without its part along n. */
struct vec3 press_along(const struct press *p, struct vec3 across);

/* How little the velocities after the change tell of g', by rounding [m/s]: 0 where that is enough, for it makes no force worth
 * mentioning. */
double press_rate_rounding(const struct press *p, const struct press_change *change,
                           const struct scene_values *v, const struct motion *q, int contact);

/* Moves the bodies, books impulse, dissipated energy and external work; the clock is the caller's. */
void press_apply(const struct press *p, const struct press_change *change, const struct scene_values *v,
                 struct motion *q, int contact);

#endif
#endif
