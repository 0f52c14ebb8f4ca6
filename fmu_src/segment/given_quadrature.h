/*
 * The force of a contact while all motion is given, between two places of a communication step next to each
 * other at which its law may change: a quadrature whose panels are halved until halves and whole agree.
 */
#ifndef CONTACT_SEGMENT_GIVEN_QUADRATURE_H
#define CONTACT_SEGMENT_GIVEN_QUADRATURE_H

#include "scene/present.h"

/* So many panels of a step may be halved. A pass of the centres at a distance of 1e-16 takes about a hundred;
 * a step has at most some dozen such places. */
enum { HALVINGS = 4096 };

/* One contact over a step, s in [0, 1]. */
struct given_step {
    const struct scene_values *v;
    struct scene_state *q; /* its regime is the one that is looked at */
    int contact;
    double length; /* of the step [s] */
    int halvings;  /* that are left */
};

struct contact_state *given_contact(const struct given_step *step);

/* At s; bodies and contacts. */
void given_instant(const struct given_step *step, double s, struct scene_instant *at);

/* The regime, the mean force and the peaks between two places next to each other at which the law may change,
 * or the gap has an extreme. */
void given_integrate_between(struct given_step *step, double from, double to);

#endif
