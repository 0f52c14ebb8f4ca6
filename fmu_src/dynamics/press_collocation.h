/* A pair that presses, in local coordinates (contact/collocation.h): steps as long as the motion along the contact allows,
 * whatever the penalty factor. Variable s in [0, 2], time = half s. */
#ifndef CONTACT_PRESS_COLLOCATION_H
#define CONTACT_PRESS_COLLOCATION_H

#include "contact/collocation.h"
#include "dynamics/press.h"

#if SCENE_ANY_FREE

/* What the motion is like at the start of a step. */
struct press_outlook {
    struct collocation_problem problem;
    double distance;   /* d [m] */
    double rate_along; /* |c' along the contact| / d [1/s] */
    double turning;    /* the rate at which the motion along the contact turns now [1/s] */
    struct oscillator_rates
        rates;          /* of the radial oscillator; sqrt(p_n / m_red) below critical damping [1/s] */
    double oscillation; /* bound of how far x will deviate from what follows the load [m] */
    bool swings;        /* below critical damping */
    double load_depth;  /* how deep the load alone presses, -side f / square [m] */
};

struct press_outlook press_outlook_of(const struct press *p);

/* The largest `turning` within a step of so many seconds: a pull that grows with time, perhaps from nothing, makes it faster
 * than it is at the start. Equal to `turning` where the pull is constant or fades. */
double press_turning_within(const struct press_outlook *outlook, double step);

/* The longest step, up to `longest`, in which the motion along the contact turns by about `radians`. */
double press_step_within(const struct press_outlook *outlook, double longest, double radians);

struct press_collocation {
    const struct press *from;
    struct collocation step;
};

/* False where the iteration does not converge. */
bool press_collocation_make(struct press_collocation *p, const struct press *from,
                            const struct press_outlook *outlook, double step, enum collocation_kind kind,
                            const struct lobatto *nodes, double tolerance);

void press_collocation_sample(const void *press_collocation, double s, struct press_sample *sample);

/* The same at a Lobatto node, cheaper. */
void press_collocation_sample_node(const struct press_collocation *p, int node, struct press_sample *sample);

/* Without the oscillation. */
void press_collocation_sample_slow(const struct press_collocation *p, double s, struct press_sample *sample);

/* Of a spanning step: the quantities without the oscillation, each less all the oscillation may add where only its sign counts:
 * what is left of -g, of F_n and of the rate (factor: the sign in which it is watched). */
struct press_reserve {
    const struct press_collocation *of;
    enum press_quantity quantity;
    double factor, offset;
};

/* Value and slope at s of factor quantity + offset - envelope; a bracket_function of a struct press_reserve. */
void press_reserve_at(const void *press_reserve, double s, double *value, double *slope);

/* The same from what press_collocation_sample_slow says there; the envelope is press_envelope_of. */
void press_reserve_from(const struct press_reserve *reserve, const struct oscillator_envelope *envelope,
                        double s, const struct press_sample *slow, double *value, double *slope);

/* What the oscillation alone brings to a quantity. */
struct oscillator_envelope press_envelope_of(const struct press_collocation *p, enum press_quantity quantity);

struct press_change press_collocation_change(const struct press_collocation *p, double s);

#endif
#endif
