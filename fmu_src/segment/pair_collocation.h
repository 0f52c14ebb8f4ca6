/* A contact pair by collocation in local coordinates (segment/collocation.h): steps as long as the tangential
 * motion allows, whatever the penalty factor. Variable s in [0, 2], time = half s. */
#ifndef CONTACT_SEGMENT_PAIR_COLLOCATION_H
#define CONTACT_SEGMENT_PAIR_COLLOCATION_H

#include "segment/collocation.h"
#include "segment/contact_pair.h"

/* Rates and sizes of the motion at the start of a step. */
struct pair_timescales {
    struct collocation_problem problem;
    /* coefficients of C, from the first one on: the part that the contact's motion feels */
    struct vec3 felt[SEPARATION_DEGREE];
    double distance;   /* d [m]; INFINITY of a plane, whose normal never turns */
    double rate_along; /* |c' along the contact| / d [1/s] */
    /* rate_along + sqrt(|A| / d) at the start: n turns by about a radian in its inverse [1/s] */
    double tangential_rate;
    /* of the radial oscillator; sqrt(p_n / m_red) below critical damping [1/s] */
    struct oscillator_rates rates;
    double oscillation;       /* amplitude of the oscillation of x about its particular solution [m] */
    bool underdamped;         /* below critical damping */
    double equilibrium_depth; /* penetration at equilibrium with the load, -side f / omega2 [m] */
};

void pair_timescales_make(struct pair_timescales *out, const struct contact_pair *p);

/* The largest tangential rate within a step of so many seconds [1/s]. It exceeds that at the start where the
 * relative acceleration A grows with time, perhaps from zero. */
double pair_tangential_rate_within(const struct pair_timescales *scales, double step);

/* The longest step, up to `longest` [s], in which the tangential motion covers about `radians`. */
double pair_step_within(const struct pair_timescales *scales, double longest, double radians);

struct pair_collocation {
    const struct contact_pair *from;
    const struct vec3 *felt; /* of pair_timescales */
    struct collocation step;
};

void pair_collocation_sample(const void *pair_collocation, double s, struct pair_sample *sample);

/* The same at a Lobatto node, cheaper. */
void pair_collocation_sample_node(const struct pair_collocation *p, int node, struct pair_sample *sample);

/* Of the averaged motion, the oscillation left out. */
void pair_collocation_sample_averaged(const void *pair_collocation, double s, struct pair_sample *sample);

/* Lower bound of factor quantity + offset in an averaged step: the averaged quantity less the envelope of the
 * oscillation. */
struct pair_lower_bound {
    const struct pair_collocation *of;
    enum pair_quantity quantity;
    double factor, offset;
};

/* Value and slope at s of factor quantity + offset - envelope; a root_function of a struct
 * pair_lower_bound. */
void pair_lower_bound_at(const void *pair_lower_bound, double s, double *value, double *slope);

/* The same from the averaged sample at s; `envelope` is pair_envelope_of the bounded quantity. */
void pair_lower_bound_from(const struct pair_lower_bound *bound, const struct oscillator_envelope *envelope,
                           double s, const struct pair_sample *slow, double *value, double *slope);

/* What the oscillation alone adds to a quantity but for its sign (the force is minus it): its value at the
 * start and its rate per s. */
void pair_free_oscillation(const struct pair_collocation *p, enum pair_quantity quantity, double *start,
                           double *rate);

/* Bound of it. */
struct oscillator_envelope pair_envelope_of(const struct pair_collocation *p, enum pair_quantity quantity);

struct pair_change pair_collocation_change(const void *pair_collocation, double s);

#endif
